//! What was measured, as a table.

use noisefloor_tests::statistics::Ratio;
use std::fmt::Write;

/// A case of many repetitions.
pub(crate) struct ErrorRow {
    pub(crate) group: &'static str,
    pub(crate) case: String,
    pub(crate) n: usize,
    pub(crate) terms: usize,
    pub(crate) repetitions: usize,
    /// Calls that were refused or whose estimate was not finite.
    pub(crate) failed: usize,
    /// The plain estimator's root mean square error.
    pub(crate) plain_rmse: f64,
    /// RMSE over the plain estimator's, in the order of the group's columns; None where some estimates failed.
    pub(crate) ratios: Vec<(&'static str, Option<Ratio>)>,
}

/// A row for each estimator.
pub(crate) fn csv(rows: &[ErrorRow]) -> String {
    let mut out = "group;case;n;terms;repetitions;failed;plain_rmse;estimator;ratio;half_width\n".to_owned();
    for row in rows {
        for (estimator, ratio) in &row.ratios {
            let _ = write!(out, "{};{};{};{};", row.group, row.case, row.n, row.terms);
            let _ = write!(out, "{};{};{:e};{estimator};", row.repetitions, row.failed, row.plain_rmse);
            let _ = match ratio {
                Some(ratio) => writeln!(out, "{:.5e};{:.3e}", ratio.value, ratio.half_width),
                None => writeln!(out, ";"),
            };
        }
    }
    out
}
