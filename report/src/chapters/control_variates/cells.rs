//! The grid: every estimator, basis, order, integrand and sample count.

use crate::chapters::statistics::Estimate;
use crate::measure::table::{Row, Table};
use anyhow::Result;
use itertools::Itertools;

/// What an estimate is made with.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Setting {
    pub(super) estimator: String,
    pub(super) basis: String,
    pub(super) order: usize,
}

/// The plain mean.
pub(super) const MEAN: &str = "mean";
/// The library's default.
pub(super) const DEFAULT: &str = "robust";

impl Setting {
    pub(super) fn name(&self) -> String {
        let Self { estimator, basis, order } = self;
        match (estimator.as_str(), basis.as_str()) {
            (MEAN, _) => "MC".to_owned(),
            (_, "legendre") => format!("{estimator}, order {order}"),
            _ => format!("{estimator}, {basis}, order {order}"),
        }
    }
}

/// One integrand at one sample count by one setting.
#[derive(Clone)]
pub(super) struct Cell {
    pub(super) integrand: String,
    pub(super) dims: usize,
    pub(super) n: usize,
    pub(super) setting: Setting,
    pub(super) ratio: Estimate,
    pub(super) ns: f64,
    pub(super) mean_ns: f64,
}

/// Ratios below it count as it in means: a polynomial that is integrated exactly would otherwise decide.
const LEAST: f64 = 0.01;

impl Cell {
    fn new(row: Row) -> Result<Self> {
        Ok(Self {
            integrand: row.number("integrand")?,
            dims: row.number("dims")?,
            n: row.number("n")?,
            setting: Setting {
                estimator: row.number("estimator")?,
                basis: row.number("basis")?,
                order: row.number("order")?,
            },
            ratio: row.ratio("ratio")?,
            ns: row.number("ns")?,
            mean_ns: row.number("mean_ns")?,
        })
    }
}

/// A setting over several integrands; their cells are independent.
pub(super) struct Summary<'a> {
    pub(super) setting: &'a Setting,
    pub(super) cells: Vec<&'a Cell>,
}

impl Summary<'_> {
    /// The geometric mean of the ratios. Each side of the logarithms' intervals is combined by itself, in squares: the
    /// cells' need not be symmetric, as ratios below [`LEAST`] count as it.
    pub(super) fn ratio(&self) -> Estimate {
        let count = self.cells.len() as f64;
        let logarithm = |ratio: f64| ratio.max(LEAST).ln();
        let value = self.cells.iter().map(|cell| logarithm(cell.ratio.value)).sum::<f64>() / count;
        let side = |end: fn(&Estimate) -> f64| {
            let distance = |cell: &&Cell| logarithm(end(&cell.ratio)) - logarithm(cell.ratio.value);
            self.cells.iter().map(|cell| distance(cell).powi(2)).sum::<f64>().sqrt() / count
        };
        let [low, high] = [value - side(|ratio| ratio.low), value + side(|ratio| ratio.high)].map(f64::exp);
        let seeds = self.cells.iter().map(|cell| cell.ratio.seeds).min().unwrap_or(0);
        Estimate { value: value.exp(), low, high, seeds }
    }

    pub(super) fn ns(&self) -> f64 {
        self.mean(|cell| cell.ns)
    }

    /// Efficiency over MC's if a sample costs so many nanoseconds.
    pub(super) fn gain(&self, cost: f64) -> f64 {
        self.mean(|cell| (cell.mean_ns + cost) / (cell.ns + cost) / cell.ratio.value.max(LEAST).powi(2))
    }

    /// The geometric one.
    fn mean(&self, of: impl Fn(&Cell) -> f64) -> f64 {
        (self.cells.iter().map(|cell| of(cell).ln()).sum::<f64>() / self.cells.len() as f64).exp()
    }

    /// The integrand of the largest ratio.
    pub(super) fn worst(&self) -> &Cell {
        self.cells.iter().max_by(|a, b| a.ratio.value.total_cmp(&b.ratio.value)).unwrap_or(&self.cells[0])
    }

    /// Whether no integrand's error is larger than `limit`. None: the intervals do not decide.
    pub(super) fn is_within(&self, limit: f64) -> Option<bool> {
        let is_below = self.cells.iter().all(|cell| cell.ratio.high <= limit);
        let is_above = self.cells.iter().any(|cell| cell.ratio.low > limit);
        (is_below || is_above).then_some(is_below)
    }
}

/// The whole grid.
pub(super) struct Cells {
    pub(super) all: Vec<Cell>,
    pub(super) counts: Vec<usize>,
    /// (dims, n, order): what the library recommends; order 0 is the mean.
    recommended: Vec<[usize; 3]>,
}

impl Cells {
    pub(super) fn new(grid: &Table, recommended: &Table) -> Result<Self> {
        let all = grid.rows().map(Cell::new).collect::<Result<Vec<_>>>()?;
        let counts = all.iter().map(|cell| cell.n).sorted().dedup().collect();
        let order = |row: Row| Ok([row.number::<usize>("dims")?, row.number("n")?, row.number("order")?]);
        Ok(Self { all, counts, recommended: recommended.rows().map(order).collect::<Result<_>>()? })
    }

    /// The library's advice for independent samples of one pixel.
    pub(super) fn recommended(&self, dims: usize, n: usize) -> Setting {
        let found = self.recommended.iter().find(|[d, count, _]| (*d, *count) == (dims, n));
        let order = found.map_or(0, |[.., order]| *order);
        let estimator = if order == 0 { MEAN } else { DEFAULT };
        Setting { estimator: estimator.to_owned(), basis: "legendre".to_owned(), order }
    }

    /// Every setting that has a cell for each of the integrands of these dims.
    pub(super) fn summaries(&self, dims: impl Fn(usize) -> bool, n: usize) -> Vec<Summary<'_>> {
        let here = || self.all.iter().filter(|cell| cell.n == n && dims(cell.dims));
        let integrands = here().filter(|cell| cell.setting.estimator == MEAN).count();
        let settings = here().map(|cell| &cell.setting).sorted().dedup();
        let of = |setting| Summary { setting, cells: here().filter(|cell| cell.setting == *setting).collect() };
        settings.map(of).filter(|summary| summary.cells.len() == integrands).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(value: f64, above: f64) -> Cell {
        Cell {
            integrand: format!("f{value}"),
            dims: 2,
            n: 16,
            setting: Setting { estimator: DEFAULT.to_owned(), basis: "legendre".to_owned(), order: 2 },
            ratio: Estimate::of_logarithm(value, above, 27),
            ns: 20.0,
            mean_ns: 5.0,
        }
    }

    fn geometric_mean(cells: &[Cell]) -> Estimate {
        Summary { setting: &cells[0].setting, cells: cells.iter().collect() }.ratio()
    }

    #[test]
    fn what_intervals_do_not_decide_is_not_safe() {
        let of = |low: f64, high: f64| {
            let cell = Cell { ratio: Estimate { value: low, low, high, seeds: 27 }, ..cell(low, 0.0) };
            Summary { setting: &cell.setting, cells: vec![&cell] }.is_within(1.05)
        };
        assert_eq!(of(0.9, 1.05), Some(true));
        assert_eq!(of(0.715, 1.349), None);
        assert_eq!(of(0.9, f64::INFINITY), None);
        assert_eq!(of(1.06, 1.2), Some(false));
    }

    #[test]
    fn intervals_of_means_are_positive_and_those_of_logarithms() {
        // Three of four are exact: the interval is a fourth of the one's in logarithms.
        let cells = [cell(0.5, 0.0), cell(0.5, 0.0), cell(0.5, 0.0), cell(0.5, 0.5)];
        let mean = geometric_mean(&cells);
        assert!((mean.high - 0.5 * 2f64.powf(0.25)).abs() < 1e-12 && (mean.low - 0.5 / 2f64.powf(0.25)).abs() < 1e-12);
        // A ratio of a thousandth that may be a tenth: the mean is of what counts, .01, and nothing is below that.
        let mean = geometric_mean(&[cell(0.001, 0.099), cell(0.01, 0.0)]);
        assert!((mean.value - 0.01).abs() < 1e-12 && (mean.low - 0.01).abs() < 1e-12, "{mean:?}");
        assert!((mean.high - 0.01 * 10f64.sqrt()).abs() < 1e-9, "{mean:?}");
        // Wide, as few repetitions are.
        let mean = geometric_mean(&[cell(2.231, 4.18), cell(0.002, 0.5), cell(0.1, 0.9)]);
        assert!(0.0 < mean.low && mean.low < mean.value && mean.value < mean.high, "{mean:?}");
        // Where one knows nothing, nothing is known of all.
        assert!(!geometric_mean(&[cell(0.5, f64::INFINITY), cell(0.5, 0.1)]).has_interval());
    }

    #[test]
    fn the_lower_end_of_a_cell_is_of_its_logarithm() -> Result<()> {
        let text = "ratio,half_width,repetitions\n2.231,4.18,27\n";
        let table = Table::parse(text, "grid.csv")?;
        let ratio = table.rows().next().expect("a row").ratio("ratio")?;
        assert!((ratio.low - 2.231 * 2.231 / 6.411).abs() < 1e-9, "{ratio:?}");
        Ok(())
    }
}
