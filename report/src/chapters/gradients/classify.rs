//! train_mlp.c: test error against steps and time, and the variance of the gradient (figures 6.2, 6.4 and 6.11).

use super::summary::Summary;
use super::{Context, Written};
use crate::chapters::chapter::Chapter;
use crate::chapters::figure::Unit;
use crate::chapters::measured::read;
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::demo::training::data;
use crate::demo::training::mlp::{self, BATCH, HIDDEN, Plan};
use crate::demo::training::program::Program;
use crate::measure::table::Table;
use anyhow::{Context as _, Result};
use std::path::PathBuf;

/// In every form of the report: small, and with many seeds.
const DIGITS: &str = "examples_c/data/digits";
/// The first epoch that is late in training: a run that ends before it is not judged by its variance.
const LATE: u32 = 5;

pub(super) struct Trainer {
    program: Program,
    /// None: it could not be had.
    mnist: Option<PathBuf>,
}

impl Trainer {
    pub(super) fn new(context: &Context) -> Result<Self> {
        let program = Program::compile("train_mlp.c", &context.archive)?;
        let mnist = (context.sizes() != "quick").then(data::mnist).and_then(|mnist| {
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
            let plan = Plan { name: "MNIST", data: folder.clone(), seeds, epochs, rate: "0.0005", variance_epochs };
            self.train(context, &plan, ["mnist", "mnist-time"], chapter, targets)?;
            self.variance(context, &plan, ("mnist variance", "mnist-variance"), chapter, targets)?;
        }
        let (seeds, epochs) = digits;
        let data = PathBuf::from(DIGITS);
        let plan = Plan { name: "small digits", data, seeds, epochs, rate: "0.001", variance_epochs: epochs };
        self.train(context, &plan, ["digits", "digits-time"], chapter, targets)?;
        self.variance(context, &plan, ("digits variance", "digits-variance"), chapter, targets)
    }

    fn train(
        &self,
        context: &Context,
        plan: &Plan,
        [name, time]: [&'static str; 2],
        chapter: &mut Chapter,
        targets: &mut Targets,
    ) -> Result<()> {
        let (seeds, epochs, [first, second]) = (plan.seeds.to_string(), plan.epochs.to_string(), HIDDEN);
        let Written { csv, summary } = context.run(&self.program, name, &plan.runs()?)?;
        let summary = Summary::parse(&summary)?;
        chapter.section(&format!("Test error, {}", plan.name), "figures 6.4 and 6.11");
        chapter.setting(format!("{name}: rate"), plan.rate);
        let batch = chapter.setting(format!("{name}: batch"), BATCH);
        let hidden = chapter.setting(format!("{name}: hidden"), format!("{first}-{second}"));
        chapter.setting(format!("{name}: epochs"), plan.epochs);
        chapter.setting(format!("{name}: seeds"), plan.seeds);
        chapter.paragraph(&format!(
            "A multilayer perceptron with hidden layers of {hidden}, batches of {batch}, Adam at a constant rate of {}, {seeds} seeds, {epochs} epochs.",
            plan.rate
        ));
        summary.write(chapter, name, 2);
        let rows = Table::parse(&csv, name, ',')?;
        for (file, column, label) in [(name, "step", "steps"), (time, "seconds", "seconds of training")] {
            let plot = mlp::error_plot(plan, &rows, column, label)?;
            context.plot(chapter, file, &plot, &format!("test error against {label}, {}", plan.name))?;
        }
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
        (name, picture): (&'static str, &str),
        chapter: &mut Chapter,
        targets: &mut Targets,
    ) -> Result<()> {
        let epochs = plan.variance_epochs.to_string();
        context.bar.set_message(format!("gradients: {name}"));
        let csv = context.measured.text(&format!("{name}.csv"), || {
            let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
            let path = scratch.path().join("variance.csv");
            self.program.run(&plan.variance(&path)?, &context.report.interrupted, |_| ())?;
            read(&path)
        })?;
        context.bar.inc(1);
        let rows = Table::parse(&csv, name, ',')?;
        chapter.section(&format!("Variance of the gradient, {}", plan.name), "figure 6.2");
        let [batches, draws] = mlp::drawn(&rows)?;
        let batches = chapter.setting(format!("{name}: batches"), batches);
        let draws = chapter.setting(format!("{name}: draws of a batch"), draws);
        chapter.paragraph(&format!(
            "One network, trained uniformly; at each epoch the variance of the gradient's estimate over that of uniform draws, at the same states. Fresh \
             unless said otherwise: importances of the network as it is. As kept: those that a table has after such a training. Ratios of one table are \
             exact; those of balance and omis are mean squared distances to the exact gradient, bias included, over {batches} batches of {draws} draws."
        ));
        let summary = Summary::parse(&mlp::variance_table(plan, &rows)?)?;
        summary.write(chapter, name, 1);
        let description = format!("variance over uniform's against epochs, {}", plan.name);
        context.plot(chapter, picture, &mlp::variance_plot(plan, &rows)?, &description)?;
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
