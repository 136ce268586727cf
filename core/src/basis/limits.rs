//! How large a basis can be.

/// The largest number of coordinates.
pub const MAX_DIMS: usize = 16;
/// The largest total degree.
pub const MAX_ORDER: usize = 7;
/// The largest number of terms, constant included: 15 coordinates at order 2.
pub const MAX_TERMS: usize = 136;
