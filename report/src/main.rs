//! What `cargo xtask demo`, `report` and `targets` start: they measure, and make tables, plots and pictures of it.

mod chapters;
mod demo;
mod measure;
mod targets;

use clap::{Parser, Subcommand};
use std::process::ExitCode;
use xtask::start;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Demonstrate and measure noisefloor")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render with every estimator: pictures and a table in target/demo
    Demo(demo::Options),
    /// Measure errors and times of everything, and write docs/report: chapters with their tables, plots and pictures
    Report(chapters::Options),
    /// Build for other targets, run the C tests and a bare-metal program there under QEMU or Wine, and
    /// write docs/report/sizes.md
    Targets(targets::Options),
    /// A step of `cargo xtask test`
    #[command(hide = true)]
    Check {
        #[arg(value_parser = ["chapters", "embree", "mitsuba", "python"])]
        step: String,
    },
}

fn main() -> ExitCode {
    start::exit(match Arguments::parse().command {
        Command::Demo(options) => demo::run(&options),
        Command::Report(options) => chapters::run(&options),
        Command::Targets(options) => targets::run(&options),
        Command::Check { step } => chapters::check(&step),
    })
}
