//! Tables that programs write: a line of headings, then rows of as many cells.

use crate::chapters::statistics::Estimate;
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::str::FromStr;

pub(crate) struct Table {
    /// For errors: where it is from.
    name: String,
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// One of its rows.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    table: &'a Table,
    cells: &'a [String],
}

impl Table {
    /// Of a file whose cells are divided by `separator` and hold none.
    pub(crate) fn read(path: &Path, separator: char) -> Result<Self> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {name}"))?;
        Self::parse(&text, &name, separator)
    }

    /// The same, divided by semicolons if the headings are, otherwise by commas.
    pub(crate) fn of_file(path: &Path) -> Result<Self> {
        let headings = std::fs::read_to_string(path).unwrap_or_default();
        let has_semicolons = headings.lines().next().is_some_and(|line| line.contains(';'));
        Self::read(path, if has_semicolons { ';' } else { ',' })
    }

    /// As [`Table::read`], of what was read already.
    pub(crate) fn parse(text: &str, name: &str, separator: char) -> Result<Self> {
        let cells = |line: &str| line.split(separator).map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines().map(cells);
        let headings = lines.next().with_context(|| format!("{name} is empty"))?;
        let rows: Vec<_> = lines.collect();
        if let Some((line, row)) = (2..).zip(&rows).find(|(_, row)| row.len() != headings.len()) {
            bail!("{name}, line {line}: {} cells under {} headings: {row:?}", row.len(), headings.len());
        }
        Ok(Self { name: name.to_owned(), headings, rows })
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|cells| Row { table: self, cells })
    }

    /// The first row with these cells under these headings.
    pub(crate) fn find(&self, wanted: &[(&str, &str)]) -> Result<Row<'_>> {
        self.rows().find(|row| row.has(wanted)).with_context(|| format!("{} has no row of {wanted:?}", self.name))
    }

    /// The rows whose cell under a heading is this.
    pub(crate) fn only(&self, heading: &str, word: &str) -> Result<Self> {
        self.column(heading)?;
        Ok(self.of(&[(heading, word)]))
    }

    /// The rows with these cells under these headings.
    pub(crate) fn of(&self, wanted: &[(&str, &str)]) -> Self {
        let rows = self.rows().filter(|row| row.has(wanted)).map(|row| row.cells.to_vec()).collect();
        Self { name: self.name.clone(), headings: self.headings.clone(), rows }
    }

    /// A column, row by row.
    pub(crate) fn numbers(&self, heading: &str) -> Result<Vec<f64>> {
        self.column(heading)?;
        self.rows().map(|row| row.number(heading)).collect()
    }

    /// The numbers of a column in the rows with these cells under these headings.
    pub(crate) fn numbers_of(&self, heading: &str, wanted: &[(&str, &str)]) -> Result<Vec<f64>> {
        self.rows().filter(|row| row.has(wanted)).map(|row| row.number(heading)).collect()
    }

    /// The different cells of a column, each with its words in the heading of a table.
    pub(crate) fn headings(&self, heading: &str, words: impl Fn(&str) -> String) -> Result<Vec<(String, &str)>> {
        Ok(self.distinct(heading)?.into_iter().map(|word| (words(word), word)).collect())
    }

    /// The different cells of a column, in the order in which they come.
    pub(crate) fn distinct(&self, heading: &str) -> Result<Vec<&str>> {
        Ok(self.kinds(&[heading])?.concat())
    }

    /// The different cells of some columns together, in the order in which they come.
    pub(crate) fn kinds(&self, headings: &[&str]) -> Result<Vec<Vec<&str>>> {
        let mut kinds = Vec::new();
        for row in self.rows() {
            let kind = headings.iter().map(|heading| row.word(heading)).collect::<Result<Vec<_>>>()?;
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        Ok(kinds)
    }

    fn column(&self, heading: &str) -> Result<usize> {
        let column = self.headings.iter().position(|name| name == heading);
        column.with_context(|| format!("{} has no column `{heading}`", self.name))
    }
}

impl<'a> Row<'a> {
    /// The cell under a heading.
    pub(crate) fn word(&self, heading: &str) -> Result<&'a str> {
        Ok(&self.cells[self.table.column(heading)?])
    }

    pub(crate) fn number<T: FromStr>(&self, heading: &str) -> Result<T> {
        let word = self.word(heading)?;
        let number = word.parse().ok();
        number.with_context(|| format!("{}: `{word}` in column `{heading}` is no number", self.table.name))
    }

    /// The ratio of a row that has one, with its interval; `count` is the column of its repetitions.
    pub(crate) fn ratio(&self, count: &str) -> Result<Estimate> {
        Ok(Estimate::of_logarithm(self.number("ratio")?, self.number("half_width")?, self.number(count)?))
    }

    /// None for an empty cell.
    pub(crate) fn optional(&self, heading: &str) -> Result<Option<f64>> {
        if self.word(heading)?.is_empty() { Ok(None) } else { self.number(heading).map(Some) }
    }

    /// Whether the cells under these headings are these.
    pub(crate) fn has(&self, wanted: &[(&str, &str)]) -> bool {
        wanted.iter().all(|(heading, value)| self.word(heading).is_ok_and(|word| word == *value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found_by_their_headings() -> Result<()> {
        let table = Table::parse("name;n;x\na, b;1;2.5e-1\nc;2;\na, b;4;3\n", "t.csv", ';')?;
        assert_eq!(table.distinct("name")?, ["a, b", "c"]);
        let some = table.only("name", "a, b")?;
        assert_eq!((some.distinct("n")?, some.numbers("x")?), (vec!["1", "4"], vec![0.25, 3.0]));
        let rows: Vec<_> = table.rows().collect();
        assert_eq!(
            (rows[0].number::<u32>("n")?, rows[0].optional("x")?, rows[1].optional("x")?),
            (1, Some(0.25), None)
        );
        let error = rows[0].number::<u32>("x").expect_err("no whole number");
        assert!(error.to_string().contains("t.csv: `2.5e-1` in column `x`"), "{error}");
        Ok(())
    }
}
