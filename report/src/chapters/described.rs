//! Chapters as data: report/chapters/NAME.toml says which figures of the programs' tables stand in which tables of a
//! chapter, and which bounds they are to keep.
//!
//! - A word in braces stands for the cell of that column.
//! - Whatever key is not named below is a column, and its value what the rows of a figure have there: a word, or a list
//!   of which any will do.

use super::chapter::Chapter;
use super::figure::{Figure, Unit};
use super::plan::{Plan, packages};
use super::statistics::Estimate;
use super::targets::Bound;
use crate::measure::table::{Filter, Row, Table, Words};
use anyhow::{Result, bail};
use itertools::Itertools;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use xtask::tools::Package;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Description {
    title: String,
    /// A line for the index and for `--help`.
    pub(crate) about: String,
    /// Roughly what a default run takes on a quiet machine of two cores, without compiling.
    pub(crate) seconds: u64,
    /// Bench targets of noisefloor-bench that it runs.
    pub(crate) programs: Vec<String>,
    /// Of Debian's, that have what is measured on.
    #[serde(deserialize_with = "packages")]
    pub(crate) packages: Vec<Package>,
    /// Where a `--full` run measures other things: a chapter of its own, which other runs leave as it is.
    pub(crate) full: Option<Full>,
    /// What was chosen.
    pub(crate) settings: BTreeMap<String, Value>,
    setting: Vec<Counted>,
    quote: Vec<Quote>,
    table: Vec<Described>,
    target: Vec<Target>,
}

/// What `--full` writes instead of a chapter.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Full {
    /// As files name it.
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) about: String,
}

/// A setting that a program's table tells.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Counted {
    name: String,
    from: String,
    #[serde(default, rename = "where")]
    rows: Filter,
    /// How many different cells this column has,
    count: Option<String>,
    /// or its first cell.
    first: Option<String>,
}

/// A figure that the text quotes.
#[derive(Deserialize)]
struct Quote {
    name: String,
    from: String,
    #[serde(flatten)]
    of: Query,
}

/// A table with a row for each combination of the cells of `down`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Described {
    name: String,
    section: String,
    from: String,
    #[serde(default, rename = "where")]
    rows: Filter,
    /// Columns of the program's table that are made rows: of each its name, and the word in the new column `what`.
    #[serde(default)]
    melt: Vec<[String; 2]>,
    /// A table for each combination of these columns' cells.
    #[serde(default)]
    each: Vec<String>,
    /// Of the rows of the program's table those that make lines; figures may be of others.
    #[serde(default)]
    lines: Filter,
    /// Each with its heading behind a colon, if that is another.
    #[serde(default)]
    down: Vec<String>,
    /// What rows are sorted by, if not by `down`.
    order: Option<Vec<String>>,
    /// None: the program's table as it is.
    #[serde(default)]
    columns: Vec<Column>,
    /// How many columns are words and aligned left: those of `down`, if nothing is said.
    words: Option<usize>,
}

#[derive(Deserialize)]
struct Column {
    heading: String,
    /// A column for each combination of these.
    #[serde(default)]
    across: Vec<String>,
    #[serde(flatten)]
    of: Query,
}

/// What a figure is made of.
#[derive(Deserialize)]
struct Query {
    /// The column of its numbers.
    of: String,
    #[serde(default)]
    show: Show,
    #[serde(default)]
    unit: Unit,
    /// The interval is in the JSON alone.
    #[serde(default)]
    brief: bool,
    /// Each number is divided by that in this column.
    per: Option<String>,
    times: Option<f64>,
    /// The value is multiplied by that of another figure; there is no interval then.
    by: Option<Box<Query>>,
    /// Not the value, but what is left of it over what is missing from 1: infinite from there on.
    #[serde(default)]
    odds: bool,
    /// Divided by the numbers of other rows, which have these cells instead. Of several such rows those that are least.
    #[serde(default)]
    over: Filter,
    #[serde(flatten)]
    rows: Filter,
}

/// How the numbers of a figure become one.
#[derive(Deserialize, Clone, Copy, Default, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Show {
    /// Of ratios the median of the pairs'.
    #[default]
    Median,
    /// Of ratios that of the means.
    Mean,
    /// The same of geometric means. None if one of the numbers is none.
    Geometric,
    /// The first.
    Once,
    /// A number, and half of its interval if there is one: "2.5 +- 0.1".
    Written,
    /// A number whose interval's ends have columns of their own.
    Ends,
    /// A ratio that has its interval, and how often it was measured, in columns of its own.
    Logarithm,
    /// No number: the different cells, one behind the other.
    Word,
}

/// A bound for a figure, in each place.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Target {
    statement: String,
    place: String,
    from: String,
    #[serde(default, rename = "where")]
    rows: Filter,
    #[serde(default)]
    melt: Vec<[String; 2]>,
    #[serde(default)]
    each: Vec<String>,
    figure: Query,
    at_most: Option<Limit>,
    at_least: Option<Limit>,
    below: Option<Limit>,
    /// What tells several limits apart, if not all words of `each`.
    by: Option<String>,
}

/// One for all places, or those that have one.
#[derive(Deserialize)]
#[serde(untagged)]
enum Limit {
    One(f64),
    Of(BTreeMap<String, f64>),
}

/// What programs have measured, by name.
pub(crate) type Measured<'a> = &'a dyn Fn(&str) -> Result<Table>;

impl Description {
    /// What a run writes: the name of the files, the title, and the index's line.
    pub(crate) fn names<'a>(&'a self, name: &'a str, plan: &Plan) -> [&'a str; 3] {
        match &self.full {
            Some(Full { name, title, about }) if plan.is_full() => [name, title, about],
            _ => [name, &self.title, &self.about],
        }
    }

    pub(crate) fn write(&self, measured: Measured, chapter: &mut Chapter, plan: &Plan) -> Result<()> {
        for (name, value) in &self.settings {
            chapter.setting(name, value);
        }
        // What was not measured has no columns.
        let measured = |name: &str| measured(name).map(|table| Some(table).filter(|table| !table.headings.is_empty()));
        for Counted { name, from, rows, count, first } in &self.setting {
            let Some(table) = measured(from)?.map(|table| table.only(rows)).transpose()? else { continue };
            let of = |column: &Option<String>| column.as_ref().map(|column| table.distinct(column)).transpose();
            if let Some(cells) = of(count)? {
                chapter.setting(name, cells.len());
            }
            if let Some(&cell) = of(first)?.iter().flatten().next() {
                chapter.setting(name, cell.parse::<u64>().map_or(Value::from(cell), Value::from));
            }
        }
        for Quote { name, from, of } in &self.quote {
            let Some(table) = measured(from)? else { continue };
            let figure = of.cell(&table, &Filter::new())?;
            if !figure.is_null() {
                chapter.quote(name, figure);
            }
        }
        for described in &self.table {
            measured(&described.from)?.map(|table| described.write(table, chapter)).transpose()?;
        }
        for target in &self.target {
            measured(&target.from)?.map(|table| target.write(table, chapter, plan)).transpose()?;
        }
        Ok(())
    }
}

impl Described {
    fn write(&self, table: Table, chapter: &mut Chapter) -> Result<()> {
        let table = table.melted(&self.melt)?.only(&self.rows)?;
        for each in table.combinations(&self.each, &self.rows)? {
            chapter.section(&filled(&self.section, &each));
            let (headings, rows) = match self.columns.is_empty() {
                true => (table.headings.clone(), table.rows().map(|row| json!(row.cells)).collect()),
                false => self.cells(&table.only(&each)?)?,
            };
            if !rows.is_empty() {
                chapter.table(&self.name, &headings.join(" | "), self.words.unwrap_or(self.down.len()), rows);
            }
        }
        Ok(())
    }

    /// Headings and rows. What was not measured, rows and columns of `across`, is left out.
    fn cells(&self, table: &Table) -> Result<(Vec<String>, Vec<Value>)> {
        let down: Vec<_> = self.down.iter().map(|down| down.split_once(": ").unwrap_or((down, down))).collect();
        let names: Vec<&str> = down.iter().map(|(name, _)| *name).collect();
        let order =
            self.order.as_ref().map_or_else(|| names.clone(), |order| order.iter().map(String::as_str).collect());
        let kinds = table.only(&self.lines)?.combinations(&order, &joined(&self.rows, &self.lines))?;
        let mut columns: Vec<(String, Vec<Value>)> = Vec::new();
        for (name, heading) in &down {
            let words = kinds.iter().map(|of| json!(of[*name].to_string()));
            columns.push(((*heading).to_owned(), words.collect()));
        }
        for column in &self.columns {
            for at in table.combinations(&column.across, &self.rows)? {
                let cells = kinds.iter().map(|of| column.of.cell(table, &joined(of, &at)));
                let cells = cells.collect::<Result<Vec<_>>>()?;
                if column.across.is_empty() || !cells.iter().all(Value::is_null) {
                    columns.push((filled(&column.heading, &at), cells));
                }
            }
        }
        let (headings, columns): (Vec<String>, Vec<Vec<Value>>) = columns.into_iter().unzip();
        let row = |at: usize| columns.iter().map(|cells| &cells[at]).collect::<Vec<_>>();
        let rows = (0..kinds.len()).map(row).filter(|row| !row[down.len()..].iter().all(|cell| cell.is_null()));
        Ok((headings, rows.map(|row| json!(row)).collect()))
    }
}

impl Target {
    /// Fails where a full run, which measures all places, has none for a limit.
    fn write(&self, table: Table, chapter: &mut Chapter, plan: &Plan) -> Result<()> {
        let table = table.melted(&self.melt)?.only(&self.rows)?;
        let mut judged = BTreeSet::new();
        let limits = [&self.at_most, &self.at_least, &self.below];
        let bounds = [Bound::AtMost, Bound::AtLeast, Bound::Below];
        for each in table.combinations(&self.each, &self.rows)? {
            let words = self.each.iter().map(|column| each[column].to_string());
            let key = self.by.as_ref().map_or_else(|| words.collect::<Vec<_>>().join(", "), |by| filled(by, &each));
            for (limit, bound) in limits.into_iter().zip(bounds) {
                let limit = match limit {
                    Some(Limit::One(limit)) => Some(limit),
                    Some(Limit::Of(limits)) => limits.get(&key),
                    None => None,
                };
                if let (Some(&limit), Some(estimate)) = (limit, self.figure.estimate(&table, &each)?) {
                    let (statement, place) = (filled(&self.statement, &each), filled(&self.place, &each));
                    chapter.target(&statement, &place, estimate, self.figure.unit, bound(limit));
                    judged.insert(key.clone());
                }
            }
        }
        let unused = |limit: &Limit| match limit {
            Limit::Of(limits) => limits.keys().find(|key| !judged.contains(*key)).cloned(),
            Limit::One(_) => None,
        };
        let unused = limits.into_iter().flatten().find_map(unused).filter(|_| plan.is_full());
        unused
            .map_or(Ok(()), |key| bail!("`{}`: no place is `{key}`, which has a limit: mend its name", self.statement))
    }
}

impl Query {
    fn cell(&self, table: &Table, of: &Filter) -> Result<Value> {
        if self.show == Show::Word {
            let words = table.only(&joined(of, &self.rows))?.distinct(&self.of)?.concat();
            return Ok(json!(Some(words).filter(|words| !words.is_empty())));
        }
        let show = if self.brief { Figure::brief } else { Figure::new };
        let Some(mut estimate) = self.estimate(table, of)? else { return Ok(Value::Null) };
        if let Some(factor) = &self.by {
            let value = factor.estimate(table, of)?.map_or(f64::NAN, |of| of.value);
            let odds = if value < 1.0 { value / (1.0 - value) } else { f64::INFINITY };
            estimate = Estimate::exact(estimate.value * if factor.odds { odds } else { value });
        }
        Ok(json!(show(estimate, self.unit)))
    }

    /// None of what was not measured.
    fn estimate(&self, table: &Table, of: &Filter) -> Result<Option<Estimate>> {
        let rows = joined(of, &self.rows);
        if matches!(self.show, Show::Written | Show::Logarithm | Show::Ends) {
            let one = |row: Row| match self.show {
                Show::Written => row.written(&self.of),
                Show::Logarithm => row.ratio(&self.of),
                _ => row.between(&self.of),
            };
            return table.only(&rows)?.rows().next().map(one).transpose();
        }
        let own = self.numbers(table, &rows)?;
        if own.is_empty() {
            return Ok(None);
        }
        if self.over.is_empty() {
            return Ok(self.sum_up(&own));
        }
        let mut all = Vec::new();
        for over in choices(&self.over) {
            let others = joined(&rows, &over);
            // Nothing is compared with itself.
            let is_same = table.only(&others)? == table.only(&rows)?;
            let numbers = if is_same { Vec::new() } else { self.numbers(table, &others)? };
            let sums = [&own, &numbers].map(|numbers| self.sum_up(numbers));
            let ratio = match self.show {
                _ if numbers.is_empty() => continue,
                Show::Mean => Estimate::ratio_of_means(&own, &numbers),
                Show::Geometric if sums.contains(&None) => continue,
                Show::Geometric => Estimate::ratio_of_geometric_means(&own, &numbers),
                _ if own.len() == numbers.len() => Estimate::ratio(&own, &numbers),
                _ => bail!("{}: {} numbers of {} over {} are no pairs", table.name, own.len(), self.of, numbers.len()),
            };
            all.push((sums[1].map_or(f64::INFINITY, |of| of.value), ratio));
        }
        Ok(Estimate::over_least(&all))
    }

    fn numbers(&self, table: &Table, rows: &Filter) -> Result<Vec<f64>> {
        // Also where there is no such row.
        table.column(&self.of)?;
        let mut all = Vec::new();
        for row in table.only(rows)?.rows() {
            if let Some(number) = row.optional(&self.of)? {
                let per = self.per.as_ref().map_or(Ok(1.0), |per| row.number(per))?;
                all.push(number / per * self.times.unwrap_or(1.0));
            }
        }
        Ok(all)
    }

    fn sum_up(&self, numbers: &[f64]) -> Option<Estimate> {
        let &first = numbers.first()?;
        match self.show {
            Show::Mean => Some(Estimate::mean(numbers)),
            Show::Geometric if numbers.iter().any(|number| !number.is_finite()) => None,
            Show::Geometric => Some(Estimate::geometric_mean(numbers)),
            Show::Once => Some(Estimate::exact(first)).filter(|_| first.is_finite()),
            _ => Some(Estimate::median(numbers)),
        }
    }
}

/// The cells of both; of the second those of the same columns.
fn joined(one: &Filter, other: &Filter) -> Filter {
    one.iter().chain(other).map(|(column, words)| (column.clone(), words.clone())).collect()
}

/// Each combination of one word of every column.
fn choices(filter: &Filter) -> Vec<Filter> {
    let cells = |(column, words): (&String, &Words)| {
        words.list().iter().map(|word| (column.clone(), Words::One(word.clone()))).collect::<Vec<_>>()
    };
    filter.iter().map(cells).multi_cartesian_product().map(Filter::from_iter).collect()
}

/// The text with columns' cells for their names in braces.
fn filled(text: &str, cells: &Filter) -> String {
    cells
        .iter()
        .fold(text.to_owned(), |text, (column, words)| text.replace(&format!("{{{column}}}"), &words.to_string()))
}
