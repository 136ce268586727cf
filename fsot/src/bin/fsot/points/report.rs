//! What `fsot points` prints of what it made.

use super::classes::Classes;
use crate::drive::Run;
use fsot::error::Result;
use fsot::export::points::Table;
use fsot::metrics::text::PrefixTable;
use fsot::metrics::{self, PointReport};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// The integration error of more points than this is not measured: it would take longer than their optimisation.
const INTEGRATED: usize = 16_384;
/// Rows of a table of classes or prefixes.
const ROWS: usize = 16;
/// Integrands of each family for the errors of prefixes.
const INTEGRANDS: usize = 256;

pub(super) fn report(out: &Path, table: &Table, classes: &Classes, run: &Run) -> Result<(String, Value)> {
    let mut text = format!("{}\n", out.display());
    let mut json = json!({ "out": out.to_string_lossy(), "run": run.json() });
    run.describe(&mut text);
    // The metrics compare with the uniform distribution.
    let points = &table.points;
    if classes.all_uniform() {
        let whole = if points.len() > INTEGRATED { metrics::quick(points)? } else { metrics::measure(points)? };
        text.push_str(&whole.to_string());
        json["quality"] = json!(whole);
    }
    let mut rows = Vec::new();
    for (name, class) in classes.parts().take(ROWS) {
        rows.push((name, metrics::quick(&metrics::select(points, |i| classes.holds(class, i)))?));
    }
    if !rows.is_empty() {
        parts(&mut text, &rows);
        let rows = rows.iter().map(|(name, report)| json!({ "class": name, "report": report }));
        json["classes"] = rows.collect();
    }
    let prefixes = classes.prefixes();
    if !prefixes.is_empty() {
        // Between prefixes the error is larger. The last is among them.
        let every = prefixes.len().div_ceil(ROWS);
        let counts: Vec<usize> = prefixes.iter().copied().skip((prefixes.len() - 1) % every).step_by(every).collect();
        let errors = metrics::prefix_errors(std::slice::from_ref(points), &counts, INTEGRANDS)?;
        write!(text, "  errors of the first points\n{}", PrefixTable(&errors)).ok();
        json["prefixes"] = json!(errors);
    }
    Ok((text, json))
}

fn parts(text: &mut String, rows: &[(&str, PointReport)]) {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.4}"));
    writeln!(text, "  {:<16}{:>10}{:>10}{:>10}{:>12}", "class", "points", "P_low", "NN", "SW2 e3").ok();
    for (name, report) in rows {
        let low = report.spectra.first().map(|spectrum| spectrum.summary.low);
        let neighbours = report.neighbours.as_ref().map(|neighbours| neighbours.mean);
        let transport = 1e3 * report.transport.sliced_w2;
        let [low, neighbours, transport] = [low, neighbours, Some(transport)].map(number);
        writeln!(text, "  {name:<16}{:>10}{low:>10}{neighbours:>10}{transport:>12}", report.points).ok();
    }
}
