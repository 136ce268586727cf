//! Seconds against the number of points, and of classes.

use super::Sets;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use anyhow::Result;

pub(super) fn write(sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Seconds against points", "");
    let mut rows = Vec::new();
    for classes in sets.distinct(&[("sampler", "optimised")], "classes")? {
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
            }
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
    Ok(())
}
