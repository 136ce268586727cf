//! `cargo xtask`: everything the project does beyond `cargo build`.

use clap::{Args, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;
use xtask::*;

#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", about = "Build, test and demonstrate noisefloor")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// What the program that is started reads.
#[derive(Args)]
#[command(disable_help_flag = true)]
struct Passed {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

#[derive(Subcommand)]
enum Command {
    /// Build target/noisefloor/libnoisefloor.a, the archive that C and C++ programs link
    Library,
    /// Install headers, libraries, CMake package and pkg-config file
    Install(install::Options),
    /// Render with every estimator: pictures and a table in target/demo
    Demo(Passed),
    /// Run every test; installs what it needs when it may
    Test(test::Options),
    /// Measure errors and times of everything, and write docs/report: chapters with their tables, plots and pictures
    Report(Passed),
    /// Build POV-Ray with our patch, and check it against POV-Ray as it is
    Povray,
    /// Write the report's figures into the documents
    Fill,
    /// Run the fuzz targets for a while; inputs that crash go to fuzz/regressions
    Fuzz(fuzz::Options),
    /// Regenerate include/noisefloor.h and its parts
    Header,
    /// Rewrite capi/abi.txt, the list of what the C ABI promises. --unreleased: also what breaks programs without a new
    /// NF_ABI_VERSION, as no release has had the present one yet
    Abi(Passed),
    /// Rewrite THIRD_PARTY.md, the list of other people's packages and their licences
    Licences,
    /// Build the page to play with, target/demo/playground.html
    Playground,
    /// Build the path tracer on Embree with the thesis's scenes, and print where it is
    Embree,
    /// Build for other targets, run the C tests and a bare-metal program there under QEMU or Wine, and
    /// write docs/report/sizes.md
    Targets(Passed),
    /// Make the tiles in core/tiles with fsot, or check that they are what it makes
    Tiles(tiles::Options),
}

fn main() -> ExitCode {
    start::exit(match Arguments::parse().command {
        Command::Demo(passed) => {
            println!("pictures and tables of a path tracer, then of small trainers: see target/demo");
            start::start("report", "demo", &passed.arguments)
        }
        Command::Povray => renderers::povray(),
        Command::Report(passed) => start::start("report", "report", &passed.arguments),
        Command::Targets(passed) => start::start("report", "targets", &passed.arguments),
        Command::Header => start::start("release", "header", &[]),
        Command::Abi(passed) => start::start("release", "abi", &passed.arguments),
        Command::Fill => fill::run(),
        Command::Test(options) => test::run(&options),
        Command::Fuzz(options) => fuzz::run(&options),
        Command::Licences => start::start("release", "licences", &[]),
        Command::Install(options) => install::run(&options),
        Command::Tiles(options) => tiles::run(&options),
        Command::Embree => renderers::embree().map(|path| println!("{}", path.display())),
        Command::Playground => playground::build().map(|path| println!("{}", path.display())),
        Command::Library => library::build().map(|path| println!("{}", path.display())),
    })
}
