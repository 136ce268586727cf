//! How large the rooms of the house are: the product, its tools, and what is written about it.

use crate::outcome::Outcome;
use crate::{paths, run};
use anyhow::Result;
use std::fs;

/// Prints lines of Rust, words of the documents, and the report's size.
pub fn print() -> Result<Outcome> {
    let Some(files) = run::tracked() else {
        return Ok(Outcome::NotRun("git does not know which files there are".to_owned()));
    };
    let of = |prefix: &str, ending: &str| -> Vec<String> {
        let wanted = files.iter().filter(|file| file.starts_with(prefix) && file.ends_with(ending));
        wanted.filter_map(|file| fs::read_to_string(paths::root().join(file)).ok()).collect()
    };
    let lines = |texts: &[String]| texts.iter().map(|text| text.lines().count()).sum::<usize>();
    let words = |texts: &[String]| texts.iter().map(|text| text.split_whitespace().count()).sum::<usize>();
    for room in ["core/src/", "capi/src/", "fsot/", "tests/", "fuzz/", "bench/", "report/", "xtask/"] {
        let texts = of(room, ".rs");
        println!("   {room:<10} {:>6} lines of Rust in {} files", lines(&texts), texts.len());
    }
    let doctests = of("core/src/", ".rs").iter().map(|text| in_fences(text)).sum::<usize>();
    println!("   core/src/  {doctests:>6} lines of doctests");
    let readme = of("README.md", "");
    let numbers = readme.iter().flat_map(|text| text.split(|c: char| !c.is_ascii_digit() && c != '.'));
    let numbers = numbers.filter(|word| word.contains(|c: char| c.is_ascii_digit())).count();
    println!("   README.md  {:>6} words, {numbers} numbers, {} lines", words(&readme), lines(&readme));
    let report = of("docs/report/", ".md");
    println!("   docs/      {:>6} words of guides", words(&of("docs/", ".md")) - words(&report));
    let bytes = files.iter().filter(|file| file.starts_with("docs/report/"));
    let bytes =
        bytes.filter_map(|file| fs::metadata(paths::root().join(file)).ok()).map(|data| data.len()).sum::<u64>();
    println!("   docs/report {:>5.1} MB", bytes as f64 / 1e6);
    let tree =
        run::read(run::cargo().args(["tree", "--package", "xtask", "--prefix", "none", "--edges", "normal,build"]))?;
    let packages: std::collections::BTreeSet<&str> = tree.lines().map(|line| line.trim_end_matches(" (*)")).collect();
    println!("   xtask      {:>6} packages", packages.len());
    Ok(Outcome::Passed)
}

/// Lines between fences of comments.
fn in_fences(text: &str) -> usize {
    let mut inside = false;
    let comments = text.lines().map(str::trim_start).filter(|line| line.starts_with("///") || line.starts_with("//!"));
    let counted = comments.filter(|line| {
        let is_fence = line[3..].trim_start().starts_with("```");
        inside ^= is_fence;
        inside && !is_fence
    });
    counted.count()
}
