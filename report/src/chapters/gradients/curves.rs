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
