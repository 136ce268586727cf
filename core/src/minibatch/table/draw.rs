//! Drawing batches with replacement.

use super::importances::Table;
use super::kernel::{ARITY, Block, Kernel, prefetch};
use super::mixture::{Mixture, Ways};
use super::tree::{self, CHILDREN, Levels, Node};
use crate::error::{Error, ensure};
use crate::matrix::{from, halves, set};
use crate::rng::{Rng, split_mix};

/// How many draws go down the tree together: enough to hide the latency of memory, few enough for the first cache.
pub(super) const CHUNK: usize = 64;
/// How many nodes the first cache holds beside what else a draw needs.
const NEAR: usize = 128;

impl<I: AsRef<[f32]>, S: AsRef<[i64]>, K: Kernel> Table<I, S, K> {
    /// Draws items with replacement, independent of each other.
    ///
    /// `weight`, as long as `index`, becomes 1 / (N p) of each: gradients times weights, averaged over the batch,
    /// estimate the gradient of the mean loss without bias (importance sampling; the weight 1 / p of Algorithm 3 over
    /// N). With `None`, or where the weights are not used, it is adaptive sampling (w = p): biased towards important
    /// items by design.
    ///
    /// The generator advances by 64 bits, whatever the length. An empty `index` is no error, and leaves it where it is.
    ///
    /// # Errors
    /// [`Error::Length`] for another number of weights; [`Error::NoSamples`] where every importance and the
    /// uniform fraction are 0.
    // As the four below: without one of them, draws take 7 to 15 % more instructions.
    #[inline(always)]
    pub fn draw(&self, rng: &mut Rng, index: &mut [u32], weight: Option<&mut [f32]>) -> Result<(), Error> {
        self.draw_by(rng, index, weight, noise)
    }

    /// As [`Table::draw`], one draw from each of as many equal parts of the line of probabilities as there are draws:
    /// for each of the two ways to it, an item comes less than two times more or less often than on average. Less
    /// variance than independent draws wherever neighbouring items are alike; weights and their use are the same.
    ///
    /// Those drawn uniformly come first, and both in the order of the data set, but for the 16 items of a block, which
    /// come by columns of four: 0, 4, 8, 12, 1, ... Use the batch as a whole.
    #[inline]
    pub fn draw_stratified(&self, rng: &mut Rng, index: &mut [u32], weight: Option<&mut [f32]>) -> Result<(), Error> {
        let width = u64::MAX / (index.len() as u64).max(1);
        let within = |seed, k| ((u128::from(noise(seed, k)) * u128::from(width)) >> 64) as u64;
        self.draw_by(rng, index, weight, |seed, k| k.wrapping_mul(width).wrapping_add(within(seed, k)))
    }

    #[inline(always)]
    fn draw_by(
        &self,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
        bits: impl Fn(u64, u64) -> u64,
    ) -> Result<(), Error> {
        check_lengths(index, &weight)?;
        if !index.is_empty() {
            self.draw_mixture::<CHUNK>(&self.mixture()?, f64::from(self.state.items), rng, index, weight, bits);
        }
        Ok(())
    }

    /// Draws from a mixture of its own, for checked lengths: draw k where `bits`, of a seed and k, fall. Weights are
    /// 1 / (`factor` p).
    #[inline(always)]
    pub(super) fn draw_mixture<const AT_ONCE: usize>(
        &self,
        mixture: &Mixture,
        factor: f64,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
        bits: impl Fn(u64, u64) -> u64,
    ) {
        let (by_weight, by_item) = mixture.factors(factor);
        let descent = Descent {
            blocks: self.blocks(),
            nodes: self.nodes(),
            levels: self.levels,
            ways: mixture.ways(),
            by_weight,
            by_item,
            last: mixture.items.saturating_sub(1),
        };
        let seed = rng.next_u64();
        let mut weights = weight.map(|weight| weight.chunks_mut(AT_ONCE));
        for (chunk, index) in (0..).zip(index.chunks_mut(AT_ONCE)) {
            let weight = weights.as_mut().and_then(Iterator::next).unwrap_or_default();
            descent.draw::<K, AT_ONCE>(index, weight, |i| bits(seed, chunk * AT_ONCE as u64 + i));
        }
    }
}

/// What all draws of a batch share.
struct Descent<'a> {
    blocks: &'a [Block],
    nodes: &'a [Node],
    levels: Levels,
    ways: Ways,
    /// What an item's weight in the tree, and what its existence adds to `factor` times its probability.
    by_weight: f64,
    by_item: f64,
    /// The last item.
    last: u32,
}

impl Descent<'_> {
    /// At most `AT_ONCE` draws; as many weights as draws, or none.
    #[inline(always)]
    fn draw<K: Kernel, const AT_ONCE: usize>(&self, index: &mut [u32], weight: &mut [f32], bits: impl Fn(u64) -> u64) {
        // The draws by the tree: which of the chunk's they are, in which node or block they are, the position among its
        // weights, and behind its point.
        let mut slot = [0u8; AT_ONCE];
        let mut place = [0u32; AT_ONCE];
        let mut rest = [0i64; AT_ONCE];
        let mut fraction = [0f64; AT_ONCE];
        let mut uniform_slot = [0u8; AT_ONCE];
        let mut trees = 0;
        // Without branches, which could not be predicted: every draw is written as both, and one of them counts.
        for (i, out) in index.iter_mut().enumerate().take(AT_ONCE) {
            let bits = bits(i as u64);
            let uniform = self.ways.last_uniform.is_some_and(|last| bits <= last);
            let (place, below) = self.ways.scales[usize::from(uniform)].map(bits);
            slot[trees % AT_ONCE] = i as u8;
            rest[trees % AT_ONCE] = place as i64;
            // 53 bits: 0 to less than 1.
            fraction[trees % AT_ONCE] = (below >> 11) as i64 as f64 * (1.0 / 9_007_199_254_740_992.0);
            uniform_slot[(i - trees) % AT_ONCE] = i as u8;
            *out = place as u32;
            trees += usize::from(!uniform);
        }
        self.descend::<K, AT_ONCE>(trees, &mut place, &mut rest);
        // The weights of their blocks.
        let mut weights = [1f64; AT_ONCE];
        for (((place, rest), fraction), weight) in
            place.iter_mut().zip(&mut rest).zip(&mut fraction).zip(&mut weights).take(trees)
        {
            *weight = self.step::<K>(0, place, rest) as f64;
            *fraction += *rest as f64;
            prefetch::<K, _>(self.blocks, *place as usize);
        }
        // Where in the block.
        for (fraction, weight) in fraction.iter_mut().zip(&weights) {
            *fraction = (*fraction / weight).min(BELOW_ONE);
        }
        let mut totals = [1f64; AT_ONCE];
        let mut importance = [1f32; AT_ONCE];
        for ((((&place, &fraction), &slot), total), q) in
            place.iter().zip(&fraction).zip(&slot).zip(&mut totals).zip(&mut importance).take(trees)
        {
            let Some(block) = self.blocks.get(place as usize) else { continue };
            let (item, sum) = K::find_item(block, fraction);
            (*total, *q) = (sum, block[item % ARITY]);
            set(index, slot as usize, place * ARITY as u32 + item as u32);
        }
        // Nothing to do, unless the table's memory has been damaged: whatever it holds, what is drawn exists.
        for out in index.iter_mut() {
            *out = (*out).min(self.last);
        }
        if weight.is_empty() {
            return;
        }
        let mut results = [0f32; AT_ONCE];
        for (((result, &q), &total), &weight) in results.iter_mut().zip(&importance).zip(&totals).zip(&weights) {
            *result = self.weight(q, total, weight);
        }
        for (&result, &slot) in results.iter().zip(&slot).take(trees) {
            set(weight, slot as usize, result);
        }
        for &slot in uniform_slot.iter().take(weight.len().saturating_sub(trees)) {
            let (Some(&item), Some(out)) = (index.get(slot as usize), weight.get_mut(slot as usize)) else { continue };
            let which = item as usize / ARITY;
            let (Some(block), Some(node)) = (self.blocks.get(which), self.nodes.get(which / CHILDREN)) else {
                continue;
            };
            let total = K::total(block);
            // A block of importance 0 can be drawn from uniformly only.
            let (q, total) = if total > 0.0 { (block[item as usize % ARITY], total) } else { (0.0, 1.0) };
            *out = self.weight(q, total, tree::weight(node, which % CHILDREN) as f64);
        }
    }

    /// Takes the draws from the root to the nodes of the lowest level.
    #[inline(always)]
    fn descend<K: Kernel, const AT_ONCE: usize>(
        &self,
        draws: usize,
        place: &mut [u32; AT_ONCE],
        rest: &mut [i64; AT_ONCE],
    ) {
        let starts = self.levels.starts();
        // Levels that the first cache holds in one go, the others one by one, so that many accesses are under way at a
        // time.
        let near = starts.iter().position(|&start| self.nodes.len() - start <= NEAR).unwrap_or(0).max(1);
        let (far, near) = halves(starts, near);
        for (place, rest) in place.iter_mut().zip(rest.iter_mut()).take(draws) {
            let mut at = (*place, *rest);
            for start in near.iter().rev() {
                self.step::<K>(*start, &mut at.0, &mut at.1);
            }
            (*place, *rest) = at;
            if let Some(below) = far.last() {
                prefetch::<K, _>(self.nodes, below + *place as usize);
            }
        }
        for (below, start) in far.iter().zip(from(far, 1)).rev() {
            for (place, rest) in place.iter_mut().zip(rest.iter_mut()).take(draws) {
                self.step::<K>(*start, place, rest);
                prefetch::<K, _>(self.nodes, below + *place as usize);
            }
        }
    }

    /// From a node of the level that starts at `start` to one of its children, whose weight is returned.
    fn step<K: Kernel>(&self, start: usize, place: &mut u32, rest: &mut i64) -> i64 {
        let Some(node) = self.nodes.get(start + *place as usize) else { return 1 };
        let child = K::find_child(node, *rest) % CHILDREN;
        let (begin, end) = tree::span(node, child);
        *rest = rest.wrapping_sub(begin);
        *place = *place * CHILDREN as u32 + child as u32;
        end.wrapping_sub(begin)
    }

    /// 1 / (factor p), with one division, for an item of importance `q` in a block of this sum and weight.
    fn weight(&self, q: f32, total: f64, weight: f64) -> f32 {
        (total / (self.by_weight * weight * f64::from(q) + self.by_item * total)) as f32
    }
}

/// The largest number below 1: times a total it is below the total.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// # Errors
/// [`Error::Length`] unless there are as many weights as indices, or none at all.
pub(super) fn check_lengths(index: &[u32], weight: &Option<&mut [f32]>) -> Result<(), Error> {
    ensure(weight.as_ref().is_none_or(|weight| weight.len() == index.len()), Error::Length)
}

/// The bits of draw `k`: draws need no order.
pub(super) fn noise(seed: u64, k: u64) -> u64 {
    split_mix(seed, k.wrapping_add(1))
}
