//! How much the errors of two pixels count together.

use super::basis::{MODES, Spectrum};
use super::power::LANES;

/// Pixels whose errors are seen together: no farther than this along each axis.
pub(crate) const REACH: usize = 8;
/// Distances along an axis, from 0.
const SIDE: usize = REACH + 1;
/// Pairs of pixels that count less are left out.
const LEAST: f64 = 0.003;
/// Frequencies of which a pair counts less are left out.
const FAINT: f64 = 0.02;

/// What pairs of pixels count where a pixel with itself counts 1, for each product of cosines: the squares of Gaussian
/// filters of 2.1 pixels and, for less, of one, times the correlation of two pixels' integrands.
#[derive(Debug)]
pub(crate) struct Weights {
    /// `[distance along y][along x]`; none if too little.
    weights: Vec<Option<Box<Weight>>>,
    /// Pixels along each side of the torus.
    size: i32,
}

/// What two pixels count together.
#[derive(Debug)]
pub(crate) struct Weight {
    /// Frequencies along each axis that count, from 0.
    modes: usize,
    factors: Spectrum,
}

impl Weight {
    /// Adds weighed errors to a sum.
    pub(crate) fn add(&self, errors: &Spectrum, sum: &mut Spectrum) {
        let rows = |spectrum| <[f32]>::as_chunks::<MODES>(spectrum).0;
        let sums = sum.as_chunks_mut::<MODES>().0.iter_mut();
        for ((sum, factors), errors) in sums.zip(rows(&self.factors)).zip(rows(errors)).take(self.modes) {
            for ((sum, factor), error) in sum[..self.modes].iter_mut().zip(factors).zip(errors) {
                *sum += factor * error;
            }
        }
    }
}

impl Weights {
    /// For a torus of size x size pixels.
    pub(crate) fn new(size: usize) -> Weights {
        let weights = (0..SIDE * SIDE).map(|place| {
            let square = ((place / SIDE).pow(2) + (place % SIDE).pow(2)) as f64;
            let filter = |sigma: f64| libm::exp(-square / (4.0 * sigma * sigma));
            let filtered = (filter(2.1) + 0.3 * filter(1.0)) / 1.3;
            let weight = |mode: usize| filtered * correlation(mode, libm::sqrt(square));
            let seen = square > 0.0 && weight(MODES) > LEAST;
            let modes = (0..MODES).take_while(|&mode| weight(mode) > FAINT).count().next_multiple_of(LANES);
            seen.then(|| Box::new(Weight { modes, factors: std::array::from_fn(|mode| weight(mode) as f32) }))
        });
        Weights { weights: weights.collect(), size: size as i32 }
    }

    /// None if two pixels so far apart do not see each other, or are one.
    fn at(&self, x: i32, y: i32) -> Option<&Weight> {
        let (x, y) = (x.unsigned_abs() as usize, y.unsigned_abs() as usize);
        if x > REACH || y > REACH {
            return None;
        }
        self.weights[y * SIDE + x].as_deref()
    }

    fn column_and_row(&self, pixel: usize) -> (i32, i32) {
        (pixel as i32 % self.size, pixel as i32 / self.size)
    }

    /// What two pixels of the torus count together; none if they do not see each other, or are one.
    pub(crate) fn between(&self, pixel: usize, other: usize) -> Option<&Weight> {
        let ((x, y), (other_x, other_y)) = (self.column_and_row(pixel), self.column_and_row(other));
        let half = self.size / 2;
        let wrapped = |d: i32| (d + half).rem_euclid(self.size) - half;
        self.at(wrapped(x - other_x), wrapped(y - other_y))
    }

    /// The pixels that one sees, and what each counts with it.
    pub(crate) fn around(&self, pixel: usize) -> impl Iterator<Item = (usize, &Weight)> {
        let (x, y) = self.column_and_row(pixel);
        let (size, reach) = (self.size, REACH as i32);
        let all = (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| (dx, dy)));
        all.filter_map(move |(dx, dy)| {
            let other = (y + dy).rem_euclid(size) * size + (x + dx).rem_euclid(size);
            self.at(dx, dy).map(|weight| (other as usize, weight))
        })
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
