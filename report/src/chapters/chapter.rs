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

    /// The tables that follow stand below this heading.
    pub(crate) fn section(&mut self, title: &str) {
        title.clone_into(&mut self.section);
    }

    /// A figure that the text quotes.
    pub(crate) fn quote(&mut self, name: impl Into<String>, figure: Figure) {
        self.quoted.insert(name.into(), figure);
    }

    /// What was chosen, not measured.
    pub(crate) fn setting(&mut self, name: impl Into<String>, value: impl Into<Value>) {
        self.settings.insert(name.into(), value.into());
    }

    /// Columns between bars. What stands in the first `words` of them is aligned left.
    pub(crate) fn table(&mut self, name: &str, columns: &str, words: usize, rows: Vec<Vec<Cell>>) {
        let columns = columns.split(" | ").map(str::to_owned).collect();
        self.tables.push(Table { name: name.to_owned(), section: self.section.clone(), columns, words, rows });
    }

    pub(crate) fn json(&self) -> Value {
        json!({ "title": self.title, "settings": self.settings, "quoted": self.quoted, "tables": self.tables })
    }

    pub(crate) fn render(&self, template: &str, exists: &dyn Fn(&str) -> bool) -> Result<String> {
        template::fill(template, &self.json(), exists)
    }
}
