//! The chapter on minibatches' gradients: the trainers of examples_c, run as report/chapters/gradients_runs.toml says.

use super::prelude::*;
use super::template::word;
use crate::measure::plot::{Plot, Series};
use crate::measure::{progress, running};
use indicatif::ProgressBar;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use xtask::{paths, run};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Runs {
    network: Vec<Network>,
    run: Vec<Run>,
    method: Vec<Method>,
}

/// A training.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Network {
    name: String,
    title: String,
    /// A folder; none: MNIST, if it can be had.
    data: Option<String>,
    seeds: String,
    epochs: String,
    variance: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Run {
    table: String,
    program: String,
    arguments: String,
    /// In a full report only.
    #[serde(default)]
    full: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Method {
    name: String,
    is: [String; 2],
    colour: usize,
}

const MODES: [&str; 5] = ["uniform", "importance", "adaptive", "balance", "omis"];

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let runs: Runs = report.plan.read("gradients_runs")?;
    let further: Vec<&Run> = runs.run.iter().filter(|run| report.plan.is_full() || !run.full).collect();
    let bar = progress::bar((2 * runs.network.len() + further.len()) as u64)?;
    let missing = |error: &anyhow::Error| println!("without MNIST, which could not be had: {error:#}");
    let mnist = if report.plan.is_quick() { None } else { mnist().inspect_err(missing).ok() };
    let mut programs = BTreeMap::new();
    for source in further.iter().map(|run| run.program.as_str()).chain(["train_mlp.c"]) {
        // For this machine: what is measured is time. Without errno the compiler vectorises square roots.
        programs.insert(source, running::example(source, &["-O3", "-march=native", "-fno-math-errno"])?);
    }
    report.compiled();
    let mut tables = BTreeMap::new();
    for network in &runs.network {
        let Some(data) = network.data.clone().or_else(|| Some(mnist.as_ref()?.to_str()?.to_owned())) else { continue };
        let name = &network.name;
        // The chapter's settings: Adam's learning rate, draws of a step, units of the layers between.
        let setting = |what: &str| report.description.settings.get(&format!("{name}: {what}")).and_then(word);
        let setting = |what: &str| setting(what).with_context(|| format!("gradients.toml has no {what} of {name}"));
        let (rate, batch, hidden) = (&setting("rate")?, setting("batch")?, setting("hidden")?.replace('-', ","));
        let train = |epochs: &str, more: &[&str]| {
            let network = ["--data", &data, "--epochs", epochs, "--rate", rate, "--hidden", &hidden];
            run_one(&programs["train_mlp.c"], name, &[&network[..], more].concat(), &bar)
        };
        let (csv, said) =
            train(&network.epochs, &["--batch", &batch, "--modes", &MODES.join(","), "--seeds", &network.seeds])?;
        let plot = error_plot(network, rate, &Table::parse(&csv, name)?)?;
        report.output.write_text(&format!("{}-{name}-time.svg", report.names[0]), &plot)?;
        tables.insert(name.clone(), summary(&said)?);

        let scratch = tempfile::tempdir()?;
        train(&network.variance, &["--variance", &scratch.path().join("variance.csv").to_string_lossy()])?;
        let named = |row: &Row| {
            let is = [row.word("method")?, row.word("uniform_fraction")?];
            let method = runs.method.iter().find(|method| method.is == is);
            Ok(method.map_or(String::new(), |method| method.name.clone()))
        };
        let variance = Table::read(scratch.path(), "variance")?.with("line", named)?;
        if network.data.is_none() {
            let plot = variance_plot(network, rate, &variance, &runs.method)?;
            report.output.write_text(&format!("{}-{name}-variance.svg", report.names[0]), &plot)?;
        }
        tables.insert(format!("{name} variance"), variance);
    }
    for Run { table, program, arguments, .. } in further {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        tables.insert(table.clone(), summary(&run_one(&programs[&**program], table, &arguments, &bar)?.1)?);
    }
    bar.finish_and_clear();
    // What was not run has no columns.
    let mut chapter =
        report.described(&|name| Ok(tables.get(name).cloned().unwrap_or_else(|| Table::new(name, ""))))?;
    chapter.judge();
    Ok(chapter)
}

/// The folder with MNIST's four files.
pub(super) fn mnist() -> Result<PathBuf> {
    let folder = paths::target().join("data/mnist");
    run::check(run::command("sh").arg("report/mnist.sh").arg(&folder))?;
    Ok(folder)
}

/// Runs to the end: the standard output, CSV, and the standard error, a summary.
fn run_one(program: &Path, name: &str, arguments: &[&str], bar: &ProgressBar) -> Result<(String, String)> {
    bar.set_message(format!("gradients: {name}"));
    let (mut command, mut csv) = (run::command(program), String::new());
    command.args(arguments);
    let said = running::run(command, |line| {
        csv += &format!("{line}\n");
        Ok(())
    })?;
    bar.inc(1);
    Ok((csv, said))
}

/// The first table of a text in Markdown.
fn summary(text: &str) -> Result<Table> {
    let mut lines = text.lines().skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let headings = cells(lines.next().context("the trainer wrote no table")?);
    let mut table = Table::new("the trainer's summary", &headings.join(" | "));
    lines.skip(1).for_each(|line| table.push(cells(line)));
    Ok(table)
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

fn error_plot(network: &Network, rate: &str, table: &Table) -> Result<String> {
    let line = |mode: &&str| line(&table.of(&[("mode", mode)]), mode, "epoch", "seconds", ("test_error", 100.0));
    let mut series: Vec<Series> = MODES.iter().map(line).collect::<Result<_>>()?;
    for line in &mut series {
        // The untrained network, wrong nine times in ten, would take up most of the picture.
        line.points.retain(|&(at, _)| at > 0.0);
        line.band.retain(|&(at, ..)| at > 0.0);
    }
    let Network { title, seeds, .. } = network;
    let title = format!("{title}, rate {rate}: mean of {seeds} seeds, 95 % confidence intervals");
    Plot { title: &title, x: "seconds of training", y: "test error, %", series: &series }.svg()
}

fn variance_plot(network: &Network, rate: &str, table: &Table, methods: &[Method]) -> Result<String> {
    let line = |Method { name, is, colour }: &Method| -> Result<Series> {
        let series = line(&table.of(&[("line", name)]), name, "epoch", "epoch", ("ratio", 1.0))?;
        Ok(Series { dashed: is[1] == "0.2", colour: Some(*colour), ..series })
    };
    let series: Vec<Series> = methods.iter().map(line).collect::<Result<_>>()?;
    let title = &network.title;
    let title = format!("{title}, rate {rate}: variance of the gradient estimate, one network trained uniformly");
    Plot { title: &title, x: "epoch", y: "variance / uniform's", series: &series }.svg()
}
