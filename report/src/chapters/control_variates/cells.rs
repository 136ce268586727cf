//! The grid: every estimator, basis, order, integrand and sample count.

use crate::chapters::statistics::Estimate;
use crate::measure::table::{Row, Table};
use anyhow::Result;

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
    pub(super) fn read(row: Row) -> Result<Self> {
        let (estimator, basis) = (row.word("estimator")?.to_owned(), row.word("basis")?.to_owned());
        Ok(Self { estimator, basis, order: row.number("order")? })
    }

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
            integrand: row.word("integrand")?.to_owned(),
            dims: row.number("dims")?,
            n: row.number("n")?,
            setting: Setting::read(row)?,
            ratio: row.ratio("ratio")?,
            ns: row.number("ns")?,
            mean_ns: row.number("mean_ns")?,
        })
    }

    /// Efficiency over MC's if a sample costs so many nanoseconds.
    fn gain(&self, cost: f64) -> f64 {
        (self.mean_ns + cost) / (self.ns + cost) / self.ratio.value.max(LEAST).powi(2)
    }
}

/// A setting over several integrands.
pub(super) struct Summary {
    pub(super) setting: Setting,
    /// Geometric means.
    pub(super) ratio: Estimate,
    pub(super) ns: f64,
    /// For free samples, and for those of a microsecond.
    pub(super) gains: [f64; 2],
    pub(super) worst: Estimate,
    /// The largest of the lower and of the upper ends of the integrands' intervals.
    pub(super) ends: [f64; 2],
    /// Its integrand.
    pub(super) place: String,
}

impl Summary {
    /// None for no cells.
    fn new(setting: &Setting, cells: &[&Cell]) -> Option<Self> {
        let worst = cells.iter().max_by(|a, b| a.ratio.value.total_cmp(&b.ratio.value))?;
        let count = cells.len() as f64;
        let largest = |end: &dyn Fn(&Estimate) -> f64| cells.iter().map(|cell| end(&cell.ratio)).fold(0.0, f64::max);
        let mean = |of: &dyn Fn(&Cell) -> f64| (cells.iter().map(|cell| of(cell).ln()).sum::<f64>() / count).exp();
        Some(Self {
            setting: setting.clone(),
            ratio: geometric_mean(cells),
            ns: mean(&|cell| cell.ns),
            gains: [0.0, MICROSECOND].map(|cost| mean(&|cell| cell.gain(cost))),
            worst: worst.ratio,
            ends: [largest(&|ratio| ratio.low), largest(&|ratio| ratio.high)],
            place: worst.integrand.clone(),
        })
    }
}

/// The geometric mean of the ratios of independent cells. Each side of the logarithms' intervals is combined by itself,
/// in squares: the cells' need not be symmetric, as ratios below [`LEAST`] count as it.
fn geometric_mean(cells: &[&Cell]) -> Estimate {
    let count = cells.len() as f64;
    let logarithm = |ratio: f64| ratio.max(LEAST).ln();
    let value = cells.iter().map(|cell| logarithm(cell.ratio.value)).sum::<f64>() / count;
    let side = |end: fn(&Estimate) -> f64| {
        let squares = cells.iter().map(|cell| (logarithm(end(&cell.ratio)) - logarithm(cell.ratio.value)).powi(2));
        squares.sum::<f64>().sqrt() / count
    };
    let [low, high] = [value - side(|ratio| ratio.low), value + side(|ratio| ratio.high)].map(f64::exp);
    let seeds = cells.iter().map(|cell| cell.ratio.seeds).min().unwrap_or(0);
    Estimate { value: value.exp(), low, high, seeds }
}

const MICROSECOND: f64 = 1000.0;

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
        let mut counts: Vec<usize> = all.iter().map(|cell| cell.n).collect();
        counts.sort_unstable();
        counts.dedup();
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
    pub(super) fn summaries(&self, dims: impl Fn(usize) -> bool, n: usize) -> Vec<Summary> {
        let here: Vec<&Cell> = self.all.iter().filter(|cell| cell.n == n && dims(cell.dims)).collect();
        let integrands = here.iter().filter(|cell| cell.setting.estimator == MEAN).count();
        let mut settings: Vec<&Setting> = here.iter().map(|cell| &cell.setting).collect();
        settings.sort();
        settings.dedup();
        let of = |setting| here.iter().copied().filter(|cell| &cell.setting == setting).collect();
        let complete = settings.into_iter().map(|setting| (setting, of(setting)));
        let complete = complete.filter(|(_, cells): &(_, Vec<&Cell>)| cells.len() == integrands);
        complete.filter_map(|(setting, cells)| Summary::new(setting, &cells)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(in super::super) fn cell(value: f64, above: f64) -> Cell {
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

    #[test]
    fn intervals_of_means_are_positive_and_those_of_logarithms() {
        // Three of four are exact: the interval is a fourth of the one's in logarithms.
        let cells = [cell(0.5, 0.0), cell(0.5, 0.0), cell(0.5, 0.0), cell(0.5, 0.5)];
        let mean = geometric_mean(&cells.each_ref());
        assert!((mean.high - 0.5 * 2f64.powf(0.25)).abs() < 1e-12 && (mean.low - 0.5 / 2f64.powf(0.25)).abs() < 1e-12);
        // A ratio of a thousandth that may be a tenth: the mean is of what counts, .01, and nothing is below that.
        let mean = geometric_mean(&[&cell(0.001, 0.099), &cell(0.01, 0.0)]);
        assert!((mean.value - 0.01).abs() < 1e-12 && (mean.low - 0.01).abs() < 1e-12, "{mean:?}");
        assert!((mean.high - 0.01 * 10f64.sqrt()).abs() < 1e-9, "{mean:?}");
        // Wide, as few repetitions are.
        let mean = geometric_mean(&[&cell(2.231, 4.18), &cell(0.002, 0.5), &cell(0.1, 0.9)]);
        assert!(0.0 < mean.low && mean.low < mean.value && mean.value < mean.high, "{mean:?}");
        // Where one knows nothing, nothing is known of all.
        assert!(!geometric_mean(&[&cell(0.5, f64::INFINITY), &cell(0.5, 0.1)]).has_interval());
    }

    #[test]
    fn the_lower_end_of_a_cell_is_of_its_logarithm() -> Result<()> {
        let text = "ratio,half_width,repetitions\n2.231,4.18,27\n";
        let table = Table::parse(text, "grid.csv", ',')?;
        let ratio = table.rows().next().expect("a row").ratio("ratio")?;
        assert!((ratio.low - 2.231 * 2.231 / 6.411).abs() < 1e-9, "{ratio:?}");
        Ok(())
    }
}
