//! `fsot sampler`: the table of a nested-net tile, and its sidecar.

use crate::common::Common;
use crate::drive::{drive, finish};
use crate::names;
use fsot::error::Result;
use fsot::export::sidecar;
use fsot::output;
use fsot::sampler::problem::{OCTAVES, iterations};
use fsot::sampler::sidecar::SamplerOctave;
use fsot::sampler::{SamplerOptimizer, SamplerProblem, SamplerSidecar};
use serde_json::json;
use std::fmt::{Display, Formatter, Write};
use std::str::FromStr;

/// What `fsot sampler` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// Pixels along each side: 32, 64 or 128
    #[arg(long, value_name = "PIXELS", default_value_t = SamplerProblem::default().size)]
    size: usize,
    /// Each pixel has 2^BITS offsets for each axis, 1 to 6; fewer take longer, as each moves more points
    #[arg(long, default_value_t = SamplerProblem::default().bits)]
    bits: u32,
    /// How much the first 1, 2, 4, ... 64 samples count: 7 numbers for any --bits, separated by commas
    #[arg(long, default_value_t = Weights(SamplerProblem::default().weights))]
    weights: Weights,
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

/// A number for each octave.
#[derive(Clone, Copy, Debug)]
struct Weights([f32; OCTAVES]);

impl Display for Weights {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0.map(|weight| weight.to_string()).join(","))
    }
}

impl FromStr for Weights {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Weights, String> {
        let number = |number: &str| number.parse().map_err(|_| format!("`{number}` is no number"));
        let numbers: Vec<f32> = text.split(',').map(number).collect::<std::result::Result<_, _>>()?;
        numbers.try_into().map(Weights).map_err(|all: Vec<f32>| format!("give {OCTAVES} numbers, not {}", all.len()))
    }
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
    let mut run = drive(&mut optimizer, &json!({ "command": "sampler", "sampler": problem }), &args.common)?;
    let (table, report) = (optimizer.table(), optimizer.measure());
    let octaves = SamplerOctave::all(&report);
    let mut text = format!("{}\n", out.display());
    run.describe(&mut text);
    text.push_str("  spp  filtered     raw  border\n");
    for SamplerOctave { spp, filtered, raw, border: [least, most] } in &octaves {
        writeln!(text, "  {spp:>3}  {filtered:8.4}  {raw:6.4}  {least:.2} to {most:.2}").unwrap_or(());
    }
    let json = json!({ "out": out.to_string_lossy(), "run": run.json(), "octaves": octaves });
    finish(&mut run, |outputs| {
        outputs.add(out, &table.bytes())?;
        let Some(path) = &beside else { return Ok(()) };
        let sidecar = SamplerSidecar::new(command(args, &problem), &problem, &table, &report);
        outputs.add(path, &sidecar::encode(&sidecar)?)
    })?;
    args.common.print([], &text, &json)
}

fn problem(args: &Args) -> Result<SamplerProblem> {
    let default = SamplerProblem::default();
    let problem = SamplerProblem {
        size: args.size,
        bits: args.bits,
        weights: args.weights.0,
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
    let weights = Weights(*weights);
    let name = args.common.out.file_name().unwrap_or_default().to_string_lossy();
    format!(
        "fsot sampler --size {size} --bits {bits} --weights {weights} --exponent {exponent} --border {border} \
         --seed {seed} --iterations {iterations} --out {}",
        crate::tile::quoted(&name)
    )
}
