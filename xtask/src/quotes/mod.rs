//! Do the documents quote what was measured? README.md and docs/*.md say where their figures come from:
//!
//! ```text
//! <!-- figures: embree/direct @ dining; embree/quoted; tiles/128_4SPP_2D -->
//! ```
//!
//! is about all figures up to the next such line or the next heading. docs/quoting.md says how to write it; these are the rules.
//!
//! - A figure is a number with decimals or with a unit (of time, `%`, `times`, `instructions`), outside of code, links and formulas.
//! - A source is a table of a chapter of docs/report (CHAPTER/TABLE), the figures that the chapter's text quotes (CHAPTER/quoted), its settings
//!   (CHAPTER/settings), or one of core/tiles/*.toml (tiles/NAME; `tiles` where the rows of a table
//!   name the tiles). `@` narrows it to the cells whose row and column have all these words: a word of any row's name must be in
//!   the cell's, any other in its column's. A chapter alone is none.
//! - The figure must be a cell's value, sign included, rounded to the figure's digits. In a table's row only the source's rows count that share the most words with
//!   it. Behind `±` stands how far both ends of the same cell's interval are from it, in brackets its ends.
//! - If more than a third of the figures beside it would pass as well, the figure is not accepted: the source must be narrowed.
//! - A source that no figure comes from is an error; so is `none (why)`, for numbers that nothing here has measured, without such a number.

mod compare;
mod nearest;
mod number;
mod source;
mod text;

use crate::paths;
use source::Sources;
use std::fs;
use std::path::PathBuf;

fn documents() -> Vec<PathBuf> {
    let mut all = vec![paths::root().join("README.md")];
    let entries = fs::read_dir(paths::root().join("docs")).expect("docs");
    all.extend(
        entries.map(|entry| entry.expect("an entry").path()).filter(|path| path.extension().is_some_and(|e| e == "md")),
    );
    all.sort();
    all
}

#[test]
fn every_figure_of_the_documents_was_measured() {
    let sources = Sources::new(&paths::root().join("docs/report"), &paths::root().join("core/tiles"));
    let mut wrong = Vec::new();
    for path in documents() {
        let name = path.strip_prefix(paths::root()).expect("below the root").display().to_string();
        let document = fs::read_to_string(&path).expect("a document");
        let found = text::check(&document, &sources);
        wrong.extend(found.wrong.iter().map(|(line, message)| format!("{name}:{line}: {message}")));
        wrong.extend(found.without_source.iter().map(|(line, figure)| {
            format!("{name}:{line}: {figure} has no source: write <!-- figures: ... --> before it")
        }));
    }
    assert!(wrong.is_empty(), "\n{}\n{} figures; docs/quoting.md says how to quote", wrong.join("\n"), wrong.len());
}

#[cfg(test)]
mod tests;
