//! What points pay for being where the marginals have too many.

use super::border::{BINS, Border, Shares, around, bin};
use super::energy::{Energy, Places};
use super::problem::OCTAVES;

/// What the marginals ask of the points whose first octave is the index: `[octave][axis][bin]`.
pub(crate) type Prices = [[[f32; BINS]; 2]; OCTAVES];

/// What sets the prices of a step.
pub(crate) struct Market<'a> {
    pub(crate) border: &'a Border,
    pub(crate) energy: &'a Energy,
    /// What a relative surplus costs an octave of weight 1.
    pub(crate) cost: f32,
}

impl Market<'_> {
    pub(crate) fn prices(&self) -> Prices {
        let mut sum = [[0.0; BINS]; 2];
        let mut prices = [[[0.0; BINS]; 2]; OCTAVES];
        for &octave in self.energy.octaves.iter().rev() {
            let factor = self.factor(octave);
            for (axis, sum) in sum.iter_mut().enumerate() {
                for (bin, sum) in sum.iter_mut().enumerate() {
                    *sum += factor * self.border.price(octave, axis, bin);
                }
            }
            prices[octave] = sum;
        }
        prices
    }

    /// Prices without what a pixel's own points add to them.
    pub(crate) fn without(&self, prices: &Prices, own: &Places) -> Prices {
        let mut prices = *prices;
        let mut sums = [Shares::default(); OCTAVES];
        let mut sum = Shares::default();
        for &octave in self.energy.octaves.iter().rev() {
            let factor = self.factor(octave);
            sum.iter_mut().zip(self.border.share(octave)).for_each(|(sum, share)| *sum += factor * share);
            sums[octave] = sum;
        }
        for (axis, places) in own.iter().enumerate() {
            for (place, first) in places.iter().zip(self.energy.first).take(self.energy.points) {
                // In an octave's prices are those of all longer ones; a point is in its own and these.
                for (bin, distance) in around(bin(*place), sum.len() - 1) {
                    for &octave in &self.energy.octaves {
                        prices[octave][axis][bin] -= sums[octave.max(first)][distance];
                    }
                }
            }
        }
        prices
    }

    /// What a relative surplus of an octave costs a point.
    fn factor(&self, octave: usize) -> f32 {
        self.cost * self.energy.weights[octave] / (1u32 << octave) as f32
    }
}
