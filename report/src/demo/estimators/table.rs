//! The table of results, as Markdown and as CSV.

use crate::measure::markdown;

/// One estimator in one scene at one number of samples per pixel.
pub(crate) struct Row {
    pub(crate) scene: &'static str,
    pub(crate) estimator: String,
    pub(crate) order: u32,
    pub(crate) spp: u32,
    pub(crate) rel_mse: f64,
    /// relMSE over the plain mean's, from the same samples.
    pub(crate) ratio: f64,
    /// Time per sample, in nanoseconds: making it, and estimating from it.
    pub(crate) sampling_ns: f64,
    pub(crate) estimating_ns: f64,
    /// Total time over the plain mean's.
    pub(crate) time_ratio: f64,
    /// Samples per pixel that the plain mean makes in this estimator's time.
    pub(crate) equal_time_spp: u32,
    /// relMSE over that of the plain mean with that many samples.
    pub(crate) equal_time_ratio: f64,
}

const HEADINGS: [&str; 11] = [
    "scene",
    "spp",
    "estimator",
    "order",
    "relMSE",
    "ratio to mc, same samples",
    "sampling ns",
    "estimating ns",
    "time ratio to mc",
    "mc spp in that time",
    "ratio to mc, same time",
];

const COLUMNS: [&str; 11] = [
    "scene",
    "spp",
    "estimator",
    "order",
    "rel_mse",
    "ratio_same_samples",
    "sampling_ns_per_sample",
    "estimating_ns_per_sample",
    "time_ratio",
    "mc_spp_same_time",
    "ratio_same_time",
];

/// Columns of words are aligned left, columns of numbers right.
const WORDS: [usize; 2] = [0, 2];

fn cells(row: &Row) -> [String; 11] {
    let order = if row.estimator == super::plan::BASELINE { "-".to_owned() } else { row.order.to_string() };
    [
        row.scene.to_owned(),
        row.spp.to_string(),
        row.estimator.clone(),
        order,
        format!("{:.3e}", row.rel_mse),
        format!("{:.3}", row.ratio),
        format!("{:.1}", row.sampling_ns),
        format!("{:.1}", row.estimating_ns),
        format!("{:.3}", row.time_ratio),
        row.equal_time_spp.to_string(),
        format!("{:.3}", row.equal_time_ratio),
    ]
}

pub(crate) fn markdown(rows: &[Row]) -> String {
    markdown::table(&HEADINGS, &WORDS, rows.iter().map(cells))
}

pub(crate) fn csv(rows: &[Row]) -> String {
    markdown::csv(&COLUMNS, rows.iter().map(cells))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_one_line_per_row() {
        let row = Row {
            scene: "direct",
            estimator: "mc".to_owned(),
            order: 2,
            spp: 16,
            rel_mse: 0.01,
            ratio: 1.0,
            sampling_ns: 200.0,
            estimating_ns: 3.0,
            time_ratio: 1.0,
            equal_time_spp: 16,
            equal_time_ratio: 1.0,
        };
        let rows = [row];
        assert_eq!(markdown(&rows).lines().count(), 3);
        assert_eq!(csv(&rows).lines().nth(1), Some("direct,16,mc,-,1.000e-2,1.000,200.0,3.0,1.000,16,1.000"));
    }
}
