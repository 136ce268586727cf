//! Gradients of a data set's mean loss, from minibatches drawn in proportion to importance (chapter 6).
//!
//! - [`importance`]: how important an item is, from the output layer alone (6.1.4).
//! - [`weights()`]: one weight per drawn item of several importance distributions, so that the optimal MIS gradient
//!   costs one weighted backward pass; [`Gradient`]: the same from explicit per-item gradients, with momentum over
//!   steps (6.2).
//!
//! Everywhere the estimate of the gradient of the **mean** loss is `(1 / batch) sum_s weight_s gradient_s`.

mod batch;
mod gradient;
pub mod importance;
mod system;
mod weights;

pub use batch::Batch;
pub use gradient::{Gradient, len};
pub use system::System;
pub use weights::weights;
