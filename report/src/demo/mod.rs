//! `cargo xtask demo`: the path tracer with every estimator and every sampler, and the trainers with every kind of
//! minibatch, as pictures and as tables.

mod estimators;
mod tiles;
pub(crate) mod training;

use crate::measure::interrupt;
use crate::measure::output::Output;
use crate::measure::renderer::Renderer;
use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Instant;
use xtask::paths;

#[derive(Args)]
pub(crate) struct Options {
    /// Small images and short references: a look at whether everything works, not at the figures
    #[arg(long)]
    quick: bool,
    /// One part instead of all
    #[arg(long, value_enum)]
    only: Option<Part>,
    /// A folder of files NAME.nft that stand in for the library's tiles of the same names
    #[arg(long, value_name = "DIR")]
    tiles: Option<PathBuf>,
    /// Where the pictures and tables go [default: target/demo]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Control variates: every estimator, random samples
    Estimators,
    /// Samplers: random, Sobol, tiles; plain means, and control variates of each pixel and shared by neighbours
    Tiles,
    /// Minibatches: trainers with uniform, importance, adaptive and optimal-MIS sampling
    Training,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    let folder = options.out.clone().unwrap_or_else(|| paths::target().join("demo"));
    let folder = std::path::absolute(&folder).with_context(|| format!("{} is no folder", folder.display()))?;
    let interrupted = interrupt::catch()?;
    let output = Output::new(&folder)?;
    let wanted = |part| options.only.is_none_or(|only| only == part);
    let mut tables = Vec::new();
    if wanted(Part::Estimators) || wanted(Part::Tiles) {
        println!("building the library and the path tracer");
        let renderer = Renderer::build(interrupted.clone())?;
        let parts = [
            (Part::Estimators, estimators::run as fn(&Options, &Renderer, &Output) -> Result<String>),
            (Part::Tiles, tiles::run),
        ];
        for (_, make) in parts.into_iter().filter(|(part, _)| wanted(*part)) {
            tables.push(make(options, &renderer, &output)?);
        }
    }
    if wanted(Part::Training) {
        println!("building the library and the trainers");
        tables.push(training::run(options, &interrupted, &output)?);
    }
    interrupt::check(&interrupted)?;
    output.commit()?;
    println!("{}", tables.join("\n"));
    println!("pictures and tables: {} ({:.0} s)", folder.display(), start.elapsed().as_secs_f64());
    Ok(())
}
