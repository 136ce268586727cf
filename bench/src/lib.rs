//! What the benchmarks share: the two doors to the library, and how its estimators are configured.

pub mod c_abi;
pub mod c_tile;
pub mod method;

pub use method::{Door, Method, Prepared};
