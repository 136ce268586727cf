//! What the points are worth, by number of points and by seconds.

use super::Sets;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use anyhow::Result;

/// Study, sampler and name of what is compared.
const COMPARED: [(&str, &str, &str); 5] = [
    ("scaling", "optimised", "draft"),
    ("standard", "optimised", "standard"),
    ("million", "optimised", "few steps"),
    ("peer", "Owen-Sobol", "Owen-Sobol"),
    ("peer", "random", "random"),
];

pub(super) fn write(sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Quality against points", "");
    let mut rows = Vec::new();
    let mut sizes = sets.distinct(&[("study", "peer")], "points")?;
    sizes.sort_by_key(|size| size.parse::<u64>().unwrap_or(0));
    for (study, sampler, name) in COMPARED {
        for size in &sizes {
            let wanted = [("study", study), ("sampler", sampler), ("classes", "1"), ("points", size.as_str())];
            let cell = |column| -> Result<Cell> {
                Ok(sets.mean(&wanted, column)?.map(|of| Figure::brief(of, Unit::Number)).into())
            };
            let thousandths = |column| -> Result<Cell> {
                let of = sets.mean(&wanted, column)?.map(|of| Figure::exact(1e3 * of.value, Unit::Number));
                Ok(of.into())
            };
            if sets.mean(&wanted, "gaussians")?.is_none() {
                continue;
            }
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
    }
    let columns =
        ["points are", "points", "half-planes", "Gaussians", "L2 star", "W2", "W2's bound", "nearest neighbour"];
    chapter.table("quality", &columns, 1, rows);
    compare(sets, chapter)?;
    Ok(())
}

/// Whether it is better than a sequence that costs nothing.
fn compare(sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    let sizes = sets.distinct(&[("study", "standard")], "points")?;
    let Some(points) = sizes.last() else { return Ok(()) };
    let mut over = |what: &str, column: &str| -> Result<()> {
        let own = sets.mean(&[("study", "standard"), ("points", points)], column)?;
        let sobol = sets.mean(&[("sampler", "Owen-Sobol"), ("points", points)], column)?;
        let ratio = own.zip(sobol).map_or(f64::NAN, |(own, sobol)| own.value / sobol.value);
        chapter.quote(format!("{what}, standard quality over Owen-Sobol"), Figure::exact(ratio, Unit::Ratio));
        Ok(())
    };
    over("half-planes", "half_planes")?;
    over("Gaussians", "gaussians")?;
    over("L2 star discrepancy", "discrepancy")?;
    chapter.setting("points of sets of standard quality", points.parse::<u64>()?);
    Ok(())
}

/// The same size, longer and longer.
pub(super) fn steps(sets: &Sets, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Quality against seconds", "");
    let mut rows = Vec::new();
    for points in sets.distinct(&[("study", "steps")], "points")? {
        for steps in sets.distinct(&[("study", "steps"), ("points", &points)], "steps")? {
            let wanted = [("study", "steps"), ("points", points.as_str()), ("steps", steps.as_str())];
            let cell = |column| -> Result<Cell> {
                Ok(sets.mean(&wanted, column)?.map(|of| Figure::brief(of, Unit::Number)).into())
            };
            let seconds = sets.mean(&wanted, "seconds")?;
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
    }
    let columns = ["points", "steps", "seconds", "half-planes", "Gaussians", "L2 star", "nearest neighbour"];
    chapter.table("steps", &columns, 0, rows);
    judge(sets, targets)
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
