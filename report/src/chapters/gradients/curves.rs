//! Rows of tables as lines of a plot: the mean over the seeds, and its 95 % confidence interval.

use crate::chapters::statistics::Estimate;
use crate::measure::plot::Series;
use crate::measure::table::Table;
use anyhow::Result;

impl Table {
    /// One line: at each different word of `key`, in order, the means of `x` and of `y` times `factor`.
    pub(super) fn line(&self, name: &str, key: &str, x: &str, (y, factor): (&str, f64)) -> Result<Series> {
        let mut series = Series { name: name.to_owned(), ..Series::default() };
        for word in self.distinct(key)? {
            let group = self.only(key, word)?;
            let at = Estimate::mean(&group.numbers(x)?).value;
            let Estimate { value, low, high, seeds } = Estimate::mean(&group.numbers(y)?);
            series.points.push((at, factor * value));
            if seeds > 1 {
                series.band.push((at, factor * low, factor * high));
            }
        }
        Ok(series)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_averaged() {
        let text = "mode,seed,step,y\na,1,0,1\nb,1,0,5\na,1,7,2\na,2,0,3\na,2,7,4\n";
        let rows = Table::parse(text, "t.csv", ',').expect("a table");
        assert_eq!(rows.distinct("mode").expect("a column"), ["a", "b"]);
        let line = rows.only("mode", "a").and_then(|rows| rows.line("a", "step", "step", ("y", 10.0))).expect("a line");
        assert_eq!(line.points, [(0.0, 20.0), (7.0, 30.0)]);
        // Two values 1 from the mean: a standard error of 1.
        assert!((line.band[0].2 - line.points[0].1 - 127.06).abs() < 1e-9);
        let alone = rows.only("mode", "b").and_then(|rows| rows.line("b", "step", "step", ("y", 1.0))).expect("a line");
        assert!(alone.band.is_empty());
    }
}
