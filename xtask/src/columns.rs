//! The lines of code and text: no longer than a screen is wide.

use crate::outcome::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;

const WIDTH: usize = 120;
const KINDS: [&str; 6] = ["rs", "c", "h", "hpp", "cpp", "md"];
const APART: [&str; 3] = ["docs/report/", "THIRD_PARTY.md", "report/"];

/// Checks every file that git knows.
pub fn check() -> Result<Outcome> {
    let Some(files) = run::tracked() else {
        return Ok(Outcome::NotRun("git does not know which files there are".to_owned()));
    };
    let of_a_kind = |name: &&String| name.rsplit_once('.').is_some_and(|(_, kind)| KINDS.contains(&kind));
    let mut long = Vec::new();
    for name in files.iter().filter(of_a_kind).filter(|name| !APART.iter().any(|apart| name.starts_with(apart))) {
        let path = paths::root().join(name);
        let text = fs::read_to_string(&path).with_context(|| format!("cannot read {name}"))?;
        let is_document = name.ends_with(".md");
        let is_long = |line: &str| if is_document { columns_of_text(line) } else { line.chars().count() } > WIDTH;
        long.extend(text.lines().zip(1..).filter(|(line, _)| is_long(line)).map(|(_, at)| format!("{name}:{at}")));
    }
    if !long.is_empty() {
        bail!("lines of more than {WIDTH} columns:\n   {}", long.join("\n   "));
    }
    Ok(Outcome::Passed)
}

/// The columns of a line of Markdown: 0 where it cannot be broken, and without the targets of links.
fn columns_of_text(line: &str) -> usize {
    let is_whole = ["|", "<", "!["].iter().any(|start| line.trim_start().starts_with(start));
    let mut parts = line.split("](");
    let first = parts.next().unwrap_or_default().chars().count();
    let rest = parts.map(|part| 1 + part.split_once(')').map_or(part, |(_, text)| text).chars().count());
    if is_whole { 0 } else { first + rest.sum::<usize>() }
}

#[cfg(test)]
mod tests {
    use super::columns_of_text;

    #[test]
    fn tables_and_the_targets_of_links_have_no_width() {
        assert_eq!(columns_of_text("| a | b |") + columns_of_text("  <!-- a: b -->"), 0);
        assert_eq!(columns_of_text("see [the guide](docs/guide.md), and [x](y)."), "see [the guide], and [x].".len());
        assert_eq!(columns_of_text("τ = 2 π"), 7);
    }
}
