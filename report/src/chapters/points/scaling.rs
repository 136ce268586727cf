//! Seconds against the number of points, and of classes.

use super::Sets;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::{Estimate, student};
use anyhow::Result;

pub(super) fn write(sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Seconds against points", "");
    let mut rows = Vec::new();
    let mut fits = Vec::new();
    for classes in sets.distinct(&[("sampler", "optimised")], "classes")? {
        let mut points = Vec::new();
        for study in ["scaling", "million"] {
            let counts = sets.distinct(&[("study", study), ("classes", &classes)], "points")?;
            let all = counts.iter().filter_map(|count| Some((count, count.parse::<f64>().ok()?)));
            for (count, number) in all {
                let of = |part| [("study", study), ("classes", &classes), ("points", count), ("part", part)];
                let seconds = sets.mean(&of("all"), "seconds")?;
                let steps = sets.distinct(&of("all"), "steps")?.concat();
                let cell = |part, column| -> Result<Cell> {
                    Ok(sets.mean(&of(part), column)?.map(|mean| Figure::brief(mean, Unit::Number)).into())
                };
                rows.push(row![
                    classes.as_str(),
                    count.as_str(),
                    steps,
                    seconds.map(|seconds| Figure::new(seconds, Unit::Seconds)),
                    seconds.map(|seconds| Figure::exact(1e6 * seconds.value / number, Unit::Number)),
                    cell("all", "neighbour")?,
                    cell("colour", "neighbour")?,
                ]);
                if let Some(seconds) = seconds.filter(|_| study == "scaling") {
                    points.push((number, seconds.value));
                }
            }
        }
        if points.len() > 2 {
            fits.push((classes.clone(), slope(&points), points.len()));
        }
    }
    let columns = [
        "classes",
        "points",
        "steps",
        "seconds",
        "microseconds per point",
        "nearest neighbour",
        "colour: nearest neighbour",
    ];
    chapter.table("scaling", &columns, 0, rows);
    let rows = fits
        .into_iter()
        .map(|(classes, slope, sizes)| row![classes, sizes.to_string(), Figure::new(slope, Unit::Ratio)]);
    chapter.table("exponents", &["classes", "sizes", "exponent"], 0, rows.collect());
    Ok(())
}

/// The slope of the logarithms, and its interval.
fn slope(points: &[(f64, f64)]) -> Estimate {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|log| log.0), mean(|log| log.1));
    let spread: f64 = logs.iter().map(|log| (log.0 - x).powi(2)).sum();
    let value = logs.iter().map(|log| (log.0 - x) * (log.1 - y)).sum::<f64>() / spread;
    let residuals: f64 = logs.iter().map(|log| (log.1 - y - value * (log.0 - x)).powi(2)).sum();
    let half = student(count - 2.0) * (residuals / (count - 2.0) / spread).sqrt();
    Estimate { value, low: value - half, high: value + half, seeds: logs.len() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_is_found() {
        let exact = slope(&[(1.0, 2.0), (10.0, 2.0 * 10f64.powf(1.2)), (100.0, 2.0 * 100f64.powf(1.2))]);
        assert!((exact.value - 1.2).abs() < 1e-12 && exact.high - exact.low < 1e-9);
        let noisy = slope(&[(1.0, 1.0), (10.0, 12.0), (100.0, 95.0), (1000.0, 1010.0)]);
        assert!(noisy.low < 1.0 && noisy.high > 1.0 && noisy.high - noisy.low < 0.3);
    }
}
