//! Point sets and tiles in the formats of other programs.

pub mod nft;
pub mod points;
pub mod sidecar;
pub mod tile;
