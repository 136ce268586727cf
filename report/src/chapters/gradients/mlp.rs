//! train_mlp.c: test error against steps and time, and the variance of the gradient (figures 6.2, 6.4 and 6.11).

use super::Parts;
use super::trainer::{Program, Summary};
use crate::chapters::prelude::*;
use crate::measure::plot::{Plot, Series};
use std::collections::BTreeSet;
use std::path::PathBuf;
use xtask::{paths, run};

const MODES: [&str; 5] = ["uniform", "importance", "adaptive", "balance", "omis"];
const MNIST: &str = "MNIST";
/// In every form of the report: small, and with many seeds.
const DIGITS: &str = "examples_c/data/digits";
/// The first epoch that is late in training: a run that ends before it is not judged by its variance.
const LATE: u32 = 5;
/// Items of a minibatch, and sizes of the hidden layers.
const BATCH: &str = "64";
const HIDDEN: [u32; 2] = [128, 64];

pub(super) struct Trainer {
    program: Program,
    /// None: it could not be had.
    mnist: Option<PathBuf>,
}

/// What is trained, and for how long.
struct Plan {
    /// In names of tables and plots, and in titles.
    name: &'static str,
    title: &'static str,
    data: PathBuf,
    seeds: u32,
    epochs: u32,
    /// Adam's learning rate. MNIST: of .0003, .0005 and .001 the one that suits uniform sampling best.
    rate: &'static str,
    variance_epochs: u32,
}

/// The folder with MNIST's four files.
fn mnist() -> Result<PathBuf> {
    let folder = paths::target().join("data/mnist");
    run::check(run::command("sh").arg("report/mnist.sh").arg(&folder))?;
    Ok(folder)
}

impl Trainer {
    pub(super) fn new(parts: &Parts) -> Result<Self> {
        let program = Program::compile("train_mlp.c", &parts.archive)?;
        let mnist = (parts.sizes() != "quick").then(mnist).and_then(|mnist| {
            mnist.inspect_err(|error| println!("without MNIST, which could not be had: {error:#}")).ok()
        });
        Ok(Self { program, mnist })
    }

    pub(super) fn write(&self, parts: &mut Parts) -> Result<()> {
        let (mnist, digits) = match parts.sizes() {
            "quick" => ([1, 1, 1], [2, 4]),
            "full" => ([8, 10, 10], [20, 15]),
            _ => ([3, 4, 2], [20, 15]),
        };
        let mut plans = Vec::new();
        if let Some(data) = self.mnist.clone() {
            let [seeds, epochs, variance_epochs] = mnist;
            plans.push(Plan { name: "mnist", title: MNIST, data, seeds, epochs, rate: "0.0005", variance_epochs });
        }
        let ([seeds, epochs], data) = (digits, PathBuf::from(DIGITS));
        let rate = "0.001";
        plans.push(Plan { name: "digits", title: "small digits", data, seeds, epochs, rate, variance_epochs: epochs });
        for plan in &plans {
            self.errors(plan, parts)?;
            self.variance(plan, parts)?;
        }
        Ok(())
    }

    /// Test errors of all modes and seeds.
    fn errors(&self, plan: &Plan, parts: &mut Parts) -> Result<()> {
        let (name, epochs, seeds) = (plan.name, plan.epochs.to_string(), plan.seeds.to_string());
        let modes = MODES.join(",");
        let (csv, said) = plan.run(&self.program, parts, name, &epochs, &["--modes", &modes, "--seeds", &seeds])?;
        let chapter = &mut parts.chapter;
        chapter.section(&format!("Test error, {}", plan.title), "figures 6.4 and 6.11");
        chapter.setting(format!("{name}: rate"), plan.rate);
        chapter.setting(format!("{name}: batch"), BATCH.parse::<u32>()?);
        chapter.setting(format!("{name}: hidden"), HIDDEN.map(|size| size.to_string()).join("-"));
        chapter.setting(format!("{name}: epochs"), plan.epochs);
        chapter.setting(format!("{name}: seeds"), plan.seeds);
        let summary = Summary::parse(&said)?;
        summary.write(chapter, name, 2);
        parts.plot(&format!("{name}-time"), &error_plot(plan, &Table::parse(&csv, name, ',')?)?)?;
        for mode in ["importance", "adaptive"] {
            // Two columns have this name; the second is that at equal time.
            if let Some((value, half)) = summary.number(&[&epochs, mode], "minus uniform's") {
                let estimate = Estimate { value, low: value - half, high: value + half, seeds: plan.seeds as usize };
                let statement = format!("Test error at equal time minus uniform's, percent: {mode}");
                let place = format!("{}, {epochs} epochs", plan.title);
                parts.targets.below(&statement, &place, estimate, Unit::Percent, 0.0);
            }
        }
        Ok(())
    }

    /// The variance of the gradient along a training.
    fn variance(&self, plan: &Plan, parts: &mut Parts) -> Result<()> {
        let name = if plan.title == MNIST { "mnist variance" } else { "digits variance" };
        let (scratch, epochs) = (tempfile::tempdir()?, plan.variance_epochs.to_string());
        let path = scratch.path().join("variance.csv");
        let file = path.to_str().context("a temporary folder whose name is not Unicode")?;
        plan.run(&self.program, parts, name, &epochs, &["--variance", file])?;
        let table = Table::read(&path, ',')?;
        let chapter = &mut parts.chapter;
        chapter.section(&format!("Variance of the gradient, {}", plan.title), "figure 6.2");
        // How much the trainer drew to measure what has no exact ratio.
        let drawn = table.find(&[("method", "omis")])?;
        chapter.setting(format!("{name}: batches"), drawn.number::<u32>("batches")?);
        chapter.setting(format!("{name}: draws of a batch"), drawn.number::<u32>("batch")?);
        let last = plan.variance_epochs;
        let epochs = BTreeSet::from([0, 1, 2, last / 2, last]);
        let across: Vec<_> = epochs.into_iter().map(|epoch| (format!("epoch {epoch}"), epoch.to_string())).collect();
        let down = METHODS[1..].iter().map(|(method, fraction, name, _)| (row![*name], (*method, *fraction)));
        chapter.grid(name, (1, "variance / uniform's"), down, &across, |(method, fraction), epoch| {
            let wanted = [("method", *method), ("uniform_fraction", fraction), ("epoch", epoch)];
            Ok(table.numbers_of("ratio", &wanted)?.first().map_or("-".to_owned(), |ratio| format!("{ratio:.3}")).into())
        })?;
        if plan.title == MNIST {
            parts.plot("mnist-variance", &variance_plot(plan, &table)?)?;
        }
        let (wanted, end) = ([("method", "importance_stale"), ("uniform_fraction", "0.2")], last.to_string());
        let ratio = table.numbers_of("ratio", &[&wanted[..], &[("epoch", &end)]].concat())?;
        if let (true, Some(ratio)) = (last >= LATE, ratio.first()) {
            let statement =
                format!("Variance over uniform's at the end, epoch {LATE} or later: importance as kept, delta .2");
            let (place, ratio) = (format!("{}, epoch {last}", plan.title), (ratio * 1000.0).round() / 1000.0);
            parts.targets.at_most(&statement, &place, Estimate::exact(ratio), Unit::Ratio, 0.5);
        }
        Ok(())
    }
}

impl Plan {
    fn run(
        &self,
        program: &Program,
        parts: &Parts,
        name: &str,
        epochs: &str,
        more: &[&str],
    ) -> Result<(String, String)> {
        let hidden = HIDDEN.map(|size| size.to_string()).join(",");
        let data = self.data.to_str().context("a folder whose name is not Unicode")?;
        let network = ["--data", data, "--epochs", epochs, "--rate", self.rate, "--batch", BATCH, "--hidden", &hidden];
        parts.run(program, name, &[&network[..], more].concat())
    }
}

/// One line of a plot: at each different word of `key`, in order, the mean of `x` and that of `y` times `factor`, with
/// its 95 % confidence interval over the seeds.
fn line(table: &Table, name: &str, key: &str, x: &str, (y, factor): (&str, f64)) -> Result<Series> {
    let mut series = Series { name: name.to_owned(), ..Series::default() };
    for word in table.distinct(key)? {
        let group = table.of(&[(key, word)]);
        let at = Estimate::mean(&group.numbers(x)?).value;
        let Estimate { value, low, high, seeds } = Estimate::mean(&group.numbers(y)?);
        series.points.push((at, factor * value));
        if seeds > 1 {
            series.band.push((at, factor * low, factor * high));
        }
    }
    Ok(series)
}

fn error_plot(plan: &Plan, table: &Table) -> Result<String> {
    let line = |mode: &&str| line(&table.of(&[("mode", mode)]), mode, "epoch", "seconds", ("test_error", 100.0));
    let mut series: Vec<Series> = MODES.iter().map(line).collect::<Result<_>>()?;
    for line in &mut series {
        // The untrained network, wrong nine times in ten, would take up most of the picture.
        line.points.retain(|&(at, _)| at > 0.0);
        line.band.retain(|&(at, ..)| at > 0.0);
    }
    let title = format!("{}, rate {}: mean of {} seeds, 95 % confidence intervals", plan.title, plan.rate, plan.seeds);
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

fn variance_plot(plan: &Plan, table: &Table) -> Result<String> {
    let line = |&(method, fraction, name, colour): &(&str, &str, &str, usize)| -> Result<Series> {
        let rows = table.of(&[("method", method), ("uniform_fraction", fraction)]);
        let series = line(&rows, name, "epoch", "epoch", ("ratio", 1.0))?;
        Ok(Series { dashed: fraction == "0.2", colour: Some(colour), ..series })
    };
    let series: Vec<Series> = METHODS.iter().map(line).collect::<Result<_>>()?;
    let (name, rate) = (plan.title, plan.rate);
    let title = format!("{name}, rate {rate}: variance of the gradient estimate, one network trained uniformly");
    Plot { title: &title, x: "epoch", y: "variance / uniform's", logarithmic: true, series: &series }.svg()
}
