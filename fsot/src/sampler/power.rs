//! The kernel of the energy: minus the distance of two points to a power.

use std::f32::consts::LN_2;

/// Numbers that are worked on side by side.
pub(crate) const LANES: usize = 8;

/// `squared`^half, to 6e-5 of it, for numbers from 1e-10 to 4. The same bits on every machine.
#[inline(always)]
pub(crate) fn power(squared: f32, half: f32) -> f32 {
    // The exponent and the logarithm of the mantissa from sqrt(1/2) to sqrt(2).
    let bits = (squared + 1e-10).to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = (bits as i32 >> 23) as f32;
    let mantissa = f32::from_bits((bits & 0x007f_ffff).wrapping_add(0x3f35_04f3)) - 1.0;
    let quotient = mantissa / (mantissa + 2.0);
    let square = quotient * quotient;
    let logarithm = exponent + quotient * (2.885_39 + square * (0.961_796_7 + square * 0.598_978_65));
    let wanted = logarithm * half;
    // Rounded by a number whose last bit is 1.
    let rounded = wanted + 12_582_912.0;
    let whole = rounded.to_bits().wrapping_sub(0x4b40_0000);
    let rest = wanted - (rounded - 12_582_912.0);
    let value = 1.0 + rest * (LN_2 + rest * (0.240_226_5 + rest * (0.055_504_1 + rest * 0.009_618_13)));
    f32::from_bits(value.to_bits().wrapping_add(whole << 23))
}

/// The sum over points j of weight j times power(distance of (x, y) to point j): minus the energies of a point with
/// others. `take` is told the terms, eight by eight.
#[inline(always)]
fn each([x, y]: [f32; 2], [xs, ys, weights]: [&[f32]; 3], half: f32, mut take: impl FnMut(usize, [f32; LANES])) -> f32 {
    let mut sums = [0.0f32; LANES];
    let [xs, ys, weights] = [xs, ys, weights].map(|all| all.as_chunks::<LANES>().0);
    for (chunk, ((xs, ys), weights)) in xs.iter().zip(ys).zip(weights).enumerate() {
        let mut terms = [0.0; LANES];
        for lane in 0..LANES {
            let (dx, dy) = (xs[lane] - x, ys[lane] - y);
            terms[lane] = weights[lane] * power(dx * dx + dy * dy, half);
            sums[lane] += terms[lane];
        }
        take(chunk, terms);
    }
    total(&sums)
}

/// That sum; `into` gets the terms.
#[inline]
pub(crate) fn terms(at: [f32; 2], points: [&[f32]; 3], half: f32, into: &mut [f32]) -> f32 {
    let into = into.as_chunks_mut::<LANES>().0;
    each(at, points, half, |chunk, terms| into[chunk] = terms)
}

/// That sum.
#[inline]
pub(crate) fn sum(at: [f32; 2], points: [&[f32]; 3], half: f32) -> f32 {
    each(at, points, half, |_, _| ())
}

#[inline(always)]
pub(crate) fn total(s: &[f32; LANES]) -> f32 {
    ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for half in [0.05f32, 0.325, 0.5, 0.75] {
            for i in 1..=2000 {
                let squared = (i as f32 / 1000.0).powi(3) / 4.0;
                let (ours, exact) = (power(squared, half), libm::pow(f64::from(squared) + 1e-10, f64::from(half)));
                assert!((f64::from(ours) / exact - 1.0).abs() < 6e-5, "{squared}^{half}: {ours} for {exact}");
            }
        }
    }

    #[test]
    fn sums_are_those_of_their_terms() {
        let points = |factor: f32| -> [f32; 16] { std::array::from_fn(|i| (i as f32 * factor).fract()) };
        let (xs, ys, weights) = (points(0.37), points(0.61), points(0.23));
        let mut into = [0.0; 16];
        let all = terms([0.3, 0.8], [&xs, &ys, &weights], 0.325, &mut into);
        for i in 0..16 {
            let (dx, dy) = (f64::from(xs[i]) - 0.3, f64::from(ys[i]) - 0.8);
            let exact = f64::from(weights[i]) * libm::pow(dx * dx + dy * dy, 0.325);
            assert!((f64::from(into[i]) - exact).abs() < 1e-4, "{i}");
        }
        assert!((all - into.iter().sum::<f32>()).abs() < 1e-5);
        assert_eq!(sum([0.3, 0.8], [&xs, &ys, &weights], 0.325), all);
    }
}
