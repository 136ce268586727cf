//! Changing importances.

use super::importances::{Table, check_importances};
use super::kernel::{ARITY, Block, Kernel, Portable, prefetch};
use super::tree::{self, CHILDREN, Node};
use crate::error::{Error, check_part, ensure};
use crate::matrix::{first_mut, from, halves};
use crate::real::power_of_two;

/// How many changes go up the tree together.
const CHUNK: usize = 64;
/// A scale is chosen so that the sum has this many bits: room to grow by a factor of 2^11, and to shrink by 2^6 with
/// the most items there can be, by 2^18 with a million.
const BITS: i32 = 51;
/// The sum stays below this.
const LARGEST_SUM: i64 = 1 << 62;
/// The sum stays above this times the number of blocks, so that rounding a block's weight changes little.
const LEAST_WEIGHT: i64 = 1 << 16;

impl<I: AsRef<[f32]> + AsMut<[f32]>, S: AsRef<[i64]> + AsMut<[i64]>, K: Kernel> Table<I, S, K> {
    /// Sets the importance of the visited items: `q = momentum q + (1 - momentum) importance` (line 13 of Algorithm 3,
    /// (6.11)), one after the other, so that an item that comes twice is changed twice. Momentum 0 forgets the old
    /// value; .3 is a good choice.
    ///
    /// Where the sum of all has grown or shrunk by orders of magnitude since the table was built, it is built again at
    /// a new scale, which takes time for every item; else a change costs the same few nanoseconds however many items
    /// there are.
    ///
    /// # Errors
    /// These change nothing: [`Error::Length`] for different lengths; [`Error::Range`] for an item that does not exist,
    /// a negative importance, or a momentum outside 0..=1; [`Error::NotFinite`].
    #[inline]
    pub fn update(&mut self, index: &[u32], importance: &[f32], momentum: f32) -> Result<(), Error> {
        check_importances(importance)?;
        check_part(momentum)?;
        ensure(index.len() == importance.len(), Error::Length)?;
        self.check_items(index)?;
        // -0 would make importances of -0, a sign that stands for items taken out.
        let momentum = momentum + 0.0;
        let fresh = 1.0 - momentum;
        let mut in_range = true;
        let mut left = importance;
        for index in index.chunks(CHUNK) {
            // Not zipped with the other's chunks: in small code the count of those divides by a length that may be 0.
            let (importance, after) = halves(left, index.len());
            left = after;
            for &item in index {
                let which = item as usize / ARITY;
                prefetch::<K, _>(self.blocks(), which);
                prefetch::<K, _>(self.nodes(), which / CHILDREN);
            }
            // No valid importances exceed f32::MAX; a damaged one must not stay infinite or NaN.
            let mix = |&q: &f32| move |old: f32| (momentum * old + fresh * q).min(f32::MAX);
            in_range &= self.change(index.iter().copied().zip(importance.iter().map(mix)));
        }
        self.restore_scale(in_range);
        Ok(())
    }

    /// Adds items behind the last. Takes the time of an update for each, or of building the table if they are many.
    ///
    /// # Errors
    /// These change nothing: [`Error::Memory`] if there is no room; [`Error::Range`] for a negative importance;
    /// [`Error::NotFinite`].
    pub fn append(&mut self, importance: &[f32]) -> Result<(), Error> {
        check_importances(importance)?;
        let room = (self.capacity() - self.state.items) as usize;
        ensure(importance.len() <= room, Error::Memory)?;
        if importance.is_empty() {
            return Ok(());
        }
        let first = self.state.items;
        self.state.items += importance.len() as u32;
        if importance.len() >= first as usize / ARITY {
            let places = self.importance.as_mut().iter_mut().skip(first as usize);
            places.zip(importance).for_each(|(to, &from)| *to = from + 0.0);
            self.rebuild();
        } else {
            let mut in_range = true;
            for (chunk, start) in importance.chunks(CHUNK).zip((first..).step_by(CHUNK)) {
                in_range &= self.change((start..=u32::MAX).zip(chunk.iter().map(|&q| move |_| q + 0.0)));
            }
            self.restore_scale(in_range);
        }
        Ok(())
    }

    /// Adds `epsilon` to every importance, as Algorithm 3 does after an epoch so that no item is forgotten. Exact:
    /// every importance is the f32 sum. Takes time for every item; the uniform fraction does the same for nothing.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; [`Error::Range`] for a negative number.
    #[inline]
    pub fn add_epsilon(&mut self, epsilon: f32) -> Result<(), Error> {
        check_importances(&[epsilon])?;
        for q in first_mut(self.importance.as_mut(), self.state.items as usize) {
            *q = (*q + epsilon).min(f32::MAX);
        }
        let in_range = self.build::<K>();
        self.restore_scale(in_range);
        Ok(())
    }

    /// Makes the sums follow an item whose importance has been changed.
    pub(super) fn refresh(&mut self, item: u32) {
        let in_range = self.change(core::iter::once((item, |q| q)));
        self.restore_scale(in_range);
    }

    /// At most [`CHUNK`] changes: an item, and its new importance from the old. False if the sums are beyond their
    /// range, and wrong until they are built again.
    fn change<F: Fn(f32) -> f32>(&mut self, changes: impl Iterator<Item = (u32, F)>) -> bool {
        let scale = self.state.scale;
        let levels = self.levels;
        let (blocks, nodes) = self.parts();
        let upper = from(levels.starts(), 1);
        // For each change the block and by how much its weight differs.
        let mut pending = [(0u32, 0i64); CHUNK];
        let mut count = 0;
        // The sum of new weights: while it is in range, no sum in the tree can have wrapped around to a harmless
        // number.
        let mut fresh = 0i64;
        for (pending, (item, change)) in pending.iter_mut().zip(changes) {
            let which = item as usize / ARITY;
            let (Some(block), Some(node)) = (blocks.get_mut(which), nodes.get_mut(which / CHILDREN)) else {
                continue;
            };
            let item = item as usize % ARITY;
            let q = change(block[item]);
            let weight = weight(K::replace(block, item, q), scale);
            fresh = fresh.saturating_add(weight);
            let difference = weight.wrapping_sub(tree::weight(node, which % CHILDREN));
            K::add(node, which % CHILDREN, difference);
            *pending = ((which / CHILDREN) as u32, difference);
            count += 1;
        }
        let pending = first_mut(&mut pending, count);
        // All changes meet in the root: they are added up first, or each would wait for the one before it.
        let (root, between) = upper.split_last().map_or((None, upper), |(root, between)| (Some(root), between));
        for start in between {
            for (below, difference) in pending.iter_mut() {
                let which = *below as usize / CHILDREN;
                let Some(node) = nodes.get_mut(start + which) else { continue };
                K::add(node, *below as usize % CHILDREN, *difference);
                *below = which as u32;
            }
        }
        if let Some(node) = root.and_then(|&root| nodes.get_mut(root)) {
            let mut differences = [0i64; CHILDREN];
            for (below, difference) in pending {
                let sum = &mut differences[*below as usize % CHILDREN];
                *sum = sum.wrapping_add(*difference);
            }
            tree::add_all(node, &differences);
        }
        fresh < LARGEST_SUM && (0..LARGEST_SUM).contains(&nodes.last().map_or(0, |root| root[CHILDREN - 1]))
    }

    /// Builds the table again if its sum has left the range of its scale.
    pub(super) fn restore_scale(&mut self, in_range: bool) {
        let sum = self.sum();
        let least = i64::from(self.state.items / ARITY as u32 + 1) * LEAST_WEIGHT;
        if !in_range || (sum > 0 && sum < least) {
            self.rebuild();
        }
    }

    /// Builds the sums from the importances, at the scale that suits them.
    #[cold]
    #[inline(never)]
    pub(super) fn rebuild(&mut self) {
        let sum: f64 = self.blocks().iter().take(self.used()).map(Portable::total).sum();
        if sum > 0.0 {
            // Between 2^-149 and 2^160: the exponent of a normal f64.
            let exponent = (sum.to_bits() >> 52) as i32 - 1023;
            self.state.scale = power_of_two(BITS - 1 - exponent);
        }
        self.build::<Portable>();
    }

    /// How many blocks have items. Those behind them are room, and weigh nothing.
    fn used(&self) -> usize {
        (self.state.items as usize).div_ceil(ARITY)
    }

    /// Builds the sums at the scale there is. False if they are beyond their range.
    pub(super) fn build<By: Kernel>(&mut self) -> bool {
        let (levels, scale, used) = (self.levels, self.state.scale, self.used());
        let (blocks, nodes) = self.parts();
        let blocks = first_mut(blocks, used);
        let mut in_range = true;
        let mut sum_of_all = 0i64;
        for (node, blocks) in nodes.iter_mut().zip(blocks.chunks(CHILDREN)) {
            let mut sum = 0i64;
            let mut blocks = blocks.iter();
            for end in node.iter_mut() {
                let weight = blocks.next().map_or(0, |block| weight(By::total(block), scale));
                // Wrapping around could end at a harmless number.
                sum = sum.saturating_add(weight);
                *end = sum;
            }
            in_range &= sum < LARGEST_SUM;
            sum_of_all = sum_of_all.saturating_add(sum);
        }
        tree::raise(nodes, &levels, used.div_ceil(CHILDREN));
        in_range && sum_of_all < LARGEST_SUM
    }

    /// The blocks and the nodes, to write.
    fn parts(&mut self) -> (&mut [Block], &mut [Node]) {
        let (blocks, _) = self.importance.as_mut().as_chunks_mut();
        let (nodes, _) = self.sums.as_mut().as_chunks_mut();
        (first_mut(blocks, self.blocks), first_mut(nodes, self.levels.nodes()))
    }
}

/// The largest f64 that an i64 holds.
const MOST_WEIGHT: f64 = 9_223_372_036_854_774_784.0;

/// The weight of a block: its sum times the scale, rounded, at least 1 if it is not 0.
fn weight(total: f64, scale: f64) -> i64 {
    // A number that no i64 holds is an invalid operation on some processors, though the cast saturates.
    let rounded = (total * scale + 0.5).min(MOST_WEIGHT) as i64;
    if total > 0.0 { rounded.max(1) } else { 0 }
}
