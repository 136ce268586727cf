//! How the samples of each hard case are made. Each position alone is uniform over the cube, so that the plain mean is
//! right on average; it is how positions lie to each other, or the values, that is hard.

use noisefloor_tests::integrands::Integrand;
use noisefloor_tests::random::SplitMix64;

/// Makes `u` and `f` of one repetition.
pub(crate) type Draw = Box<dyn Fn(&mut SplitMix64, &mut [f32], &mut [f32])>;

/// One hard case for control variates.
pub(crate) struct Case {
    pub(crate) group: &'static str,
    pub(crate) name: String,
    pub(crate) dims: usize,
    pub(crate) order: usize,
    pub(crate) counts: Vec<usize>,
    pub(crate) integral: f64,
    pub(crate) draw: Draw,
}

/// exp(-sum u), and its integral.
fn smooth(u: &[f32]) -> f64 {
    (-u.iter().map(|&u| f64::from(u)).sum::<f64>()).exp()
}

fn integral_of_smooth(dims: usize) -> f64 {
    (1.0 - (-1.0_f64).exp()).powi(dims as i32)
}

fn spread(rng: &mut SplitMix64, u: &mut [f32]) {
    u.iter_mut().for_each(|u| *u = rng.uniform_f32());
}

/// Independent positions, and a value for each.
fn independent(
    group: &'static str,
    name: &str,
    [dims, order]: [usize; 2],
    counts: &[usize],
    integral: f64,
    value: impl Fn(&[f32], &mut SplitMix64) -> f64 + 'static,
) -> Case {
    let draw = move |rng: &mut SplitMix64, u: &mut [f32], f: &mut [f32]| {
        spread(rng, u);
        f.iter_mut().zip(u.chunks(dims)).for_each(|(f, u)| *f = value(u, rng) as f32);
    };
    Case { group, name: name.to_owned(), dims, order, counts: counts.to_vec(), integral, draw: Box::new(draw) }
}

/// Two coordinates, order 3, values of [`smooth`]; `place` moves positions that were spread.
fn placed(name: &str, place: impl Fn(&mut SplitMix64, &mut [f32]) + 'static) -> Case {
    let draw = move |rng: &mut SplitMix64, u: &mut [f32], f: &mut [f32]| {
        spread(rng, u);
        place(rng, u);
        f.iter_mut().zip(u.chunks(2)).for_each(|(f, u)| *f = smooth(u) as f32);
    };
    let (dims, order, counts) = (2, 3, vec![16, 64]);
    let integral = integral_of_smooth(2);
    Case { group: "places", name: name.to_owned(), dims, order, counts, integral, draw: Box::new(draw) }
}

/// Only the first `distinct` positions, each again and again.
fn copies(u: &mut [f32], distinct: usize) {
    for i in 2 * distinct..u.len() {
        u[i] = u[i % (2 * distinct)];
    }
}

/// All positions in a box of this size.
fn boxed(rng: &mut SplitMix64, u: &mut [f32], size: f32) {
    let corner = [rng.uniform_f32(), rng.uniform_f32()].map(|x| (1.0 - size) * x);
    u.iter_mut().enumerate().for_each(|(i, u)| *u = corner[i % 2] + size * *u);
}

/// In the order in which the chapter shows them.
pub(crate) fn cases() -> Vec<Case> {
    let plain = |u: &[f32], _: &mut SplitMix64| smooth(u);
    let mut cases = vec![
        independent("few samples", "independent positions", [2, 3], &[1, 2, 5, 10, 11], integral_of_smooth(2), plain),
        placed("on a line, in a random place", |rng, u| {
            let shift = rng.uniform_f32();
            u.chunks_mut(2).for_each(|u| u[1] = (u[0] + shift).fract());
        }),
        placed("each position twice", |_, u| copies(u, u.len() / 4)),
        placed("each position four times", |_, u| copies(u, u.len() / 8)),
        placed("two distinct positions", |_, u| copies(u, 2)),
        placed("all at one position", |_, u| copies(u, 1)),
        placed("in a box of 1e-3", |rng, u| boxed(rng, u, 1e-3)),
        placed("in a box of 1e-6", |rng, u| boxed(rng, u, 1e-6)),
    ];
    cases.extend(values());
    cases.extend(integrands());
    let many = |name: &str, dims, order, counts: &[usize]| {
        independent("many terms", name, [dims, order], counts, integral_of_smooth(dims), plain)
    };
    cases.extend([
        many("1 dim, order 7", 1, 7, &[8, 64]),
        many("2 dims, order 7", 2, 7, &[16, 64]),
        many("3 dims, order 7", 3, 7, &[64, 130]),
        many("15 dims, order 2", 15, 2, &[64, 136]),
        many("16 dims, order 1", 16, 1, &[16, 64]),
    ]);
    cases
}

/// Values that arithmetic could lose, or a fit could fall for.
fn values() -> Vec<Case> {
    const COUNTS: [usize; 2] = [16, 64];
    let exact = integral_of_smooth(2);
    let scaled = |factor: f64, offset: f64| {
        let name = match (factor, offset) {
            (_, 0.0) => format!("times {factor:e}"),
            (1.0, _) => format!("plus {offset:e}"),
            _ => format!("{offset} plus {factor:e} times"),
        };
        let value = move |u: &[f32], _: &mut SplitMix64| offset + factor * smooth(u);
        independent("values", &name, [2, 3], &COUNTS, offset + factor * exact, value)
    };
    let mut cases: Vec<Case> =
        [(1e-42, 0.0), (1e-30, 0.0), (1e30, 0.0), (3e38, 0.0), (1.0, 1e4), (1.0, 1e8), (1.0, 1e12), (1e-6, 1.0)]
            .map(|(factor, offset)| scaled(factor, offset))
            .into();
    let magnitudes = (1e20 - 1e-20) / (40.0 * 10.0_f64.ln());
    cases.push(independent("values", "1e-20 to 1e20", [2, 3], &COUNTS, magnitudes, |u, _| {
        10.0_f64.powf(40.0 * f64::from(u[0]) - 20.0)
    }));
    cases.push(independent("values", "one in a hundred is 1e20", [2, 3], &COUNTS, 0.99 * exact + 1e18, |u, rng| {
        if rng.uniform() < 0.01 { 1e20 } else { smooth(u) }
    }));
    cases.push(independent("values", "one in sixteen is 1, others 0", [2, 3], &COUNTS, 0.0625, |_, rng| {
        f64::from(u8::from(rng.uniform() < 0.0625))
    }));
    cases.push(independent("values", "noise, whatever the position", [2, 3], &COUNTS, 0.0, |_, rng| rng.normal()));
    cases.push(independent("values", "the sign of noise, times 3e38", [2, 3], &COUNTS, 0.0, |_, rng| {
        3e38 * rng.normal().signum()
    }));
    cases
}

/// Needles, steps and whatever else the tests call adversarial.
fn integrands() -> Vec<Case> {
    let chosen = ["step", "gaussian", "four lights", "kink", "disc", "discontinuous"];
    let all = noisefloor_tests::integrands::all();
    let adversarial = noisefloor_tests::integrands::adversarial();
    let named = all.into_iter().filter(|integrand| chosen.contains(&integrand.name));
    let case = |Integrand { name, dims, integral, evaluate }: Integrand| {
        independent("integrands", name, [dims, 3], &[16, 64], integral, move |u, _| {
            let mut point = [0.0; 16];
            point.iter_mut().zip(u).for_each(|(x, &u)| *x = u.into());
            evaluate(&point[..dims])
        })
    };
    adversarial.into_iter().chain(named).map(case).collect()
}
