//! Minibatches whose items are drawn in proportion to their importance (chapter 6).
//!
//! - [`Table`]: a persistent importance for each item of a data set; draws batches, follows what training learns.

mod shuffle;
pub mod table;

pub use shuffle::shuffle;
pub use table::Table;
