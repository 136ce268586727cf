//! How much the errors of two pixels count together.

use super::basis::{MODES, SPECTRUM, Spectrum};

/// Pixels whose errors are seen together: no farther than this along each axis.
pub(crate) const REACH: usize = 8;
/// Distances along an axis, from 0.
const SIDE: usize = REACH + 1;
/// Pairs of pixels that count less are left out.
const LEAST: f64 = 0.003;

/// What pairs of pixels count where a pixel with itself counts 1, for each product of cosines: the squares of Gaussian
/// filters of 2.1 pixels and, for less, of one, times the correlation of two pixels' integrands.
pub(crate) struct Weights {
    /// `[distance along y][along x]`; none if too little.
    weights: Vec<Option<Box<Spectrum>>>,
}

impl Weights {
    pub(crate) fn new() -> Weights {
        let weights = (0..SIDE * SIDE).map(|place| {
            let square = ((place / SIDE).pow(2) + (place % SIDE).pow(2)) as f64;
            let filter = |sigma: f64| libm::exp(-square / (4.0 * sigma * sigma));
            let filtered = (filter(2.1) + 0.3 * filter(1.0)) / 1.3;
            let weight = |mode: usize| (filtered * correlation(mode, libm::sqrt(square))) as f32;
            let seen = square > 0.0 && filtered * correlation(MODES, libm::sqrt(square)) > LEAST;
            seen.then(|| Box::new(std::array::from_fn::<f32, SPECTRUM, _>(weight)))
        });
        Weights { weights: weights.collect() }
    }

    /// None if two pixels so far apart do not see each other, or are one.
    pub(crate) fn at(&self, x: i32, y: i32) -> Option<&Spectrum> {
        let (x, y) = (x.unsigned_abs() as usize, y.unsigned_abs() as usize);
        if x > REACH || y > REACH {
            return None;
        }
        self.weights[y * SIDE + x].as_deref()
    }

    /// The pixels that one sees, relative to it.
    pub(crate) fn neighbours(&self) -> Vec<(i32, i32)> {
        let reach = REACH as i32;
        let all = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y)));
        all.filter(|(x, y)| self.at(*x, *y).is_some()).collect()
    }
}

/// How alike two pixels' integrands are in a product of cosines: fitted to tables of seven rendered scenes. Fine
/// features move and vanish sooner than coarse ones.
fn correlation(mode: usize, distance: f64) -> f64 {
    let (x, y) = (mode / MODES, mode % MODES);
    let square = (x * x + y * y) as f64;
    let (rate, power) = if square <= 1.0 { (0.27, 0.92) } else { (0.4 * libm::pow(square, 0.275), 1.0) };
    1.0 / (1.0 + rate * libm::pow(distance, power))
}
