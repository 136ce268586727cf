//! The operations that a draw and an update consist of, so that a caller may have them for its processor.
//!
//! Sums of a block run down columns of four, column after column, so that a vector unit needs three additions for all
//! columns and a few more to join them. In f64 they lose nothing that a draw of 64 random bits could see.

use super::tree::Node;
pub use crate::processor::Portable;

/// How many importances a block has: one cache line.
pub const ARITY: usize = 16;

/// Importances, in four rows of four columns.
pub type Block = [f32; ARITY];

/// The inner operations of a table, in plain Rust; every implementation must do the same to the bit.
pub trait Kernel {
    /// The sum of a block: of its columns from the first row to the last, and then of the columns from the first to the
    /// last. An importance that is not above 0 counts as 0.
    fn total(block: &Block) -> f64 {
        columns(block).1
    }

    /// The item of a block that `u` in `0.0..1.0` falls on, and the block's sum: the first whose end is above `u` times
    /// the sum, in the order of columns, where an item ends at the start of its column plus the column's sum up to it.
    /// Never one of importance 0.
    fn find_item(block: &Block, u: f64) -> (usize, f64) {
        let (sums, total) = columns(block);
        let y = u * total;
        // The same association as in the total, so that an item of 0 ends exactly where the one before it does.
        let starts = [0.0, sums[0], sums[0] + sums[1], (sums[0] + sums[1]) + sums[2]];
        let q = block.map(positive);
        let mut running = [0.0; 4];
        let mut counts = [0i64; 4];
        for row in 0..4 {
            running = add_row(&running, &q, row);
            let mut more = counts;
            for column in 0..4 {
                more[column] += i64::from(starts[column] + running[column] <= y);
            }
            counts = more;
        }
        let position = ((counts[0] + counts[1]) + (counts[2] + counts[3])) as usize % ARITY;
        (position % 4 * 4 + position / 4, total)
    }

    /// How many children end at or before `r`: the child that `r`, below the node's weight, falls on. Never one of
    /// weight 0.
    fn find_child(node: &Node, r: i64) -> usize {
        node.iter().filter(|end| **end <= r).count()
    }

    /// Sets one importance of a block; the sum afterwards.
    fn replace(block: &mut Block, item: usize, q: f32) -> f64 {
        block[item % ARITY] = q;
        Self::total(block)
    }

    /// Adds to the ends of `child` and of those behind it, wrapping around.
    fn add(node: &mut Node, child: usize, difference: i64) {
        let mut ends = *node;
        for (i, end) in ends.iter_mut().enumerate() {
            *end = end.wrapping_add(if i >= child { difference } else { 0 });
        }
        *node = ends;
    }

    /// May ask the memory for something that will be needed soon: batches wait for many answers at a time.
    fn prefetch<T>(_soon: &T) {}
}

impl Kernel for Portable {}

/// [`Kernel::prefetch`], if there is such an element.
pub(super) fn prefetch<K: Kernel, T>(all: &[T], at: usize) {
    if let Some(soon) = all.get(at) {
        K::prefetch(soon);
    }
}

/// The sums of a block's columns, and of the block.
fn columns(block: &Block) -> ([f64; 4], f64) {
    let q = block.map(positive);
    let mut sums = [q[0], q[1], q[2], q[3]];
    for row in 1..4 {
        sums = add_row(&sums, &q, row);
    }
    (sums, ((sums[0] + sums[1]) + sums[2]) + sums[3])
}

fn add_row(sums: &[f64; 4], q: &[f64; ARITY], row: usize) -> [f64; 4] {
    // Copied before it is written, which lets compilers use vector instructions.
    let mut out = *sums;
    for column in 0..4 {
        out[column] += q[(4 * row + column) % ARITY];
    }
    out
}

/// An item taken out of the table for a while has a negative importance, which counts as 0.
pub(super) fn positive(q: f32) -> f64 {
    f64::from(if q > 0.0 { q } else { 0.0 })
}
