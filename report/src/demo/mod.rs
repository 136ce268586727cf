//! `cargo xtask demo`: the path tracer with every estimator and every sampler, and the trainers with every kind of
//! minibatch, as pictures and as tables.

mod estimators;
mod index;
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
    let wanted = |part| options.only.is_none_or(|only| only == part);
    let mut pages = index::Pages::default();
    // Each part moves into the folder when it is complete.
    let mut write = |title: &str, make: &dyn Fn(&Output) -> Result<String>| -> Result<()> {
        println!("\n{title}");
        let output = Output::new(&folder)?;
        let table = make(&output)?;
        interrupt::check(&interrupted)?;
        pages.add(title, output.names()?);
        output.write_text("index.html", &pages.html())?;
        output.commit()?;
        println!("{table}");
        Ok(())
    };
    if wanted(Part::Tiles) || wanted(Part::Estimators) {
        println!("building the library and the path tracer");
        let renderer = Renderer::build(interrupted.clone())?;
        if wanted(Part::Tiles) {
            write("Samplers, and fits shared by pixels", &|output| tiles::run(options, &renderer, output))?;
        }
        if wanted(Part::Estimators) {
            write("Estimators of single pixels", &|output| estimators::run(options, &renderer, output))?;
        }
    }
    if wanted(Part::Training) {
        println!("building the library and the trainers");
        for (title, trainer) in training::TRAINERS {
            write(title, &|output| training::run(options, &interrupted, output, trainer))?;
        }
    }
    println!("\npictures and tables: {} ({:.0} s)", folder.join("index.html").display(), start.elapsed().as_secs_f64());
    Ok(())
}
