//! A block: 16 importances, one cache line, and which of them a number between 0 and their sum falls on.
//!
//! Sums run down columns of four, column after column, so that a vector unit needs three additions for all columns and
//! a few more to join them. In f64 they lose nothing that a draw of 64 random bits could see.

/// How many importances a block has, and how many children a node of the tree.
pub const ARITY: usize = 16;

/// Importances, in four rows of four columns.
pub type Block = [f32; ARITY];

type Row = [f64; 4];

/// The sum of a block, and of its columns.
#[inline]
fn columns(block: &Block) -> (Row, f64) {
    let q = block.map(positive);
    let mut sums = [q[0], q[1], q[2], q[3]];
    for row in 1..4 {
        sums = add(&sums, &q, row);
    }
    (sums, ((sums[0] + sums[1]) + sums[2]) + sums[3])
}

#[inline]
pub(super) fn total(block: &Block) -> f64 {
    columns(block).1
}

/// The item that `u` in `0.0..1.0` falls on, never one of importance 0, and the block's sum.
#[inline]
pub(super) fn find(block: &Block, u: f64) -> (usize, f64) {
    let (sums, total) = columns(block);
    let y = u * total;
    // The same association as in the total, so that an item of 0 ends exactly where the one before it does.
    let starts = [0.0, sums[0], sums[0] + sums[1], (sums[0] + sums[1]) + sums[2]];
    let q = block.map(positive);
    let mut running = [0.0; 4];
    let mut counts = [0i64; 4];
    for row in 0..4 {
        running = add(&running, &q, row);
        let mut more = counts;
        for column in 0..4 {
            more[column] += i64::from(starts[column] + running[column] <= y);
        }
        counts = more;
    }
    let position = ((counts[0] + counts[1]) + (counts[2] + counts[3])) as usize % ARITY;
    (position % 4 * 4 + position / 4, total)
}

#[inline]
fn add(sums: &Row, q: &[f64; ARITY], row: usize) -> Row {
    // Copied before it is written, which lets compilers use vector instructions.
    let mut out = *sums;
    for column in 0..4 {
        out[column] += q[(4 * row + column) % ARITY];
    }
    out
}

/// An item taken out of the table for a while has a negative importance, which counts as 0.
#[inline]
pub(super) fn positive(q: f32) -> f64 {
    f64::from(if q > 0.0 { q } else { 0.0 })
}
