//! What the benchmarks share: the two doors to the library, and how its estimators are configured.

pub mod c_abi;
pub mod c_gradient;
pub mod c_table;
pub mod c_tile;
pub mod method;

pub use method::{Door, Method, Prepared};
use std::path::{Path, PathBuf};

/// The folder of this name in cargo's target folder.
pub fn output(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    target.join(name)
}
