//! What `f32` accumulation costs in error and saves in time.

use crate::chapters::chapter::{Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::measure::table::{Row, Table};
use anyhow::Result;

pub(super) fn write(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("f32 against f64", "");
    let mut rows = Vec::new();
    for method in ["robust", "least squares"] {
        for degree in ["2", "3"] {
            let of = |name: &str| -> Result<Vec<Row<'_>>> {
                let mut found = Vec::new();
                for row in table.rows() {
                    if row.word("method")? == name && row.word("degree")? == degree {
                        found.push(row);
                    }
                }
                Ok(found)
            };
            let (narrow, wide) = (of(&format!("{method} f32"))?, of(method)?);
            let mut ratios: Vec<(f64, String)> = Vec::new();
            let mut largest = (0.0, String::new());
            let mut times = Vec::new();
            for (narrow, wide) in narrow.iter().zip(&wide) {
                let place = format!("{}, n = {}", narrow.word("integrand")?, narrow.word("n")?);
                let ratio: f64 = narrow.number("rmse_to_f64")?;
                if ratio.is_finite() && ratio > 0.0 {
                    ratios.push((ratio, place.clone()));
                }
                let difference: f64 = narrow.number("difference_from_f64")?;
                if difference > largest.0 {
                    largest = (difference, place);
                }
                times.push(narrow.number::<f64>("ns_per_sample")? / wide.number::<f64>("ns_per_sample")?);
            }
            let mean = |values: &mut dyn Iterator<Item = f64>, count: usize| {
                (values.map(f64::ln).sum::<f64>() / count as f64).exp()
            };
            let Some(worst) = ratios.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            let ratio = |value: f64| Figure::exact(value, Unit::Ratio);
            rows.push(row![
                method,
                degree,
                ratio(mean(&mut ratios.iter().map(|(ratio, _)| *ratio), ratios.len())),
                ratio(worst.0),
                worst.1.clone(),
                Figure::exact(largest.0, Unit::Error),
                largest.1,
                ratio(mean(&mut times.iter().copied(), times.len())),
                ratio(times.iter().copied().fold(0.0, f64::max)),
            ]);
        }
    }
    let columns = [
        "estimator",
        "order",
        "RMSE over f64's",
        "worst",
        "where",
        "difference",
        "where ",
        "time over f64's",
        "largest",
    ];
    chapter.table("f32 against f64", &columns.map(str::trim), 1, rows);
    Ok(())
}
