#![cfg_attr(all(panic = "abort", not(test)), no_std)]
//! The C ABI of noisefloor. `include/noisefloor.h` is generated from this crate and is its documentation.
//!
//! Every function checks its arguments, writes its outputs only on success, and never panics, allocates or locks.
//! This crate is the only one that contains `unsafe`; the pointer checks are in [`convert`].

// What a caller must promise is written for C readers, once, at the head of the header.
#![allow(clippy::missing_safety_doc)]

#[cfg(target_arch = "x86_64")]
mod avx2;
mod check;
mod convert;
mod cv;
mod dispatch;
mod fill;
mod gradient;
mod importance;
mod magic;
mod mis;
mod omis;
mod recommend;
mod rng;
mod sampler;
mod shard;
mod status;
mod table;
mod tile;
mod wrong;

pub use check::*;
pub use cv::*;
pub use gradient::*;
pub use importance::*;
pub use mis::*;
pub use omis::*;
pub use recommend::*;
pub use rng::*;
pub use sampler::*;
pub use shard::*;
pub use status::*;
pub use table::*;
pub use tile::*;

/// Nothing in the library can panic (a test looks for the panic symbols in the archive), so this is never reached.
#[cfg(all(panic = "abort", not(test)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
