//! Minibatches whose items are drawn in proportion to their importance, and gradients of the mean loss from them
//! (chapter 6).
//!
//! - [`Table`]: a persistent importance for each item of a data set; draws batches, follows what training learns
//!   (section 6.1.3).
//! - [`shuffle()`]: the items in a random order, without an array: the first epoch.
//! - [`importance`]: how important an item is, from the output layer alone (section 6.1.4).
//! - [`weights()`]: one weight per drawn item of several importance distributions, so that the optimal MIS gradient
//!   costs one weighted backward pass; [`Gradient`]: the same from explicit per-item gradients, with momentum over
//!   steps (section 6.2).
//!
//! Everywhere the estimate of the gradient of the **mean** loss is `(1 / batch) sum_s weight_s gradient_s`.

mod batch;
mod gradient;
pub mod importance;
mod shuffle;
mod system;
pub mod table;
mod weights;

pub use batch::Batch;
pub use gradient::{Gradient, gradient_len};
pub use shuffle::shuffle;
pub use system::System;
pub use table::Table;
pub use weights::weights;
