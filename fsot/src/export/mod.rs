//! Point sets and tiles in the formats of other programs.

pub mod points;
pub mod tile;
