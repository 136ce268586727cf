//! What `cargo xtask` is made of, for the crates `release` and `report` too.

pub mod c_tests;
pub mod fill;
pub mod fuzz;
pub mod install;
pub mod instructions;
pub mod library;
pub mod playground;
pub mod python;
pub mod renderers;
pub mod run;
pub mod start;
pub mod test;
pub mod texts;
pub mod tiles;
pub mod tools;

/// Where things are.
pub mod paths {
    use anyhow::{Context, Result};
    use serde_json::Value;
    use std::path::{Path, PathBuf};

    /// The workspace root.
    pub fn root() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
    }

    /// A text, by its path from the workspace root.
    pub fn read(name: impl AsRef<Path>) -> Result<String> {
        let path = root().join(name);
        std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
    }

    /// The same of JSON.
    pub fn json(name: impl AsRef<Path>) -> Result<Value> {
        serde_json::from_str(&read(&name)?).with_context(|| format!("{} is no JSON", name.as_ref().display()))
    }

    /// The elements of an array; none of anything else.
    pub fn elements(json: &Value) -> &[Value] {
        json.as_array().map_or(&[], Vec::as_slice)
    }

    /// Cargo's target folder, wherever the user put it.
    pub fn target() -> PathBuf {
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |dir| root().join(dir))
    }

    /// Where the C library and what is linked with it go.
    pub fn output() -> PathBuf {
        target().join("noisefloor")
    }

    /// What is in a folder, in order.
    pub fn list(folder: impl AsRef<Path>) -> Result<Vec<PathBuf>> {
        let folder = root().join(folder);
        let list = || std::fs::read_dir(&folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>();
        let mut paths = list().with_context(|| format!("cannot read {}", folder.display()))?;
        paths.sort();
        Ok(paths)
    }

    /// The files of a folder whose names end so, in order.
    pub fn of_kind(folder: &str, extension: &str) -> Result<Vec<PathBuf>> {
        let mut paths = list(folder)?;
        paths.retain(|path| path.extension().is_some_and(|found| found == extension));
        Ok(paths)
    }
}
