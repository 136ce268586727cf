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
    name: String,
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

/// A table's columns: one by one, or between bars.
pub(crate) trait Columns {
    fn list(&self) -> Vec<String>;
}

impl Columns for str {
    fn list(&self) -> Vec<String> {
        self.split(" | ").map(str::to_owned).collect()
    }
}

impl<T: AsRef<str>> Columns for [T] {
    fn list(&self) -> Vec<String> {
        self.iter().map(|column| column.as_ref().to_owned()).collect()
    }
}

impl<T: AsRef<str>, const N: usize> Columns for [T; N] {
    fn list(&self) -> Vec<String> {
        self[..].list()
    }
}

impl<T: AsRef<str>> Columns for Vec<T> {
    fn list(&self) -> Vec<String> {
        self[..].list()
    }
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

    /// A figure that the text quotes.
    pub(crate) fn quote(&mut self, name: impl Into<String>, figure: Figure) {
        self.quoted.insert(name.into(), figure);
    }

    /// What was chosen, not measured.
    pub(crate) fn setting(&mut self, name: impl Into<String>, value: impl Into<Value>) {
        self.settings.insert(name.into(), value.into());
    }

    /// What stands in the first `words` of the columns is aligned left.
    pub(crate) fn table(
        &mut self,
        name: impl Into<String>,
        columns: &(impl Columns + ?Sized),
        words: usize,
        rows: Vec<Vec<Cell>>,
    ) {
        self.tables.push(Table {
            name: name.into(),
            section: self.section.clone(),
            columns: columns.list(),
            words,
            rows,
        });
    }

    /// A table with a row for each of `down` and a column for each of `across`; the words of a row stand under `lead`.
    /// A row without any cell is left out.
    pub(crate) fn grid<D, A>(
        &mut self,
        name: &'static str,
        lead: (usize, &str),
        down: impl IntoIterator<Item = (Vec<Cell>, D)>,
        across: &[(impl AsRef<str>, A)],
        cell: impl Fn(&D, &A) -> Result<Cell>,
    ) -> Result<()> {
        let (words, mut columns) = (lead.0, lead.1.list());
        let first = columns.len();
        let mut rows = Vec::new();
        for (mut cells, of) in down {
            for (_, at) in across {
                cells.push(cell(&of, at)?);
            }
            if cells[first..].iter().any(|cell| !matches!(cell, Cell::Missing)) {
                rows.push(cells);
            }
        }
        columns.extend(across.iter().map(|(heading, _)| heading.as_ref().to_owned()));
        self.table(name, &columns, words, rows);
        Ok(())
    }

    pub(crate) fn json(&self) -> Value {
        json!({ "title": self.title, "settings": self.settings, "quoted": self.quoted, "tables": self.tables })
    }

    pub(crate) fn render(&self, template: &str, exists: &dyn Fn(&str) -> bool) -> Result<String> {
        template::fill(template, &self.json(), exists)
    }
}
