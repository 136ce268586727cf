//! What holds for all texts: lines no longer than a screen is wide, links that lead somewhere, code that is a
//! program's; and how much there is.

use crate::tools::{self, Missing};
use crate::{c_tests, library, paths, run};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

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

/// Checks the links of all documents: each must lead to what git knows, and to a heading in it. Templates are checked
/// as docs/report/ has them, filled in.
pub fn links() -> Result<()> {
    let files = tracked()?;
    let known: BTreeSet<&Path> = files.iter().flat_map(|name| Path::new(name).ancestors()).collect();
    let is_document = |name: &&String| name.ends_with(".md") && !name.starts_with("report/templates/");
    let (mut links, mut documents, mut broken) = (0, 0, Vec::new());
    for document in files.iter().filter(is_document) {
        documents += 1;
        for link in links_of(&without_blocks(&paths::read(document)?)).filter(|link| !link.contains("://")) {
            links += 1;
            if !leads_somewhere(Path::new(document), link, &known)? {
                broken.push(format!("{document}: {link}"));
            }
        }
    }
    ensure!(broken.is_empty(), "links to no file that git knows, or to no heading:\n   {}", broken.join("\n   "));
    println!("   {links} links in {documents} documents");
    Ok(())
}

/// A text without its blocks of code.
fn without_blocks(text: &str) -> String {
    let mut is_code = false;
    let mut is_text = |line: &&str| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    };
    text.lines().filter(|line| is_text(line)).map(|line| line.to_owned() + "\n").collect()
}

/// What stands between `](` and `)`, and in attributes of HTML.
fn links_of(text: &str) -> impl Iterator<Item = &str> {
    let between =
        |before, after| text.split(before).skip(1).filter_map(move |rest: &str| Some(rest.split_once(after)?.0));
    let all = between("](", ")").chain(between("href=\"", "\"")).chain(between("src=\"", "\""));
    all.filter(|link| !link.is_empty() && !link.contains(char::is_whitespace))
}

/// Paths are from the workspace root, whose own is empty.
fn leads_somewhere(document: &Path, link: &str, known: &BTreeSet<&Path>) -> Result<bool> {
    let (file, heading) = link.split_once('#').map_or((link, None), |(file, heading)| (file, Some(heading)));
    let target = if file.is_empty() { Some(document.to_path_buf()) } else { joined(document, file) };
    let Some(target) = target.filter(|target| known.contains(target.as_path())) else { return Ok(false) };
    let is_text = target.extension().is_some_and(|extension| extension == "md");
    let Some(heading) = heading.filter(|_| is_text) else { return Ok(true) };
    Ok(without_blocks(&paths::read(&target)?).lines().filter_map(anchor).any(|anchor| anchor == heading))
}

/// A path from a document's folder; none of what is not below the root.
fn joined(document: &Path, link: &str) -> Option<PathBuf> {
    let mut path = document.parent()?.to_path_buf();
    for part in Path::new(link).components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if path.pop() => {}
            Component::Normal(name) => path.push(name),
            _ => return None,
        }
    }
    Some(path)
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
    use super::{anchor, columns_of_text, leads_somewhere, links_of, without_blocks};
    use std::collections::BTreeSet;
    use std::path::Path;

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
        let text = "a [b](c.md#d), `x](y z)` and ![e](f.png)\n<a href=\"g.md\"><img src=\"h.svg\" width=\"9\"></a>";
        assert_eq!(links_of(text).collect::<Vec<_>>(), ["c.md#d", "f.png", "g.md", "h.svg"]);
    }

    #[test]
    fn links_lead_to_what_git_knows_and_to_headings_outside_of_code() {
        let files = ["README.md", "docs/a.md", "docs/b.png"];
        let known: BTreeSet<&Path> = files.iter().flat_map(|name| Path::new(name).ancestors()).collect();
        let leads = |link| leads_somewhere(Path::new("docs/a.md"), link, &known).expect("README.md is readable");
        for good in ["b.png", "./b.png", "../README.md", "../docs/", "..", "../README.md#limits", "b.png#part"] {
            assert!(leads(good), "{good}");
        }
        // Cargo.toml is there, but not among the files.
        for bad in ["c.md", "../a.md", "../../README.md", "/etc/passwd", "../Cargo.toml", "../README.md#no-heading"] {
            assert!(!leads(bad), "{bad}");
        }
        let text = without_blocks("# One\n```sh\n# no heading\n```\n  ```\n[a](b)\n  ```\n## Two\n");
        assert_eq!(text, "# One\n## Two\n");
    }
}
