//! What the tests share: the oracle, the integrands, the statistics.

pub mod integrands;
pub mod legendre;
pub mod oracle;
pub mod planar;
pub mod random;
pub mod shared;
pub mod statistics;
pub mod tile;
