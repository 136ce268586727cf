//! Links the C library that `cargo xtask library` has built, if it has.

use std::path::{Path, PathBuf};
use std::time::SystemTime;
use std::{env, fs};

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package lies in the workspace");
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    let folder = target.join("noisefloor");
    let archive = folder.join("libnoisefloor.a");
    let sources = ["core/src", "core/tiles", "capi/src"].map(|folder| root.join(folder));
    println!("cargo:rustc-check-cfg=cfg(archive)");
    println!("cargo:rerun-if-env-changed=CARGO_TARGET_DIR");
    for path in sources.iter().chain([&archive]) {
        println!("cargo:rerun-if-changed={}", path.display());
    }
    let state = match modified(&archive) {
        None => "missing",
        Some(built) if sources.iter().any(|folder| newest(folder) > Some(built)) => "older than the sources",
        Some(_) => "up to date",
    };
    println!("cargo:rustc-env=ARCHIVE_STATE={state}");
    if state != "missing" {
        println!("cargo:rustc-cfg=archive");
        println!("cargo:rustc-link-search=native={}", folder.display());
        println!("cargo:rustc-link-lib=static=noisefloor");
    }
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).and_then(|data| data.modified()).ok()
}

/// The time of the newest file below a folder, but for what says how a tile was made.
fn newest(folder: &Path) -> Option<SystemTime> {
    let entries = fs::read_dir(folder).ok()?;
    let is_compiled = |path: &PathBuf| !path.extension().is_some_and(|kind| kind == "toml" || kind == "md");
    let time = |path: PathBuf| if path.is_dir() { newest(&path) } else { modified(&path) };
    entries.filter_map(|entry| time(Some(entry.ok()?.path()).filter(is_compiled)?)).max()
}
