//! Several tables drawn as one: each process of a data-parallel trainer owns the table of its part of the data.

use super::draw::{CHUNK, check_lengths, noise};
use super::importances::Table;
use super::kernel::Kernel;
use super::mixture::{Mixture, shares};
use crate::error::{Error, check_part, ensure};
use crate::real::Real;
use crate::rng::Rng;

/// What the others must know of one process's table: 16 bytes that all processes exchange before a draw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shard {
    /// The sum of its importances.
    pub importance: f64,
    /// How many items it has.
    pub items: u64,
}

impl Shard {
    /// What all of these are together; every process must add them in the same order, for the same bits.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; [`Error::Range`] for a negative sum, one of no items, or 2^53 items or more;
    /// [`Error::NoSamples`] if there is no item.
    pub fn sum(shards: impl IntoIterator<Item = Shard>) -> Result<Shard, Error> {
        let mut all = Shard::default();
        for shard in shards {
            ensure(shard.importance.is_finite(), Error::NotFinite)?;
            let items = all.items.saturating_add(shard.items);
            ensure(shard.importance >= 0.0 && items < 1 << 53, Error::Range)?;
            ensure(shard.items > 0 || shard.importance == 0.0, Error::Range)?;
            all = Shard { importance: all.importance + shard.importance, items };
        }
        ensure(all.importance.is_finite(), Error::NotFinite)?;
        ensure(all.items > 0, Error::NoSamples)?;
        Ok(all)
    }

    /// The probability that a draw from `all` falls to this part by importance, and uniformly.
    ///
    /// # Errors
    /// [`Error::NoSamples`] if nothing can be drawn.
    fn ways(&self, all: &Shard, uniform_fraction: f64) -> Result<(f64, f64), Error> {
        let (tree, uniform) = shares(all.importance > 0.0, uniform_fraction)?;
        // Without importance `tree` is 0.
        let part = (self.importance / all.importance.or_one(), self.items as f64 / all.items as f64);
        Ok((tree * part.0, uniform * part.1))
    }
}

/// How many of a batch's items come from each shard: in proportion to their probabilities, rounded up or down at random
/// so that each is right on average (systematic sampling). `counts`, as long as `shards`, sums to `batch`.
///
/// Every process calls it with the same shards and a generator of the same seed, and so learns its own part.
///
/// # Errors
/// As for [`Shard::sum`]; [`Error::Length`] for different lengths, [`Error::Range`] for a fraction outside 0..=1;
/// [`Error::NotFinite`]; [`Error::NoSamples`] if every importance and the fraction are 0.
///
/// ```
/// use noisefloor::minibatch::table::{Shard, allocate};
/// use noisefloor::rng::Rng;
///
/// let shards = [Shard { importance: 3.0, items: 10 }, Shard { importance: 1.0, items: 10 }];
/// let mut counts = [0; 2];
/// allocate(shards.into_iter(), 0.0, &mut Rng::seed(1), 8, &mut counts)?;
/// assert_eq!(counts, [6, 2]);
/// # Ok::<(), noisefloor::Error>(())
/// ```
pub fn allocate(
    shards: impl Iterator<Item = Shard> + Clone,
    uniform_fraction: f32,
    rng: &mut Rng,
    batch: u32,
    counts: &mut [u32],
) -> Result<(), Error> {
    check_part(uniform_fraction)?;
    ensure(shards.clone().count() == counts.len(), Error::Length)?;
    let all = Shard::sum(shards.clone())?;
    let fraction = f64::from(uniform_fraction);
    let share = |shard: Shard| shard.ways(&all, fraction).map(|(tree, uniform)| tree + uniform);
    share(all)?;
    let offset = rng.uniform_f64();
    let mut end = 0.0;
    let mut before = 0;
    // The last shard that can be drawn from takes what rounding leaves.
    let possible = |&(_, shard): &(usize, Shard)| share(shard).is_ok_and(|share| share > 0.0);
    let last = shards.clone().enumerate().filter(possible).map(|(i, _)| i).last();
    for (i, (shard, count)) in shards.zip(counts).enumerate() {
        end += share(shard)?;
        // How many of the points offset, offset + 1, ... lie before the shard's end.
        let until = match last.is_some_and(|last| i < last) {
            // Not `clamp`, which can panic.
            true => (libm::ceil(end * f64::from(batch) - offset) as u32).max(before).min(batch),
            false => batch,
        };
        *count = until - before;
        before = until;
    }
    Ok(())
}

impl<I: AsRef<[f32]>, S: AsRef<[i64]>, K: Kernel> Table<I, S, K> {
    /// What other processes must know of this table.
    pub fn shard(&self) -> Shard {
        Shard { importance: self.total(), items: u64::from(self.state.items) }
    }

    /// As [`Table::draw`] for this process's part of a batch over several tables that are, together, `all` (their
    /// [`Shard::sum`], this table's [`Table::shard`] included): weights are those of the whole. Gradients times
    /// weights, summed over the parts and divided by the whole batch's size, estimate the gradient of the mean loss
    /// over all items.
    ///
    /// All tables must have the same uniform fraction. How many items each process draws, [`allocate`] says.
    ///
    /// # Errors
    /// [`Error::Length`] for another number of weights; [`Error::Range`] if `all` is less than this table alone, or has
    /// 2^53 items; [`Error::NotFinite`]; [`Error::NoSamples`] if nothing can be drawn from any, or from this table and
    /// `index` is not empty. Where `all` dwarfs this table a weight may be infinite.
    #[inline]
    pub fn draw_shard(
        &self,
        all: &Shard,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        check_lengths(index, &weight)?;
        ensure(all.importance.is_finite(), Error::NotFinite)?;
        let own = self.shard();
        let has_own = all.items >= own.items && all.importance >= own.importance;
        ensure(has_own && all.items < 1 << 53, Error::Range)?;
        let (tree, uniform) = own.ways(all, f64::from(self.state.uniform_fraction))?;
        let share = tree + uniform;
        // What `allocate` asks of a table from which nothing can be drawn.
        if index.is_empty() {
            return Ok(());
        }
        ensure(share > 0.0, Error::NoSamples)?;
        let mixture = Mixture::of(self.sum(), self.state.items, uniform / share)?;
        self.draw_mixture::<CHUNK>(&mixture, share * all.items as f64, rng, index, weight, noise);
        Ok(())
    }
}
