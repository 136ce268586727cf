#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]
#![cfg_attr(
    not(all(feature = "control-variate", feature = "minibatch", feature = "sampler", feature = "tile")),
    allow(dead_code, unused_imports, reason = "each feature uses some of what they share")
)]
#![cfg_attr(
    not(all(
        feature = "control-variate",
        feature = "minibatch",
        feature = "sampler",
        feature = "tile",
        feature = "warp"
    )),
    allow(rustdoc::broken_intra_doc_links, reason = "they lead to what other features have")
)]
//! noisefloor: less Monte Carlo noise for the samples a renderer or trainer already pays for.
//!
//! - [`control_variate`]: a pixel's own samples, fitted by functions with known integrals, give an estimate whose error
//!   is usually far below the mean's and never noticeably above it (chapter 4).
//! - [`recommend`](mod@recommend): which estimator and which tile to use, from measurements.
//! - [`mis`]: weights for multiple importance sampling, the variance-minimising ones included (section 2.2.2).
//! - [`sampler`]: numbers for a renderer, whose error over the image is the least visible (chapter 5).
//! - [`tile`]: the same from tables of your own, or made for one number of samples.
//! - [`warp`]: from primary sample space to the shapes that a scene needs (section 2.2.1).
//! - [`minibatch`]: minibatches drawn in proportion to importance, and gradients of least variance from them (chapter
//!   6).
//! - [`rng`]: a small generator with the same stream on every target.
//!
//! Nothing allocates, and nothing panics on any input: errors are values. The same input gives the same bits on every
//! target with the arithmetic of IEEE 754 (32-bit x86 needs SSE2 for it). Chapters and equations are those of
//! C. Salaün, "Toward Improving Monte Carlo Estimator for Rendering and Machine Learning", 2025.
//!
//! A program without `std` brings a `#[panic_handler]`, which nothing here calls. Its code may stay in the program:
//! compilers remove the last checks that never fail only with `lto = "fat"` and `codegen-units = 1`, at `opt-level` 3
//! or "s".
//!
//! # Features
//!
//! All modules and four tiles are default; take what you need with `default-features = false`.
//!
//! - `control-variate`: [`control_variate`], [`basis`] and [`recommend`](mod@recommend).
//! - `mis`; `minibatch`, which implies it; `tile`: the modules of these names.
//! - `sampler`: [`sampler`], with its table of 256 KiB.
//! - `warp`: [`warp`], by `glam`.
//! - `tile-128-1spp-2d` and its like: one tile each. Default are it, `tile-128-4spp-2d`, `tile-128-1spp-4d` and
//!   `tile-64-1spp-2d`, at most 512 KiB together.
//! - `all-tiles`: every tile.
//!
//! ```
//! # #[cfg(feature = "control-variate")] {
//! use noisefloor::control_variate::{Config, Samples, estimate};
//! use noisefloor::rng::Rng;
//!
//! // 64 samples of exp(-x - y) over the unit square.
//! let mut rng = Rng::seed(1);
//! let mut u = [0.0f32; 128];
//! u.iter_mut().for_each(|u| *u = rng.uniform_f32());
//! let mut f = [0.0f32; 64];
//! f.iter_mut().zip(u.chunks_exact(2)).for_each(|(f, u)| *f = (-u[0] - u[1]).exp());
//!
//! let config = Config::new(2, 2, 1);
//! let mut workspace = [0.0f64; 512];
//! let estimate = estimate(&config, Samples::new(&u, &f), &mut workspace)?;
//! let exact = (1.0 - (-1.0f32).exp()).powi(2);
//! assert!((estimate.mean[0] - exact).abs() < 0.005);
//! # }
//! # Ok::<(), noisefloor::Error>(())
//! ```

mod arena;
#[cfg(feature = "control-variate")]
pub mod basis;
mod checksum;
#[cfg(feature = "control-variate")]
pub mod control_variate;
pub mod error;
mod hash;
mod lanes;
mod linalg;
mod matrix;
#[cfg(feature = "minibatch")]
pub mod minibatch;
#[cfg(feature = "mis")]
pub mod mis;
#[cfg(any(feature = "sampler", feature = "tile"))]
mod pixels;
#[cfg(any(feature = "control-variate", feature = "minibatch"))]
pub mod processor;
pub mod real;
#[cfg(feature = "control-variate")]
pub mod recommend;
pub mod rng;
#[cfg(feature = "sampler")]
pub mod sampler;
#[cfg(feature = "tile")]
pub mod tile;
#[cfg(feature = "warp")]
pub mod warp;

pub use error::{Error, Invalid};

#[cfg(all(doctest, feature = "control-variate", feature = "sampler"))]
#[doc = include_str!("../README.md")]
struct Readme;
