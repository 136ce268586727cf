//! A chapter of the report: what is written as Markdown, and the same figures as JSON.

use super::figure::Figure;
use super::targets::Judged;
use crate::measure::markdown;
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

impl Cell {
    fn text(&self) -> String {
        match self {
            Self::Word(word) => word.clone(),
            Self::Figure(figure) => figure.text.clone(),
            Self::Missing => "-".to_owned(),
        }
    }
}

#[derive(Serialize)]
struct Table {
    name: &'static str,
    section: String,
    columns: Vec<String>,
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

/// Grows as the chapter is written, from the top down.
#[derive(Default)]
pub(crate) struct Chapter {
    text: String,
    section: String,
    sections: Vec<String>,
    tables: Vec<Table>,
    quoted: BTreeMap<String, Figure>,
    settings: BTreeMap<String, Value>,
    targets: Vec<Judged>,
}

impl Chapter {
    pub(crate) fn new(title: &str) -> Self {
        Self {
            text: format!("# {title}\n"),
            section: title.to_owned(),
            sections: vec![title.to_owned()],
            ..Self::default()
        }
    }

    /// What was written elsewhere follows.
    pub(crate) fn append(&mut self, mut other: Self) {
        self.text += &other.text;
        self.section = other.section;
        self.sections.append(&mut other.sections);
        self.tables.append(&mut other.tables);
        self.quoted.append(&mut other.quoted);
        self.settings.append(&mut other.settings);
        self.targets.append(&mut other.targets);
    }

    /// A heading; `source` names the figures of the thesis that the section stands beside.
    pub(crate) fn section(&mut self, title: &str, source: &str) {
        let heading = if source.is_empty() { title.to_owned() } else { format!("{title} ({source})") };
        self.text += &format!("\n## {heading}\n");
        self.section.clone_from(&heading);
        self.sections.push(heading);
    }

    /// A paragraph. Its numbers come from [`Self::quote`] and [`Self::setting`].
    pub(crate) fn paragraph(&mut self, text: &str) {
        self.text += &format!("\n{}\n", wrap(text));
    }

    pub(crate) fn list<T: AsRef<str>>(&mut self, points: &[T]) {
        self.text.push('\n');
        for point in points {
            self.text += &format!("- {}\n", wrap(point.as_ref()).replace('\n', "\n  "));
        }
    }

    /// Records a figure that the text quotes, and returns how it is written.
    pub(crate) fn quote(&mut self, name: impl Into<String>, figure: Figure) -> String {
        let text = figure.text.clone();
        self.quoted.insert(name.into(), figure);
        text
    }

    /// Records a number that was chosen, not measured, and returns it.
    pub(crate) fn setting<T: Into<Value> + Clone>(&mut self, name: impl Into<String>, value: T) -> T {
        self.settings.insert(name.into(), value.clone().into());
        value
    }

    /// `columns`: their headings; what stands in the first `words` of them is aligned left.
    pub(crate) fn table(
        &mut self,
        name: &'static str,
        columns: &[impl AsRef<str>],
        words: usize,
        rows: Vec<Vec<Cell>>,
    ) {
        let columns: Vec<&str> = columns.iter().map(AsRef::as_ref).collect();
        let cells = rows.iter().map(|row| row.iter().map(Cell::text).collect());
        let words: Vec<usize> = (0..words).collect();
        self.text += &format!("\n{}", markdown::lines(&columns, &words, cells.collect()));
        let columns = columns.into_iter().map(str::to_owned).collect();
        self.tables.push(Table { name, section: self.section.clone(), columns, rows });
    }

    pub(crate) fn picture(&mut self, file: &str, description: &str) {
        self.text += &format!("\n![{description}]({file})\n");
    }

    /// Headings so far.
    pub(crate) fn sections(&self) -> &[String] {
        &self.sections
    }

    /// What the index is told.
    pub(crate) fn hand_over(&mut self, mut targets: Vec<Judged>) {
        self.targets.append(&mut targets);
    }

    pub(crate) fn markdown(&self) -> &str {
        &self.text
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "title": self.sections.first(),
            "targets": self.targets,
            "sections": self.sections,
            "settings": self.settings,
            "quoted": self.quoted,
            "tables": self.tables,
        })
    }
}

/// Columns of a line of text.
const WIDTH: usize = 140;

/// Breaks lines between words.
fn wrap(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapters::figure::Unit;

    #[test]
    fn what_is_written_is_in_the_json_too() {
        let mut chapter = Chapter::new("Title");
        chapter.section("Direct light", "figure 4.4");
        let spp = chapter.setting("spp", 64);
        let worst = chapter.quote("worst ratio", Figure::exact(0.5, Unit::Ratio));
        chapter.paragraph(&format!("At {spp} samples the worst ratio is {worst}."));
        chapter.table("direct", &["scene", "ratio"], 1, vec![row!["dining", Figure::exact(0.25, Unit::Ratio)]]);
        assert!(chapter.markdown().contains("\n## Direct light (figure 4.4)\n"));
        assert!(chapter.markdown().contains("At 64 samples the worst ratio is 0.500."));
        assert!(chapter.markdown().contains("| dining | 0.250 |"));
        let json = chapter.json();
        assert_eq!(json["quoted"]["worst ratio"]["value"], 0.5);
        assert_eq!(json["settings"]["spp"], 64);
        assert_eq!(json["tables"][0]["rows"][0][1]["text"], "0.250");
    }

    #[test]
    fn long_lines_are_broken_between_words() {
        let text = wrap(&"word ".repeat(100));
        assert!(text.lines().all(|line| line.len() <= WIDTH && !line.ends_with(' ')));
        assert_eq!(text.split_whitespace().count(), 100);
    }
}
