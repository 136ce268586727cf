//! `cargo package`: what would be published is complete, and small enough for the registry.

use super::PUBLISHED;
use crate::outcome::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The registry's limit for a package, compressed.
const LIMIT: u64 = 10 << 20;
/// What cargo adds to our files, and what must be there whatever the folder holds.
const ADDED: [&str; 2] = ["Cargo.toml.orig", "Cargo.lock"];
const NEEDED: [&str; 3] = ["LICENSE-MIT", "LICENSE-APACHE", "Cargo.toml"];

/// Packs each published package without compiling it again; the tests have compiled the same files.
pub fn check() -> Result<Outcome> {
    let mut package = run::cargo();
    package.args(["package", "--quiet", "--no-verify", "--allow-dirty", "--locked"]);
    run::read(package.args(PUBLISHED.iter().flat_map(|name| ["--package", name])))?;
    let metadata = run::read(run::cargo().args(["metadata", "--no-deps", "--format-version", "1"]))?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata).context("cargo metadata wrote no JSON")?;
    let packages = metadata["packages"].as_array().map_or(&[][..], Vec::as_slice);
    for one in packages {
        let name = one["name"].as_str().context("a package without a name")?;
        let private = one["publish"].as_array().is_some_and(Vec::is_empty);
        if private == PUBLISHED.contains(&name) {
            bail!("{name}: `publish` in its Cargo.toml says otherwise than xtask/src/release/mod.rs");
        }
        if !private {
            check_one(name, one)?;
        }
    }
    Ok(Outcome::Passed)
}

fn check_one(name: &str, package: &serde_json::Value) -> Result<()> {
    let text = |key: &str| package[key].as_str().with_context(|| format!("{name}: no `{key}` in its Cargo.toml"));
    for key in ["description", "license", "rust_version"] {
        text(key)?;
    }
    let readme = Path::new(text("readme")?).file_name().context("a readme without a name")?.to_owned();
    let folder = Path::new(text("manifest_path")?).parent().context("a manifest without a folder")?;
    let list = run::read(run::cargo().args(["package", "--list", "--allow-dirty", "--locked", "--package", name]))?;
    let packed: BTreeSet<_> = list.lines().map(PathBuf::from).collect();
    let mut wanted = BTreeSet::from_iter(NEEDED.iter().map(PathBuf::from).chain([PathBuf::from(readme)]));
    files(folder, Path::new(""), &mut wanted)?;
    let missing: Vec<_> = wanted.difference(&packed).collect();
    if !missing.is_empty() {
        bail!("the package {name} would lack {missing:?}");
    }
    let strange: Vec<_> = packed.difference(&wanted).filter(|path| !is_added(path)).collect();
    if !strange.is_empty() {
        bail!("the package {name} would hold {strange:?}, which its folder has not");
    }
    let archive = paths::target().join(format!("package/{name}-{}.crate", text("version")?));
    let size = fs::metadata(&archive).with_context(|| format!("cannot read {}", archive.display()))?.len();
    println!("   {name}: {} files, {:.2} MB", packed.len(), size as f64 / 1e6);
    if size > LIMIT {
        bail!("{} has {size} bytes, more than the {LIMIT} that the registry takes", archive.display());
    }
    Ok(())
}

fn is_added(path: &Path) -> bool {
    ADDED.iter().any(|name| path == Path::new(name)) || path == Path::new(".cargo_vcs_info.json")
}

/// All files under a folder, as paths from it.
fn files(folder: &Path, below: &Path, found: &mut BTreeSet<PathBuf>) -> Result<()> {
    let here = folder.join(below);
    for entry in fs::read_dir(&here).with_context(|| format!("cannot read {}", here.display()))? {
        let path = below.join(entry.with_context(|| format!("cannot read {}", here.display()))?.file_name());
        if folder.join(&path).is_dir() {
            files(folder, &path, found)?;
        } else {
            found.insert(path);
        }
    }
    Ok(())
}
