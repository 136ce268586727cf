//! How files are named.

use std::path::Path;

/// The ending of a file's name, in lower case; empty if it has none.
pub fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}
