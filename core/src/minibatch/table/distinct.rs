//! Drawing without replacement.

use super::draw::check_lengths;
use super::{Portable, Table};
use crate::Error;
use crate::rng::Rng;

impl<I: AsRef<[f32]> + AsMut<[f32]>, S: AsRef<[i64]> + AsMut<[i64]>> Table<I, S> {
    /// Draws different items, one after the other, each with the probabilities of [`Table::draw`] among those not yet drawn.
    ///
    /// Weights make the same estimate as those of [`Table::draw`], gradients times weights averaged over the batch, without
    /// bias: with c_k the probability that the k-th of B draws had among those left, `weight = (1 / c_k + B - k) / N`
    /// (D. Raj, "Some Estimators in Sampling with Varying Probabilities without Replacement", 1956). The whole data set as
    /// one batch gives the exact mean in the last draw's estimate, not in their average.
    ///
    /// Items drawn are taken out of the table while the others are drawn, and put back with the same bits: this takes the time of
    /// three updates for each, and exclusive access.
    ///
    /// Errors, which change nothing but the generator: [`Error::Range`] for more draws than items, or another number of
    /// weights; [`Error::NoSamples`] where the uniform fraction is 0 and fewer items have an importance above 0.
    pub fn draw_distinct(
        &mut self,
        rng: &mut Rng,
        index: &mut [u32],
        mut weight: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        check_lengths(index, &weight)?;
        if index.len() > self.state.items as usize {
            return Err(Error::Range);
        }
        let possible = || self.importance.as_ref().iter().filter(|q| **q > 0.0).take(index.len()).count();
        if self.state.uniform_fraction == 0.0 && possible() < index.len() {
            return Err(Error::NoSamples);
        }
        let scale = self.state.scale;
        let items = f64::from(self.state.items);
        let batch = index.len() as f64;
        for drawn in 0..index.len() {
            // There is something left to draw, as checked.
            let Ok(mixture) = self.mixture() else { break };
            let mut item = [0];
            loop {
                self.draw_mixture::<Portable>(&mixture, 1.0, rng, &mut item, None);
                // What has been taken is met by a uniform draw only.
                if !self.is_taken(item[0]) {
                    break;
                }
            }
            let left = 1.0 - mixture.uniform * (drawn as f64 / items);
            let chance = self.probability_in(&mixture, item[0]) / left;
            if let Some(out) = weight.as_mut().and_then(|weight| weight.get_mut(drawn)) {
                *out = ((1.0 / chance + (batch - (drawn + 1) as f64)) / items) as f32;
            }
            if let Some(out) = index.get_mut(drawn) {
                *out = item[0];
            }
            self.turn(item[0]);
            self.refresh(item[0]);
        }
        for &item in index.iter() {
            self.turn(item);
            if self.state.scale == scale {
                self.refresh(item);
            }
        }
        if self.state.scale != scale {
            // Without its largest items the table went to another scale.
            self.state.scale = scale;
            self.rebuild_at_scale();
        }
        Ok(())
    }

    fn is_taken(&self, item: u32) -> bool {
        self.importance.as_ref().get(item as usize).is_some_and(|q| q.is_sign_negative())
    }

    /// Takes an item out, by a sign that makes its importance count as 0, or puts it back.
    fn turn(&mut self, item: u32) {
        if let Some(q) = self.importance.as_mut().get_mut(item as usize) {
            *q = -*q;
        }
    }
}
