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

/// Pixels on a side of the blocks that share fits, as the text of the group says.
const BLOCK: u32 = 8;

/// Groups of cases of many repetitions: as the program names them, the section's title, and what it says.
const GROUPS: [(&str, &str, &str); 8] = [
    ("few samples", "Few samples", "exp(-x - y), order 3: fewer samples than terms, as many, one more."),
    (
        "places",
        "Positions that starve a fit",
        "The same integrand. Each position alone is uniform over the square, so that the mean is right on average; together they lie on a line, \
         coincide, or fill a tiny box.",
    ),
    (
        "values",
        "Extreme values",
        "The same integrand scaled, shifted, mixed with rare huge values, or replaced by noise. Where the plain mean's error is the rounding of \
         the values themselves, no estimate can have less: a ratio of one is then the best there is.",
    ),
    (
        "integrands",
        "Needles, steps, peaks",
        "Order 3. The first six are those of the tests that a fit should leave alone.",
    ),
    ("many terms", "Many terms, many dims", "exp(-sum of x), from fewer samples than terms to just more."),
    ("shared fits", "Shared fits", "Blocks of 8 x 8 pixels, order 3, where neighbours have little to share."),
    (
        "streams",
        "Many samples",
        "Accumulators to which a thousand samples at a time are added; order 2. The mean in f32 is a running sum.",
    ),
    (
        "optimal weights",
        "Optimal MIS weights",
        "exp(-2 x), techniques that the weights can hardly tell apart; the plain counterpart is the balance heuristic of the same samples. The \
         default has a ridge, which is as many samples that know nothing, and takes differences of less than a ten-thousandth part for rounding; the \
         plain solve has none.",
    ),
];

/// A case's estimators.
struct Case<'a> {
    group: &'a str,
    name: String,
    samples: usize,
    rows: Vec<Row<'a>>,
}

pub(super) fn write(report: &Report) -> Result<()> {
    let [program] = report.build()?;
    let folder = tempfile::tempdir()?;
    program::measure(report, &program, folder.path())?;
    let errors = Table::read(&folder.path().join("errors.csv"), ';')?;
    let outcomes = Table::read(&folder.path().join("outcomes.csv"), ';')?;
    let cases = cases(&errors)?;
    let mut chapter = Chapter::new("Numerical hard cases");
    introduce(&mut chapter);
    targets(&mut chapter, &cases)?;
    for group in GROUPS {
        write_group(&mut chapter, group, &cases)?;
    }
    write_outcomes(&mut chapter, &outcomes)?;
    report.write(&chapter)
}

fn introduce(chapter: &mut Chapter) {
    let confidence = chapter.setting("confidence, percent", 95);
    chapter.setting("total degree of the fits", 3);
    chapter.paragraph(
        "Measured by `cargo bench --package noisefloor-bench --bench hard_cases`, through the Rust API, whose errors have names; the C functions \
         return the same as statuses. Repetitions have fixed seeds: the same build gives the same figures.",
    );
    chapter.list(&[
        format!(
            "MC: the root mean square error of the plain mean, in the integrand's own unit. Ratios: an estimator's RMSE over it, on the same samples, in brackets \
             the {confidence} % interval; below one is better than MC. A ratio of zero is an exact result, to the rounding of an f32; \
             where MC alone is exact it is infinite."
        ),
        "default: the robust mixture in f64; in f32, on targets without f64; least squares: one fit on its own samples, the published estimator, which promises nothing \
         here; 4-fold: the exactly unbiased one."
            .to_owned(),
        "failed: calls that were refused, or whose estimate was not finite.".to_owned(),
    ]);
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
    targets.write_summary(chapter);
    let group = |case: &&Case| !["optimal weights", "shared fits", "streams"].contains(&case.group);
    let mut worst: Vec<(&str, f64, String)> = Vec::new();
    for estimator in [DEFAULT, "least squares", "4-fold"] {
        let mut found = (estimator, 0.0, String::new());
        for case in cases.iter().filter(group) {
            match case.ratio(estimator)? {
                Some(ratio) if ratio.value > found.1 => found = (estimator, ratio.value, case.place()),
                _ => {}
            }
        }
        worst.push(found);
    }
    let said: Vec<String> = worst
        .into_iter()
        .map(|(estimator, ratio, place)| {
            chapter.setting(format!("worst place, {estimator}"), place.as_str());
            let ratio = chapter.quote(format!("worst ratio, {estimator}"), Figure::exact(ratio, Unit::Ratio));
            format!("{estimator} {ratio} ({place})")
        })
        .collect();
    chapter
        .paragraph(&format!("The largest ratio to MC of one pixel's estimators over all cases: {}.", said.join(", ")));
    Ok(())
}

fn write_group(chapter: &mut Chapter, (group, title, text): (&'static str, &str, &str), cases: &[Case]) -> Result<()> {
    let here: Vec<&Case> = cases.iter().filter(|case| case.group == group).collect();
    let Some(first) = here.first() else { return Ok(()) };
    let estimators = first.rows.iter().map(|row| row.word("estimator")).collect::<Result<Vec<_>>>()?;
    chapter.section(title, "");
    if group == "shared fits" {
        chapter.setting("pixels on a side of a block", BLOCK);
    }
    chapter.paragraph(text);
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
        let mut said = Vec::new();
        for case in neighbours {
            let Some(ratio) = case.ratio(DEFAULT)? else { continue };
            let name = format!("ratio of a bright pixel's neighbours, n = {}", case.samples);
            said.push(chapter.quote(name, Figure::exact(ratio.value, Unit::Ratio)));
        }
        chapter.paragraph(&format!(
            "The bright pixel's neighbours alone: their error is {} times that of their own means. Where the mean is trusted most, pixels so far from all others are left \
             out of the fits. Highlights of more than a few pixels of a window are not: give them surfaces or factors of their own (docs/shared_fits.md).",
            said.join(" and ")
        ));
    }
    Ok(())
}

fn write_outcomes(chapter: &mut Chapter, outcomes: &Table) -> Result<()> {
    chapter.section("Single calls", "");
    chapter.paragraph(
        "What is no number, out of range, damaged, or at the end of the range. Control variates: the answer of all six estimators, which is one. Errors are relative \
         (of weights and lengths: from one); beside them the error of what computes the same plainly, where there is such a thing.",
    );
    let mut rows = Vec::new();
    for row in outcomes.rows() {
        let figure = |value: Option<f64>| value.map(|value| Figure::exact(value, Unit::Error));
        let plain = row.word("plain")?;
        let plain_error: Cell = match row.optional("plain_error")? {
            Some(error) if error.is_finite() => figure(Some(error)).into(),
            Some(error) => (if error.is_nan() { "NaN" } else { "infinite" }).into(),
            None => Cell::Missing,
        };
        rows.push(row![
            row.word("group")?,
            row.word("case")?,
            row.word("outcome")?,
            figure(row.optional("error")?),
            if plain.is_empty() { "-" } else { plain },
            plain_error,
        ]);
    }
    let columns = ["service", "case", "outcome", "error", "plainly", "its error"];
    chapter.table("single calls", &columns, 3, rows);
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
        let json = chapter.json();
        json["targets"][0].clone()
    }

    #[test]
    fn a_case_without_a_finite_ratio_is_not_reached() {
        let good = "values;good;8;6;32;0;1e0;default;9e-1;1e-2\n";
        let counts = |json: &serde_json::Value| (json["reached"].as_u64(), json["of"].as_u64());
        assert_eq!(counts(&summary(good)), (Some(1), Some(1)));
        let exact = summary(&format!("{good}values;plain is exact;8;6;32;0;0e0;default;inf;0e0\n"));
        assert_eq!(counts(&exact), (Some(1), Some(2)));
        assert_eq!(
            (exact["place"].as_str(), exact["verdict"].as_str()),
            (Some("plain is exact, n = 8"), Some("NOT REACHED"))
        );
        assert_eq!(exact["measured"], "infinite");
        let failed = summary(&format!("{good}values;fails;8;6;32;3;1e0;default;;\n"));
        assert_eq!(counts(&failed), (Some(1), Some(2)));
    }
}
