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
