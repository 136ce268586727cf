//! Classes (section 5.3): which points shall follow which distribution, and how much it counts.

mod file;
mod filter;
mod function;
pub mod presets;
mod weighted;

pub use file::{ClassEntry, ClassFile, TargetSpec};
pub use function::{ClassFunction, Step};
pub use presets::{progressive, progressive_prefixes, ramp, single, three_colors, two_colors};
pub use weighted::{Class, ClassCoordinates};

pub(crate) use filter::{Filter, RUN};
pub(crate) use function::MIN_SIGMA;
pub(crate) use weighted::{check_weight, middle, normalised};
