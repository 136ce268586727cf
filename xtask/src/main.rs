//! `cargo xtask`: everything the project does beyond `cargo build`.

mod abi;
mod c_tests;
mod columns;
mod demo;
mod embree;
mod examples;
mod fill;
mod fit;
mod fuzz;
mod header;
mod install;
mod instructions;
mod library;
mod links;
mod measure;
mod path_tracer;
mod paths;
mod povray;
mod povray_patched;
mod python;
mod release;
mod report;
mod run;
mod targets;
mod test;
mod threads;
mod tiles;
mod tools;
mod train_mlp;
mod trainer;
mod valgrind;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Build, test and demonstrate noisefloor")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render with every estimator: pictures and a table in target/demo
    Demo(demo::Options),
    /// Build POV-Ray with our patch, check it, and compare it with POV-Ray as it is
    Povray(povray_patched::Options),
    /// Measure errors and times of everything, and write docs/report: chapters with their tables, plots and pictures
    Report(report::Options),
    /// Write the report's figures into the documents
    Fill,
    /// Run every test; installs what it needs when it may
    Test(test::Options),
    /// Run the fuzz targets for a while; inputs that crash go to fuzz/regressions
    Fuzz(fuzz::Options),
    /// Regenerate include/noisefloor.h
    Header,
    /// Rewrite capi/abi.txt, the list of what the C ABI promises
    Abi(abi::Options),
    /// Rewrite THIRD_PARTY.md, the list of other people's packages and their licences
    Licences,
    /// Install headers, libraries, CMake package and pkg-config file
    Install(install::Options),
    /// Build target/noisefloor/libnoisefloor.a, the archive that C and C++ programs link
    Library,
    /// Build target/noisefloor/embree_harness, the path tracer on Embree with the thesis's scenes
    Embree,
    /// Build for other targets, run the C tests and a bare-metal program there under QEMU, and write
    /// docs/report/sizes.md
    Targets(targets::Options),
    /// Make the tiles in core/tiles with fsot, or check that they are what it makes
    Tiles(tiles::Options),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Demo(options) => demo::run(&options),
        Command::Povray(options) => povray_patched::run(&options),
        Command::Report(options) => report::run(&options),
        Command::Fill => fill::run(),
        Command::Test(options) => test::run(&options),
        Command::Fuzz(options) => fuzz::run(&options),
        Command::Header => header::write(),
        Command::Abi(options) => abi::write(&options),
        Command::Licences => release::licences::write(),
        Command::Install(options) => install::run(&options),
        Command::Targets(options) => targets::run(&options),
        Command::Tiles(options) => tiles::run(&options),
        Command::Embree => embree::build().map(|path| println!("{}", path.display())),
        Command::Library => library::build().map(|path| println!("{}", path.display())),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
