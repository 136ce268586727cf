//! The table: the memory of the importances and of their sums, and what they say.

use super::kernel::{ARITY, Block, Kernel, Portable};
use super::mixture::Mixture;
use super::tree::{self, CHILDREN, Levels, MAX_BLOCKS, Node};
use crate::error::{Error, check_part, ensure};
use crate::matrix::{at, first};
use crate::real::power_of_two;
use core::marker::PhantomData;

/// The uniform fraction of a new table: no weight 1 / (N p) above 5. Measured best on classification (.2 to .5 are
/// close).
pub const DEFAULT_UNIFORM_FRACTION: f32 = 0.2;

/// How many f32 of importances a table for so many items needs: `items`, rounded up to blocks of 16. 0 if no memory has
/// them.
pub const fn importance_len(items: u32) -> usize {
    let len = (items as u64).div_ceil(ARITY as u64) * ARITY as u64;
    if len <= (isize::MAX as usize / size_of::<f32>()) as u64 { len as usize } else { 0 }
}

/// How many i64 of sums a table for so many items needs: one for 15 items or so. 0 if no memory has the importances.
pub const fn sums_len(items: u32) -> usize {
    Levels::new(importance_len(items) / ARITY).nodes() * CHILDREN
}

/// What a table knows besides its memory; see [`Table::resume`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// What an importance is multiplied by to give its weight in the sums: a power of two.
    pub scale: f64,
    /// How many items there are.
    pub items: u32,
    /// The part of draws that are uniform, 0..=1.
    pub uniform_fraction: f32,
}

impl State {
    /// Whether a table may have it.
    pub(super) fn is_valid(&self) -> bool {
        (power_of_two(-300)..=power_of_two(300)).contains(&self.scale)
            && self.scale.to_bits() << 12 == 0
            && self.items > 0
            && (0.0..=1.0).contains(&self.uniform_fraction)
    }
}

/// Importances of the items of a data set, from which batches are drawn.
///
/// Item i is drawn with probability `p_i = (1 - d) q_i / sum q + d / N`, d being the uniform fraction: every weight
/// 1 / (N p_i) is then at most 1 / d. Where all importances are 0 draws are uniform, or refused if d is 0.
///
/// The memory is [`importance_len`] values of f32 and [`sums_len`] of i64, borrowed or owned, 4.6 bytes per item in
/// all. More memory is room for [`Table::append`].
///
/// ```
/// use noisefloor::minibatch::{Table, table};
/// use noisefloor::rng::Rng;
///
/// const ITEMS: u32 = 1000;
/// let mut table = Table::new([0.0; table::importance_len(ITEMS)], [0; table::sums_len(ITEMS)], ITEMS, None)?;
/// let mut rng = Rng::seed(1);
/// let (mut index, mut weight) = ([0; 64], [0.0; 64]);
/// table.draw(&mut rng, &mut index, Some(&mut weight))?;
/// // Gradients times `weight`, averaged over the batch, estimate the gradient of the mean loss. Then what was learnt:
/// let importance = index.map(|i| if i < 10 { 5.0 } else { 0.1 });
/// table.update(&index, &importance, 0.3)?;
/// # Ok::<(), noisefloor::Error>(())
/// ```
///
/// `K` is what draws and updates consist of: [`Portable`], unless [`Table::with_kernel`] takes another.
#[derive(Clone, Debug)]
pub struct Table<I, S, K = Portable> {
    pub(super) importance: I,
    pub(super) sums: S,
    /// How many blocks there is room for, and the tree over them.
    pub(super) blocks: usize,
    pub(super) levels: Levels,
    pub(super) state: State,
    kernel: PhantomData<K>,
}

impl<I: AsRef<[f32]>, S: AsRef<[i64]>> Table<I, S> {
    /// Takes up the memory that a table of this state has used, all of it: its length says where things are.
    ///
    /// # Errors
    /// [`Error::Memory`] if it is too small for the items, [`Error::Range`] for a state that no table has. The
    /// contents are not checked: if they are not what that table left there, draws are still of items that exist, but
    /// not as often as they should be, and weights are any numbers.
    pub fn resume(importance: I, sums: S, state: State) -> Result<Self, Error> {
        ensure(state.is_valid(), Error::Range)?;
        // The most blocks that the sums are for, by bisection.
        let fits = |blocks| Levels::new(blocks).nodes() * CHILDREN <= sums.as_ref().len();
        let most = (importance.as_ref().len() / ARITY).min(MAX_BLOCKS);
        let (mut blocks, mut not) = if fits(most) { (most, most) } else { (0, most) };
        while not - blocks > 1 {
            let middle = blocks + (not - blocks) / 2;
            if fits(middle) { blocks = middle } else { not = middle }
        }
        ensure(blocks * ARITY >= state.items as usize, Error::Memory)?;
        Ok(Table { importance, sums, blocks, levels: Levels::new(blocks), state, kernel: PhantomData })
    }

    /// The same table, drawn from and updated by other code, which gives the same bits.
    #[inline]
    pub fn with_kernel<K: Kernel>(self) -> Table<I, S, K> {
        let Table { importance, sums, blocks, levels, state, .. } = self;
        Table { importance, sums, blocks, levels, state, kernel: PhantomData }
    }
}

impl<I: AsRef<[f32]>, S: AsRef<[i64]>, K: Kernel> Table<I, S, K> {
    /// Sets the part of draws that are uniform over the items, 0..=1: no weight 1 / (N p) is above its reciprocal, none
    /// of B draws of [`Table::draw_distinct`] above that and (B - 1) / N. 0 draws by importance alone, 1 uniformly.
    /// Small fractions let weights explode when an importance has become out of date.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::Range`].
    pub fn set_uniform_fraction(&mut self, fraction: f32) -> Result<(), Error> {
        check_part(fraction)?;
        // Turns -0 into 0.
        self.state.uniform_fraction = fraction + 0.0;
        Ok(())
    }

    /// What is needed to take up the memory again.
    pub fn state(&self) -> State {
        self.state
    }

    /// The number of items N.
    pub fn items(&self) -> u32 {
        self.state.items
    }

    /// How many items there is room for.
    pub fn capacity(&self) -> u32 {
        (self.blocks * ARITY).min(u32::MAX as usize) as u32
    }

    /// The sum of all importances, as the tree has it: each block's sum is rounded, by 1 / 2^50 of all or so, and by up
    /// to 2^-17 of the mean block's once importances have shrunk.
    pub fn total(&self) -> f64 {
        self.sum() as f64 / self.state.scale
    }

    /// The importance of an item; 0 for an item that does not exist.
    pub fn importance(&self, item: u32) -> f32 {
        if item < self.state.items { at(self.importance.as_ref(), item as usize) } else { 0.0 }
    }

    /// The probability of drawing an item, as f32; 0 for an item that does not exist, or if nothing can be drawn.
    pub fn probability(&self, item: u32) -> f32 {
        let Ok(mixture) = self.mixture() else { return 0.0 };
        if item < self.state.items { self.probability_in(&mixture, item) as f32 } else { 0.0 }
    }

    /// Writes the probabilities of some items; elements of `probability` beyond them stay as they are.
    ///
    /// # Errors
    /// [`Error::Range`] for an item that does not exist; [`Error::Length`] for fewer elements than items;
    /// [`Error::NoSamples`] as for [`Table::draw`].
    pub fn probabilities(&self, index: &[u32], probability: &mut [f32]) -> Result<(), Error> {
        ensure(probability.len() >= index.len(), Error::Length)?;
        self.check_items(index)?;
        let mixture = self.mixture()?;
        for (out, &item) in probability.iter_mut().zip(index) {
            *out = self.probability_in(&mixture, item) as f32;
        }
        Ok(())
    }

    pub(super) fn probability_in(&self, mixture: &Mixture, item: u32) -> f64 {
        let item = item as usize;
        let block = self.blocks().get(item / ARITY);
        let q = at(self.importance.as_ref(), item);
        let node = self.nodes().get(item / ARITY / CHILDREN);
        let weight = node.map_or(0, |node| tree::weight(node, item / ARITY % CHILDREN));
        mixture.probability(q, block.map_or(0.0, Portable::total), weight)
    }

    /// Whether the table has these items: else [`Error::Range`].
    #[inline]
    pub fn check_items(&self, index: &[u32]) -> Result<(), Error> {
        let beyond = index.iter().fold(false, |beyond, &item| beyond | (item >= self.state.items));
        ensure(!beyond, Error::Range)
    }

    pub(super) fn mixture(&self) -> Result<Mixture, Error> {
        Mixture::of(self.sum(), self.state.items, f64::from(self.state.uniform_fraction))
    }

    /// The sum of all weights, below 2^62.
    pub(super) fn sum(&self) -> i64 {
        self.nodes().last().map_or(0, |root| root[CHILDREN - 1]).max(0)
    }

    pub(super) fn blocks(&self) -> &[Block] {
        let (blocks, _) = self.importance.as_ref().as_chunks();
        first(blocks, self.blocks)
    }

    /// The nodes, those of the lowest level first; the root is the last.
    pub(super) fn nodes(&self) -> &[Node] {
        let (nodes, _) = self.sums.as_ref().as_chunks();
        first(nodes, self.levels.nodes())
    }
}

impl<I: AsRef<[f32]> + AsMut<[f32]>, S: AsRef<[i64]> + AsMut<[i64]>> Table<I, S> {
    /// A table of `items` items, with these importances or, without, 1 for each, and [`DEFAULT_UNIFORM_FRACTION`].
    ///
    /// # Errors
    /// [`Error::Range`] for no items or a negative importance; [`Error::Length`] for another number of them;
    /// [`Error::NotFinite`] for NaN or infinity; [`Error::NoSamples`] if all are 0; [`Error::Memory`] for less than
    /// [`importance_len`] and [`sums_len`].
    pub fn new(importance: I, sums: S, items: u32, values: Option<&[f32]>) -> Result<Self, Error> {
        let state = State { scale: 1.0, items, uniform_fraction: DEFAULT_UNIFORM_FRACTION };
        let mut table = Table::resume(importance, sums, state)?;
        if let Some(values) = values {
            ensure(values.len() == items as usize, Error::Length)?;
            check_importances(values)?;
            ensure(values.iter().any(|&q| q > 0.0), Error::NoSamples)?;
        }
        let memory = table.clear();
        match values {
            Some(values) => memory.iter_mut().zip(values).for_each(|(to, &from)| *to = from + 0.0),
            None => memory.iter_mut().take(items as usize).for_each(|q| *q = 1.0),
        }
        table.rebuild();
        Ok(table)
    }

    /// Makes the memory that of no items, and returns that of the importances.
    pub(super) fn clear(&mut self) -> &mut [f32] {
        self.sums.as_mut().fill(0);
        let importances = self.importance.as_mut();
        importances.fill(0.0);
        importances
    }
}

/// Whether a table takes these importances: [`Error::NotFinite`], or [`Error::Range`] for a negative one.
pub fn check_importances(values: &[f32]) -> Result<(), Error> {
    // No early end: compilers check eight at a time.
    let (finite, negative) =
        values.iter().fold((true, false), |(finite, negative), &q| (finite & q.is_finite(), negative | (q < 0.0)));
    ensure(finite, Error::NotFinite)?;
    ensure(!negative, Error::Range)
}
