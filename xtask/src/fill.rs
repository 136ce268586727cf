//! `cargo xtask fill`: writes the report's figures into the documents.
//!
//! A comment right behind a number names the cell that it is from, and the number is replaced by what the cell holds,
//! with as many decimals as it has:
//!
//! ```text
//! takes 600<!-- instructions/counts: nf_cv_estimate robust 64 | instructions --> instructions
//! ```
//!
//! - `CHAPTER/TABLE: ROW | COLUMN` is a cell of docs/report/CHAPTER.json. ROW is some of the row's cells, with commas
//!   between them, that no other row has; COLUMN is a column's name, or its place from 1 on. In a Markdown table it is
//!   `\|`, as cells end at `|` even there.
//! - `CHAPTER/quoted: NAME` and `CHAPTER/settings: NAME` are the figures that a chapter's text quotes, and its
//!   settings.
//! - `tiles/NAME: KEY` is a line of core/tiles/NAME.toml.
//! - Behind it may stand ` low` or ` high`, an end of the cell's interval; `[2]`, the second of several numbers; and
//!   ` * 100`, another unit.

use crate::paths::{self, elements};
use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

/// Fills all documents.
pub fn run() -> Result<()> {
    for (path, old, new) in documents()? {
        if old != new {
            fs::write(&path, new).with_context(|| path.display().to_string())?;
            println!("{}", path.display());
        }
    }
    Ok(())
}

/// Every document with its text as it is and as it should be.
fn documents() -> Result<Vec<(PathBuf, String, String)>> {
    let mut all = vec![paths::root().join("README.md"), paths::root().join("examples_c/README.md")];
    all.extend(paths::of_kind("docs", "md")?);
    let filled = all.into_iter().map(|path| {
        let old = paths::read(&path)?;
        let new = fill(&old, &measured).with_context(|| path.display().to_string())?;
        Ok((path, old, new))
    });
    filled.collect()
}

/// Replaces the numbers before markers by what `cell` says.
fn fill(document: &str, cell: &dyn Fn(&str) -> Result<f64>) -> Result<String> {
    let (mut out, mut rest) = (String::new(), document);
    while let Some((before, behind)) = rest.split_once("<!-- ") {
        let (name, after) = behind.split_once(" -->").context("a comment without end")?;
        out.push_str(before);
        let is_marker = name.split_once(": ").is_some_and(|(source, _)| source.contains('/') && !source.contains("//"));
        if is_marker {
            let is_row = out.rsplit('\n').next().is_some_and(|line| line.starts_with('|'));
            ensure!(!is_row || !name.contains(" | "), "<!-- {name} --> ends a cell of its table: write \\| for |");
            let number = out.trim_end_matches('`').trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len();
            let old = out.split_off(number);
            let digits = old.trim_end_matches('`');
            ensure!(!digits.is_empty(), "no number stands before <!-- {name} -->");
            let value = cell(&name.replace("\\|", "|")).with_context(|| format!("<!-- {name} -->"))?;
            let is_signed = out.ends_with(['-', '−', '+']);
            ensure!(is_signed || value >= 0.0, "<!-- {name} -->: {value} has a sign that {digits} has not");
            if is_signed && out.ends_with('+') == (value < 0.0) {
                out.pop();
                out.push(if value < 0.0 { '−' } else { '+' });
            }
            out.push_str(&written(value.abs(), digits));
            out.push_str(&old[digits.len()..]);
        }
        out += &format!("<!-- {name} -->");
        rest = after;
    }
    out.push_str(rest);
    Ok(out)
}

/// A value as `like` is written: with as many decimals, and with or without a zero before the point.
fn written(value: f64, like: &str) -> String {
    let decimals = like.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let text = format!("{value:.decimals$}");
    match text.strip_prefix("0.") {
        Some(decimals) if like.starts_with('.') => format!(".{decimals}"),
        _ => text,
    }
}

/// What a marker names.
fn measured(marker: &str) -> Result<f64> {
    let (marker, factor) = match marker.split_once(" * ") {
        Some((marker, factor)) => (marker, factor.parse()?),
        None => (marker, 1.0),
    };
    let (marker, place) = match marker.strip_suffix(']').and_then(|marker| marker.rsplit_once('[')) {
        Some((marker, place)) => (marker, place.parse()?),
        None => (marker, 1),
    };
    let ends = [(" low", Some(0)), (" high", Some(1))];
    let end = ends.into_iter().find_map(|(word, end)| Some((marker.strip_suffix(word)?, end)));
    let (marker, end) = end.unwrap_or((marker, None));
    let (source, cell) = marker.split_once(": ").context("not SOURCE: CELL")?;
    let (chapter, table) = source.split_once('/').context("not CHAPTER/TABLE")?;
    let value = if chapter == "tiles" {
        let text = paths::read(format!("core/tiles/{table}.toml"))?;
        let line = text.lines().find_map(|line| line.strip_prefix(cell)?.strip_prefix(" = "));
        Value::String(line.context("no such key")?.to_owned())
    } else {
        let json = paths::json(format!("docs/report/{chapter}.json"))?;
        match table {
            "quoted" | "settings" => json[table][cell].clone(),
            _ => in_table(&json, table, cell)?,
        }
    };
    Ok(factor * number(&value, end, place).with_context(|| format!("no such number in {value}"))?)
}

/// The cell of a table.
fn in_table(json: &Value, table: &str, cell: &str) -> Result<Value> {
    let (row, column) = cell.split_once(" | ").context("not ROW | COLUMN")?;
    // A cell's text may itself hold commas.
    let is_named = |cells: &[Value]| {
        let names: Vec<String> = cells.iter().map(text).collect();
        let whole = format!("{}, ", names.join(", "));
        row.split(", ").all(|part| names.iter().any(|name| name == part)) || whole.starts_with(&format!("{row}, "))
    };
    let tables = elements(&json["tables"]).iter().filter(|known| known["name"] == table);
    let rows = tables
        .flat_map(|table| elements(&table["rows"]).iter().map(|row| (elements(&table["columns"]), elements(row))));
    let found: Vec<_> = rows.filter(|(_, cells)| is_named(cells)).collect();
    let [(columns, cells)] = found[..] else { bail!("{} rows of {table} are `{row}`", found.len()) };
    let index = columns.iter().position(|name| name == column);
    let index = index.or_else(|| column.parse::<usize>().ok()?.checked_sub(1));
    let cell = index.and_then(|index| cells.get(index));
    cell.cloned().with_context(|| format!("no column `{column}` among {columns:?}"))
}

fn text(cell: &Value) -> String {
    cell["text"].as_str().or(cell.as_str()).unwrap_or_default().to_owned()
}

/// A cell's value, an end of its interval, or the number in this place, from 1 on, of its text.
fn number(cell: &Value, end: Option<usize>, place: usize) -> Option<f64> {
    if let Some(end) = end {
        return cell["interval"].get(end)?.as_f64();
    }
    if let Some(value) = cell.as_f64().or(cell["value"].as_f64()) {
        return Some(value);
    }
    let text = cell.as_str()?;
    let mut numbers =
        text.split(|c: char| !c.is_ascii_digit() && !"+-.e".contains(c)).filter_map(|word| word.parse().ok());
    numbers.nth(place.checked_sub(1)?)
}

#[cfg(test)]
mod tests {
    use super::{documents, fill, in_table, number};
    use serde_json::json;

    #[test]
    fn documents_hold_the_figures_of_the_report() {
        for (path, old, new) in documents().unwrap() {
            assert!(old == new, "{} is not current: `cargo xtask fill` writes it", path.display());
        }
    }

    #[test]
    fn numbers_keep_their_form() {
        let filled = |text: &str, value: f64| fill(text, &|_| Ok(value));
        assert_eq!(filled("is .50<!-- a/b: c --> of", 0.123).unwrap(), "is .12<!-- a/b: c --> of");
        assert_eq!(filled("`1050`<!-- a/b: c -->", 1049.6).unwrap(), "`1050`<!-- a/b: c -->");
        assert_eq!(filled("-0.5<!-- a/b: c -->", -0.66).unwrap(), "-0.7<!-- a/b: c -->");
        assert_eq!(filled("−0.5<!-- a/b: c -->", 0.66).unwrap(), "+0.7<!-- a/b: c -->");
        assert_eq!(filled("+.5<!-- a/b: c -->", -0.66).unwrap(), "−.7<!-- a/b: c -->");
        assert_eq!(filled("<!-- a comment --> 3", 1.0).unwrap(), "<!-- a comment --> 3");
        assert!(filled("some<!-- a/b: c -->", 1.0).is_err());
        assert!(filled("1.0<!-- a/b: c -->", -1.0).is_err());
    }

    #[test]
    fn cells_are_found() {
        let cell = json!({"text": "2.0", "value": 2.0, "interval": [1.0, 3.0]});
        let table =
            json!({"name": "t", "columns": ["scene", "n", "ratio"], "rows": [["a", "16", cell], ["a", "64", "7; 8"]]});
        let json = json!({"tables": [table]});
        assert_eq!(number(&in_table(&json, "t", "a, 16 | ratio").unwrap(), None, 1), Some(2.0));
        assert_eq!(number(&in_table(&json, "t", "16 | 3").unwrap(), Some(1), 1), Some(3.0));
        assert_eq!(number(&in_table(&json, "t", "64 | ratio").unwrap(), None, 2), Some(8.0));
        assert!(in_table(&json, "t", "a | ratio").is_err() && in_table(&json, "t", "a, 6 | ratio").is_err());
        assert!(in_table(&json, "t", "16 | none").is_err());
    }
}
