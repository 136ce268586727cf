//! How many densities there can be.

/// The most techniques that one call combines.
pub const MAX_TECHNIQUES: usize = 16;
