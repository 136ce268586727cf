//! The functions of two coordinates that q and A are made of.

use super::super::products::*;

/// Functions of the coordinates: of degree 1, then of degree 2.
pub(super) const FUNCTIONS: usize = 5;
/// Those that A has.
pub(super) const SLOPES: usize = 2;
pub(super) const SQRT_3: f32 = super::super::batch::SQRT_3 as f32;
pub(super) const SQRT_5: f32 = 2.236_068;

/// The orthonormal Legendre polynomial of degree 1 of a coordinate.
pub(super) const fn linear(u: f32) -> f32 {
    (u + u - 1.0) * SQRT_3
}

#[inline(always)]
pub(super) fn functions(x: &Four, y: &Four) -> [Four; FUNCTIONS] {
    let mut out = [[NONE; AT_ONCE]; FUNCTIONS];
    let place = |u: &Eight| lanes::each(u, linear);
    let square = |x: &Eight| lanes::each(x, |x| (x * x - 1.0) * (0.5 * SQRT_5));
    for row in 0..AT_ONCE {
        let (x, y) = (place(&x[row]), place(&y[row]));
        let xy = product(&x, &y);
        for (out, function) in out.iter_mut().zip([x, y, square(&x), xy, square(&y)]) {
            out[row] = function;
        }
    }
    out
}
