//! A second look at what the first leaves open: whether a setting keeps close to the plain mean on every integrand.

use crate::functions::Function;
use crate::grid::Row;
use crate::race::{Effort, Setting, measure};
use std::collections::HashSet;

/// The report calls a setting safe whose error is at most so many times the plain mean's on every integrand of a family
/// (`SAFE` in report/src/chapters/control_variates/frontier.rs).
const SAFE: f64 = 1.05;
/// Of the first look's repetitions.
pub(crate) const TIMES: usize = 8;

/// The report's families: 1, 2, 3 to 5 and more dims.
fn family(dims: usize) -> usize {
    [1, 2, 5].iter().filter(|&&most| dims > most).count()
}

/// A setting of a family at a sample count.
fn key(row: &Row) -> (usize, usize, &'static str, String, usize) {
    let Setting { method, order } = row.result.setting;
    (family(row.dims), row.n, method.name, format!("{:?}", method.basis), order)
}

/// Rows whose interval holds the bound, of settings that no other integrand of the family rules out.
pub(crate) fn open(rows: &[Row]) -> Vec<usize> {
    let unsafe_ones: HashSet<_> = rows.iter().filter(|row| row.result.ratio.lower() > SAFE).map(key).collect();
    let is_open = |row: &Row| row.result.ratio.upper() > SAFE && !unsafe_ones.contains(&key(row));
    (0..rows.len()).filter(|&index| is_open(&rows[index])).collect()
}

/// Measures these rows, of one function and sample count, on other samples, whose errors replace the first ones:
/// pooled, a first figure that was chosen for being near the bound would still count. Times stay those of all settings
/// in turns.
pub(crate) fn measure_again(rows: &mut [Row], open: &[usize], function: &Function, seed: u64, effort: Effort) {
    let settings: Vec<Setting> = open.iter().map(|&index| rows[index].result.setting).collect();
    let results = measure(function, &settings, rows[open[0]].n, seed, effort);
    // The plain mean comes first.
    for (&index, again) in open.iter().zip(&results[1..]) {
        let result = &mut rows[index].result;
        (result.ratio, result.repetitions) = (again.ratio, again.repetitions);
    }
}
