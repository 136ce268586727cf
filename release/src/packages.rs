//! What would be published is complete, and versions are the same wherever they are said.

use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use xtask::tools::Missing;
use xtask::{paths, run};

/// The packages that are published, in the order in which they must be.
pub(crate) const PUBLISHED: [&str; 3] = ["noisefloor", "noisefloor-capi", "noisefloor-fsot"];
/// The registry's limit for a package, compressed.
const LIMIT: u64 = 10 << 20;
/// What cargo adds to our files, and what must be there whatever the folder holds.
const ADDED: [&str; 3] = ["Cargo.toml.orig", "Cargo.lock", ".cargo_vcs_info.json"];
const NEEDED: [&str; 3] = ["LICENSE-MIT", "LICENSE-APACHE", "Cargo.toml"];

/// Packs each published package without compiling it again; the tests have compiled the same files.
pub(crate) fn check() -> Result<()> {
    let mut package = run::cargo();
    package.args(["package", "--quiet", "--no-verify", "--allow-dirty", "--locked"]);
    run::read(package.args(PUBLISHED.iter().flat_map(|name| ["--package", name])))?;
    for one in &run::packages()? {
        let name = one["name"].as_str().context("a package without a name")?;
        let private = one["publish"].as_array().is_some_and(Vec::is_empty);
        if private == PUBLISHED.contains(&name) {
            bail!("{name}: `publish` in its Cargo.toml says otherwise than release/src/packages.rs");
        }
        if !private {
            check_one(name, one)?;
        }
    }
    Ok(())
}

fn check_one(name: &str, package: &Value) -> Result<()> {
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
    let strange: Vec<_> =
        packed.difference(&wanted).filter(|path| !ADDED.iter().any(|name| *path == Path::new(name))).collect();
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

/// Texts that name the oldest Rust that compiles the project.
const NAME_RUST: [&str; 2] = ["README.md", "docs/install.md"];

/// The declared Rust version is what the texts say and compiles what is published; CHANGELOG.md knows the project's
/// version, and whoever asks CMake or cargo for one asks for it.
pub(crate) fn versions() -> Result<()> {
    let packages = run::packages()?;
    let core = packages.iter().find(|package| package["name"] == "noisefloor").context("there is no `noisefloor`")?;
    let rust = core["rust_version"].as_str().context("`noisefloor` has no rust-version")?;
    for package in &packages {
        if package["rust_version"] != rust {
            bail!("{} has the rust-version {}, `noisefloor` {rust}", package["name"], package["rust_version"]);
        }
    }
    for name in NAME_RUST {
        let text = paths::read(name)?;
        let said: Vec<_> = text.split("Rust 1.").skip(1).map(minor).collect();
        if said.is_empty() || said.iter().any(|minor| format!("1.{minor}") != rust) {
            bail!("{name} says Rust 1.{}, Cargo.toml {rust}", said.join(" and 1."));
        }
    }
    let version = core["version"].as_str().context("`noisefloor` has no version")?;
    pins(&packages, version)?;
    if !paths::read("CHANGELOG.md")?.lines().any(|line| line.split(' ').take(2).eq(["##", version])) {
        bail!("CHANGELOG.md has no section `## {version}`, which is the version in Cargo.toml");
    }
    let short = version.rsplit_once('.').map_or(version, |(short, _)| short);
    let asked = run::read(run::command("git").args(["grep", "-oE", r"find_package\(noisefloor [0-9]+\.[0-9.]+"]));
    let asked = asked.map_err(|_| Missing("git does not say who asks CMake for which version".to_owned()))?;
    if let Some(other) = asked.lines().find(|asked| !asked.ends_with(&format!(" {short}"))) {
        bail!("{other}: it must be {short}, as the version in Cargo.toml is {version}");
    }
    compiles(rust)
}

/// Whatever is published has the version, and asks for what else is published in the same one, or, for tests alone, in
/// any.
fn pins(packages: &[Value], version: &str) -> Result<()> {
    let is_ours = |package: &Value| PUBLISHED.iter().any(|name| package["name"] == *name);
    for package in packages.iter().filter(|package| is_ours(package)) {
        let name = &package["name"];
        if package["version"] != version {
            bail!("{name} has the version {}, `noisefloor` {version}", package["version"]);
        }
        let others = paths::elements(&package["dependencies"]).iter().filter(|other| is_ours(other));
        for other in others.filter(|other| other["kind"] != "dev" || other["req"] != "*") {
            if other["req"] != format!("^{version}") {
                bail!("{name} asks for {} {}, and the version is {version}", other["name"], other["req"]);
            }
        }
    }
    Ok(())
}

/// Compiles what is published with the declared version, if that is at hand.
fn compiles(rust: &str) -> Result<()> {
    let version = run::read(run::command("rustc").arg("--version"))?;
    if version.split_whitespace().nth(1).is_some_and(|version| version.starts_with(&format!("{rust}."))) {
        println!("   this is Rust {rust}, so all tests are with the declared version");
        return Ok(());
    }
    if run::read(run::command("rustup").args(["run", rust, "cargo", "--version"])).is_err() {
        bail!(Missing(format!(
            "the texts agree, but Rust {rust} is not installed to compile with: `rustup toolchain install {rust}`"
        )));
    }
    let mut check = run::command("rustup");
    check.args(["run", rust, "cargo", "check", "--quiet", "--locked", "--target-dir"]);
    check.arg(paths::target().join("declared"));
    run::check(check.args(PUBLISHED.iter().flat_map(|name| ["--package", name])))
}

/// The digits at the beginning.
fn minor(text: &str) -> &str {
    text.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::pins;
    use serde_json::json;

    #[test]
    fn what_is_published_asks_for_its_own_version() {
        let with = |version: &str, req: &str, kind: Option<&str>| {
            let other = json!({"name": "noisefloor", "req": req, "kind": kind});
            let strange = json!({"name": "libm", "req": "^9", "kind": null});
            let capi = json!({"name": "noisefloor-capi", "version": version, "dependencies": [strange, other]});
            let bench = json!({"name": "noisefloor-bench", "version": "0.0.0", "dependencies": [other]});
            pins(&[capi, bench], "0.2.0").is_ok()
        };
        assert!(with("0.2.0", "^0.2.0", None) && with("0.2.0", "*", Some("dev")));
        assert!(!with("0.2.0", "^0.1.0", None) && !with("0.2.0", "*", None) && !with("0.2.0", "^0.1.0", Some("dev")));
        assert!(!with("0.1.0", "^0.2.0", None));
    }
}
