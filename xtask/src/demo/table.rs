//! The table of results, as Markdown and as CSV.

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

/// A Markdown table that is also aligned as plain text.
pub(crate) fn markdown(rows: &[Row]) -> String {
    let body: Vec<_> = rows.iter().map(cells).collect();
    let widths: [usize; 11] = std::array::from_fn(|column| {
        body.iter().map(|cells| cells[column].len()).chain([HEADINGS[column].len()]).max().unwrap_or(0)
    });
    let line = |cells: &[String; 11]| {
        let padded = cells.iter().zip(widths).enumerate().map(|(column, (cell, width))| {
            if WORDS.contains(&column) { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        format!("| {} |\n", padded.collect::<Vec<_>>().join(" | "))
    };
    let mut text = line(&HEADINGS.map(str::to_owned));
    let rule = widths
        .iter()
        .enumerate()
        .map(|(column, &width)| if WORDS.contains(&column) { "-".repeat(width) } else { "-".repeat(width - 1) + ":" });
    text += &format!("| {} |\n", rule.collect::<Vec<_>>().join(" | "));
    text.extend(body.iter().map(line));
    text
}

/// No cell contains a comma or a quote.
pub(crate) fn csv(rows: &[Row]) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    text.extend(rows.iter().map(|row| cells(row).join(",") + "\n"));
    text
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
        let markdown = markdown(&rows);
        assert_eq!(markdown.lines().count(), 3);
        assert!(markdown.lines().all(|line| line.len() == markdown.lines().next().map_or(0, str::len)));
        assert_eq!(csv(&rows).lines().nth(1), Some("direct,16,mc,-,1.000e-2,1.000,200.0,3.0,1.000,16,1.000"));
    }
}
