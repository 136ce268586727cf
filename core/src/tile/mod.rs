//! Tiles: tables of sample points for the pixels of an image, and the sampler that draws from them.
//!
//! A tile holds, for each pixel of a small square that repeats over the image, a few points of the unit cube. They are
//! optimised offline (chapter 5) so that each pixel's points are well distributed, and so that what error remains
//! differs as much as it can between neighbouring pixels: the eye, a filter or a denoiser then removes most of it.
//!
//! - [`Tile`]: a view of a table, from a file's bytes ([`Tile::from_bytes`]) or of those compiled in ([`Builtin`]).
//! - [`Sampler`]: one sample of one pixel. Each decision of a path (lens, light, bounce) has a *domain*, a child of the
//!   sampler by a key of its own; there are no dimension counters. Any sample can be had in any order.
//! - [`fill()`]: many pixels and samples at once, the same bits.
//! - [`Header`]: how a tile is stored.
//!
//! `docs/tiles.md` has the semantics and a renderer's calls, `core/tiles/README.md` the format.

mod builtin;
mod draw;
mod format;
mod hash;
mod net;
mod point;
mod sampler;
mod sequence;
mod shape;
mod site;
mod view;

pub use crate::pixels::{PixelSampler, fill, fill_len};
pub use builtin::Builtin;
pub use format::{HEADER_BYTES, Header, KERNEL_BYTES, MAGIC, VERSION, quantize};
pub use sampler::Sampler;
pub use shape::{MAX_DIMS, MAX_FRAMES, MAX_SIZE, MAX_SPP, Shape};
pub use view::Tile;
