//! Filtered sliced optimal transport (chapter 5): point sets and perceptual sample tiles, optimised offline.
//!
//! Chapters and equations are those of C. Salaün, "Toward Improving Monte Carlo Estimator for Rendering and Machine
//! Learning", 2025.
//!
//! `examples/library.rs` is a program that optimises points by a function, with progress and a checkpoint. All work is
//! done on the current rayon pool, which [`rayon::ThreadPool::install`] chooses.

#![warn(missing_debug_implementations)]

pub mod checkpoint;
pub mod class;
pub mod counted;
pub mod digest;
pub mod error;
pub mod export;
pub mod memory;
pub mod metrics;
pub mod optimize;
pub mod output;
pub mod picture;
pub mod place;
pub mod points;
pub mod random;
pub mod read;
pub mod run;
pub mod sampler;
pub mod stipple;
pub mod target;
pub mod tile;

pub use error::Error;
