//! One-dimensional functions: orthonormal on [0, 1], integral zero.

use crate::lanes::Lanes;
use crate::matrix::at;
use crate::real::Real;

/// Which one-dimensional functions a basis is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Family {
    /// Orthonormal shifted Legendre polynomials.
    #[default]
    Legendre,
    /// Walsh functions: piecewise constant on eighths.
    Step,
    /// Half-waves sin(pi d x + pi/2), which are cos(pi d x).
    Sine,
    /// Isotropic Gaussians.
    Gaussian,
}

impl Family {
    /// Every one, in the order of their numbers in C.
    pub const ALL: [Family; 4] = [Self::Legendre, Self::Step, Self::Sine, Self::Gaussian];
}

/// What the recurrences of a family run on. Legendre: 2x - 1. Sine: cos(pi x). Otherwise x.
// As all that evaluates a basis: without, estimates of one pixel take 2 to 5 % more instructions, image fits 3 %.
#[inline(always)]
pub(crate) fn argument<R: Real, const L: usize>(family: Family, x: &Lanes<R, L>) -> Lanes<R, L> {
    match family {
        Family::Legendre => x.map(|x| x + x - R::ONE),
        Family::Sine => x.map(|x| (R::from_f64(core::f64::consts::PI) * x).cos()),
        Family::Step | Family::Gaussian => *x,
    }
}

/// sqrt(2 d + 1) sqrt(2 d - 1) / d for d = 1 to 7: see [`next`].
const LEGENDRE_UP: [f64; 8] = [
    0.0,
    1.732_050_807_568_877_2,
    1.936_491_673_103_708_5,
    1.972_026_594_366_538_6,
    1.984_313_483_298_443,
    1.989_974_874_213_24,
    1.993_043_457_183_566_4,
    1.994_891_434_824_134_4,
];

/// sqrt(2 d + 1) (d - 1) / (d sqrt(2 d - 3)) for d = 1 to 7, and 0 for d = 1.
const LEGENDRE_DOWN: [f64; 8] = [
    0.0,
    0.0,
    1.118_033_988_749_895,
    1.018_350_154_434_631,
    1.006_230_589_874_905_4,
    1.002_853_072_844_814,
    1.001_542_020_962_219_2,
    1.000_927_213_921_958,
];

/// The function of degree `degree`, given those of the two degrees below (the constant 1 for degree 0).
#[inline(always)]
pub(crate) fn next<R: Real, const L: usize>(
    family: Family,
    degree: usize,
    argument: &Lanes<R, L>,
    below: &Lanes<R, L>,
    second_below: &Lanes<R, L>,
) -> Lanes<R, L> {
    let mut out = *argument;
    let (up, down) = match family {
        // d P_d = (2 d - 1) t P_(d-1) - (d - 1) P_(d-2) with phi_d = sqrt(2 d + 1) P_d.
        Family::Legendre => (R::from_f64(at(&LEGENDRE_UP, degree)), R::from_f64(at(&LEGENDRE_DOWN, degree))),
        // cos(d a) = 2 cos(a) cos((d-1) a) - cos((d-2) a), all but the constant scaled by sqrt(2).
        Family::Sine => {
            let root = R::from_f64(core::f64::consts::SQRT_2);
            match degree {
                1 => (root, R::ZERO),
                2 => (R::ONE + R::ONE, root),
                _ => (R::ONE + R::ONE, R::ONE),
            }
        }
        Family::Step | Family::Gaussian => {
            for x in &mut out {
                *x = walsh(degree, *x);
            }
            return out;
        }
    };
    let (below, second) = (*below, *second_below);
    for l in 0..L {
        out[l] = up * out[l] * below[l] - down * second[l];
    }
    out
}

/// The Walsh function with `degree` sign changes, 0 to 7, which is constant on each eighth of [0, 1].
fn walsh<R: Real>(degree: usize, x: R) -> R {
    // A float-to-integer cast saturates, so this is total; 1 belongs to the last eighth.
    let cell = ((x.to_f32() * 8.0) as u32).min(7);
    let gray = (degree ^ (degree >> 1)) as u32;
    // Bit i of the Gray code belongs to the binary digit 2^-(i+1) of x.
    let mask = ((gray & 1) << 2) | (gray & 2) | ((gray >> 2) & 1);
    if (cell & mask).count_ones() & 1 == 0 { R::ONE } else { -R::ONE }
}
