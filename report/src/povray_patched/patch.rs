//! The patch: what it must say of itself, and putting it on.

use super::{ours, refusals};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use xtask::outcome::Outcome;
use xtask::run;

fn path() -> PathBuf {
    ours().join("noisefloor.patch")
}

/// Puts the patch on, after taking off the one that was put on before.
pub(crate) fn apply(source: &Path) -> Result<()> {
    let applied = source.join("noisefloor.patch");
    let wanted = fs::read(path()).with_context(|| format!("cannot read {}", path().display()))?;
    if applied.exists() {
        if fs::read(&applied).with_context(|| format!("cannot read {}", applied.display()))? == wanted {
            return Ok(());
        }
        patch(source, &applied, &["--reverse"])?;
        fs::remove_file(&applied).with_context(|| format!("cannot remove {}", applied.display()))?;
    }
    patch(source, &path(), &["--forward"])?;
    fs::write(&applied, wanted).with_context(|| format!("cannot write {}", applied.display()))
}

fn patch(source: &Path, file: &Path, options: &[&str]) -> Result<()> {
    // Whether it fits is known before anything is changed.
    for dry in [&["--dry-run"][..], &[]] {
        let mut patch = run::command("patch");
        patch.current_dir(source).args(["--strip=1", "--fuzz=0", "--batch", "--silent"]).args(options).args(dry);
        run::check(patch.arg("--input").arg(file)).with_context(|| {
            format!("{} does not fit {}: remove that folder, and it is fetched anew", file.display(), source.display())
        })?;
    }
    Ok(())
}

/// Whether the patch is well formed, says its licence, and has a notice beside it that says the same; and whether our
/// side of it compiles, and refuses what it should. POV-Ray itself is not needed.
pub(crate) fn check(archive: &Path) -> Result<Outcome> {
    let text = fs::read_to_string(path()).with_context(|| format!("cannot read {}", path().display()))?;
    let files = well_formed(&text)?;
    if !text.contains("SPDX-License-Identifier: AGPL-3.0-or-later\n") {
        bail!("{} does not say that it is under POV-Ray's licence", path().display());
    }
    let notice = fs::read_to_string(ours().join("README.md")).context("cannot read the notice beside the patch")?;
    // However its lines are broken.
    let notice = notice.split_whitespace().collect::<Vec<_>>().join(" ");
    for claim in ["AGPL-3.0-or-later", "nothing built from it is distributed", "noisefloor.patch"] {
        if !notice.contains(claim) {
            bail!("README.md beside the patch does not say `{claim}`");
        }
    }
    refusals::check(archive)?;
    println!("   {} files of POV-Ray are changed", files.len());
    Ok(Outcome::Passed)
}

/// The files that a unified diff changes, if every hunk has as many lines as it says.
fn well_formed(text: &str) -> Result<Vec<&str>> {
    let mut files = Vec::new();
    let mut left = [0_usize; 2]; // of the hunk, in the old file and in the new one
    for (number, line) in (1..).zip(text.lines()) {
        if left == [0, 0] {
            if let Some(name) = line.strip_prefix("+++ b/") {
                files.push(name);
            } else if let Some(hunk) = line.strip_prefix("@@ ") {
                left = lengths(hunk).with_context(|| format!("line {number} is no head of a hunk: {line}"))?;
            }
            continue;
        }
        let takes = match line.chars().next() {
            Some(' ') | None => [1, 1],
            Some('-') => [1, 0],
            Some('+') => [0, 1],
            Some('\\') => [0, 0],
            Some(_) => bail!("line {number} is outside of what its hunk announced: {line}"),
        };
        for (left, taken) in left.iter_mut().zip(takes) {
            *left = left.checked_sub(taken).with_context(|| format!("the hunk at line {number} is too long"))?;
        }
    }
    if left != [0, 0] || files.is_empty() {
        bail!("the patch ends within a hunk, or has none");
    }
    Ok(files)
}

/// `-1,7 +1,8 @@ ...` -> [7, 8]
fn lengths(hunk: &str) -> Option<[usize; 2]> {
    let mut words = hunk.split(' ');
    let mut length = |sign: char| -> Option<usize> {
        let word = words.next()?.strip_prefix(sign)?;
        word.split_once(',').map_or(Some(1), |(_, length)| length.parse().ok())
    };
    Some([length('-')?, length('+')?])
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "text\n--- a/x\n+++ b/x\n@@ -1,2 +1,3 @@\n one\n+two\n three\n";

    #[test]
    fn hunks_are_as_long_as_they_say() {
        assert_eq!(well_formed(GOOD).expect("well formed"), ["x"]);
        assert!(well_formed(&GOOD.replace("+two\n", "")).is_err());
        assert!(well_formed(&GOOD.replace("+two\n", "+two\n+more\n+and more\n")).is_err());
        assert!(well_formed(&GOOD.replace("@@ -1,2", "@@ 1,2")).is_err());
        assert!(well_formed("text\n").is_err());
    }
}
