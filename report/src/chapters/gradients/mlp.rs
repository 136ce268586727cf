//! train_mlp.c: test error against steps and time, and the variance of the gradient (figures 6.2, 6.4 and 6.11).

use crate::measure::plot::{Plot, Series};
use crate::measure::table::Table;
use anyhow::{Context, Result};
use std::collections::BTreeSet;
use std::iter;
use std::path::{Path, PathBuf};

pub(super) const MODES: [&str; 5] = ["uniform", "importance", "adaptive", "balance", "omis"];

/// Items of a minibatch, and sizes of the hidden layers: [`Plan::arguments`] gives them to the trainer, reports quote
/// them.
pub(super) const BATCH: u32 = 64;
pub(super) const HIDDEN: [u32; 2] = [128, 64];

/// What is trained, and for how long.
pub(super) struct Plan {
    pub(super) name: &'static str,
    pub(super) data: PathBuf,
    pub(super) seeds: u32,
    pub(super) epochs: u32,
    /// Adam's learning rate. MNIST: of .0003, .0005 and .001 the one that suits uniform sampling best.
    pub(super) rate: &'static str,
    pub(super) variance_epochs: u32,
}

impl Plan {
    /// The trainer's command line, but for what it writes.
    fn arguments(&self, epochs: u32, more: &[&str]) -> Result<Vec<String>> {
        let (epochs, batch, [first, second]) = (epochs.to_string(), BATCH.to_string(), HIDDEN);
        let hidden = format!("{first},{second}");
        let network = ["--data", text(&self.data)?, "--epochs", &epochs, "--rate", self.rate];
        let words = [&network[..], &["--batch", &batch, "--hidden", &hidden], more].concat();
        Ok(words.into_iter().map(str::to_owned).collect())
    }

    /// All modes, all seeds.
    pub(super) fn runs(&self) -> Result<Vec<String>> {
        self.arguments(self.epochs, &["--modes", &MODES.join(","), "--seeds", &self.seeds.to_string()])
    }

    /// The variance of the gradient, as a table in `file`.
    pub(super) fn variance(&self, file: &Path) -> Result<Vec<String>> {
        self.arguments(self.variance_epochs, &["--variance", text(file)?])
    }
}

fn text(path: &Path) -> Result<&str> {
    path.to_str().with_context(|| format!("{} is not Unicode", path.display()))
}

pub(super) fn error_plot(plan: &Plan, rows: &Table) -> Result<String> {
    let line = |mode: &&str| rows.only("mode", mode)?.line(mode, "epoch", "seconds", ("test_error", 100.0));
    let mut series: Vec<Series> = MODES.iter().map(line).collect::<Result<_>>()?;
    for line in &mut series {
        // The untrained network, wrong nine times in ten, would take up most of the picture.
        line.points.retain(|&(at, _)| at > 0.0);
        line.band.retain(|&(at, ..)| at > 0.0);
    }
    let title = format!("{}, rate {}: mean of {} seeds, 95 % confidence intervals", plan.name, plan.rate, plan.seeds);
    Plot { title: &title, x: "seconds of training", y: "test error, %", logarithmic: true, series: &series }.svg()
}

/// (method, uniform fraction, name, colour): those with a uniform fraction are dashed.
const METHODS: [(&str, &str, &str, usize); 11] = [
    ("uniform", "1", "uniform", 0),
    ("loss", "0", "loss", 4),
    ("importance", "0", "importance", 1),
    ("importance", "0.2", "importance, delta .2", 1),
    ("last_layer", "0", "last layer", 6),
    ("gradient_norm", "0", "gradient norm", 3),
    ("importance_stale", "0", "importance, as kept, delta 0", 2),
    ("importance_stale", "0.2", "importance, as kept, delta .2", 2),
    ("balance", "0.2", "balance, delta .2", 7),
    ("omis", "0.2", "omis, delta .2", 5),
    ("omis_stale", "0.2", "omis, as kept, delta .2", 0),
];

pub(super) fn variance_plot(plan: &Plan, rows: &Table) -> Result<String> {
    let line = |&(method, fraction, name, colour): &(&str, &str, &str, usize)| -> Result<Series> {
        let rows = rows.only("method", method)?.only("uniform_fraction", fraction)?;
        let mut series = rows.line(name, "epoch", "epoch", ("ratio", 1.0))?;
        series.dashed = fraction == "0.2";
        series.colour = Some(colour);
        Ok(series)
    };
    let series: Vec<Series> = METHODS.iter().map(line).collect::<Result<_>>()?;
    let title =
        format!("{}, rate {}: variance of the gradient estimate, one network trained uniformly", plan.name, plan.rate);
    Plot { title: &title, x: "epoch", y: "variance / uniform's", logarithmic: true, series: &series }.svg()
}

/// How many batches the trainer drew to measure what has no exact ratio, and of how many items each.
pub(super) fn drawn(rows: &Table) -> Result<[u32; 2]> {
    let row = rows.only("method", "omis")?;
    let row = row.rows().next().context("the trainer's table has no row of omis")?;
    Ok([row.number("batches")?, row.number("batch")?])
}

/// The ratios at a few of the epochs, as Markdown.
pub(super) fn variance_table(plan: &Plan, rows: &Table) -> Result<String> {
    let last = plan.variance_epochs;
    let epochs = BTreeSet::from([0, 1, 2, last / 2, last]);
    let mut cells = Vec::new();
    for (method, fraction, name, _) in &METHODS[1..] {
        let rows = rows.only("method", method)?.only("uniform_fraction", fraction)?;
        let (at, ratios) = (rows.numbers("epoch")?, rows.numbers("ratio")?);
        let ratio = |epoch: u32| {
            let found = at.iter().zip(&ratios).find(|(at, _)| **at == f64::from(epoch));
            found.map_or("-".to_owned(), |(_, ratio)| format!("{ratio:.3}"))
        };
        cells.push(iter::once((*name).to_owned()).chain(epochs.iter().copied().map(ratio)).collect());
    }
    let headings: Vec<String> = epochs.iter().map(|epoch| format!("epoch {epoch}")).collect();
    let headings: Vec<&str> = iter::once("variance / uniform's").chain(headings.iter().map(String::as_str)).collect();
    Ok(crate::measure::markdown::lines(&headings, &[0], cells))
}
