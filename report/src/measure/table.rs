//! Tables that programs write: a line of headings, then rows of as many cells.

use crate::chapters::statistics::Estimate;
use anyhow::{Context, Result, bail};
use itertools::Itertools;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::str::FromStr;
use xtask::paths;

/// What rows must have, by the names of columns.
pub(crate) type Filter = BTreeMap<String, Words>;

/// Cells, of which any will do.
#[derive(Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub(crate) enum Words {
    One(String),
    Any(Vec<String>),
}

impl Words {
    pub(crate) fn list(&self) -> &[String] {
        match self {
            Self::One(word) => std::slice::from_ref(word),
            Self::Any(words) => words,
        }
    }
}

impl fmt::Display for Words {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.list().join(", "))
    }
}

#[derive(Clone, PartialEq)]
pub(crate) struct Table {
    /// For errors: where it is from.
    pub(crate) name: String,
    pub(crate) headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// One of its rows.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    table: &'a Table,
    pub(crate) cells: &'a [String],
}

impl Table {
    /// Without rows; headings between bars.
    pub(crate) fn new(name: &str, headings: &str) -> Self {
        let headings = headings.split(" | ").filter(|heading| !heading.is_empty()).map(str::to_owned).collect();
        Self { name: name.to_owned(), headings, rows: Vec::new() }
    }

    pub(crate) fn push(&mut self, row: impl IntoIterator<Item: ToString>) {
        self.rows.push(row.into_iter().map(|cell| cell.to_string()).collect());
    }

    /// NAME.csv. Its cells are divided by semicolons if the headings are, otherwise by commas, and hold none.
    pub(crate) fn read(folder: &Path, name: &str) -> Result<Self> {
        let path = folder.join(format!("{name}.csv"));
        Self::parse(&paths::read(&path)?, &path.display().to_string())
    }

    /// The same, of what was read already.
    pub(crate) fn parse(text: &str, name: &str) -> Result<Self> {
        let mut lines = text.lines();
        let headings = lines.next().with_context(|| format!("{name} is empty"))?;
        let separator = if headings.contains(';') { ';' } else { ',' };
        let cells = |line: &str| line.split(separator).map(str::to_owned).collect::<Vec<_>>();
        let (headings, rows) = (cells(headings), lines.map(cells).collect::<Vec<_>>());
        if let Some((line, row)) = (2..).zip(&rows).find(|(_, row)| row.len() != headings.len()) {
            bail!("{name}, line {line}: {} cells under {} headings: {row:?}", row.len(), headings.len());
        }
        Ok(Self { name: name.to_owned(), headings, rows })
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|cells| Row { table: self, cells })
    }

    /// The rows with these cells under these headings.
    pub(crate) fn of(&self, wanted: &[(&str, &str)]) -> Self {
        self.filtered(|row| wanted.iter().all(|(heading, cell)| row.word(heading).is_ok_and(|word| word == *cell)))
    }

    /// The rows that a filter lets through.
    pub(crate) fn only(&self, filter: &Filter) -> Result<Self> {
        let wanted: Vec<(usize, &[String])> =
            filter.iter().map(|(heading, words)| Ok((self.column(heading)?, words.list()))).collect::<Result<_>>()?;
        Ok(self.filtered(|row| wanted.iter().all(|(column, words)| words.contains(&row.cells[*column]))))
    }

    pub(crate) fn filtered(&self, is_wanted: impl Fn(&Row) -> bool) -> Self {
        let rows = self.rows().filter(is_wanted).map(|row| row.cells.to_vec()).collect();
        Self { name: self.name.clone(), headings: self.headings.clone(), rows }
    }

    /// Columns made rows: of each column its name, and the word for it in the new column `what`; `value` has the cells.
    pub(crate) fn melted(mut self, columns: &[[String; 2]]) -> Result<Self> {
        if columns.is_empty() {
            return Ok(self);
        }
        let places = columns.iter().map(|[name, word]| Ok((self.column(name)?, word))).collect::<Result<Vec<_>>>()?;
        let melt = |row: Vec<String>| {
            let one = |&(at, word): &(usize, &String)| [&row[..], &[word.clone(), row[at].clone()]].concat();
            places.iter().map(one).collect::<Vec<_>>()
        };
        self.rows = self.rows.into_iter().flat_map(melt).collect();
        self.headings.extend(["what", "value"].map(str::to_owned));
        Ok(self)
    }

    /// With another column.
    pub(crate) fn with(&self, heading: &str, cell: impl Fn(&Row) -> Result<String>) -> Result<Self> {
        let mut table = self.clone();
        for (cells, row) in table.rows.iter_mut().zip(self.rows()) {
            cells.push(cell(&row)?);
        }
        table.headings.push(heading.to_owned());
        Ok(table)
    }

    /// The different cells of some columns together; columns are sorted as the filter lists their cells, or by where
    /// they come first. Of no columns one, which lets all rows through.
    pub(crate) fn combinations(&self, headings: &[impl AsRef<str>], by: &Filter) -> Result<Vec<Filter>> {
        let headings: Vec<&str> = headings.iter().map(AsRef::as_ref).collect();
        let order = |heading: &&str| match by.get(*heading) {
            Some(words) => Ok(words.list().iter().map(String::as_str).collect()),
            None => self.distinct(heading),
        };
        let orders = headings.iter().map(order).collect::<Result<Vec<Vec<&str>>>>()?;
        let place = |kind: &Vec<&str>| -> Vec<Option<usize>> {
            kind.iter().zip(&orders).map(|(cell, order)| order.iter().position(|word| word == cell)).collect()
        };
        let mut kinds = if headings.is_empty() { vec![Vec::new()] } else { self.kinds(&headings)? };
        kinds.sort_by_key(place);
        let filter = |kind: Vec<&str>| {
            headings.iter().zip(kind).map(|(name, word)| ((*name).to_owned(), Words::One(word.to_owned()))).collect()
        };
        Ok(kinds.into_iter().map(filter).collect())
    }

    /// A column, row by row.
    pub(crate) fn numbers(&self, heading: &str) -> Result<Vec<f64>> {
        self.column(heading)?;
        self.rows().map(|row| row.number(heading)).collect()
    }

    /// The different cells of a column, in the order in which they come.
    pub(crate) fn distinct(&self, heading: &str) -> Result<Vec<&str>> {
        Ok(self.kinds(&[heading])?.concat())
    }

    /// The different cells of some columns together, in the order in which they come.
    pub(crate) fn kinds(&self, headings: &[&str]) -> Result<Vec<Vec<&str>>> {
        let columns = headings.iter().map(|heading| self.column(heading)).collect::<Result<Vec<_>>>()?;
        let kinds = self.rows.iter().map(|cells| columns.iter().map(|&column| &*cells[column]).collect());
        Ok(kinds.unique().collect())
    }

    /// `NAME[2]` is the second column of this name.
    pub(crate) fn column(&self, heading: &str) -> Result<usize> {
        let (name, skip) = heading.strip_suffix("[2]").map_or((heading, 0), |name| (name, 1));
        let mut columns = (0..self.headings.len()).filter(|&column| self.headings[column] == name);
        columns.nth(skip).with_context(|| format!("{} has no column `{heading}`", self.name))
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

    /// A ratio, with its interval and how often it was measured.
    pub(crate) fn ratio(&self, heading: &str) -> Result<Estimate> {
        Ok(Estimate::of_logarithm(self.number(heading)?, self.number("half_width")?, self.number("repetitions")?))
    }

    /// A number, and half of its interval if there is one: "2.5 +- 0.1".
    pub(crate) fn written(&self, heading: &str) -> Result<Estimate> {
        let word = self.word(heading)?;
        let (value, half) = word.split_once(" +- ").unwrap_or((word, "0"));
        let [value, half] = [value, half].map(|word| word.trim().parse::<f64>());
        let (value, half) = (value?, half?);
        Ok(Estimate::about(value, half, 2))
    }

    /// A number whose interval's ends have columns of their own.
    pub(crate) fn between(&self, heading: &str) -> Result<Estimate> {
        let [value, low, high] = ["", "_low", "_high"].map(|end| self.number(&format!("{heading}{end}")));
        Ok(Estimate { value: value?, low: low?, high: high?, seeds: 2 })
    }

    /// None for an empty cell, or a dash.
    pub(crate) fn optional(&self, heading: &str) -> Result<Option<f64>> {
        if matches!(self.word(heading)?, "" | "-") { Ok(None) } else { self.number(heading).map(Some) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found_by_their_headings() -> Result<()> {
        let table = Table::parse("name;n;x\na, b;1;2.5e-1\nc;2;\na, b;4;3\nc;5;-\n", "t.csv")?;
        assert_eq!(table.distinct("name")?, ["a, b", "c"]);
        let some = table.of(&[("name", "a, b")]);
        assert_eq!((some.distinct("n")?, some.numbers("x")?), (vec!["1", "4"], vec![0.25, 3.0]));
        let rows: Vec<_> = table.rows().collect();
        assert_eq!(
            (rows[0].number::<u32>("n")?, rows[0].optional("x")?, rows[1].optional("x")?),
            (1, Some(0.25), None)
        );
        assert_eq!(rows[3].optional("x")?, None);
        let error = rows[0].number::<u32>("x").expect_err("no whole number");
        assert!(error.to_string().contains("t.csv: `2.5e-1` in column `x`"), "{error}");
        Ok(())
    }
}
