//! capi/abi.txt: every function, type, layout and constant of the C ABI, so that no change of them goes unseen.

mod header;
mod layout;

pub use header::Header;

use crate::outcome::Outcome;
use crate::paths;
use anyhow::{Context, Result, bail};
use clap::Args;
use std::fs;
use std::path::PathBuf;

#[derive(Args)]
pub struct Options {
    /// Allow what breaks programs without a new NF_ABI_VERSION: no release has had the present one yet
    #[arg(long)]
    unreleased: bool,
}

/// Rewrites capi/abi.txt, unless what it promised is gone and the version is as it was.
pub fn write(options: &Options) -> Result<()> {
    let (path, now) = (path(), current()?);
    let before = fs::read_to_string(&path).unwrap_or_default();
    let broken = gone(&before, &now);
    if !broken.is_empty() && version_line(&before) == version_line(&now) && !options.unreleased {
        bail!(
            "programs built with the present header would break, and NF_ABI_VERSION is as before. Changed or \
             removed:\n  {}\n\
             raise NF_ABI_VERSION in capi/src/status.rs and run `cargo xtask header`; or, if no release has had it, \
             add --unreleased",
            broken.join("\n  ")
        );
    }
    fs::write(&path, now).with_context(|| format!("cannot write {}", path.display()))
}

/// Fails if the committed list is not what the header and the compiler say.
pub fn check() -> Result<Outcome> {
    if !cfg!(target_pointer_width = "64") {
        return Ok(Outcome::NotRun("capi/abi.txt is of targets with pointers of 64 bits".to_owned()));
    }
    let path = path();
    let committed = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let now = current()?;
    if committed == now {
        return Ok(Outcome::Passed);
    }
    let (broken, new) = (gone(&committed, &now), gone(&now, &committed));
    bail!(
        "the C ABI is not that of capi/abi.txt.\nchanged or removed, which breaks programs:\n  {}\nnew:\n  {}\n\
         if this is meant: `cargo xtask abi`, and docs/releases.md says when NF_ABI_VERSION must be raised",
        broken.join("\n  "),
        new.join("\n  ")
    )
}

fn path() -> PathBuf {
    paths::root().join("capi/abi.txt")
}

fn current() -> Result<String> {
    let header = Header::committed()?;
    header.check_asserts()?;
    let mut text = String::from(
        "# The C ABI where pointers have 64 bits: what `cargo xtask abi` read from the header and the compiler. \
         Do not edit.\n",
    );
    text += &format!("version {}\n", header.version()?);
    for line in header.lines().iter().chain(&layout::measure(&header)?) {
        text += line;
        text.push('\n');
    }
    Ok(text)
}

/// The lines of one that the other has not. The version is no promise.
fn gone<'a>(these: &'a str, those: &str) -> Vec<&'a str> {
    let kept: std::collections::HashSet<_> = those.lines().collect();
    these.lines().filter(|line| !kept.contains(line) && !line.starts_with("version ")).collect()
}

fn version_line(text: &str) -> Option<&str> {
    text.lines().find(|line| line.starts_with("version "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_removed_or_changed_line_is_gone_and_a_new_one_is_not() {
        let before = "version 1\nfunction void nf_a(void)\nstruct nf_s: size 8, alignment 4\n";
        let now = "version 2\nstruct nf_s: size 12, alignment 4\nfunction void nf_a(void)\nconstant NF_B 1\n";
        assert_eq!(gone(before, now), ["struct nf_s: size 8, alignment 4"]);
        assert_eq!(gone(now, before), ["struct nf_s: size 12, alignment 4", "constant NF_B 1"]);
    }
}
