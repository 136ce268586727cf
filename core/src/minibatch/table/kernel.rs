//! The operations that a draw and an update consist of, so that a caller may have them for its processor.

use super::block::{self, ARITY, Block};
use super::tree::{self, Node};

/// The inner operations of a table, in plain Rust; every implementation must do the same to the bit.
pub trait Kernel {
    /// The sum of a block: of its columns from the first row to the last, and then of the columns from the first to the
    /// last. An importance that is not above 0 counts as 0.
    #[inline]
    fn total(block: &Block) -> f64 {
        block::total(block)
    }

    /// The item of a block that `u` in `0.0..1.0` falls on, and the block's sum: the first whose end is above `u` times
    /// the sum, in the order of columns, where an item ends at the start of its column plus the column's sum up to it.
    #[inline]
    fn find_item(block: &Block, u: f64) -> (usize, f64) {
        block::find(block, u)
    }

    /// How many children end at or before `r`.
    #[inline]
    fn find_child(node: &Node, r: i64) -> usize {
        tree::find(node, r)
    }

    /// Sets one importance of a block; the sum afterwards.
    #[inline]
    fn replace(block: &mut Block, item: usize, q: f32) -> f64 {
        block[item % ARITY] = q;
        block::total(block)
    }

    /// Adds to the ends of `child` and of those behind it, wrapping around.
    #[inline]
    fn add(node: &mut Node, child: usize, difference: i64) {
        tree::add(node, child, difference);
    }

    /// May ask the memory for something that will be needed soon: batches wait for many answers at a time.
    fn prefetch<T>(_soon: &T) {}
}

/// [`Kernel::prefetch`], if there is such an element.
#[inline]
pub(super) fn prefetch<K: Kernel, T>(all: &[T], at: usize) {
    if let Some(soon) = all.get(at) {
        K::prefetch(soon);
    }
}

/// Plain Rust.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

impl Kernel for Portable {}
