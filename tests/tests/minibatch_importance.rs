//! Importance functions: against plain f64 and differences of the loss, at the limits, and what they refuse.

use noisefloor::Error;
use noisefloor::minibatch::importance::{self, Softmax, Split};
use noisefloor::rng::Rng;
use proptest::prelude::*;

/// The norm over all nodes, NaN where it is refused.
fn of_all(gradient: &[f32]) -> f32 {
    let mut norm = [f32::NAN];
    importance::nodes(gradient, Split::Norm, &mut norm).ok();
    norm[0]
}

/// -ln softmax(z)[label], for logits of moderate size.
fn loss(z: &[f64], label: usize) -> f64 {
    z.iter().map(|z| z.exp()).sum::<f64>().ln() - z[label]
}

fn softmax(z: &[f64]) -> Vec<f64> {
    let sum: f64 = z.iter().map(|z| z.exp()).sum();
    z.iter().map(|z| z.exp() / sum).collect()
}

fn norm(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn assert_close(actual: f32, expected: f64) {
    // Half a unit in the last place of f32, and the oracle's own rounding where it cancels.
    assert!((f64::from(actual) - expected).abs() <= 1e-7 * expected.abs() + 1e-14, "{actual} is not {expected}");
}

fn random(rng: &mut Rng, len: usize, size: f32) -> Vec<f32> {
    (0..len).map(|_| size * (2.0 * rng.uniform_f32() - 1.0)).collect()
}

#[test]
fn cross_entropy_is_the_oracle() {
    let mut rng = Rng::seed(1);
    for classes in [1, 2, 3, 10, 1000] {
        for size in [0.0, 0.1, 3.0, 30.0] {
            let logits = random(&mut rng, classes, size);
            let z: Vec<f64> = logits.iter().map(|&z| z.into()).collect();
            for label in [0, classes / 2, classes - 1] {
                let expected: Vec<f64> =
                    softmax(&z).iter().enumerate().map(|(k, s)| s - f64::from(k == label)).collect();
                let softmax = Softmax::new(&logits, label).unwrap();
                assert_close(softmax.norm(), norm(expected.iter().copied()));
                assert_close(softmax.loss(), loss(&z, label));
                let gradient: Vec<f32> = softmax.gradient().collect();
                assert_eq!(gradient.len(), classes);
                gradient.iter().zip(&expected).for_each(|(&g, &e)| assert_close(g, e));
                let sum: f64 = gradient.iter().map(|&g| f64::from(g)).sum();
                assert!(sum.abs() < 1e-6);
                assert_close(of_all(&gradient), norm(gradient.iter().map(|&g| g.into())));
            }
        }
    }
}

/// Central differences in f64: the derivative is the loss's.
#[test]
fn gradients_are_differences_of_the_loss() {
    let mut rng = Rng::seed(2);
    for classes in [2, 5, 17] {
        let logits = random(&mut rng, classes, 4.0);
        let label = rng.below(classes as u32) as usize;
        let gradient: Vec<f32> = Softmax::new(&logits, label).unwrap().gradient().collect();
        let target = random(&mut rng, classes, 4.0);
        let mut squares = Vec::new();
        for k in 0..classes {
            let h = 1e-4;
            let at = |offset: f64| {
                let mut z: Vec<f64> = logits.iter().map(|&z| z.into()).collect();
                z[k] += offset;
                z
            };
            let difference = (loss(&at(h), label) - loss(&at(-h), label)) / (2.0 * h);
            assert!((difference - f64::from(gradient[k])).abs() < 1e-7, "{difference} {}", gradient[k]);
            let square = |z: &[f64]| z.iter().zip(&target).map(|(z, &t)| (z - f64::from(t)).powi(2)).sum::<f64>();
            squares.push((square(&at(h)) - square(&at(-h))) / (2.0 * h));
        }
        let expected = norm(squares);
        assert!((f64::from(importance::squared_error(&logits, &target)) - expected).abs() < 1e-6 * expected);
    }
}

/// Where f32 arithmetic, or a softmax without its maximum taken off, gives NaN, 0 or infinity.
#[test]
fn limits() {
    for (logits, label, norm, loss) in [
        (&[1e38, -1e38][..], 0, 0.0, 0.0),
        (&[1e38, -1e38], 1, 2f32.sqrt(), 2e38),
        (&[f32::MAX, f32::MIN], 1, 2f32.sqrt(), f32::MAX),
        (&[f32::MAX, f32::MAX], 1, 0.5f32.sqrt(), std::f32::consts::LN_2),
        (&[1e38; 4], 3, 0.75f32.sqrt(), 4f32.ln()),
        (&[-1e38, -1e38, -1e38], 0, (2f32 / 3.0).sqrt(), 3f32.ln()),
        (&[5.0], 0, 0.0, 0.0),
        // 1 - softmax is e^-60 / (1 + e^-60): far below f32's and f64's resolution at 1.
        (&[60.0, 0.0], 0, 2f32.sqrt() * 8.756_511e-27, 8.756_511e-27),
    ] {
        let close = |a: f32, b: f32| (a - b).abs() <= 2e-7 * b.abs();
        let softmax = Softmax::new(logits, label).unwrap();
        assert!(close(softmax.norm(), norm), "{logits:?}");
        assert!(close(softmax.loss(), loss), "{logits:?}");
        let gradient: Vec<f32> = softmax.gradient().collect();
        assert!(close(of_all(&gradient), norm), "{logits:?} {gradient:?}");
    }
    assert!(Softmax::new(&[1e38, -1e38], 1).unwrap().gradient().eq([1.0, -1.0]));
    assert_close(of_all(&[1e38, -1e38]), 2f64.sqrt() * f64::from(1e38_f32));
    assert_close(importance::squared_error(&[1e38], &[1.0]), 2.0 * f64::from(1e38_f32));
    assert_eq!(importance::squared_error(&[3e38, -3e38], &[-3e38, 3e38]), f32::MAX);
    assert_eq!(of_all(&[f32::MAX; 3]), f32::MAX);
    assert_eq!(of_all(&[1e-45]), 1e-45);
    assert_eq!(importance::squared_error(&[1.5], &[1.0]), 1.0);
}

#[test]
fn wrong_input_is_nan_or_an_error() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let values = [0.0, bad];
        assert_eq!(Softmax::new(&values, 0).err(), Some(Error::NotFinite));
        assert!(importance::squared_error(&values, &[0.0; 2]).is_nan());
        assert!(importance::squared_error(&[0.0; 2], &values).is_nan());
        assert!(of_all(&values).is_nan());
        let mut out = [7.0; 2];
        assert_eq!(importance::nodes(&values, Split::Norm, &mut out), Err(Error::NotFinite));
        assert_eq!(out, [7.0; 2]);
    }
    assert_eq!(Softmax::new(&[], 0).err(), Some(Error::Range));
    assert_eq!(Softmax::new(&[0.0], 1).err(), Some(Error::Range));
    assert!(importance::squared_error(&[], &[]).is_nan());
    assert!(importance::squared_error(&[1.0], &[1.0, 2.0]).is_nan());
    assert!(of_all(&[]).is_nan());
    let mut out = [7.0; 34];
    for (nodes, split, techniques) in [
        (20, Split::Norm, 0),
        (20, Split::Norm, 17),
        (20, Split::Sign, 0),
        (20, Split::Sign, 3),
        (20, Split::Sign, 18),
        (2, Split::Norm, 3),
        (0, Split::Norm, 1),
        (0, Split::Sign, 2),
        (1, Split::Sign, 4),
    ] {
        assert_eq!(importance::nodes(&[1.0; 20][..nodes], split, &mut out[..techniques]), Err(Error::Range));
    }
    assert_eq!(out, [7.0; 34]);
}

#[test]
fn nodes_are_grouped() {
    let gradient = [3.0, -1.0, 4.0, -1.0, -5.0];
    let nodes = |split, techniques| {
        let mut out = vec![f32::NAN; techniques];
        importance::nodes(&gradient, split, &mut out).unwrap();
        out
    };
    let root = |square: f32| square.sqrt();
    assert_eq!(nodes(Split::Norm, 1), [root(52.0)]);
    assert_eq!(nodes(Split::Norm, 2), [root(50.0), root(2.0)]);
    assert_eq!(nodes(Split::Norm, 5), gradient.map(f32::abs));
    assert_eq!(nodes(Split::Sign, 2), [5.0, root(27.0)]);
    assert_eq!(nodes(Split::Sign, 4), [5.0, 5.0, 0.0, root(2.0)]);
    assert_eq!(nodes(Split::Sign, 10), [3.0, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 1.0, 0.0, 5.0]);
}

proptest! {
    #[test]
    fn anything_finite_gives_finite(
        bits in prop::collection::vec(any::<u32>(), 1..20),
        label in 0_usize..25,
        sign in any::<bool>(),
        techniques in 0_usize..20,
    ) {
        let values: Vec<f32> = bits.iter().map(|&bits| f32::from_bits(bits)).collect();
        let finite = values.iter().all(|v| v.is_finite());
        let valid = finite && label < values.len();
        let softmax = Softmax::new(&values, label);
        prop_assert_eq!(softmax.is_ok(), valid);
        if let Ok(softmax) = softmax {
            prop_assert!((0.0..1.4143).contains(&softmax.norm()));
            prop_assert!(softmax.loss().is_finite() && softmax.loss() >= 0.0);
            prop_assert!(softmax.gradient().all(|g| g.abs() <= 1.0));
        }
        prop_assert_eq!(of_all(&values).is_finite(), finite);
        prop_assert_eq!(importance::squared_error(&values, &values) == 0.0, finite);
        let mut out = vec![f32::NAN; techniques];
        let split = if sign { Split::Sign } else { Split::Norm };
        let answer = importance::nodes(&values, split, &mut out);
        let right = out.iter().all(|q| if answer.is_ok() { q.is_finite() && *q >= 0.0 } else { q.is_nan() });
        prop_assert!(right);
    }
}
