//! `fsot`: makes point sets and sample tiles by filtered sliced optimal transport.

mod common;
mod drive;
mod export;
mod info;
mod interrupt;
mod measure;
mod pictures;
mod place;
mod points;
mod spectrum;
mod stipple;
mod tile;

use clap::{Parser, Subcommand};
use fsot::Error;
use std::process::ExitCode;

/// Exit code of every error; clap uses it for arguments that it cannot parse.
const FAILURE: u8 = 2;

#[derive(Parser)]
#[command(name = "fsot", version, about = "Optimises point sets and sample tiles by filtered sliced optimal transport")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Spread points evenly, or by a density, in classes or progressively
    Points(points::Args),
    /// Place objects of several colours and sizes
    Place(place::Args),
    /// Draw a picture, or an animation, with dots
    Stipple(stipple::Args),
    /// Make a tile of samples for the pixels of a renderer
    Tile(tile::Args),
    /// Print how good point sets and tiles are
    Measure(measure::Args),
    /// Draw spectra and error curves
    Spectrum(spectrum::Args),
    /// Write a tile as a texture, raw numbers or source code
    Export(export::Args),
    /// Print what a tile is and how it was made
    Info(info::Args),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Points(args) => points::run(&args),
        Command::Place(args) => place::run(&args),
        Command::Stipple(args) => stipple::run(&args),
        Command::Tile(args) => tile::run(&args),
        Command::Measure(args) => measure::run(&args),
        Command::Spectrum(args) => spectrum::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Info(args) => info::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Error::Stopped(sentence)) => {
            eprintln!("{sentence}");
            ExitCode::from(interrupt::EXIT)
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(FAILURE)
        }
    }
}
