//! A chapter of the report, as data: tables, figures that its text quotes, settings. Its text is a template.

use super::figure::Figure;
use super::template;
use anyhow::Result;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A cell of a table.
#[derive(Clone, Serialize)]
#[serde(untagged)]
pub(crate) enum Cell {
    Word(String),
    Figure(Figure),
    /// Not measured.
    Missing,
}

impl From<&str> for Cell {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

impl From<String> for Cell {
    fn from(word: String) -> Self {
        Self::Word(word)
    }
}

impl From<u32> for Cell {
    fn from(number: u32) -> Self {
        Self::Word(number.to_string())
    }
}

impl From<Figure> for Cell {
    fn from(figure: Figure) -> Self {
        Self::Figure(figure)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::Missing, Into::into)
    }
}

#[derive(Serialize)]
struct Table {
    name: &'static str,
    section: String,
    columns: Vec<String>,
    /// What stands in so many columns is aligned left.
    words: usize,
    rows: Vec<Vec<Cell>>,
}

/// A row of cells of any kinds.
macro_rules! row {
    ($($cell:expr),+ $(,)?) => { vec![$($crate::chapters::chapter::Cell::from($cell)),+] };
}
pub(crate) use row;

/// A table's columns: `words`, then `more` that depend on what was measured.
pub(crate) fn headings(words: &[&str], more: impl IntoIterator<Item = String>) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).chain(more).collect()
}

#[derive(Default)]
pub(crate) struct Chapter {
    title: String,
    section: String,
    tables: Vec<Table>,
    quoted: BTreeMap<String, Figure>,
    settings: BTreeMap<String, Value>,
}

impl Chapter {
    pub(crate) fn new(title: &str) -> Self {
        Self { title: title.to_owned(), section: title.to_owned(), ..Self::default() }
    }

    /// The tables that follow stand below this heading; `source` names the figures of the thesis beside them.
    pub(crate) fn section(&mut self, title: &str, source: &str) {
        self.section = if source.is_empty() { title.to_owned() } else { format!("{title} ({source})") };
    }

    pub(crate) fn current_section(&self) -> &str {
        &self.section
    }

    /// A figure that the text quotes.
    pub(crate) fn quote(&mut self, name: impl Into<String>, figure: Figure) {
        self.quoted.insert(name.into(), figure);
    }

    /// What was chosen, not measured.
    pub(crate) fn setting(&mut self, name: impl Into<String>, value: impl Into<Value>) {
        self.settings.insert(name.into(), value.into());
    }

    /// `columns`: their headings; what stands in the first `words` of them is aligned left.
    pub(crate) fn table(
        &mut self,
        name: &'static str,
        columns: &[impl AsRef<str>],
        words: usize,
        rows: Vec<Vec<Cell>>,
    ) {
        let columns = columns.iter().map(|column| column.as_ref().to_owned()).collect();
        self.tables.push(Table { name, section: self.section.clone(), columns, words, rows });
    }

    /// A table with a row for each of `down` and a column for each of `across`; the words of a row stand under `words`.
    /// A row without any cell is left out.
    pub(crate) fn grid<D, A>(
        &mut self,
        name: &'static str,
        words: &[&str],
        down: impl IntoIterator<Item = (Vec<Cell>, D)>,
        across: &[(String, A)],
        cell: impl Fn(&D, &A) -> Result<Cell>,
    ) -> Result<()> {
        let mut rows = Vec::new();
        for (mut cells, of) in down {
            for (_, at) in across {
                cells.push(cell(&of, at)?);
            }
            if cells[words.len()..].iter().any(|cell| !matches!(cell, Cell::Missing)) {
                rows.push(cells);
            }
        }
        self.table(name, &headings(words, across.iter().map(|(heading, _)| heading.clone())), words.len(), rows);
        Ok(())
    }

    pub(crate) fn json(&self) -> Value {
        json!({ "title": self.title, "settings": self.settings, "quoted": self.quoted, "tables": self.tables })
    }

    pub(crate) fn render(&self, template: &str, exists: &dyn Fn(&str) -> bool) -> Result<String> {
        template::fill(template, &self.json(), exists)
    }
}
