//! Tiles, the sampler that draws from them, and its batch form.

mod fill;
mod sampler;
mod shipped;
mod view;

pub use fill::*;
pub use sampler::*;
pub use shipped::*;
pub use view::*;
