//! The grid: every estimator, basis, order, integrand and sample count.

use crate::measure::table::{Row, Table};
use crate::report::statistics::Estimate;
use anyhow::Result;
use std::fmt::Write;

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
pub(super) const ESTIMATORS: [&str; 6] =
    [DEFAULT, "least squares", "leave-one-out", "4-fold", "gradient descent", "incremental"];
pub(super) const BASES: [&str; 4] = ["legendre", "step", "sine", "gaussian"];

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
    /// Per second and squared unit, samples for free.
    efficiency: String,
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
            ratio: ratio(row)?,
            ns: row.number("ns")?,
            mean_ns: row.number("mean_ns")?,
            efficiency: row.word("efficiency")?.to_owned(),
        })
    }

    /// Efficiency over MC's if a sample costs so many nanoseconds.
    fn gain(&self, cost: f64) -> f64 {
        (self.mean_ns + cost) / (self.ns + cost) / self.ratio.value.max(LEAST).powi(2)
    }
}

/// The ratio of a row that has one, with its interval.
pub(super) fn ratio(row: Row) -> Result<Estimate> {
    let (value, half): (f64, f64) = (row.number("ratio")?, row.number("half_width")?);
    Ok(Estimate { value, low: (value - half).max(0.0), high: value + half, seeds: row.number("repetitions")? })
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
    /// Its integrand.
    pub(super) place: String,
}

impl Summary {
    /// None for no cells.
    pub(super) fn new(setting: &Setting, cells: &[&Cell]) -> Option<Self> {
        let worst = cells.iter().max_by(|a, b| a.ratio.value.total_cmp(&b.ratio.value))?;
        let count = cells.len() as f64;
        let mean = |of: &dyn Fn(&Cell) -> f64| (cells.iter().map(|cell| of(cell).ln()).sum::<f64>() / count).exp();
        let value = mean(&|cell| cell.ratio.value.max(LEAST));
        let spread = |cell: &&Cell| ((cell.ratio.high - cell.ratio.value) / cell.ratio.value.max(LEAST)).powi(2);
        let half = value * cells.iter().map(spread).sum::<f64>().sqrt() / count;
        Some(Self {
            setting: setting.clone(),
            ratio: Estimate { value, low: value - half, high: value + half, seeds: cells.len() },
            ns: mean(&|cell| cell.ns),
            gains: [0.0, MICROSECOND].map(|cost| mean(&|cell| cell.gain(cost))),
            worst: worst.ratio,
            place: worst.integrand.clone(),
        })
    }
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
        let of = |setting: &Setting| -> Vec<&Cell> {
            here.iter().copied().filter(|cell| &cell.setting == setting).collect()
        };
        let complete = settings.into_iter().map(|setting| (setting, of(setting)));
        complete
            .filter(|(_, cells)| cells.len() == integrands)
            .filter_map(|(setting, cells)| Summary::new(setting, &cells))
            .collect()
    }

    /// Every cell, for other programs.
    pub(super) fn csv(&self) -> String {
        let mut out = "integrand,dims,n,estimator,basis,order,ratio,half_width,ns,efficiency\n".to_owned();
        for cell in &self.all {
            let Cell {
                integrand, dims, n, setting: Setting { estimator, basis, order }, ratio, ns, efficiency, ..
            } = cell;
            let half = ratio.high - ratio.value;
            let _ = write!(out, "{integrand},{dims},{n},{estimator},{basis},{order},");
            let _ = writeln!(out, "{:.3e},{half:.1e},{ns:.0},{efficiency}", ratio.value);
        }
        out
    }
}
