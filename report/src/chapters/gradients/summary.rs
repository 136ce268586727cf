//! The trainers' summaries: tables in Markdown.

use crate::chapters::chapter::{Cell, Chapter};
use anyhow::{Context, Result};

/// One table's headings and rows.
pub(super) struct Summary {
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
}

impl Summary {
    /// The first table of a text.
    pub(super) fn parse(text: &str) -> Result<Self> {
        let mut lines = text.lines().skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
        let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
        let columns: Vec<String> = cells(lines.next().context("the trainer wrote no table")?);
        let rows = lines.skip(1).map(cells).collect();
        Ok(Self { columns, rows })
    }

    /// The first number of the cell in the row whose first cells are `keys`; and half of its interval, if it has one.
    pub(super) fn number(&self, keys: &[&str], column: &str) -> Option<(f64, f64)> {
        let at = self.columns.iter().position(|name| name == column)?;
        let row = self.rows.iter().find(|row| keys.iter().zip(row.iter()).all(|(key, cell)| key == cell))?;
        let mut words = row.get(at)?.split(" +- ");
        let mut next = || words.next()?.trim().parse().ok();
        Some((next()?, next().unwrap_or(0.0)))
    }

    pub(super) fn write(&self, chapter: &mut Chapter, name: &'static str, words: usize) {
        let rows = self.rows.iter().map(|row| row.iter().map(|cell| Cell::from(cell.as_str())).collect());
        chapter.table(name, &self.columns, words, rows.collect());
    }
}
