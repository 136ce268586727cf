//! Drawing without replacement.

use super::draw::{check_lengths, noise};
use super::importances::Table;
use super::kernel::{Kernel, Portable};
use super::mixture::Mixture;
use crate::error::{Error, ensure};
use crate::matrix::{first, set};
use crate::rng::Rng;

/// A search for an item not yet taken ends where so many should have been found: once in e^64 searches, or where the
/// table's memory has been damaged.
const PATIENCE: f64 = 64.0;

impl<I: AsRef<[f32]> + AsMut<[f32]>, S: AsRef<[i64]> + AsMut<[i64]>, K: Kernel> Table<I, S, K> {
    /// Draws different items, one after the other. The k-th is item i with probability
    ///
    /// `c_i = ((1 - d) q_i / sum q + d / N) / (1 - d (k - 1) / N)`,
    ///
    /// the sum being that of the items not yet drawn, and d the uniform fraction (1 if that sum is 0).
    ///
    /// Weights make the same estimate as those of [`Table::draw`], gradients times weights averaged over the batch,
    /// without bias: with c_k the probability of the k-th of B draws, `weight = (1 / c_k + B - k) / N` (D. Raj, "Some
    /// Estimators in Sampling with Varying Probabilities without Replacement", 1956). No weight is above
    /// 1 / d + (B - 1) / N.
    ///
    /// Items drawn are taken out of the table while the others are drawn, and put back with the same bits: a draw takes
    /// the time of ten updates or so, and exclusive access. Where a few items have nearly all of the sum, the table is
    /// built again without them, which takes time for every item.
    ///
    /// # Errors
    /// These change nothing: [`Error::Range`] for more draws than items; [`Error::Length`] for another number of
    /// weights; [`Error::NoSamples`] where the uniform fraction is 0 and fewer items have an importance above 0.
    #[inline]
    pub fn draw_distinct(
        &mut self,
        rng: &mut Rng,
        index: &mut [u32],
        mut weight: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        check_lengths(index, &weight)?;
        let items = self.state.items;
        ensure(index.len() <= items as usize, Error::Range)?;
        let importance = first(self.importance.as_ref(), items as usize);
        let possible = || importance.iter().filter(|q| **q > 0.0).take(index.len()).count();
        ensure(self.state.uniform_fraction > 0.0 || possible() == index.len(), Error::NoSamples)?;
        let scale = self.state.scale;
        let batch = index.len() as f64;
        for drawn in 0..index.len() {
            // There is something left to draw, as checked; sums that say otherwise have been damaged.
            let mixture = self.mixture().unwrap_or(Mixture::uniform(items));
            // What has been taken is met by a uniform draw only.
            let left = 1.0 - mixture.uniform * (drawn as f64 / f64::from(items));
            let item = self.draw_left(&mixture, left, rng);
            let chance = self.probability_in(&mixture, item) / left;
            if let Some(out) = weight.as_mut().and_then(|weight| weight.get_mut(drawn)) {
                *out = ((1.0 / chance + (batch - (drawn + 1) as f64)) / f64::from(items)) as f32;
            }
            set(index, drawn, item);
            self.turn(item);
            self.refresh(item);
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
            self.build::<Portable>();
        }
        Ok(())
    }

    /// Draws until an item has not been taken, of which a draw has the probability `left`.
    fn draw_left(&self, mixture: &Mixture, left: f64, rng: &mut Rng) -> u32 {
        let (mut item, mut expected) = ([0], 0.0);
        while expected < PATIENCE {
            self.draw_mixture::<1>(mixture, 1.0, rng, &mut item, None, noise);
            if !self.is_taken(item[0]) {
                return item[0];
            }
            expected += left;
        }
        self.next_left(item[0])
    }

    /// The first item not taken from this one on, and then from the first; this one if there is none.
    #[cold]
    #[inline(never)]
    fn next_left(&self, item: u32) -> u32 {
        let is_left = |item: &u32| !self.is_taken(*item);
        (item..self.state.items).chain(0..item).find(is_left).unwrap_or(item)
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
