//! `fsot`: makes point sets and sample tiles by filtered sliced optimal transport.

// They panic if nobody reads: see `say`.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod common;
mod drive;
mod export;
mod info;
mod interrupt;
mod measure;
mod names;
mod pictures;
mod place;
mod points;
mod process;
mod sampler;
mod say;
mod scenes;
mod spectrum;
mod stipple;
mod tile;

use clap::{Parser, Subcommand};
use fsot::Error;
use say::{GONE, STANDARD_OUTPUT, is_cut, is_gone, say};
use std::io::Write;
use std::process::ExitCode;

/// Exit code of every error; clap uses it for arguments that it cannot parse.
const FAILURE: u8 = 2;

#[derive(Parser)]
#[command(name = "fsot", version, about = "Optimises point sets and sample tiles by filtered sliced optimal transport")]
#[command(after_help = "To begin: fsot points -n 4096 --out p.txt\nOptions: fsot COMMAND --help\nManual: docs/fsot.md")]
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
    /// Make the table of a sampler that is good at any number of samples
    Sampler(sampler::Args),
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
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(answer) => return print(&answer),
    };
    let result = match arguments.command {
        Command::Points(args) => args.common.threads.install(|| points::run(&args)),
        Command::Place(args) => args.common.threads.install(|| place::run(&args)),
        Command::Stipple(args) => args.common.threads.install(|| stipple::run(&args)),
        Command::Tile(args) => args.common.threads.install(|| tile::run(&args)),
        Command::Sampler(args) => args.common.threads.install(|| sampler::run(&args)),
        Command::Measure(args) => measure::run(&args),
        Command::Spectrum(args) => spectrum::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Info(args) => info::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Error::Stopped(sentence)) => {
            say(&sentence).ok();
            ExitCode::from(interrupt::EXIT)
        }
        Err(error) => failed(&error),
    }
}

/// Says what an error is, unless nobody wants to know.
fn failed(error: &Error) -> ExitCode {
    if !is_cut(error) {
        say(&format!("error: {error}")).ok();
    }
    ExitCode::from(if is_gone(error) { GONE } else { FAILURE })
}

/// Prints what clap answers: help, the version or what is wrong with the arguments.
fn print(answer: &clap::Error) -> ExitCode {
    match answer.print().and_then(|()| std::io::stdout().flush()) {
        Err(error) if !answer.use_stderr() => failed(&Error::write(STANDARD_OUTPUT)(error)),
        _ => ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(FAILURE)),
    }
}
