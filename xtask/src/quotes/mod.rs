//! Do the documents quote what was measured? README.md and docs/*.md say where their figures come from:
//!
//! ```text
//! <!-- figures: embree/direct, tiles/128_4SPP_2D -->
//! ```
//!
//! is about all figures up to the next such line or the next heading. A source is a chapter of docs/report, one of its tables
//! (CHAPTER/TABLE), the figures that its text quotes (CHAPTER/quoted) or its settings (CHAPTER/settings); `tiles` or one of
//! core/tiles/*.toml; `test NAME`, a file of tests/tests that measures and prints them: that it exists is all that is checked; or
//! `none (why)`, of numbers that nothing here has measured: settings, constants, what others have published. A figure is a number with decimals or
//! before a unit of time or `%`, outside of code and formulas. It must be one of its sources', rounded to the decimals
//! that the document gives; a table's interval counts with its ends and with half of its width.

mod source;
mod text;

use crate::paths;
use source::Sources;
use std::fs;
use std::path::PathBuf;

/// Documents, and how many of their figures do not say yet where they come from, at most. Not to grow: a new figure needs a source.
/// Where one has got its source, lower the number.
const WITHOUT_SOURCE: &[(&str, usize)] = &[
    ("docs/choosing.md", 1265),
    ("docs/fsot_points.md", 178),
    ("docs/fsot_tiles.md", 159),
    ("docs/metrics.md", 110),
    ("docs/shared_fits.md", 7),
    ("docs/stippling.md", 38),
    ("docs/tiles.md", 35),
];

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
        wrong.extend(found.wrong.iter().map(|message| format!("{name}:{message}")));
        let allowed = WITHOUT_SOURCE.iter().find(|(file, _)| *file == name).map_or(0, |(_, count)| *count);
        if found.without_source.len() > allowed {
            let list = found.without_source.join(", ");
            wrong.push(format!(
                "{name}: {} figures without a source, where {allowed} are known: say where they come from, <!-- figures: ... -->\n    {list}",
                found.without_source.len()
            ));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn a_wrong_figure_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let json = r#"{"settings": {"spp": 64}, "quoted": {"worst": {"value": 1.234}}, "tables": [
        {"name": "direct", "rows": [["dining", {"text": "0.434 [0.40, 0.46]", "value": 0.4343, "interval": [0.40, 0.46]}]]}]}"#;
    fs::write(folder.path().join("embree.json"), json).expect("a file");
    fs::write(folder.path().join("A.toml"), "spp = 4\nfiltered = [0.04299, 0.002204]\n").expect("a file");
    let sources = Sources::new(folder.path(), folder.path());
    let wrong = |document: &str| text::check(document, &sources).wrong;
    let right = "# T\n\n<!-- figures: embree/direct -->\nThe error is .43 ± .03, or 43.\n";
    assert_eq!(wrong(right), Vec::<String>::new());
    assert_eq!(wrong(&right.replace(".43", ".44")).len(), 1, "a wrong figure");
    assert_eq!(wrong(&right.replace(".43", ".433")).len(), 1, "more decimals than are right");
    assert_eq!(wrong(&right.replace("direct", "indirect")).len(), 1, "a table that is not there");
    assert_eq!(wrong(&right.replace("embree/", "povray/")).len(), 1, "a chapter that is not there");
    assert_eq!(wrong("<!-- figures: embree/direct -->\n1.23\n").len(), 1, "a figure of another part");
    assert!(wrong("<!-- figures: embree/quoted -->\n1.23\n").is_empty());
    assert!(wrong("<!-- figures: embree -->\n1.23 and 0.43\n").is_empty());
    assert!(wrong("<!-- figures: tiles/A -->\n.043 / .0022\n").is_empty());
    assert_eq!(wrong("<!-- figures: tiles/A -->\n.044\n").len(), 1);
    assert!(wrong("<!-- figures: embree/settings -->\n64 ms\n").is_empty());
    assert_eq!(wrong("<!-- figures: embree/settings -->\n63 ms\n").len(), 1);
    assert!(wrong("<!-- figures: test cv_never_worse -->\n.044\n").is_empty());
    assert_eq!(wrong("<!-- figures: test cv_nonsense -->\n.044\n").len(), 1, "a test that is not there");
    assert_eq!(wrong("<!-- figures: none -->\n.044\n").len(), 1, "none must say why");
    assert!(wrong("<!-- figures: none (settings) -->\n.044\n").is_empty());
    // A heading ends what a line says.
    let found = text::check(&format!("{right}\n## Next\n\n.43\n"), &sources);
    assert_eq!((found.wrong.len(), found.without_source.len()), (0, 1));
}
