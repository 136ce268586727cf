//! What the benchmarks share: the two doors to the library, how its estimators are configured, and where results go.

pub mod c_abi;
pub mod c_gradient;
pub mod c_table;
pub mod c_tile;
pub mod method;

use anyhow::{Context, Result};
pub use method::{Door, Method, Prepared};
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of this name in cargo's target folder.
pub fn output(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    target.join(name)
}

/// Writes a file, whole or not at all, and before it the folder that it goes into if there is none.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let mut new = path.as_os_str().to_owned();
    new.push(".new");
    let written = fs::write(&new, content).and_then(|()| fs::rename(&new, path));
    written.with_context(|| format!("cannot write {}", path.display()))
}
