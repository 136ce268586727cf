//! Tables of importances, and minibatches drawn from them.

use crate::convert::{self, Slice};
use crate::dispatch::{self, Reader, Writer};
use crate::rng::{self, nf_rng};
use crate::status::*;
use crate::wrong::{Wrong, rule};
use core::ffi::c_void;
use noisefloor_core::Error;
use noisefloor_core::minibatch::table::{self, ARITY, MAX_BLOCKS, State, Table};

/// The importances of the items of a data set, from which minibatches are drawn (Algorithm 3).
///
/// Item i is drawn with probability p_i = (1 - d) q_i / sum q + d / N: q_i is its importance, d the uniform fraction,
/// .2 unless set. No weight 1 / (N p_i) is then above 1 / d. Draws and weights round alike; where d is 0, an item
/// beside one 2^53 times as important is lost. Where all importances are 0 draws are uniform, or NF_ERR_NO_SAMPLES if d
/// is 0. The struct refers to the memory its items live in: keep one copy.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct nf_table {
    /// q_i, of each item, to be read. In the memory given to nf_table_init.
    pub importance: *mut f32,
    /// The sums over them, behind.
    pub sums: *mut i64,
    /// A power of two: importances times this are what is summed.
    pub scale: f64,
    /// How many items there are: N.
    pub items: u32,
    /// How many blocks of 16 items there is room for.
    pub blocks: u32,
    /// d, the part of draws that are uniform; to be written at will, 0 to 1, else all calls are NF_ERR_RANGE. At 0 an
    /// item of importance 0 is never drawn, and one whose importance is out of date can get a weight of thousands.
    pub uniform_fraction: f32,
    /// Says that this is a table.
    pub magic: u32,
}

/// "nf_t", read on a little-endian machine.
const MAGIC: u32 = u32::from_le_bytes(*b"nf_t");
/// nf_table_save: the bytes before those of the items, of which each takes 4.
pub const NF_TABLE_SAVED_HEADER: u32 = 32;

const _: () = assert!(NF_TABLE_SAVED_HEADER as usize == table::HEADER_BYTES);

/// A block of items is a cache line, and starts where one does.
const ALIGNMENT: usize = 64;
/// What aligning memory that is aligned to 8 bytes takes at most.
const SLACK: usize = ALIGNMENT - 8;

/// Bytes of memory of a table, at most 4.6 for each item and a few hundred; 0 for 0 items, or if no memory has them.
#[unsafe(no_mangle)]
pub extern "C" fn nf_table_size(items: u32) -> usize {
    let blocks = items.div_ceil(ARITY as u32);
    match (items, parts(blocks)) {
        (1.., Some((importance, sums))) => importance + sums + SLACK,
        _ => 0,
    }
}

/// The bytes of the importances and of the sums of so many blocks, or nothing if no memory has them.
fn parts(blocks: u32) -> Option<(usize, usize)> {
    // The last block of all would be one item too many.
    let items = u32::try_from(u64::from(blocks) * ARITY as u64).unwrap_or(u32::MAX);
    let importance = table::importance_len(items).checked_mul(size_of::<f32>())?;
    let sums = table::sums_len(items).checked_mul(size_of::<i64>())?;
    let all = importance.checked_add(sums)?.checked_add(SLACK)?;
    (importance > 0 && all <= isize::MAX as usize).then_some((importance, sums))
}

/// Makes a table of `items` items in `memory`, of which more than nf_table_size(items) bytes are room for
/// nf_table_append; all are written. importance[items]: at least 0, finite, not all 0; or NULL, which makes all 1, for
/// an initial epoch (Algorithm 4). uniform_fraction becomes .2.
///
/// NF_ERR_RANGE: no items, bytes beyond any memory, a negative importance; NF_ERR_NOT_FINITE; NF_ERR_NO_SAMPLES: all
/// are 0; NF_ERR_MEMORY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_init(
    table: *mut nf_table,
    memory: *mut c_void,
    bytes: usize,
    items: u32,
    importance: *const f32,
) -> nf_status {
    status((|| {
        convert::usable(table)?;
        ensure(items > 0, NF_ERR_RANGE)?;
        let values = match importance.is_null() {
            true => None,
            // SAFETY: the caller passes as many importances as items.
            false => Some(unsafe { convert::slice(importance, items as usize) }?),
        };
        // SAFETY: the caller passes room for a table, and memory that no one else uses.
        unsafe { create(table, memory, bytes, items, |importance, sums| Table::new(importance, sums, items, values)) }
    })())
}

/// Draws `batch` items with replacement, independently, in proportion to importance.
///
/// index[batch]: the items. weight[batch]: 1 / (N p) of each: gradients times weights, averaged over the batch,
/// estimate the gradient of the mean loss without bias (6.3). NULL where they are not wanted: adaptive sampling (w = p
/// in Algorithm 3), which favours important items, a bias by design.
///
/// NF_ERR_RANGE: uniform_fraction; NF_ERR_NO_SAMPLES: nothing can be drawn. A batch of 0 is no error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_draw(
    table: *const nf_table,
    rng: *mut nf_rng,
    batch: u32,
    index: *mut u32,
    weight: *mut f32,
) -> nf_status {
    // SAFETY: passed on to the caller.
    unsafe { draw(table, rng, batch, index, weight, dispatch::table_draw) }
}

/// As nf_table_draw, from `batch` equal parts of the line of probabilities: less variance where neighbouring items are
/// alike. In the order of the data set but within blocks of 16, uniform draws first: use the batch as a whole.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_draw_stratified(
    table: *const nf_table,
    rng: *mut nf_rng,
    batch: u32,
    index: *mut u32,
    weight: *mut f32,
) -> nf_status {
    // SAFETY: passed on to the caller.
    unsafe { draw(table, rng, batch, index, weight, dispatch::table_draw_stratified) }
}

/// Draws `batch` different items, the k-th being item i with probability c_i = ((1 - d) q_i / sum q + d / N) / (1 - d
/// (k - 1) / N), the sum being that of the items not yet drawn, d 1 where it is 0. weight: (1 / c_k + batch - k) / N,
/// at most 1 / d + (batch - 1) / N, for the same unbiased estimate (Raj 1956).
///
/// The table is written meanwhile, and the same afterwards. A draw takes the time of some ten updates, or, where a few
/// items have nearly all of the sum, time for every item.
///
/// NF_ERR_RANGE: more than there are items; NF_ERR_NO_SAMPLES also where d is 0 and fewer items have an importance
/// above 0; else as for nf_table_draw.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_draw_distinct(
    table: *mut nf_table,
    rng: *mut nf_rng,
    batch: u32,
    index: *mut u32,
    weight: *mut f32,
) -> nf_status {
    // SAFETY: passed on to the caller. What is changed is changed back: the struct stays as it is.
    unsafe { draw(table, rng, batch, index, weight, dispatch::table_draw_distinct) }
}

/// Sets the importance of visited items, one after the other: q = momentum q + (1 - momentum) importance (line 13 of
/// Algorithm 3, (6.11)). An item that comes twice is changed twice.
///
/// index[batch]; importance[batch]: at least 0, finite. momentum: 0..1; 0 forgets the old value, .3 is a good choice.
///
/// NF_ERR_RANGE: an item, an importance, momentum; NF_ERR_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_update(
    table: *mut nf_table,
    index: *const u32,
    importance: *const f32,
    batch: u32,
    momentum: f32,
) -> nf_status {
    // SAFETY: the caller passes arrays of `batch` elements and a table that no one else uses.
    unsafe {
        change(table, |table| {
            let (index, importance) =
                (convert::slice(index, batch as usize)?, convert::slice(importance, batch as usize)?);
            Ok(dispatch::table_update(table, index, importance, momentum)?)
        })
    }
}

/// Adds epsilon, at least 0, to every importance: line 15 of Algorithm 3. The uniform fraction does so at no cost.
///
/// NF_ERR_RANGE; NF_ERR_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_add_epsilon(table: *mut nf_table, epsilon: f32) -> nf_status {
    // SAFETY: the caller passes a table that no one else uses.
    unsafe { change(table, |table| Ok(dispatch::table_add_epsilon(table, epsilon)?)) }
}

/// Adds `count` items behind the last.
///
/// NF_ERR_MEMORY: nf_table_init got no room; NF_ERR_RANGE, NF_ERR_NOT_FINITE: an importance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_append(table: *mut nf_table, importance: *const f32, count: u32) -> nf_status {
    // SAFETY: the caller passes `count` importances and a table that no one else uses.
    unsafe {
        change(table, |mut table| {
            table.append(convert::slice(importance, count as usize)?)?;
            Ok(table.state())
        })
    }
}

/// The probabilities of `count` items: p[k * stride] of index[k]. With J tables, stride J and p + j for the j-th table
/// make the rows that nf_omis_weights takes.
///
/// NF_ERR_RANGE: an item, or stride 0; NF_ERR_NO_SAMPLES as for nf_table_draw.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_probabilities(
    table: *const nf_table,
    index: *const u32,
    count: u32,
    stride: u32,
    p: *mut f32,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes a table that no one writes meanwhile, and `count` items.
        let (table, index): (Reader<'_>, _) = unsafe { (open(table)?, convert::slice(index, count as usize)?) };
        let Some(last) = count.checked_sub(1) else { return Ok(()) };
        convert::usable(p)?;
        let bytes = convert::product(last as usize, stride as usize)?.checked_mul(size_of::<f32>());
        ensure(stride > 0 && bytes.is_some_and(|bytes| bytes < isize::MAX as usize), NF_ERR_RANGE)?;
        table.check_items(index)?;
        let mut place = p;
        for index in index.chunks(64) {
            let mut probability = [0.0; 64];
            table.probabilities(index, &mut probability)?;
            for &value in probability.iter().take(index.len()) {
                // SAFETY: the caller passes room for the last of them. Those between are another's: no slice may cover
                // them.
                unsafe { place.write(value) };
                place = place.wrapping_add(stride as usize);
            }
        }
        Ok(())
    })())
}

/// Writes the table, the same bytes on every target: exactly NF_TABLE_SAVED_HEADER + 4 * items, of any alignment.
///
/// NF_ERR_LENGTH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_save(table: *const nf_table, saved: *mut c_void, len: usize) -> nf_status {
    status((|| {
        // SAFETY: the caller passes a table that no one writes meanwhile, and room for `len` bytes.
        let (table, saved): (Reader<'_>, _) = unsafe { (open(table)?, convert::outputs(saved.cast::<u8>(), len)?) };
        Ok(table.save(saved)?)
    })())
}

/// A table as nf_table_save wrote it, in memory as for nf_table_init: it draws the same items from the same generator.
///
/// NF_ERR_FOREIGN, NF_ERR_VERSION, NF_ERR_LENGTH, NF_ERR_CORRUPT: `saved`; NF_ERR_MEMORY; NF_ERR_RANGE: bytes, len.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_table_load(
    table: *mut nf_table,
    memory: *mut c_void,
    bytes: usize,
    saved: *const c_void,
    len: usize,
) -> nf_status {
    status((|| {
        convert::usable(table)?;
        convert::usable(saved)?;
        // SAFETY: the caller passes `len` bytes.
        let saved = unsafe { convert::slice(saved.cast::<u8>(), len) }?;
        let items = table::saved_items(saved)?;
        // SAFETY: the caller passes room for a table, and memory that no one else uses.
        unsafe { create(table, memory, bytes, items, |importance, sums| Table::load(importance, sums, saved)) }
    })())
}

/// # Safety
/// As for [`nf_table_draw`], or [`nf_table_draw_distinct`].
unsafe fn draw<I: Slice<f32>, S: Slice<i64>>(
    table: *const nf_table,
    rng: *mut nf_rng,
    batch: u32,
    index: *mut u32,
    weight: *mut f32,
    draw: impl FnOnce(Table<I, S>, &mut rng::Rng, &mut [u32], Option<&mut [f32]>) -> Result<(), Error>,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes a table that no one writes meanwhile, or uses where that is drawn from which writes
        // it, a generator that no one else uses, and outputs of `batch` elements.
        unsafe {
            let table = open(table)?;
            let index = convert::outputs(index, batch as usize)?;
            let weight = convert::optional_outputs(weight, batch as usize)?;
            rng::try_with(rng, |rng| draw(table, rng, index, weight))
        }
    })())
}

/// The table as the core sees it, a [`Reader`] or a [`Writer`]; the struct itself is the caller's to write.
///
/// # Safety
/// A non-NULL `table` must be one that nf_table_init or nf_table_load made, whose memory no one writes while the result
/// is used, nor reads if that can write it.
pub(crate) unsafe fn open<I: Slice<f32>, S: Slice<i64>>(table: *const nf_table) -> Result<Table<I, S>, nf_status> {
    // SAFETY: passed on to the caller.
    let table = unsafe { convert::reference(table) }?;
    let (importance, sums) = lengths(table)?;
    // SAFETY: nf_table_init made both of these lengths.
    let (importance, sums) = unsafe { (I::of(table.importance, importance)?, S::of(table.sums, sums)?) };
    // Adding 0 turns -0 into it.
    let uniform_fraction = table.uniform_fraction + 0.0;
    let state = State { scale: table.scale, items: table.items, uniform_fraction };
    Table::resume(importance, sums, state).map_err(|_| NF_ERR_STATE)
}

/// Changes a table: `change` says how it then is.
///
/// # Safety
/// As for [`open`], to write.
unsafe fn change(table: *mut nf_table, change: impl FnOnce(Writer<'_>) -> Result<State, nf_status>) -> nf_status {
    status((|| {
        // SAFETY: passed on to the caller.
        let state = change(unsafe { open(table) }?)?;
        // SAFETY: as above; nothing else refers to the struct any more.
        let table = unsafe { convert::reference_mut(table) }?;
        (table.scale, table.items, table.uniform_fraction) = (state.scale, state.items, state.uniform_fraction);
        Ok(())
    })())
}

const NO_TABLE: Wrong =
    Wrong(NF_ERR_STATE, c"it must be a table, all fields but uniform_fraction as nf_table_init() made them");

/// What is wrong with a table.
///
/// # Safety
/// As for [`open`].
pub(crate) unsafe fn check_table(table: &nf_table) -> Result<(), Wrong> {
    lengths(table)?;
    // SAFETY: passed on to the caller.
    unsafe { open(table) }.map(|_: Reader<'_>| ()).map_err(|_| NO_TABLE)
}

/// How many importances and sums a table's memory has.
fn lengths(table: &nf_table) -> Result<(usize, usize), Wrong> {
    let is_table = table.magic == MAGIC && !table.importance.is_null() && table.blocks as usize <= MAX_BLOCKS;
    ensure(is_table, NO_TABLE)?;
    let (importance, sums) = parts(table.blocks).ok_or(NO_TABLE)?;
    // nf_table_init put the sums right behind: where that no longer holds, pointers or lengths have been changed since.
    ensure(table.sums.addr() == table.importance.addr().wrapping_add(importance), NO_TABLE)?;
    rule((0.0..=1.0).contains(&table.uniform_fraction), c"uniform_fraction must be 0 to 1")?;
    Ok((importance / size_of::<f32>(), sums / size_of::<i64>()))
}

/// Makes a table in memory for at least `items` items.
///
/// # Safety
/// `table` must be room for a table, and a non-NULL `memory` the start of `bytes` bytes that no one else uses.
unsafe fn create(
    table: *mut nf_table,
    memory: *mut c_void,
    bytes: usize,
    items: u32,
    make: impl for<'a> FnOnce(&'a mut [f32], &'a mut [i64]) -> Result<Writer<'a>, Error>,
) -> Result<(), nf_status> {
    let needed = nf_table_size(items);
    ensure(needed > 0, NF_ERR_MEMORY)?;
    // SAFETY: passed on to the caller.
    let start = unsafe { convert::memory(memory, bytes, needed) }?;
    // All of them are written.
    ensure(bytes <= isize::MAX as usize, NF_ERR_RANGE)?;
    let fits = |blocks| parts(blocks).is_some_and(|(importance, sums)| importance + sums + SLACK <= bytes);
    // The most blocks that fit, by bisection: those of `items` do, one more than the most there can be does not.
    let (mut blocks, mut not) = (items.div_ceil(ARITY as u32), MAX_BLOCKS as u32 + 1);
    while not - blocks > 1 {
        let middle = blocks + (not - blocks) / 2;
        if fits(middle) { blocks = middle } else { not = middle }
    }
    let (of_importance, of_sums) = parts(blocks).ok_or(NF_ERR_MEMORY)?;
    // The first cache line that begins in the memory.
    let start = start.wrapping_add(start.addr().wrapping_neg() % ALIGNMENT);
    let (importance, sums) = (start.cast(), start.wrapping_add(of_importance).cast());
    // SAFETY: `start` is aligned for both, and at most SLACK bytes behind the start of memory that holds as much and
    // both.
    let made = unsafe {
        make(
            convert::outputs(importance, of_importance / size_of::<f32>())?,
            convert::outputs(sums, of_sums / size_of::<i64>())?,
        )
    };
    let State { scale, items, uniform_fraction } = made?.state();
    // SAFETY: passed on to the caller.
    unsafe {
        convert::write(table, nf_table { importance, sums, scale, items, blocks, uniform_fraction, magic: MAGIC })
    }
}
