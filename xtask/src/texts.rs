//! What holds for all texts: lines no longer than a screen is wide, links that lead somewhere, code that is a
//! program's; and how much there is.

use crate::tools::{self, Missing};
use crate::{c_tests, library, paths, run};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};

/// Columns of a line.
pub const WIDTH: usize = 120;
const KINDS: [&str; 10] = [".rs", ".c", ".h", ".hpp", ".cpp", ".md", ".py", ".sh", ".cmake", "CMakeLists.txt"];
const APART: [&str; 3] = ["docs/report/", "THIRD_PARTY.md", "report/templates/"];

/// Checks the lines of every file that git knows.
pub fn columns() -> Result<()> {
    let mut long = Vec::new();
    for name in tracked()? {
        if !KINDS.iter().any(|kind| name.ends_with(kind)) || APART.iter().any(|apart| name.starts_with(apart)) {
            continue;
        }
        for (at, line) in (1..).zip(paths::read(&name)?.lines()) {
            let columns = if name.ends_with(".md") { columns_of_text(line) } else { line.chars().count() };
            if columns > WIDTH {
                long.push(format!("{name}:{at}"));
            }
        }
    }
    ensure!(long.is_empty(), "lines of more than {WIDTH} columns:\n   {}", long.join("\n   "));
    Ok(())
}

/// The files that git knows, from the workspace root.
fn tracked() -> Result<Vec<String>> {
    let listed = run::read(run::command("git").args(["ls-files", "-z"]));
    let listed = listed.map_err(|_| Missing("git does not know which files there are".to_owned()))?;
    Ok(listed.split_terminator('\0').map(str::to_owned).collect())
}

/// The columns of a line of Markdown: 0 where it cannot be broken, and without the targets of links.
fn columns_of_text(line: &str) -> usize {
    let is_whole = ["|", "!["].iter().any(|start| line.trim_start().starts_with(start));
    let mut parts = line.split("](");
    let first = parts.next().unwrap_or_default().chars().count();
    let rest = parts.map(|part| 1 + part.split_once(')').map_or(part, |(_, text)| text).chars().count());
    if is_whole { 0 } else { first + rest.sum::<usize>() }
}

/// Checks the links of all documents: each must lead to a file that exists, and to a heading in it. Templates are
/// checked as docs/report/ has them, filled in.
pub fn links() -> Result<()> {
    let root = paths::root();
    let files = tracked()?;
    let is_document = |name: &&String| name.ends_with(".md") && !name.starts_with("report/templates/");
    let documents: Vec<_> = files.iter().filter(is_document).map(|name| root.join(name)).collect();
    let (mut links, mut broken) = (0, Vec::new());
    for document in &documents {
        for link in links_of(&paths::read(document)?).filter(|link| !link.contains("://")) {
            links += 1;
            if !leads_somewhere(document, link)? {
                broken.push(format!("{}: {link}", document.strip_prefix(root).unwrap_or(document).display()));
            }
        }
    }
    ensure!(broken.is_empty(), "links to no file or no heading:\n   {}", broken.join("\n   "));
    println!("   {links} links in {} documents", documents.len());
    Ok(())
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
        Some(heading) if is_text => paths::read(&target)?.lines().filter_map(anchor).any(|anchor| anchor == heading),
        _ => true,
    })
}

/// The name that a heading's line has in links: lower case, spaces as dashes, punctuation left out.
fn anchor(line: &str) -> Option<String> {
    let heading = line.starts_with('#').then(|| line.trim_start_matches('#').trim().to_lowercase())?;
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    Some(kept.map(|c| if c == ' ' { '-' } else { c }).collect())
}

/// README.md's first block of code is a part of image.cpp, letter by letter, and the two commands that do all the
/// set-up follow.
pub fn readme() -> Result<()> {
    let (text, program) = (paths::read("README.md")?, paths::read("examples_c/image.cpp")?);
    let part = program.split_once("    // README begin\n").and_then(|(_, rest)| rest.split_once("    // README end\n"));
    let (part, _) = part.context("examples_c/image.cpp has no part between `README begin` and `README end`")?;
    let part: String = part.lines().map(|line| format!("{}\n", line.strip_prefix("    ").unwrap_or(line))).collect();
    let block = text.split_once("```cpp\n").and_then(|(before, rest)| (!before.contains("```")).then_some(rest));
    let block = block.and_then(|rest| rest.split_once("```")).context("README.md does not open with a block of C++")?;
    ensure!(block.0 == part, "README.md's first block of code is not the part of examples_c/image.cpp that it shows");
    for command in ["\ncargo xtask demo ", "\ncargo xtask test "] {
        ensure!(block.1.contains(command), "README.md does not say `{}`", command.trim());
    }
    Ok(())
}

/// Prints how large everything is.
pub fn sizes() -> Result<()> {
    tools::packages(&[c_tests::PYTHON])?;
    run::check(run::command("python3").args(["-B", "xtask/sizes.py"]).arg(library::build()?))
}

#[cfg(test)]
mod tests {
    use super::{anchor, columns_of_text, links_of};

    #[test]
    fn tables_and_the_targets_of_links_have_no_width() {
        assert_eq!(columns_of_text("| a | b |") + columns_of_text("  ![a](b)"), 0);
        assert_eq!(columns_of_text("see [the guide](docs/guide.md), and [x](y)."), "see [the guide], and [x].".len());
        assert_eq!(columns_of_text("τ = 2 π") + columns_of_text("<td>"), 11);
    }

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
