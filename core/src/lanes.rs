//! Eight samples side by side.
//!
//! The batch estimators do the same arithmetic for eight samples at a time, element by element, which compilers turn
//! into whatever vector unit the target has. Sums over samples keep eight partial sums and join them in one fixed
//! order, so the width of the unit never shows in the result.

use crate::real::Real;

/// How many samples a panel holds.
pub(crate) const LANES: usize = 8;

/// One value for each of eight samples.
pub(crate) type Lanes<R, const L: usize = LANES> = [R; L];

/// The same value in every lane.
#[inline(always)]
pub(crate) fn splat<R: Real, const L: usize>(value: R) -> Lanes<R, L> {
    [value; L]
}

// The operations copy their operands before they store: compilers then know that no store changes an operand, without
// which they would not use vector instructions.

/// `f(a, b)` lane by lane.
#[inline(always)]
pub(crate) fn zip<R: Real, const L: usize>(a: &Lanes<R, L>, b: &Lanes<R, L>, f: impl Fn(R, R) -> R) -> Lanes<R, L> {
    let (mut out, b) = (*a, *b);
    for l in 0..L {
        out[l] = f(out[l], b[l]);
    }
    out
}

/// `a + b * c` lane by lane.
#[inline(always)]
pub(crate) fn plus_product<R: Real, const L: usize>(a: Lanes<R, L>, b: Lanes<R, L>, c: Lanes<R, L>) -> Lanes<R, L> {
    let mut out = a;
    for l in 0..L {
        out[l] += b[l] * c[l];
    }
    out
}

/// `a - b * c` lane by lane.
#[inline(always)]
pub(crate) fn minus_product<R: Real, const L: usize>(a: Lanes<R, L>, b: Lanes<R, L>, c: Lanes<R, L>) -> Lanes<R, L> {
    let mut out = a;
    for l in 0..L {
        out[l] -= b[l] * c[l];
    }
    out
}

/// `a += b * c` lane by lane.
#[inline(always)]
pub(crate) fn add_product<R: Real, const L: usize>(a: &mut Lanes<R, L>, b: &Lanes<R, L>, c: &Lanes<R, L>) {
    *a = plus_product(*a, *b, *c);
}

/// `a += s * b` lane by lane.
#[inline(always)]
pub(crate) fn add_scaled<R: Real, const L: usize>(a: &mut Lanes<R, L>, s: R, b: &Lanes<R, L>) {
    let (mut out, b) = (*a, *b);
    for l in 0..L {
        out[l] += s * b[l];
    }
    *a = out;
}

/// `a -= s * b` lane by lane.
#[inline(always)]
pub(crate) fn subtract_scaled<R: Real, const L: usize>(a: &mut Lanes<R, L>, s: R, b: &Lanes<R, L>) {
    let (mut out, b) = (*a, *b);
    for l in 0..L {
        out[l] -= s * b[l];
    }
    *a = out;
}

/// The sum of the eight lanes, always as ((0+4)+(2+6)) + ((1+5)+(3+7)).
#[inline(always)]
pub(crate) fn sum<R: Real>(a: &Lanes<R>) -> R {
    let [a0, a1, a2, a3, a4, a5, a6, a7] = *a;
    ((a0 + a4) + (a2 + a6)) + ((a1 + a5) + (a3 + a7))
}

/// The dot product of two rows, with eight partial sums; the shorter row sets the length.
#[inline(always)]
pub(crate) fn dot<R: Real>(a: &[R], b: &[R]) -> R {
    let (a_panels, a_rest) = a.as_chunks::<LANES>();
    let (b_panels, b_rest) = b.as_chunks::<LANES>();
    let mut total = R::ZERO;
    if !a_panels.is_empty() {
        let mut partial = splat(R::ZERO);
        for (a, b) in a_panels.iter().zip(b_panels) {
            add_product(&mut partial, a, b);
        }
        total = sum(&partial);
    }
    for (&a, &b) in a_rest.iter().zip(b_rest) {
        total += a * b;
    }
    total
}

/// The base-2 logarithm lane by lane, of positive normal numbers; within 3e-7 of it, or of its magnitude if larger.
#[inline(always)]
pub(crate) fn log2(x: &Lanes<f32>) -> Lanes<f32> {
    // x = m 2^e with m from sqrt(1/2) to sqrt(2), and ln m = 2 (t + t^3 / 3 + ...) with t = (m - 1) / (m + 1).
    const SMALLEST: u32 = 0x3f35_04f3;
    const SERIES: [f32; 5] = [2.885_39, 0.961_796_7, 0.577_078, 0.412_198_6, 0.320_598_9];
    let mut out = *x;
    for l in 0..LANES {
        let bits = out[l].to_bits().wrapping_sub(SMALLEST) as i32;
        let exponent = bits >> 23;
        let m = f32::from_bits(((bits & 0x7f_ffff) as u32).wrapping_add(SMALLEST));
        let t = (m - 1.0) / (m + 1.0);
        let square = t * t;
        let [a, b, c, d, e] = SERIES;
        out[l] = exponent as f32 + t * (a + square * (b + square * (c + square * (d + square * e))));
    }
    out
}

/// 2 to the power of x lane by lane, for x from -126 to 126, what is beyond counted as that; within 3e-7 of it.
#[inline(always)]
pub(crate) fn exp2(x: &Lanes<f32>) -> Lanes<f32> {
    // Adding this rounds to an integer, which is then in the low bits.
    const ROUND: f32 = 12_582_912.0;
    const SERIES: [f32; 6] = [0.693_147_2, 0.240_226_5, 0.055_504_1, 0.009_618_13, 0.001_333_36, 0.000_154_04];
    let mut out = *x;
    for l in 0..LANES {
        let x = out[l];
        let x = if x > -126.0 { x } else { -126.0 };
        let x = if x < 126.0 { x } else { 126.0 };
        let rounded = x + ROUND;
        let f = x - (rounded - ROUND);
        let [a, b, c, d, e, g] = SERIES;
        let fraction = 1.0 + f * (a + f * (b + f * (c + f * (d + f * (e + f * g)))));
        let power = rounded.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(127) << 23;
        out[l] = fraction * f32::from_bits(power);
    }
    out
}
