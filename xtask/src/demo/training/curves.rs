//! Rows of CSV as lines of a plot: the mean over the seeds, and its 95 % confidence interval.

use crate::measure::plot::Series;
use anyhow::{Context, Result, bail};

/// A table as a trainer wrote it.
pub(crate) struct Rows<'a> {
    columns: Vec<&'a str>,
    rows: Vec<Vec<&'a str>>,
}

impl<'a> Rows<'a> {
    pub(crate) fn parse(csv: &'a str) -> Result<Self> {
        let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let columns = lines.next().context("the table is empty")?;
        let rows: Vec<_> = lines.collect();
        if let Some(row) = rows.iter().find(|row| row.len() != columns.len()) {
            bail!("`{}` is no row of the table", row.join(","));
        }
        Ok(Self { columns, rows })
    }

    fn column(&self, name: &str) -> Result<usize> {
        let index = self.columns.iter().position(|column| *column == name);
        index.with_context(|| format!("the table has no column `{name}`"))
    }

    /// Those whose `column` holds `value`.
    pub(crate) fn only(&self, column: &str, value: &str) -> Result<Self> {
        let index = self.column(column)?;
        let rows = self.rows.iter().filter(|row| row.get(index) == Some(&value)).cloned().collect();
        Ok(Self { columns: self.columns.clone(), rows })
    }

    /// A column, row by row.
    pub(crate) fn all(&self, name: &str) -> Result<Vec<&'a str>> {
        let index = self.column(name)?;
        Ok(self.rows.iter().filter_map(|row| row.get(index).copied()).collect())
    }

    /// The different words of a column, in the order in which they come.
    pub(crate) fn words(&self, column: &str) -> Result<Vec<&'a str>> {
        let index = self.column(column)?;
        let mut words = Vec::new();
        for word in self.rows.iter().filter_map(|row| row.get(index)) {
            if !words.contains(word) {
                words.push(*word);
            }
        }
        Ok(words)
    }

    pub(crate) fn numbers(&self, column: &str) -> Result<Vec<f64>> {
        let index = self.column(column)?;
        let parse = |word: &&str| word.parse().with_context(|| format!("`{word}` is no number"));
        self.rows.iter().filter_map(|row| row.get(index)).map(parse).collect()
    }

    /// One line: at each different word of `key`, in order, the means of `x` and of `y` times `factor`.
    pub(crate) fn line(&self, name: &str, key: &str, x: &str, (y, factor): (&str, f64)) -> Result<Series> {
        let mut series = Series { name: name.to_owned(), ..Series::default() };
        for word in self.words(key)? {
            let group = self.only(key, word)?;
            let (at, _) = interval(&group.numbers(x)?);
            let (mean, half) = interval(&group.numbers(y)?);
            series.points.push((at, factor * mean));
            if half.is_finite() {
                series.band.push((at, factor * (mean - half), factor * (mean + half)));
            }
        }
        Ok(series)
    }
}

/// 97.5 % of Student's t for 1, 2, ... degrees of freedom.
const STUDENT: [f64; 15] =
    [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.16, 2.145, 2.131];

/// 97.5 % of Student's t; beyond the table by the normal distribution's and three terms of Cornish and Fisher's expansion,
/// right to .0003.
fn student(freedom: usize) -> f64 {
    let beyond = || {
        let inverse = 1.0 / freedom as f64;
        1.95996 + inverse * (2.37227 + inverse * (2.82246 + inverse * 2.5559))
    };
    freedom.checked_sub(1).map_or(f64::NAN, |index| STUDENT.get(index).copied().unwrap_or_else(beyond))
}

/// The mean, and half the width of its 95 % confidence interval: NaN for one value.
fn interval(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, student(values.len().saturating_sub(1)) * (square / (n - 1.0) / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_beyond_the_table() {
        for (freedom, value) in [(15, 2.1314), (16, 2.1199), (19, 2.0930), (30, 2.0423), (120, 1.9799)] {
            assert!((student(freedom) - value).abs() < 5e-4, "{freedom}");
        }
        assert!(student(0).is_nan());
    }

    #[test]
    fn seeds_are_averaged() {
        let text = "mode,seed,step,y\na,1,0,1\nb,1,0,5\na,1,7,2\na,2,0,3\na,2,7,4\n";
        let rows = Rows::parse(text).expect("a table");
        assert_eq!(rows.words("mode").expect("a column"), ["a", "b"]);
        let line = rows.only("mode", "a").and_then(|rows| rows.line("a", "step", "step", ("y", 10.0))).expect("a line");
        assert_eq!(line.points, [(0.0, 20.0), (7.0, 30.0)]);
        // Two values 1 from the mean: a standard error of 1.
        assert!((line.band[0].2 - line.points[0].1 - 127.06).abs() < 1e-9);
        let alone = rows.only("mode", "b").and_then(|rows| rows.line("b", "step", "step", ("y", 1.0))).expect("a line");
        assert!(alone.band.is_empty());
        assert!(rows.words("nonsense").is_err());
        assert!(Rows::parse("a,b\n1\n").is_err() && Rows::parse("").is_err());
    }
}
