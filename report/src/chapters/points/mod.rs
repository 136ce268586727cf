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

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let [program] = report.build()?;
    let folder = tempfile::tempdir()?;
    program::measure(report, &program, folder.path())?;
    let sets = Sets(Table::read(&folder.path().join("points.csv"), ',')?);
    let mut chapter = Chapter::new("Point sets: seconds against quality");
    let mut targets = Targets::default();
    introduce(&sets, &mut chapter)?;
    scaling::write(&sets, &mut chapter)?;
    quality::write(&sets, &mut chapter)?;
    quality::steps(&sets, &mut chapter, &mut targets)?;
    targets.write(&mut chapter);
    Ok(chapter)
}

fn introduce(sets: &Sets, chapter: &mut Chapter) -> Result<()> {
    let threads = sets.0.rows().map(|row| row.number::<u32>("threads")).collect::<Result<Vec<_>>>()?;
    chapter.setting("threads", threads.into_iter().max().unwrap_or(1));
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
