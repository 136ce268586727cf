//! Where things are.

use std::path::{Path, PathBuf};

/// The workspace root.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// Cargo's target folder, wherever the user put it.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |dir| root().join(dir))
}

/// Where the C library and what is linked with it go.
pub(crate) fn output() -> PathBuf {
    target().join("noisefloor")
}

/// The generated C header.
pub(crate) fn header() -> PathBuf {
    root().join("include/noisefloor.h")
}
