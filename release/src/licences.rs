//! THIRD_PARTY.md: the packages of others, their licences, and whether ours allows them.

use crate::packages::PUBLISHED;
use anyhow::{Context, Result, bail};
use spdx::{Expression, ParseMode};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use xtask::{paths, run};

/// What may be in what we ship: nothing that asks more than that its notice be kept.
const ALLOWED: [&str; 10] =
    ["0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0", "ISC", "MIT", "Unicode-3.0", "Unlicense", "Zlib"];
/// What may also be in programs that only build and test, which nobody is given.
const ALLOWED_IN_DEVELOPMENT: [&str; 2] = ["MPL-2.0", "NCSA"];
/// Those that ask for no notice beside the licences that we ship anyway.
const WITHOUT_NOTICE: [&str; 3] = ["0BSD", "Apache-2.0", "Unlicense"];
/// Workspaces of their own: the page to play with, which is given away, and the fuzz targets.
const PAGE: &str = "docs/playground/Cargo.toml";
const FUZZ: &str = "fuzz/Cargo.toml";

const INTRODUCTION: &str = "\
# Packages of others

Written by `cargo xtask licences`; do not edit. Licences are as their authors declare them, for all targets. At the end
are the notices of packages in the library that ask for one; others come with each package's source, compiler-builtins'
with Rust's. A test compares this file with each Cargo.lock, and every licence with those that release/src/licences.rs
allows.
";
const STANDARD_LIBRARY: &str = "
The C library and the page also hold what they use of Rust's `core` (MIT OR Apache-2.0) and compiler-builtins (MIT AND
Apache-2.0 WITH LLVM-exception AND (MIT OR Apache-2.0)), of the compiler that built them.
";

/// Name and version, and licence.
type Packages = BTreeMap<(String, String), String>;

/// Rewrites THIRD_PARTY.md.
pub(crate) fn write() -> Result<()> {
    fs::write(paths::root().join("THIRD_PARTY.md"), current()?).context("cannot write THIRD_PARTY.md")
}

/// Fails if the list is old or a licence is not allowed.
pub(crate) fn check() -> Result<()> {
    if paths::read("THIRD_PARTY.md")? != current()? {
        bail!("THIRD_PARTY.md is not what Cargo.lock says: run `cargo xtask licences` and commit the result");
    }
    Ok(())
}

fn current() -> Result<String> {
    let mut library = packages(&["--package", PUBLISHED[0], "--package", PUBLISHED[1], "--edges", "normal,build"])?;
    library.extend(packages(&["--manifest-path", PAGE, "--edges", "normal,build"])?);
    let optimiser = packages(&["--package", PUBLISHED[2], "--edges", "normal,build"])?;
    let mut all = packages(&["--workspace", "--edges", "normal,build,dev"])?;
    all.extend(packages(&["--manifest-path", FUZZ, "--all-features", "--edges", "normal,build,dev"])?);
    allowed(&library, &ALLOWED)?;
    allowed(&optimiser, &ALLOWED)?;
    allowed(&all, &[&ALLOWED[..], &ALLOWED_IN_DEVELOPMENT].concat())?;
    let mut text = INTRODUCTION.to_owned();
    let title = "In the library (`noisefloor`), the C library made of it and the page to play with";
    text += &section(title, &library, &Packages::new());
    text += STANDARD_LIBRARY;
    text += &section("In `fsot` besides, or needed to compile it", &optimiser, &library);
    let notices = notices(&library)?;
    let shipped = library.into_iter().chain(optimiser).collect();
    text += &section("For building, testing and measuring only; in nothing that is given away", &all, &shipped);
    Ok(text + &notices)
}

/// The licence files of the packages whose notice must be kept.
fn notices(packages: &Packages) -> Result<String> {
    let mut text = String::new();
    let metadata = run::metadata(&["--quiet", "--locked"])?;
    for ((name, version), licence) in packages {
        if allows(licence, &WITHOUT_NOTICE)? {
            continue;
        }
        let found = metadata.iter().find(|one| one["name"] == **name && one["version"] == **version);
        let manifest = found.and_then(|one| one["manifest_path"].as_str());
        let manifest = manifest.with_context(|| format!("cargo metadata has no {name} {version}"))?;
        let file = Path::new(manifest).with_file_name("LICENSE.txt");
        let notice = fs::read_to_string(&file).with_context(|| format!("{name}: cannot read {}", file.display()))?;
        text += &format!("\n## Notice of {name}\n\n```text\n{}\n```\n", notice.trim());
    }
    Ok(text)
}

/// The packages that cargo would use for these of ours, on any target.
fn packages(selection: &[&str]) -> Result<Packages> {
    let mut tree = run::cargo();
    tree.args(["tree", "--quiet", "--locked", "--target", "all", "--prefix", "none", "--format", "{p}|{l}"]);
    let text = run::read(tree.args(selection))?;
    let mut packages = Packages::new();
    // An empty line stands between the trees of two of ours.
    for line in text.lines().filter(|line| !line.is_empty()) {
        let (package, licence) = line.split_once('|').with_context(|| format!("`cargo tree` wrote `{line}`"))?;
        let mut words = package.split_whitespace();
        let (Some(name), Some(version), place) = (words.next(), words.next(), words.next()) else {
            bail!("`cargo tree` wrote `{line}`");
        };
        // Those with a folder are ours.
        if !place.is_some_and(|place| place.starts_with("(/")) {
            let version = version.trim_start_matches('v').to_owned();
            packages.insert((name.to_owned(), version), licence.trim_end_matches(" (*)").to_owned());
        }
    }
    if packages.is_empty() {
        bail!("`cargo tree {}` named no package", selection.join(" "));
    }
    Ok(packages)
}

/// Fails unless each may be used under allowed licences alone.
fn allowed(packages: &Packages, licences: &[&str]) -> Result<()> {
    let mut refused = Vec::new();
    for ((name, version), licence) in packages {
        if !allows(licence, licences).with_context(|| format!("{name} {version}: licence `{licence}`"))? {
            refused.push(format!("{name} {version}: {licence}"));
        }
    }
    if !refused.is_empty() {
        bail!("licences that are not allowed ({} are):\n  {}", licences.join(", "), refused.join("\n  "));
    }
    Ok(())
}

/// Whether the expression can be met with these licences. An exception only adds permissions.
fn allows(expression: &str, licences: &[&str]) -> Result<bool> {
    // Old packages write `MIT/Apache-2.0`.
    let expression = Expression::parse_mode(expression, ParseMode::LAX).map_err(|error| anyhow::anyhow!("{error}"))?;
    Ok(expression.evaluate(|wanted| wanted.license.id().is_some_and(|id| licences.contains(&id.name))))
}

/// A table of the packages that are not among the others.
fn section(title: &str, packages: &Packages, without: &Packages) -> String {
    let mut text = format!("\n## {title}\n\n| package | version | licence |\n|---|---|---|\n");
    for ((name, version), licence) in packages.iter().filter(|(package, _)| !without.contains_key(*package)) {
        text += &format!("| {name} | {version} | {licence} |\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_alternative_is_enough_and_every_part_is_needed() {
        for good in ["MIT", "MIT/Apache-2.0", "MIT OR GPL-3.0-only", "(MIT OR X11) AND Unicode-3.0"] {
            assert!(allows(good, &ALLOWED).unwrap(), "{good}");
        }
        for bad in ["GPL-3.0-only", "MIT AND GPL-3.0-only", "MPL-2.0"] {
            assert!(!allows(bad, &ALLOWED).unwrap(), "{bad}");
        }
        let package = |licence: &str| Packages::from([(("name".to_owned(), "1.2.3".to_owned()), licence.to_owned())]);
        assert!(allowed(&package("MIT"), &ALLOWED).is_ok());
        let refusal = allowed(&package("GPL-3.0-only"), &ALLOWED).unwrap_err().to_string();
        assert!(refusal.contains("name 1.2.3: GPL-3.0-only"), "{refusal}");
        assert!(allows("", &ALLOWED).is_err());
        assert!(allows("none of your business", &ALLOWED).is_err());
    }
}
