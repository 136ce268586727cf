//! The chapter of point sets: seconds against quality.

mod quality;
mod scaling;

use super::Report;
use super::chapter::Chapter;
use super::program;
use super::statistics::Estimate;
use super::targets::Targets;
use crate::measure::table::{Row, Table};
use anyhow::Result;

pub(super) fn write(report: &Report) -> Result<()> {
    let [program] = report.build()?;
    let folder = tempfile::tempdir()?;
    program::measure(report, &program, folder.path())?;
    let sets = Sets(Table::read(&folder.path().join("points.csv"), ',')?);
    let mut chapter = Chapter::new("Point sets: seconds against quality");
    let mut targets = Targets::default();
    introduce(&sets, &mut chapter)?;
    scaling::write(report.output, &sets, &mut chapter)?;
    quality::write(report.output, &sets, &mut chapter)?;
    quality::steps(report.output, &sets, &mut chapter, &mut targets)?;
    targets.write_summary(&mut chapter);
    report.write(&chapter)
}

fn introduce(sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    let threads = sets.0.rows().map(|row| row.number::<u32>("threads")).collect::<Result<Vec<_>>>()?;
    let threads = chapter.setting("threads", threads.into_iter().max().unwrap_or(1));
    let confidence = chapter.setting("confidence, percent", 95);
    let few = chapter.setting("seeds of an interval, at least", 3);
    chapter.paragraph(&format!(
        "Made by `cargo xtask report --only points`; machine-readable in `points.json`. Sets of points in the unit square, made by \
         `fsot::optimize` on {threads} threads, beside random and Owen-scrambled Sobol points. Seconds are those that passed."
    ));
    chapter.list(&[
        format!("A figure is the geometric mean over seeds, and in brackets the {confidence} % interval of it, Student's of its logarithm, where there are at least {few}."),
        "Classes: equal shares of the points are colours, and every combination of colours is to be uniform: two colours have three \
         classes, three have seven, four have fifteen."
            .to_owned(),
        "Errors: root mean squares over random half-planes and Gaussian bumps, over what as many random points have on average, which is known exactly. W2: the \
         sliced Wasserstein distance to the uniform square, with its lower bound for as many points. Nearest neighbour: the mean distance over that \
         of a hexagonal lattice. Definitions: [metrics.md](../metrics.md). Fewer slices and integrands measure large sets."
            .to_owned(),
    ]);
    chapter.setting("classes", vec![1, 3, 7, 15]);
    Ok(())
}

/// What was measured.
struct Sets(Table);

impl Sets {
    fn rows<'a>(&'a self, wanted: &'a [(&'a str, &'a str)]) -> impl Iterator<Item = Row<'a>> {
        self.0.rows().filter(move |row| row.has(wanted))
    }

    /// The geometric mean of a column over the seeds of what is wanted; none where there is nothing, or no number.
    fn mean(&self, wanted: &[(&str, &str)], column: &str) -> Result<Option<Estimate>> {
        let values: Vec<f64> = self.rows(wanted).map(|row| row.number(column)).collect::<Result<_>>()?;
        Ok((!values.is_empty() && values.iter().all(|value| value.is_finite()))
            .then(|| Estimate::geometric_mean(&values)))
    }

    /// The values of a column among what is wanted, each once.
    fn distinct(&self, wanted: &[(&str, &str)], column: &str) -> Result<Vec<String>> {
        let mut all: Vec<String> = Vec::new();
        for row in self.rows(wanted) {
            let text = row.word(column)?;
            if !all.iter().any(|seen| seen == text) {
                all.push(text.to_owned());
            }
        }
        Ok(all)
    }
}
