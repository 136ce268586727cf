//! The shipped tiles' further dimensions, those beyond the tile's own, in different domains: uniform, and independent of each other.
//!
//! All randomness is in the scramble's seeds, which are fixed: each is another place of the tile and another shift, so that a sample
//! of one pixel is one independent draw for each seed. Each test states the probability that it fails by chance.

#![cfg(feature = "shipped-tiles")]
