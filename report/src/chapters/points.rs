//! The chapter of point sets: seconds against quality.

use super::prelude::*;
use super::{Report, program};

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let sets = program::measure(report)?.read("points")?;
    let mut chapter = Chapter::new("Point sets: seconds against quality");
    let mut targets = Targets::default();
    chapter.setting("threads", sets.numbers("threads")?.into_iter().fold(1.0, f64::max) as u32);
    scaling(&sets, &mut chapter)?;
    quality(&sets, &mut chapter)?;
    compare(&sets, &mut chapter)?;
    steps(&sets, &mut chapter)?;
    judge(&sets, &mut targets)?;
    targets.write(&mut chapter);
    Ok(chapter)
}

/// The geometric mean of a column over the seeds of what is wanted; none where there is nothing, or no number.
fn mean(sets: &Table, wanted: &[(&str, &str)], column: &str) -> Result<Option<Estimate>> {
    let values = sets.numbers_of(column, wanted)?;
    let is_measured = !values.is_empty() && values.iter().all(|value| value.is_finite());
    Ok(is_measured.then(|| Estimate::geometric_mean(&values)))
}

fn brief(mean: Option<Estimate>, unit: Unit) -> Cell {
    mean.map(|mean| Figure::brief(mean, unit)).into()
}

/// Seconds against the number of points, and of classes.
fn scaling(sets: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Seconds against points", "");
    let mut rows = Vec::new();
    for classes in sets.of(&[("sampler", "optimised")]).distinct("classes")? {
        for study in ["scaling", "million"] {
            for count in sets.of(&[("study", study), ("classes", classes)]).distinct("points")? {
                let of = |part| [("study", study), ("classes", classes), ("points", count), ("part", part)];
                let seconds = mean(sets, &of("all"), "seconds")?;
                let number: f64 = count.parse().with_context(|| format!("`{count}` points"))?;
                rows.push(row![
                    classes,
                    count,
                    sets.of(&of("all")).distinct("steps")?.concat(),
                    seconds.map(|seconds| Figure::new(seconds, Unit::Seconds)),
                    seconds.map(|seconds| Figure::exact(1e6 * seconds.value / number, Unit::Number)),
                    brief(mean(sets, &of("all"), "neighbour")?, Unit::Number),
                    brief(mean(sets, &of("colour"), "neighbour")?, Unit::Number),
                ]);
            }
        }
    }
    let columns = "classes | points | steps | seconds | microseconds per point | nearest neighbour | \
                   colour: nearest neighbour";
    chapter.table("scaling", columns, 0, rows);
    Ok(())
}

/// Study, sampler and name of what is compared.
const COMPARED: [(&str, &str, &str); 5] = [
    ("scaling", "optimised", "draft"),
    ("standard", "optimised", "standard"),
    ("million", "optimised", "few steps"),
    ("peer", "Owen-Sobol", "Owen-Sobol"),
    ("peer", "random", "random"),
];
/// Headings, columns, and whether they are shown as measured or, with their mean alone, in thousandths.
const QUALITIES: [(&str, (&str, bool)); 6] = [
    ("half-planes", ("half_planes_relative", false)),
    ("Gaussians", ("gaussians_relative", false)),
    ("L2 star", ("discrepancy_relative", false)),
    ("W2", ("w2", true)),
    ("W2's bound", ("bound", true)),
    ("nearest neighbour", ("neighbour", false)),
];

/// What the points are worth, by number of points.
fn quality(sets: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Quality against points", "");
    let peers = sets.of(&[("study", "peer")]);
    let mut sizes = peers.distinct("points")?;
    sizes.sort_by_key(|size| size.parse::<u64>().unwrap_or(0));
    let mut down = Vec::new();
    for (study, sampler, name) in COMPARED {
        for size in &sizes {
            let wanted = [("study", study), ("sampler", sampler), ("classes", "1"), ("points", size)];
            if mean(sets, &wanted, "gaussians")?.is_some() {
                down.push((row![name, *size], wanted));
            }
        }
    }
    chapter.grid("quality", (1, "points are | points"), down, &QUALITIES, |wanted, (column, in_thousandths)| {
        let found = mean(sets, wanted, column)?;
        Ok(match in_thousandths {
            true => found.map(|mean| Figure::exact(1e3 * mean.value, Unit::Number)).into(),
            false => brief(found, Unit::Number),
        })
    })
}

/// Whether it is better than a sequence that costs nothing.
fn compare(sets: &Table, chapter: &mut Chapter) -> Result<()> {
    let standard = sets.of(&[("study", "standard")]);
    let Some(&points) = standard.distinct("points")?.last() else { return Ok(()) };
    for (what, column) in
        [("half-planes", "half_planes"), ("Gaussians", "gaussians"), ("L2 star discrepancy", "discrepancy")]
    {
        let own = mean(&standard, &[("points", points)], column)?;
        let sobol = mean(sets, &[("sampler", "Owen-Sobol"), ("points", points)], column)?;
        let ratio = own.zip(sobol).map_or(f64::NAN, |(own, sobol)| own.value / sobol.value);
        chapter.quote(format!("{what}, standard quality over Owen-Sobol"), Figure::exact(ratio, Unit::Ratio));
    }
    chapter.setting("points of sets of standard quality", points.parse::<u64>()?);
    Ok(())
}

/// The same size, longer and longer.
fn steps(sets: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Quality against seconds", "");
    let steps = sets.of(&[("study", "steps")]);
    let down = steps.kinds(&["points", "steps"])?.into_iter();
    let down = down.map(|of| (row![of[0], of[1]], [("points", of[0]), ("steps", of[1])]));
    let columns = [&[("seconds", ("seconds", false))], &QUALITIES[..3], &QUALITIES[5..]].concat();
    chapter.grid("steps", (0, "points | steps"), down, &columns, |wanted, (column, _)| {
        let unit = if *column == "seconds" { Unit::Seconds } else { Unit::Number };
        Ok(brief(mean(&steps, wanted, column)?, unit))
    })
}

/// The bounds are those of a prototype that was written to try the method: its time of a slice on one core, and the
/// quality that it reached.
fn judge(sets: &Table, targets: &mut Targets) -> Result<()> {
    let single = sets.of(&[("study", "one thread"), ("points", "4096")]);
    let times = single.numbers("seconds")?.into_iter().zip(single.numbers("steps")?);
    let times: Vec<f64> = times.map(|(seconds, steps)| seconds / steps / 16.0 * 1e6).collect();
    if !times.is_empty() {
        let statement = "microseconds of a slice of 4,096 points, one thread";
        targets.at_most(statement, "one class", Estimate::geometric_mean(&times), Unit::Number, 17.0);
    }
    if let Some(mean) = mean(sets, &[("study", "steps"), ("points", "4096"), ("steps", "2048")], "neighbour")? {
        targets.at_least("nearest neighbour of 4,096 points, 2,048 steps", "one class", mean, Unit::Number, 0.856);
    }
    Ok(())
}
