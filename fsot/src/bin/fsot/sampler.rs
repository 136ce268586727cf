//! `fsot sampler`: the table of a nested-net tile, and its sidecar.

use crate::common::Common;
use crate::drive::{drive, finish};
use crate::names;
use fsot::Error;
use fsot::error::Result;
use fsot::export::sidecar;
use fsot::output::{self, Outputs};
use fsot::sampler::problem::{OCTAVES, iterations};
use fsot::sampler::sidecar::SamplerOctave;
use fsot::sampler::{SamplerOptimizer, SamplerProblem, SamplerSidecar};
use serde_json::json;
use std::fmt::Write;

/// What `fsot sampler` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// Pixels along each side: 32, 64 or 128
    #[arg(long, value_name = "PIXELS", default_value_t = SamplerProblem::default().size)]
    size: usize,
    /// Each pixel has 2^BITS offsets for each axis, 1 to 6
    #[arg(long, default_value_t = SamplerProblem::default().bits)]
    bits: u32,
    /// How much the first 1, 2, 4, ... 64 samples count, separated by commas
    #[arg(long, value_name = "WEIGHTS", value_delimiter = ',', default_values_t = SamplerProblem::default().weights)]
    weights: Vec<f32>,
    /// The energy of two points is minus their distance to this power
    #[arg(long, value_name = "POWER", default_value_t = SamplerProblem::default().exponent)]
    #[arg(allow_negative_numbers = true)]
    exponent: f32,
    /// How much a marginal counts that is not uniform
    #[arg(long, value_name = "WEIGHT", default_value_t = SamplerProblem::default().border)]
    #[arg(allow_negative_numbers = true)]
    border: f32,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// Makes the table and writes it.
pub(crate) fn run(args: &Args) -> Result<()> {
    let out = &args.common.out;
    names::sampler(out)?;
    let beside = (!output::is_stream(out)).then(|| sidecar::path(out));
    args.common.check_outputs(beside.as_deref(), [])?;
    beside.iter().try_for_each(|path| sidecar::check::<SamplerSidecar>(path))?;
    let problem = problem(args)?;
    let mut optimizer = SamplerOptimizer::new(problem.clone())?;
    let run = drive(&mut optimizer, &json!({ "command": "sampler", "sampler": problem }), &args.common)?;
    let (table, report) = (optimizer.table(), optimizer.measure());
    let mut outputs = Outputs::new();
    outputs.add(out, &table.bytes())?;
    if let Some(path) = &beside {
        let sidecar = SamplerSidecar::new(command(args, &problem), &problem, &table, &report);
        outputs.add(path, &sidecar::encode(&sidecar)?)?;
    }
    let octaves = SamplerOctave::all(&report);
    let mut text = format!("{}\n", out.display());
    run.describe(&mut text);
    text.push_str("  spp  filtered     raw  border\n");
    for SamplerOctave { spp, filtered, raw, border: [least, most] } in &octaves {
        writeln!(text, "  {spp:>3}  {filtered:8.4}  {raw:6.4}  {least:.2} to {most:.2}").unwrap_or(());
    }
    let json = json!({ "out": out.to_string_lossy(), "run": run.json(), "octaves": octaves });
    finish(outputs, &run)?;
    args.common.print([], &text, &json)
}

fn problem(args: &Args) -> Result<SamplerProblem> {
    let weights: [f32; OCTAVES] = args.weights.clone().try_into().map_err(|_| {
        Error::Input(format!("--weights has {} numbers: give one for each of {OCTAVES} octaves", args.weights.len()))
    })?;
    let default = SamplerProblem::default();
    let problem = SamplerProblem {
        size: args.size,
        bits: args.bits,
        weights,
        exponent: args.exponent,
        border: args.border,
        iterations: args.common.given_effort().map_or(default.iterations, iterations),
        seed: args.common.seed(),
        ..default
    };
    problem.validate()?;
    Ok(problem)
}

/// The command that makes the same file wherever it runs.
fn command(args: &Args, problem: &SamplerProblem) -> String {
    let SamplerProblem { size, bits, weights, exponent, border, iterations, seed, .. } = problem;
    let weights: Vec<String> = weights.iter().map(f32::to_string).collect();
    let name = args.common.out.file_name().unwrap_or_default().to_string_lossy();
    format!(
        "fsot sampler --size {size} --bits {bits} --weights {} --exponent {exponent} --border {border} --seed {seed} \
         --iterations {iterations} --out {}",
        weights.join(","),
        crate::tile::quoted(&name)
    )
}
