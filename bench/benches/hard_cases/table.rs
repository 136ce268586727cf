//! What was measured, as two tables: errors over many repetitions, and outcomes of single calls.

use noisefloor::Error;
use noisefloor_tests::statistics::Ratio;
use std::fmt::Write;

/// A case of many repetitions.
pub(crate) struct ErrorRow {
    pub(crate) group: &'static str,
    pub(crate) case: String,
    pub(crate) n: usize,
    pub(crate) terms: usize,
    pub(crate) repetitions: usize,
    /// Calls that were refused or whose estimate was not finite.
    pub(crate) failed: usize,
    /// The plain estimator's root mean square error.
    pub(crate) plain_rmse: f64,
    /// RMSE over the plain estimator's, in the order of the group's columns; None where some estimates failed.
    pub(crate) ratios: Vec<(&'static str, Option<Ratio>)>,
}

/// A single call, or a fixed number of them.
struct OutcomeRow {
    group: &'static str,
    case: String,
    outcome: String,
    /// Relative, or as the case says; None where a refusal is the outcome.
    error: Option<f64>,
    /// What computes the same plainly, and its error.
    plain: Option<(&'static str, f64)>,
}

/// Both tables, growing.
#[derive(Default)]
pub(crate) struct Tables {
    errors: Vec<ErrorRow>,
    outcomes: Vec<OutcomeRow>,
}

impl Tables {
    pub(crate) fn error(&mut self, row: ErrorRow) {
        self.errors.push(row);
    }

    /// What a call answered, and its error.
    pub(crate) fn outcome(
        &mut self,
        group: &'static str,
        case: impl Into<String>,
        outcome: impl Into<String>,
        error: Option<f64>,
        plain: Option<(&'static str, f64)>,
    ) {
        self.outcomes.push(OutcomeRow { group, case: case.into(), outcome: outcome.into(), error, plain });
    }

    /// A call that has no error to measure.
    pub(crate) fn refused<T>(&mut self, group: &'static str, case: impl Into<String>, result: Result<T, Error>) {
        self.outcome(group, case, status(result), None, None);
    }

    pub(crate) fn len(&self) -> usize {
        self.errors.len() + self.outcomes.len()
    }

    /// A row for each estimator.
    pub(crate) fn errors(&self) -> String {
        let mut out = "group;case;n;terms;repetitions;failed;plain_rmse;estimator;ratio;half_width\n".to_owned();
        for row in &self.errors {
            for (estimator, ratio) in &row.ratios {
                let _ = write!(out, "{};{};{};{};", row.group, row.case, row.n, row.terms);
                let _ = write!(out, "{};{};{:e};{estimator};", row.repetitions, row.failed, row.plain_rmse);
                let _ = match ratio {
                    Some(ratio) => writeln!(out, "{:.5e};{:.3e}", ratio.value, ratio.half_width),
                    None => writeln!(out, ";"),
                };
            }
        }
        out
    }

    pub(crate) fn outcomes(&self) -> String {
        let mut out = "group;case;outcome;error;plain;plain_error\n".to_owned();
        for OutcomeRow { group, case, outcome, error, plain } in &self.outcomes {
            let error = error.map_or(String::new(), |error| format!("{error:.3e}"));
            let (plain, plain_error) =
                plain.map_or(("", String::new()), |(name, error)| (name, format!("{error:.3e}")));
            let _ = writeln!(out, "{group};{case};{outcome};{error};{plain};{plain_error}");
        }
        out
    }
}

/// What a call answered, in words.
pub(crate) fn status<T>(result: Result<T, Error>) -> String {
    match result {
        Ok(_) => "accepted".to_owned(),
        Err(error) => format!("refused: {error:?}"),
    }
}
