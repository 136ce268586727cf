//! Drawing batches with replacement.

use super::block::{self, ARITY};
use super::{Levels, Table, tree};
use crate::Error;
use crate::rng::Rng;

/// How many draws go down the tree together: enough to hide the latency of memory, few enough for the first cache.
const CHUNK: usize = 64;

/// The two ways to an item: by the tree, and uniformly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mixture {
    /// The sum of the tree's weights.
    sum: i64,
    items: u32,
    /// The probability of each way.
    pub(super) tree: f64,
    pub(super) uniform: f64,
}

impl Mixture {
    /// Errors: [`Error::NoSamples`] if every weight is 0 and no draw uniform.
    pub(super) fn of(sum: i64, items: u32, uniform: f64) -> Result<Mixture, Error> {
        match (sum > 0, uniform > 0.0) {
            (true, _) => Ok(Mixture { sum, items, tree: 1.0 - uniform, uniform }),
            (false, true) => Ok(Mixture { sum, items, tree: 0.0, uniform: 1.0 }),
            (false, false) => Err(Error::NoSamples),
        }
    }

    /// The probability of an item of importance `q` in a block of sum `total` that weighs `weight`.
    #[inline(always)]
    pub(super) fn probability(&self, q: f32, total: f64, weight: i64) -> f64 {
        let (by_weight, by_item) = self.factors(1.0);
        let q = f64::from(if q > 0.0 { q } else { 0.0 });
        if total > 0.0 { by_weight * weight as f64 * (q / total) + by_item } else { by_item }
    }

    /// What an item's weight in the tree, and what its mere existence adds to `factor` times its probability.
    fn factors(&self, factor: f64) -> (f64, f64) {
        (factor * self.tree / self.sum.max(1) as f64, factor * self.uniform / f64::from(self.items))
    }

    /// Uniform draws are those whose 64 random bits are at most this; none if there is no number.
    fn threshold(&self) -> Option<u64> {
        if self.uniform > 0.0 { Some((self.uniform * TWO_64) as u64) } else { None }
    }
}

const TWO_64: f64 = 18_446_744_073_709_551_616.0;

/// Where in the tree or among the items a draw falls, as 64 random bits, and by which way.
#[derive(Clone, Copy)]
struct Position {
    bits: u64,
    uniform: bool,
}

impl<I: AsRef<[f32]>, S: AsRef<[i64]>> Table<I, S> {
    /// Draws items with replacement, independent of each other.
    ///
    /// `weight`, as long as `index`, becomes 1 / (N p) of each: gradients times weights, averaged over the batch, estimate the
    /// gradient of the mean loss without bias (importance sampling; the weight 1 / p of Algorithm 3 over N). With `None`,
    /// or where the weights are not used, it is adaptive sampling (w = p): biased towards important items by design.
    ///
    /// The generator advances by 64 bits, whatever the length. An empty `index` is no error.
    ///
    /// Errors: [`Error::Range`] for another number of weights; [`Error::NoSamples`] where every importance and the uniform
    /// fraction are 0.
    #[inline(always)]
    pub fn draw(&self, rng: &mut Rng, index: &mut [u32], weight: Option<&mut [f32]>) -> Result<(), Error> {
        self.draw_mixture(&self.mixture()?, f64::from(self.state.items), rng, index, weight)
    }

    /// As [`Table::draw`], for a mixture of its own; weights are 1 / (`factor` p).
    #[inline(always)]
    pub(super) fn draw_mixture(
        &self,
        mixture: &Mixture,
        factor: f64,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        check_lengths(index, &weight)?;
        let seed = rng.next_u64();
        let threshold = mixture.threshold();
        self.draw_at(mixture, factor, index, weight, |k| Position {
            bits: noise(seed, 2 * k),
            uniform: threshold.is_some_and(|threshold| noise(seed, 2 * k + 1) <= threshold),
        });
        Ok(())
    }

    /// As [`Table::draw`], from equal parts of the line of all importances: item i comes B p_i times, rounded up or down
    /// but for the uniform part, which is divided into equal parts too. Less variance than independent draws wherever neighbouring items
    /// are alike, and never more than a little; weights and their use are the same.
    ///
    /// The items come in the order of the data set, those of the uniform part last: use the batch as a whole.
    #[inline(always)]
    pub fn draw_stratified(&self, rng: &mut Rng, index: &mut [u32], weight: Option<&mut [f32]>) -> Result<(), Error> {
        let mixture = self.mixture()?;
        check_lengths(index, &weight)?;
        let seed = rng.next_u64();
        let batch = index.len() as u64;
        // As many uniform draws as fall to them, the fraction of one at random.
        let share = mixture.uniform * batch as f64 + noise(seed, u64::MAX) as f64 / TWO_64;
        let uniforms = (share as u64).min(batch);
        let trees = batch - uniforms;
        let stratum = |k: u64, of: u64| {
            let width = u64::MAX / of.max(1);
            k.wrapping_mul(width).wrapping_add(high_product(noise(seed, 2 * k), width))
        };
        self.draw_at(&mixture, f64::from(self.state.items), index, weight, |k| match k.checked_sub(trees) {
            None => Position { bits: stratum(k, trees), uniform: false },
            Some(k) => Position { bits: stratum(k, uniforms), uniform: true },
        });
        Ok(())
    }

    #[inline(always)]
    fn draw_at(
        &self,
        mixture: &Mixture,
        factor: f64,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
        position: impl Fn(u64) -> Position,
    ) {
        let descent = Descent::new(self, mixture, factor);
        let mut first = 0;
        let mut weights = weight.map(|weight| weight.chunks_mut(CHUNK));
        for index in index.chunks_mut(CHUNK) {
            let weight = weights.as_mut().and_then(Iterator::next).unwrap_or_default();
            descent.draw(first, index, weight, &position);
            first += CHUNK as u64;
        }
    }
}

/// What all draws of a batch share.
struct Descent<'a> {
    blocks: &'a [block::Block],
    nodes: &'a [tree::Node],
    levels: Levels,
    mixture: &'a Mixture,
    /// What an item's weight in the tree, and what its existence adds to `factor` times its probability.
    by_weight: f64,
    by_item: f64,
}

impl<'a> Descent<'a> {
    fn new<I: AsRef<[f32]>, S: AsRef<[i64]>>(table: &'a Table<I, S>, mixture: &'a Mixture, factor: f64) -> Descent<'a> {
        let (by_weight, by_item) = mixture.factors(factor);
        Descent { blocks: table.blocks(), nodes: table.nodes(), levels: table.levels, mixture, by_weight, by_item }
    }

    /// At most [`CHUNK`] draws, the first being number `first` of the batch; as many weights as draws, or none.
    #[inline(always)]
    fn draw(&self, first: u64, index: &mut [u32], weight: &mut [f32], position: &impl Fn(u64) -> Position) {
        // The draws by the tree: which of the chunk's they are, and where they are in it.
        let mut slot = [0u8; CHUNK];
        let mut at = [At { node: 0, rest: 0, fraction: 0.0 }; CHUNK];
        let mut uniform_slot = [0u8; CHUNK];
        let mut trees = 0;
        // Without branches, which could not be predicted: every draw is written as both, and one of them counts.
        for (i, out) in index.iter_mut().enumerate().take(CHUNK) {
            let position = position(first + i as u64);
            let product = u128::from(position.bits) * self.mixture.sum as u128;
            slot[trees % CHUNK] = i as u8;
            at[trees % CHUNK] =
                At { node: 0, rest: (product >> 64) as i64, fraction: product as u64 as f64 * (1.0 / TWO_64) };
            uniform_slot[(i - trees) % CHUNK] = i as u8;
            *out = high_product(position.bits, u64::from(self.mixture.items)) as u32;
            trees += usize::from(!position.uniform);
        }
        let at = at.get_mut(..trees).unwrap_or_default();
        let (lowest, upper) = self.levels.starts().split_first().unwrap_or((&0, &[]));
        for start in upper.iter().rev() {
            for at in at.iter_mut() {
                let Some(node) = self.nodes.get(start + at.node as usize) else { continue };
                let (child, begin, _) = tree::find(node, at.rest);
                at.rest -= begin;
                at.node = at.node * ARITY as u32 + child as u32;
            }
        }
        for (at, &slot) in at.iter().zip(&slot) {
            let Some(node) = self.nodes.get(lowest + at.node as usize) else { continue };
            let (child, begin, end) = tree::find(node, at.rest);
            let which = at.node as usize * ARITY + child;
            let Some(block) = self.blocks.get(which) else { continue };
            let share = ((at.rest - begin) as f64 + at.fraction) / (end - begin) as f64;
            let (item, total) = block::find(block, share.min(BELOW_ONE));
            if let Some(out) = index.get_mut(slot as usize) {
                *out = (which * ARITY + item) as u32;
            }
            if let Some(out) = weight.get_mut(slot as usize) {
                *out = self.weight(block[item % ARITY], total, end - begin);
            }
        }
        for &slot in uniform_slot.iter().take(weight.len().saturating_sub(trees)) {
            let (Some(&item), Some(out)) = (index.get(slot as usize), weight.get_mut(slot as usize)) else { continue };
            let which = item as usize / ARITY;
            let (Some(block), Some(node)) = (self.blocks.get(which), self.nodes.get(which / ARITY)) else { continue };
            let (begin, end) = tree::span(node, which % ARITY);
            *out = self.weight(block[item as usize % ARITY], block::total(block), end - begin);
        }
    }

    /// 1 / (factor p), with one division.
    #[inline(always)]
    fn weight(&self, q: f32, total: f64, weight: i64) -> f32 {
        let q = f64::from(q);
        // A block of importance 0 can be drawn from uniformly only.
        let (q, total) = if total > 0.0 { (q, total) } else { (0.0, 1.0) };
        (total / (self.by_weight * weight as f64 * q + self.by_item * total)) as f32
    }
}

#[derive(Clone, Copy)]
struct At {
    /// Which node of the level.
    node: u32,
    /// The position among the node's weights, and behind its point.
    rest: i64,
    fraction: f64,
}

/// The largest number below 1: times a total it is below the total.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// Errors: [`Error::Range`] unless there are as many weights as indices, or none at all.
pub(super) fn check_lengths(index: &[u32], weight: &Option<&mut [f32]>) -> Result<(), Error> {
    match weight {
        Some(weight) if weight.len() != index.len() => Err(Error::Range),
        _ => Ok(()),
    }
}

/// The upper half of a product: `bits` scaled to 0..`n`.
#[inline(always)]
fn high_product(bits: u64, n: u64) -> u64 {
    ((u128::from(bits) * u128::from(n)) >> 64) as u64
}

/// The `k`-th number of the SplitMix64 stream that starts behind `seed`: draws need no order.
#[inline(always)]
fn noise(seed: u64, k: u64) -> u64 {
    let mut z = seed.wrapping_add(k.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
