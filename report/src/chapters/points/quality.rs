//! What the points are worth, by number of points and by seconds.

use super::Sets;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::output::Output;
use crate::measure::plot::{Axis, Plot, Series};
use anyhow::Result;

/// Study, sampler and name of what is compared.
const COMPARED: [(&str, &str, &str); 5] = [
    ("scaling", "optimised", "draft"),
    ("standard", "optimised", "standard"),
    ("million", "optimised", "few steps"),
    ("peer", "Owen-Sobol", "Owen-Sobol"),
    ("peer", "random", "random"),
];

pub(super) fn write(output: &Output, sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Quality against points", "");
    chapter.paragraph(
        "One class. Root mean square errors and L2 star discrepancy are over what as many random points have on average; W2 and its bound are in \
         thousandths.",
    );
    let mut rows = Vec::new();
    let mut series = Vec::new();
    let mut sizes = sets.distinct(&[("study", "peer")], "points")?;
    sizes.sort_by_key(|size| size.parse::<u64>().unwrap_or(0));
    for (study, sampler, name) in COMPARED {
        let mut points = Vec::new();
        for size in &sizes {
            let wanted = [("study", study), ("sampler", sampler), ("classes", "1"), ("points", size.as_str())];
            let cell = |column| -> Result<Cell> {
                Ok(sets.mean(&wanted, column)?.map(|of| Figure::brief(of, Unit::Number)).into())
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
                cell("half_planes_relative")?,
                cell("gaussians_relative")?,
                cell("discrepancy_relative")?,
                thousandths("w2")?,
                thousandths("bound")?,
                cell("neighbour")?,
            ]);
        }
        // One size is no line.
        if points.len() > 1 {
            series.push(Series { name: name.to_owned(), points, ..Series::default() });
        }
    }
    chapter.setting("exponent of the discrepancy's norm", 2);
    let columns =
        ["points are", "points", "half-planes", "Gaussians", "L2 star", "W2", "W2's bound", "nearest neighbour"];
    chapter.table("quality", &columns, 1, rows);
    compare(sets, chapter)?;
    output.write_text("points-quality.svg", &plot("points", &series)?)?;
    chapter.picture("points-quality.svg", "error of Gaussian bumps against points");
    Ok(())
}

/// Whether it is better than a sequence that costs nothing.
fn compare(sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    let sizes = sets.distinct(&[("study", "standard")], "points")?;
    let Some(points) = sizes.last() else { return Ok(()) };
    let mut over = |what: &str, column: &str| -> Result<String> {
        let own = sets.mean(&[("study", "standard"), ("points", points)], column)?;
        let sobol = sets.mean(&[("sampler", "Owen-Sobol"), ("points", points)], column)?;
        let ratio = own.zip(sobol).map_or(f64::NAN, |(own, sobol)| own.value / sobol.value);
        Ok(chapter.quote(format!("{what}, standard quality over Owen-Sobol"), Figure::exact(ratio, Unit::Ratio)))
    };
    let (half_planes, gaussians) = (over("half-planes", "half_planes")?, over("Gaussians", "gaussians")?);
    let discrepancy = over("L2 star discrepancy", "discrepancy")?;
    let points = chapter.setting("points of sets of standard quality", points.parse::<u64>()?);
    let text = format!(
        "Standard quality over Owen-scrambled Sobol points, {points} of each: {half_planes} times the error of half-planes, {gaussians} times that of \
         Gaussian bumps, {discrepancy} times the star discrepancy."
    );
    chapter.paragraph(&text);
    Ok(())
}

/// The same size, longer and longer.
pub(super) fn steps(output: &Output, sets: &Sets, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Quality against seconds", "");
    chapter.paragraph(
        "More steps, one class. A step is sixteen slices. Errors are over random points'; the discrepancy rises again where points \
         begin to crystallise.",
    );
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for points in sets.distinct(&[("study", "steps")], "points")? {
        let mut line = Vec::new();
        for steps in sets.distinct(&[("study", "steps"), ("points", &points)], "steps")? {
            let wanted = [("study", "steps"), ("points", points.as_str()), ("steps", steps.as_str())];
            let cell = |column| -> Result<Cell> {
                Ok(sets.mean(&wanted, column)?.map(|of| Figure::brief(of, Unit::Number)).into())
            };
            let seconds = sets.mean(&wanted, "seconds")?;
            if let (Some(seconds), Some(error)) = (seconds, sets.mean(&wanted, "gaussians")?) {
                line.push((seconds.value, error.value));
            }
            rows.push(row![
                points.as_str(),
                steps.as_str(),
                seconds.map(|seconds| Figure::brief(seconds, Unit::Seconds)),
                cell("half_planes_relative")?,
                cell("gaussians_relative")?,
                cell("discrepancy_relative")?,
                cell("neighbour")?,
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

/// The bounds are those of a prototype that was written to try the method: its time of a slice on one core, and the
/// quality that it reached.
fn judge(sets: &Sets, targets: &mut Targets) -> Result<()> {
    let single = [("study", "one thread"), ("points", "4096")];
    let times: Vec<f64> = sets
        .rows(&single)
        .map(|row| Ok(row.number::<f64>("seconds")? / row.number::<f64>("steps")? / 16.0 * 1e6))
        .collect::<Result<_>>()?;
    if !times.is_empty() {
        let statement = "microseconds of a slice of 4,096 points, one thread";
        targets.at_most(statement, "one class", Estimate::geometric_mean(&times), Unit::Number, 17.0);
    }
    if let Some(mean) = sets.mean(&[("study", "steps"), ("points", "4096"), ("steps", "2048")], "neighbour")? {
        targets.at_least("nearest neighbour of 4,096 points, 2,048 steps", "one class", mean, Unit::Number, 0.856);
    }
    Ok(())
}
