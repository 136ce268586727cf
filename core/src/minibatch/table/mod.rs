//! A persistent importance for each item of a data set, and batches drawn in proportion to it (Algorithm 3).
//!
//! A position on a line as long as the sum of all importances picks an item. Leaves are the importances themselves,
//! f32, in blocks of a cache line; above them stands a tree of integer sums, 16 children to a node. Whole batches go
//! down level by level, so that the memory accesses of different draws overlap.
//!
//! Integers neither drift nor depend on the order of updates: after any number of them the sums are those that the same
//! importances give in a tree built afresh at the same scale. The scale is a power of two, so chosen that the sum is
//! near 2^50, and changed when the sum leaves its range: a block's weight is its sum rounded to 1 / 2^50 or so of all,
//! or, once importances have shrunk, to 2^-17 of the mean block's, and never to 0. Within a block f64 decides. What
//! [`Table::probability`] says is the probability of these rounded weights, so that estimates are unbiased, down to
//! probabilities of 2^-53 within a block, and of 2^-64 in all.

mod distinct;
mod draw;
mod importances;
mod kernel;
mod mixture;
mod saved;
mod shard;
mod tree;
mod update;

pub use importances::{DEFAULT_UNIFORM_FRACTION, State, Table, check_importances, importance_len, sums_len};
pub use kernel::{ARITY, Block, Kernel, Portable};
pub use saved::{HEADER_BYTES, saved_items, saved_len};
pub use shard::{Shard, allocate};
pub use tree::{CHILDREN, MAX_BLOCKS, Node};
