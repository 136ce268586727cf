//! The chapter of the numerical hard cases: what each gives, beside the plain mean.

use super::Report;
use super::chapter::{Cell, Chapter, row};
use super::figure::{Figure, Unit};
use super::program;
use super::statistics::Estimate;
use super::targets::Targets;
use crate::measure::table::{Row, Table};
use anyhow::Result;

/// What the error of the default may be over the plain one's.
const BOUND: f64 = 1.05;
const DEFAULT: &str = "default";

/// Groups of cases of many repetitions: as the program names them, and the section's title.
const GROUPS: [(&str, &str); 8] = [
    ("few samples", "Few samples"),
    ("places", "Positions that starve a fit"),
    ("values", "Extreme values"),
    ("integrands", "Needles, steps, peaks"),
    ("many terms", "Many terms, many dims"),
    ("shared fits", "Shared fits"),
    ("streams", "Many samples"),
    ("optimal weights", "Optimal MIS weights"),
];

/// A case's estimators.
struct Case<'a> {
    group: &'a str,
    name: String,
    samples: usize,
    rows: Vec<Row<'a>>,
}

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let [program] = report.build()?;
    let folder = tempfile::tempdir()?;
    program::measure(report, &program, folder.path())?;
    let errors = Table::read(&folder.path().join("errors.csv"), ';')?;
    let cases = cases(&errors)?;
    let mut chapter = Chapter::new("Numerical hard cases");
    targets(&mut chapter, &cases)?;
    for group in GROUPS {
        write_group(&mut chapter, group, &cases)?;
    }
    Ok(chapter)
}

fn cases(errors: &Table) -> Result<Vec<Case<'_>>> {
    let mut cases: Vec<Case> = Vec::new();
    for row in errors.rows() {
        let (group, name, samples) = (row.word("group")?, row.word("case")?, row.number("n")?);
        match cases.last_mut() {
            Some(case) if (case.group, case.name.as_str(), case.samples) == (group, name, samples) => {
                case.rows.push(row);
            }
            _ => cases.push(Case { group, name: name.to_owned(), samples, rows: vec![row] }),
        }
    }
    Ok(cases)
}

impl Case<'_> {
    fn row(&self, estimator: &str) -> Option<Row<'_>> {
        self.rows.iter().copied().find(|row| row.word("estimator").is_ok_and(|name| name == estimator))
    }

    fn ratio(&self, estimator: &str) -> Result<Option<Estimate>> {
        let Some(row) = self.row(estimator) else { return Ok(None) };
        let Some(value) = row.optional("ratio")? else { return Ok(None) };
        let half: f64 = row.number("half_width")?;
        Ok(Some(Estimate::of_logarithm(value, half, row.number("repetitions")?)))
    }

    /// The default's ratio. Without one, because calls failed, no bound is kept: it counts as infinite.
    fn judged(&self) -> Result<Estimate> {
        let seeds = self.rows[0].number("repetitions")?;
        let none = Estimate { value: f64::INFINITY, low: f64::INFINITY, high: f64::INFINITY, seeds };
        Ok(self.ratio(DEFAULT)?.unwrap_or(none))
    }

    fn place(&self) -> String {
        format!("{}, n = {}", self.name, self.samples)
    }
}

/// Small ratios need an exponent.
fn ratio_figure(estimate: Estimate) -> Figure {
    Figure::new(estimate, if estimate.value.abs() < 0.0095 { Unit::Error } else { Unit::Ratio })
}

fn targets(chapter: &mut Chapter, cases: &[Case]) -> Result<()> {
    let mut targets = Targets::default();
    for case in cases {
        let statement = match case.group {
            "optimal weights" => "optimal MIS weights, default, over the balance heuristic: RMSE",
            "shared fits" => "shared fits over the mean where there is nothing to share: RMSE",
            _ => "default over the mean, every hard case: RMSE",
        };
        targets.at_most(statement, &case.place(), case.judged()?, Unit::Ratio, BOUND);
        let failed = Estimate::exact(case.rows[0].number("failed")?);
        targets.at_most("calls that failed", &case.place(), failed, Unit::Count, 0.0);
    }
    targets.write(chapter);
    let group = |case: &&Case| !["optimal weights", "shared fits", "streams"].contains(&case.group);
    for estimator in [DEFAULT, "least squares", "4-fold"] {
        let mut found = (0.0, String::new());
        for case in cases.iter().filter(group) {
            match case.ratio(estimator)? {
                Some(ratio) if ratio.value > found.0 => found = (ratio.value, case.place()),
                _ => {}
            }
        }
        chapter.setting(format!("worst place, {estimator}"), found.1);
        chapter.quote(format!("worst ratio, {estimator}"), Figure::exact(found.0, Unit::Ratio));
    }
    Ok(())
}

fn write_group(chapter: &mut Chapter, (group, title): (&'static str, &str), cases: &[Case]) -> Result<()> {
    let here: Vec<&Case> = cases.iter().filter(|case| case.group == group).collect();
    let Some(first) = here.first() else { return Ok(()) };
    let estimators = first.rows.iter().map(|row| row.word("estimator")).collect::<Result<Vec<_>>>()?;
    chapter.section(title, "");
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for case in &here {
        let first = case.rows[0];
        let count =
            |heading: &str| first.number::<usize>(heading).map(|count| Figure::exact(count as f64, Unit::Count));
        let plain = Figure::exact(first.number("plain_rmse")?, Unit::Error);
        let mut cells = row![case.name.clone(), count("n")?, count("terms")?, plain];
        for estimator in &estimators {
            cells.push(case.ratio(estimator)?.map(ratio_figure).into());
        }
        cells.push(count("failed")?.into());
        rows.push(cells);
    }
    let (terms, plain) = match group {
        "optimal weights" => ("techniques", "balance"),
        _ => ("terms", "MC"),
    };
    let columns = [&["case", "samples", terms, plain][..], &estimators, &["failed"]].concat();
    chapter.table(group, &columns, 1, rows);
    if group == "shared fits" {
        let neighbours = here.iter().filter(|case| case.name.starts_with("the same"));
        for case in neighbours {
            let Some(ratio) = case.ratio(DEFAULT)? else { continue };
            let name = format!("ratio of a bright pixel's neighbours, n = {}", case.samples);
            chapter.quote(name, Figure::exact(ratio.value, Unit::Ratio));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADINGS: &str = "group;case;n;terms;repetitions;failed;plain_rmse;estimator;ratio;half_width\n";

    fn summary(rows: &str) -> serde_json::Value {
        let table = Table::parse(&format!("{HEADINGS}{rows}"), "errors", ';').expect("a table");
        let mut chapter = Chapter::new("Title");
        targets(&mut chapter, &cases(&table).expect("cases")).expect("targets");
        chapter.json()["tables"][0]["rows"][0].clone()
    }

    #[test]
    fn a_case_without_a_finite_ratio_is_not_reached() {
        let good = "values;good;8;6;32;0;1e0;default;9e-1;1e-2\n";
        let counts =
            |json: &serde_json::Value| [2, 4].map(|at| json[at]["text"].as_str().unwrap_or_default().to_owned());
        assert_eq!(counts(&summary(good)), ["1", "1"]);
        let exact = summary(&format!("{good}values;plain is exact;8;6;32;0;0e0;default;inf;0e0\n"));
        assert_eq!(counts(&exact), ["1", "2"]);
        assert_eq!([&exact[5], &exact[7]], ["plain is exact, n = 8", "NOT REACHED"]);
        assert_eq!(exact[6]["text"], "infinite");
        let failed = summary(&format!("{good}values;fails;8;6;32;3;1e0;default;;\n"));
        assert_eq!(counts(&failed), ["1", "2"]);
    }
}
