//! train_mlp.c: test error against steps and time, and the variance of the gradient (figures 6.2, 6.4 and 6.11).

use super::Context;
use super::mlp::{self, BATCH, HIDDEN, Plan};
use super::summary::Summary;
use super::trainer::Program;
use super::trainer::Written;
use crate::chapters::chapter::Chapter;
use crate::chapters::figure::Unit;
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::table::Table;
use anyhow::{Context as _, Result};
use std::path::PathBuf;
use xtask::{paths, run};

const MNIST: &str = "MNIST";
/// In every form of the report: small, and with many seeds.
const DIGITS: &str = "examples_c/data/digits";
/// The first epoch that is late in training: a run that ends before it is not judged by its variance.
const LATE: u32 = 5;

pub(super) struct Trainer {
    program: Program,
    /// None: it could not be had.
    mnist: Option<PathBuf>,
}

/// The folder with MNIST's four files.
fn mnist() -> Result<PathBuf> {
    let folder = paths::target().join("data/mnist");
    run::check(run::command("sh").arg("report/mnist.sh").arg(&folder))?;
    Ok(folder)
}

impl Trainer {
    pub(super) fn new(context: &Context) -> Result<Self> {
        let program = Program::compile("train_mlp.c", &context.archive)?;
        let mnist = (context.sizes() != "quick").then(mnist).and_then(|mnist| {
            mnist.inspect_err(|error| println!("without MNIST, which could not be had: {error:#}")).ok()
        });
        Ok(Self { program, mnist })
    }

    pub(super) fn write(&self, context: &Context, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
        let (mnist, digits) = match context.sizes() {
            "quick" => ((1, 1, 1), (2, 4)),
            "full" => ((8, 10, 10), (20, 15)),
            _ => ((3, 4, 2), (20, 15)),
        };
        if let Some(folder) = &self.mnist {
            let (seeds, epochs, variance_epochs) = mnist;
            let plan = Plan { name: MNIST, data: folder.clone(), seeds, epochs, rate: "0.0005", variance_epochs };
            self.train(context, &plan, "mnist", chapter, targets)?;
            self.variance(context, &plan, "mnist variance", chapter, targets)?;
        }
        let (seeds, epochs) = digits;
        let data = PathBuf::from(DIGITS);
        let plan = Plan { name: "small digits", data, seeds, epochs, rate: "0.001", variance_epochs: epochs };
        self.train(context, &plan, "digits", chapter, targets)?;
        self.variance(context, &plan, "digits variance", chapter, targets)
    }

    fn train(
        &self,
        context: &Context,
        plan: &Plan,
        name: &'static str,
        chapter: &mut Chapter,
        targets: &mut Targets,
    ) -> Result<()> {
        let (epochs, [first, second]) = (plan.epochs.to_string(), HIDDEN);
        let Written { csv, summary } = context.run(&self.program, name, &plan.runs()?)?;
        let summary = Summary::parse(&summary)?;
        chapter.section(&format!("Test error, {}", plan.name), "figures 6.4 and 6.11");
        chapter.setting(format!("{name}: rate"), plan.rate);
        chapter.setting(format!("{name}: batch"), BATCH);
        chapter.setting(format!("{name}: hidden"), format!("{first}-{second}"));
        chapter.setting(format!("{name}: epochs"), plan.epochs);
        chapter.setting(format!("{name}: seeds"), plan.seeds);
        summary.write(chapter, name, 2);
        let rows = Table::parse(&csv, name, ',')?;
        context.plot(&format!("{name}-time"), &mlp::error_plot(plan, &rows)?)?;
        for mode in ["importance", "adaptive"] {
            // Its two columns of differences have the same name; the second is that at equal time.
            let difference = summary.columns.iter().rposition(|column| column == "minus uniform's");
            let row = summary.rows.iter().find(|row| row[..2] == [epochs.clone(), mode.to_owned()]);
            let cell = difference.and_then(|at| row?.get(at));
            if let Some((value, half)) = cell.and_then(|cell| cell.split_once(" +- ")) {
                let number = |word: &str| word.parse::<f64>().with_context(|| format!("`{word}` is no number"));
                let (value, half) = (number(value)?, number(half)?);
                let estimate = Estimate { value, low: value - half, high: value + half, seeds: plan.seeds as usize };
                let statement = format!("Test error at equal time minus uniform's, percent: {mode}");
                targets.below(&statement, &format!("{}, {epochs} epochs", plan.name), estimate, Unit::Percent, 0.0);
            }
        }
        Ok(())
    }

    fn variance(
        &self,
        context: &Context,
        plan: &Plan,
        name: &'static str,
        chapter: &mut Chapter,
        targets: &mut Targets,
    ) -> Result<()> {
        let epochs = plan.variance_epochs.to_string();
        context.bar.set_message(format!("gradients: {name}"));
        let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
        let path = scratch.path().join("variance.csv");
        self.program.run(&plan.variance(&path)?)?;
        context.bar.inc(1);
        let rows = Table::read(&path, ',')?;
        chapter.section(&format!("Variance of the gradient, {}", plan.name), "figure 6.2");
        let [batches, draws] = mlp::drawn(&rows)?;
        chapter.setting(format!("{name}: batches"), batches);
        chapter.setting(format!("{name}: draws of a batch"), draws);
        let summary = Summary::parse(&mlp::variance_table(plan, &rows)?)?;
        summary.write(chapter, name, 1);
        if plan.name == MNIST {
            context.plot("mnist-variance", &mlp::variance_plot(plan, &rows)?)?;
        }
        if plan.variance_epochs < LATE {
            return Ok(());
        }
        let last = format!("epoch {epochs}");
        if let Some((ratio, _)) = summary.number(&["importance, as kept, delta .2"], &last) {
            let statement =
                format!("Variance over uniform's at the end, epoch {LATE} or later: importance as kept, delta .2");
            targets.at_most(&statement, &format!("{}, {last}", plan.name), Estimate::exact(ratio), Unit::Ratio, 0.5);
        }
        Ok(())
    }
}
