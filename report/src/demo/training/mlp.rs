//! train_mlp.c: test error against steps and time, and the variance of the gradient (figures 6.2, 6.4 and 6.11).

use super::Training;
use super::program::Program;
use crate::measure::plot::{Axis, Plot, Series};
use crate::measure::progress;
use crate::measure::table::Table;
use anyhow::{Context, Result};
use indicatif::ProgressBar;
use std::collections::BTreeSet;
use std::fs;
use std::iter;
use std::path::{Path, PathBuf};

pub(crate) const MODES: [&str; 5] = ["uniform", "importance", "adaptive", "balance", "omis"];

/// Items of a minibatch, and sizes of the hidden layers: [`Plan::arguments`] gives them to the trainer, reports quote
/// them.
pub(crate) const BATCH: u32 = 64;
pub(crate) const HIDDEN: [u32; 2] = [128, 64];

/// What is trained, and for how long.
pub(crate) struct Plan {
    pub(crate) name: &'static str,
    pub(crate) data: PathBuf,
    pub(crate) seeds: u32,
    pub(crate) epochs: u32,
    /// Adam's learning rate. MNIST: of .0003, .0005 and .001 the one that suits uniform sampling best.
    pub(crate) rate: &'static str,
    pub(crate) variance_epochs: u32,
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
    pub(crate) fn runs(&self) -> Result<Vec<String>> {
        self.arguments(self.epochs, &["--modes", &MODES.join(","), "--seeds", &self.seeds.to_string()])
    }

    /// The variance of the gradient, as a table in `file`.
    pub(crate) fn variance(&self, file: &Path) -> Result<Vec<String>> {
        self.arguments(self.variance_epochs, &["--variance", text(file)?])
    }

    fn new(quick: bool) -> Self {
        let data = PathBuf::from("examples_c/data/digits");
        let (seeds, epochs) = if quick { (5, 30) } else { (8, 30) };
        Self { name: "digits, 8 x 8", data, seeds, epochs, rate: "0.001", variance_epochs: epochs }
    }
}

/// Writes training-mlp*.csv, .md and .svg; returns the table.
pub(super) fn run(training: &Training) -> Result<String> {
    let program = Program::compile("train_mlp.c", &training.archive)?;
    let plan = Plan::new(training.quick);
    let rows = u64::from(plan.seeds) * MODES.len() as u64 * (u64::from(plan.epochs) + 1);
    // An epoch under the measurement of variance takes as long as about ten others.
    let variance_rows = u64::from(plan.variance_epochs) + 1;
    let bar = progress::bar(rows + 10 * variance_rows)?;

    bar.set_message(format!("{}: {} runs", plan.name, plan.seeds * MODES.len() as u32));
    let written = program.run(&plan.runs()?, training.interrupted, |_| bar.inc(1))?;

    bar.set_message(format!("{}: variance", plan.name));
    let variance = measure_variance(training, &program, &plan, &bar)?;
    bar.finish_and_clear();

    let output = training.output;
    output.write_text("training-mlp.csv", &written.csv)?;
    output.write_text("training-mlp-variance.csv", &variance)?;
    let rows = Table::parse(&written.csv, "the trainer's table", ',')?;
    output.write_text("training-mlp-steps.svg", &error_plot(&plan, &rows, "step", "steps")?)?;
    output.write_text("training-mlp-time.svg", &error_plot(&plan, &rows, "seconds", "seconds of training")?)?;
    let rows = Table::parse(&variance, "the trainer's table", ',')?;
    output.write_text("training-mlp-variance.svg", &variance_plot(&plan, &rows)?)?;
    let variance = variance_table(&plan, &rows)?;
    let table = format!("{}\n{}", written.summary, variance);
    output.write_text("training-mlp.md", &report(&plan, &written.summary, &variance, drawn(&rows)?))?;
    Ok(table)
}

fn measure_variance(training: &Training, program: &Program, plan: &Plan, bar: &ProgressBar) -> Result<String> {
    let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
    let path = scratch.path().join("variance.csv");
    program.run(&plan.variance(&path)?, training.interrupted, |_| bar.inc(10))?;
    read(&path)
}

fn text(path: &Path) -> Result<&str> {
    path.to_str().with_context(|| format!("{} is not Unicode", path.display()))
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

pub(crate) fn error_plot(plan: &Plan, rows: &Table, column: &str, label: &str) -> Result<String> {
    let line = |mode: &&str| rows.only("mode", mode)?.line(mode, "epoch", column, ("test_error", 100.0));
    let mut series: Vec<Series> = MODES.iter().map(line).collect::<Result<_>>()?;
    for line in &mut series {
        // The untrained network, wrong nine times in ten, would take up most of the picture.
        line.points.retain(|&(at, _)| at > 0.0);
        line.band.retain(|&(at, ..)| at > 0.0);
    }
    let title = format!("{}, rate {}: mean of {} seeds, 95 % confidence intervals", plan.name, plan.rate, plan.seeds);
    let x = Axis { label, logarithmic: false, range: None };
    let y = Axis { label: "test error, %", logarithmic: true, range: None };
    Plot { title: &title, x, y, series: &series }.svg()
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

pub(crate) fn variance_plot(plan: &Plan, rows: &Table) -> Result<String> {
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
    let x = Axis { label: "epoch", logarithmic: false, range: None };
    let y = Axis { label: "variance / uniform's", logarithmic: true, range: None };
    Plot { title: &title, x, y, series: &series }.svg()
}

/// How many batches the trainer drew to measure what has no exact ratio, and of how many items each.
pub(crate) fn drawn(rows: &Table) -> Result<[u32; 2]> {
    let row = rows.only("method", "omis")?;
    let row = row.rows().next().context("the trainer's table has no row of omis")?;
    Ok([row.number("batches")?, row.number("batch")?])
}

/// The ratios at a few of the epochs, as Markdown.
pub(crate) fn variance_table(plan: &Plan, rows: &Table) -> Result<String> {
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

fn report(plan: &Plan, summary: &str, variance: &str, [batches, draws]: [u32; 2]) -> String {
    format!(
        "# Minibatches drawn by importance: {name}\n\n\
         Made by examples_c/train_mlp.c: {seeds} seeds, {epochs} epochs, batches of {BATCH}, Adam with rate {rate}, one thread.\n\n{summary}\n\
         - Intervals: 95 %, Student's t over the seeds. Differences are taken seed by seed: the modes of a seed begin with the\n  \
           same network and the same first epoch.\n\
         - Time: processor time of training alone. Modes take turns, an epoch at a time.\n\n\
         ## Variance of the gradient estimate\n\nAt the same states of one network that is trained uniformly (figure 6.2).\n\n{variance}\n\
         - delta .2: a fifth of the draws uniform; where no delta is named it is 0. As kept: importances from when an item was\n  \
           last drawn, momentum .3; the others are fresh.\n\
         - balance, omis: mean squared distance to the exact gradient, bias included, over {batches} batches of {draws} draws. The others\n  \
           are exact.\n",
        name = plan.name,
        seeds = plan.seeds,
        epochs = plan.epochs,
        rate = plan.rate,
    )
}
