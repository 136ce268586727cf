//! Tables of several processes, drawn as one; and shuffling.

use crate::convert;
use crate::dispatch::{self, Reader};
use crate::rng::{self, nf_rng};
use crate::status::*;
use crate::table::{nf_table, open};
use noisefloor_core::minibatch::{
    self,
    table::{self, Shard},
};

/// What the processes of a data-parallel trainer, each with the table of its part of the data, must know of each
/// other's: before a draw all gather these 16 bytes (MPI_Allgather, for example).
#[repr(C)]
#[allow(non_camel_case_types)]
#[derive(Clone, Copy)]
pub struct nf_shard {
    /// The sum of the importances.
    pub importance: f64,
    /// The number of items.
    pub items: u64,
}

/// What the other processes must know of this table.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_shard(table: *const nf_table, out: *mut nf_shard) -> nf_status {
    status((|| {
        // SAFETY: the caller passes a table that no one writes meanwhile, and room for the result.
        unsafe {
            let table: Reader<'_> = open(table)?;
            let Shard { importance, items } = table.shard();
            convert::write(out, nf_shard { importance, items })
        }
    })())
}

/// How many of a batch's items each process draws: counts[shards], in proportion to the shards' probabilities, each
/// right on average. They sum to batch. Every process calls it with the same shards and a generator of the same seed.
/// uniform_fraction: that of all tables.
///
/// NF_ERR_RANGE: a negative sum, one of no items, 2^53 items or more together, uniform_fraction; NF_ERR_NOT_FINITE;
/// NF_ERR_NO_SAMPLES: no shards, no items, or nothing that can be drawn.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_shards_allocate(
    shard: *const nf_shard,
    shards: u32,
    uniform_fraction: f32,
    rng: *mut nf_rng,
    batch: u32,
    counts: *mut u32,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes `shards` shards, a generator that no one else uses, and room for as many counts.
        unsafe {
            let shard = convert::slice(shard, shards as usize)?;
            let counts = convert::outputs(counts, shards as usize)?;
            rng::try_with(rng, |rng| table::allocate(shared(shard), uniform_fraction, rng, batch, counts))
        }
    })())
}

/// As nf_table_draw, for this process's part of a batch over all shards, of which this table is one, unchanged since
/// its nf_shard was made: gradients times weights, summed over all processes and divided by the whole batch's size,
/// estimate the gradient of the mean loss over all items. batch: from nf_shards_allocate. Where the others dwarf it a
/// weight may be infinite.
///
/// NF_ERR_RANGE also if the shards have less than this table; else as for nf_table_draw and nf_shards_allocate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_draw_shard(
    table: *const nf_table,
    shard: *const nf_shard,
    shards: u32,
    rng: *mut nf_rng,
    batch: u32,
    index: *mut u32,
    weight: *mut f32,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes a table that no one writes meanwhile, `shards` shards, a generator that no one else
        // uses, and outputs of `batch` elements.
        unsafe {
            let table = open(table)?;
            let all = Shard::sum(shared(convert::slice(shard, shards as usize)?))?;
            let (index, weight) =
                (convert::outputs(index, batch as usize)?, convert::optional_outputs(weight, batch as usize)?);
            rng::try_with(rng, |rng| dispatch::table_draw_shard(table, &all, rng, index, weight))
        }
    })())
}

/// As the core has them.
fn shared(shards: &[nf_shard]) -> impl Iterator<Item = Shard> + Clone {
    shards.iter().map(|&nf_shard { importance, items }| Shard { importance, items })
}

/// The elements from `position` on of a random permutation of 0..items-1, which seed chooses: an epoch's order
/// (Algorithm 4) with no array of all. Positions beyond the last start again. index[count]: the output.
///
/// NF_ERR_RANGE: no items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_shuffle(seed: u64, items: u32, position: u64, count: u32, index: *mut u32) -> nf_status {
    status((|| {
        // SAFETY: the caller passes room for `count` indices.
        let index = unsafe { convert::outputs(index, count as usize) }?;
        let first = position.checked_rem(items.into()).ok_or(NF_ERR_RANGE)?;
        for (at, index) in (first..).zip(index) {
            *index = minibatch::shuffle(seed, items, (at % u64::from(items)) as u32);
        }
        Ok(())
    })())
}
