//! Links between documents: each must lead to a file that exists, and to a heading in it.

use crate::outcome::Outcome;
use crate::paths;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};

/// Checks README.md, CONTRIBUTING.md, and all of docs/ and examples_c/.
pub fn check() -> Result<Outcome> {
    let root = paths::root();
    let mut documents = vec![root.join("README.md"), root.join("CONTRIBUTING.md")];
    for folder in ["docs", "docs/report", "examples_c"] {
        documents.extend(paths::documents(folder)?);
    }
    let (mut links, mut broken) = (0, Vec::new());
    for document in &documents {
        for link in links_of(&read(document)?).filter(|link| !link.contains("://")) {
            links += 1;
            if !leads_somewhere(document, link)? {
                broken.push(format!("{}: {link}", document.strip_prefix(root).unwrap_or(document).display()));
            }
        }
    }
    if !broken.is_empty() {
        bail!("links to no file or no heading:\n   {}", broken.join("\n   "));
    }
    println!("   {links} links in {} documents", documents.len());
    Ok(Outcome::Passed)
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

/// What stands between `](` and `)`.
fn links_of(text: &str) -> impl Iterator<Item = &str> {
    let after = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    after.map(|(link, _)| link).filter(|link| !link.is_empty() && !link.contains(char::is_whitespace))
}

fn leads_somewhere(document: &Path, link: &str) -> Result<bool> {
    let (file, heading) = link.split_once('#').map_or((link, None), |(file, heading)| (file, Some(heading)));
    let folder = document.parent().unwrap_or(Path::new("."));
    let target: PathBuf = if file.is_empty() { document.to_path_buf() } else { folder.join(file) };
    let is_text = target.extension().is_some_and(|extension| extension == "md");
    Ok(match heading {
        _ if !target.exists() => false,
        Some(heading) if is_text => read(&target)?.lines().filter_map(anchor).any(|anchor| anchor == heading),
        _ => true,
    })
}

/// The name that a heading's line has in links: lower case, spaces as dashes, punctuation left out.
fn anchor(line: &str) -> Option<String> {
    let heading = line.starts_with('#').then(|| line.trim_start_matches('#').trim().to_lowercase())?;
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    Some(kept.map(|c| if c == ' ' { '-' } else { c }).collect())
}

#[cfg(test)]
mod tests {
    use super::{anchor, links_of};

    #[test]
    fn headings_become_anchors() {
        assert_eq!(anchor("## The `.nft` format, version 1").as_deref(), Some("the-nft-format-version-1"));
        assert_eq!(anchor("### `NF_CV_ROBUST`, the default").as_deref(), Some("nf_cv_robust-the-default"));
        assert_eq!(anchor("no heading"), None);
    }

    #[test]
    fn links_are_found() {
        let text = "a [b](c.md#d), `x](y z)` and ![e](f.png)";
        assert_eq!(links_of(text).collect::<Vec<_>>(), ["c.md#d", "f.png"]);
    }
}
