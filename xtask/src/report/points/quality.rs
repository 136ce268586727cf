//! What the points are worth, by number of points and by seconds.

use super::Sets;
use crate::measure::output::Output;
use crate::measure::plot::{Axis, Plot, Series};
use crate::report::chapter::{Cell, Chapter, row};
use crate::report::figure::{Figure, Unit};
use crate::report::statistics::Estimate;
use crate::report::targets::Targets;
use anyhow::Result;

/// Study, sampler and name of what is compared.
const COMPARED: [(&str, &str, &str); 5] = [
    ("scaling", "optimised", "draft"),
    ("standard", "optimised", "standard"),
    ("million", "optimised", "few steps"),
    ("peer", "Owen-Sobol", "Owen-Sobol"),
    ("peer", "random", "random"),
];

/// A mean over the random points' mean of the same size, whose own noise is not in the interval.
fn relative(sets: &Sets, wanted: &[(&str, &str)], points: &str, column: &str) -> Result<Option<Estimate>> {
    let random = [("study", "peer"), ("sampler", "random"), ("points", points)];
    let (Some(own), Some(random)) = (sets.mean(wanted, column)?, sets.mean(&random, column)?) else { return Ok(None) };
    let over = |value: f64| value / random.value;
    Ok(Some(Estimate { value: over(own.value), low: over(own.low), high: over(own.high), seeds: own.seeds }))
}

pub(super) fn write(output: &Output, sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Quality against points", "");
    chapter.paragraph(
        "One class. Root mean square errors and L2 star discrepancy over those of the random points below; W2 and its bound in thousandths, so that \
         they can be compared.",
    );
    let mut rows = Vec::new();
    let mut series = Vec::new();
    let mut sizes = sets.distinct(&[("study", "peer")], "points")?;
    sizes.sort_by_key(|size| size.parse::<u64>().unwrap_or(0));
    for (study, sampler, name) in COMPARED {
        let mut points = Vec::new();
        for size in &sizes {
            let wanted = [("study", study), ("sampler", sampler), ("classes", "1"), ("points", size.as_str())];
            let cell = |column, unit| -> Result<Cell> {
                Ok(relative(sets, &wanted, size, column)?.map(|of| Figure::brief(of, unit)).into())
            };
            let thousandths = |column| -> Result<Cell> {
                let of = sets.mean(&wanted, column)?.map(|of| Figure::exact(1e3 * of.value, Unit::Number));
                Ok(of.into())
            };
            let Some(error) = sets.mean(&wanted, "gaussians")? else { continue };
            points.push((size.parse()?, error.value));
            rows.push(row![
                name,
                size.as_str(),
                cell("half_planes", Unit::Number)?,
                cell("gaussians", Unit::Number)?,
                cell("discrepancy", Unit::Number)?,
                thousandths("w2")?,
                thousandths("bound")?,
                sets.mean(&wanted, "neighbour")?.map(|of| Figure::brief(of, Unit::Number)),
            ]);
        }
        series.push(Series { name: name.to_owned(), points, ..Series::default() });
    }
    chapter.setting("exponent of the discrepancy's norm", 2);
    let columns =
        ["points are", "points", "half-planes", "Gaussians", "L2 star", "W2", "W2's bound", "nearest neighbour"];
    chapter.table("quality", &columns, 1, rows);
    output.write_text("points-quality.svg", &plot("points", &series)?)?;
    chapter.picture("points-quality.svg", "error of Gaussian bumps against points");
    Ok(())
}

/// The same size, longer and longer.
pub(super) fn steps(output: &Output, sets: &Sets, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Quality against seconds", "");
    chapter.paragraph(
        "More steps, one class. A step is sixteen slices. Errors are over those of random points; the discrepancy rises again where points \
         begin to crystallise.",
    );
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for points in sets.distinct(&[("study", "steps")], "points")? {
        let mut line = Vec::new();
        for steps in sets.distinct(&[("study", "steps"), ("points", &points)], "steps")? {
            let wanted = [("study", "steps"), ("points", points.as_str()), ("steps", steps.as_str())];
            let cell = |column| -> Result<Cell> {
                Ok(relative(sets, &wanted, &points, column)?.map(|of| Figure::brief(of, Unit::Number)).into())
            };
            let seconds = sets.mean(&wanted, "seconds")?;
            if let (Some(seconds), Some(error)) = (seconds, sets.mean(&wanted, "gaussians")?) {
                line.push((seconds.value, error.value));
            }
            rows.push(row![
                points.as_str(),
                steps.as_str(),
                seconds.map(|seconds| Figure::brief(seconds, Unit::Seconds)),
                cell("half_planes")?,
                cell("gaussians")?,
                cell("discrepancy")?,
                sets.mean(&wanted, "neighbour")?.map(|of| Figure::brief(of, Unit::Number)),
            ]);
        }
        series.push(Series { name: format!("{points} points"), points: line, ..Series::default() });
    }
    let columns = ["points", "steps", "seconds", "half-planes", "Gaussians", "L2 star", "nearest neighbour"];
    chapter.table("steps", &columns, 0, rows);
    output.write_text("points-steps.svg", &plot("seconds", &series)?)?;
    chapter.picture("points-steps.svg", "error of Gaussian bumps against seconds");
    judge(sets, targets)
}

fn plot(x: &str, series: &[Series]) -> Result<String> {
    let axis = |label| Axis { label, logarithmic: true, range: None };
    let y = axis("root mean square error");
    Plot { title: "Gaussian bumps", x: axis(x), y, series }.svg()
}

/// DESIGN's prototype: the time of a slice on one core, and the quality that it reached.
fn judge(sets: &Sets, targets: &mut Targets) -> Result<()> {
    let single = [("study", "one thread"), ("points", "4096")];
    let times: Vec<f64> = sets
        .rows(&single)
        .map(|row| Ok(row.number::<f64>("seconds")? / row.number::<f64>("steps")? / 16.0 * 1e6))
        .collect::<Result<_>>()?;
    if !times.is_empty() {
        let statement = "microseconds of a slice of 4,096 points, one thread";
        targets.at_most(statement, "one class", Estimate::mean(&times), Unit::Number, 17.0);
    }
    for (study, points, steps, bound) in [("steps", "4096", "2048", 0.856), ("steps", "4096", "8192", 0.889)] {
        let wanted = [("study", study), ("points", points), ("steps", steps)];
        if let Some(mean) = sets.mean(&wanted, "neighbour")? {
            let statement = format!("nearest neighbour of 4,096 points, {steps} steps");
            targets.at_least(&statement, "one class", mean, Unit::Number, bound);
        }
    }
    for points in ["1024", "4096", "16384"] {
        let wanted = [("study", "standard"), ("points", points), ("classes", "1")];
        if let Some(error) = relative(sets, &wanted, points, "half_planes")? {
            targets.at_most("half-planes, standard over Owen-Sobol", &format!("{points} points"), over_sobol(sets, error, points)?, Unit::Ratio, 1.0);
        }
    }
    Ok(())
}

/// What is over random points' error, over Sobol points' instead.
fn over_sobol(sets: &Sets, of: Estimate, points: &str) -> Result<Estimate> {
    let wanted = [("study", "peer"), ("sampler", "Owen-Sobol"), ("points", points)];
    let sobol = relative(sets, &wanted, points, "half_planes")?.map_or(f64::NAN, |sobol| sobol.value);
    Ok(Estimate { value: of.value / sobol, low: of.low / sobol, high: of.high / sobol, seeds: of.seeds })
}
