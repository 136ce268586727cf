//! Eight samples side by side.
//!
//! The batch estimators do the same arithmetic for eight samples at a time, element by element, which compilers turn
//! into whatever vector unit the target has. Sums over samples keep eight partial sums and join them in one fixed
//! order, so the width of the unit never shows in the result.

use crate::real::Real;
use core::hint::black_box;

/// How many samples a panel holds.
pub(crate) const LANES: usize = 8;

/// One value for each of eight samples.
pub(crate) type Lanes<R, const L: usize = LANES> = [R; L];

// Always inlined, and so before anything else is: what is inlined later is scalar in places.

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

/// `f(a)` lane by lane, as a loop: compilers do not inline an array's `map` that has so much in it, and then it does
/// not use the vector units that its caller may.
#[inline(always)]
pub(crate) fn each(a: &Lanes<f32>, f: impl Fn(f32) -> f32) -> Lanes<f32> {
    let mut out = *a;
    for value in &mut out {
        *value = f(*value);
    }
    out
}

/// Ends an iteration of a loop over groups of lanes. Compilers would else unroll the lanes and go through several
/// iterations at once, with shuffles that take longer than the arithmetic.
#[inline(always)]
pub(crate) fn keep_together() {
    black_box(());
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

/// Sums less products, one after the other: of each sum with a column of `a`. As many as both have.
#[inline(always)]
pub(crate) fn minus_products<R: Real, const N: usize>(
    sums: [Lanes<R>; N],
    a: &[[Lanes<R>; N]],
    b: &[Lanes<R>],
) -> [Lanes<R>; N] {
    with_products(sums, a, b, minus_product)
}

/// The same by [`plus_product`], or [`minus_product`].
#[inline(always)]
pub(crate) fn with_products<R: Real, const N: usize>(
    mut sums: [Lanes<R>; N],
    a: &[[Lanes<R>; N]],
    b: &[Lanes<R>],
    with: impl Fn(Lanes<R>, Lanes<R>, Lanes<R>) -> Lanes<R>,
) -> [Lanes<R>; N] {
    // Of one length, or finding where to end takes as long as the arithmetic, as does going through them one by one.
    let len = a.len().min(b.len());
    let (Some(a), Some(b)) = (a.get(..len), b.get(..len)) else { return sums };
    let ((pairs, rest), (others, last)) = (a.as_chunks::<2>(), b.as_chunks::<2>());
    for ([x, y], [l, m]) in pairs.iter().zip(others) {
        for n in 0..N {
            sums[n] = with(with(sums[n], x[n], *l), y[n], *m);
        }
        keep_together();
    }
    if let ([x], [l]) = (rest, last) {
        for n in 0..N {
            sums[n] = with(sums[n], x[n], *l);
        }
    }
    sums
}

/// The lanes that are positive, elsewhere 1: what may be divided by.
///
/// Behind a black box: a compiler that knew where the ones come from would divide by zero there and drop the result,
/// which hosts that trap that do not survive.
#[inline(always)]
pub(crate) fn divisor<R: Real, const L: usize>(a: &Lanes<R, L>) -> Lanes<R, L> {
    black_box(a.map(Real::or_one))
}

/// The sum of the eight lanes, always as ((0+4)+(2+6)) + ((1+5)+(3+7)).
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
        let mut partial = [R::ZERO; LANES];
        for (a, b) in a_panels.iter().zip(b_panels) {
            partial = plus_product(partial, *a, *b);
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
    const TWICE: f32 = 2.0 * core::f32::consts::LOG2_E;
    each(x, |x| {
        let bits = x.to_bits().wrapping_sub(SMALLEST) as i32;
        let exponent = bits >> 23;
        let m = f32::from_bits(((bits & 0x7f_ffff) as u32).wrapping_add(SMALLEST));
        let t = (m - 1.0) / (m + 1.0);
        let square = t * t;
        let series = 1.0 + square * (1.0 / 3.0 + square * (0.2 + square * (1.0 / 7.0 + square * (1.0 / 9.0))));
        exponent as f32 + TWICE * t * series
    })
}

/// 2 to the power of x lane by lane, for x from -126 to 126, what is beyond counted as that; within 3e-7 of it.
#[inline(always)]
pub(crate) fn exp2(x: &Lanes<f32>) -> Lanes<f32> {
    // Adding this rounds to an integer, which is then in the low bits.
    const ROUND: f32 = 12_582_912.0;
    const LN_2: f32 = core::f32::consts::LN_2;
    each(x, |x| {
        let x = if x > -126.0 { x } else { -126.0 };
        let x = if x < 126.0 { x } else { 126.0 };
        let rounded = x + ROUND;
        // From -ln 2 / 2 to that: the series of the exponential function.
        let f = (x - (rounded - ROUND)) * LN_2;
        let series = 1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0));
        let fraction = 1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * series)));
        let power = rounded.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(127) << 23;
        fraction * f32::from_bits(power)
    })
}

#[cfg(test)]
#[path = "../tests/parts/lanes.rs"]
mod tests;
