//! `cargo xtask targets`: the library on other processors, with and without an operating system, run under QEMU; and
//! its size there.

mod bare_metal;
mod build;
mod chapter;
mod consumer;
mod platform;
mod sizes;
mod wasm;

use anyhow::{Context, Result, bail};
use clap::Args;
use platform::{PLATFORMS, Platform};
use sizes::Size;
use std::path::Path;
use xtask::tools::Package;
use xtask::{c_tests, library, paths, run, tools};

#[derive(Args)]
pub(crate) struct Options {
    /// Only this target; can be given several times. docs/report/sizes.md is written when all are built
    #[arg(long = "target", value_name = "TRIPLE")]
    targets: Vec<String>,
}

/// What was found out about one target.
struct Findings {
    platform: &'static Platform,
    sizes: Vec<Size>,
    /// What examples_c/bare_metal told.
    program: bare_metal::Told,
    /// What ran, in words.
    ran: String,
    /// The emulator's name and version.
    emulator: String,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    if let Some(unknown) = options.targets.iter().find(|name| PLATFORMS.iter().all(|known| known.triple != **name)) {
        let known: Vec<_> = PLATFORMS.iter().map(|known| known.triple).collect();
        bail!("`{unknown}` is none of the targets that this knows: {}", known.join(", "));
    }
    let is_wanted = |platform: &&Platform| {
        options.targets.is_empty() || options.targets.iter().any(|wanted| wanted == platform.triple)
    };
    let wanted: Vec<&'static Platform> = PLATFORMS.iter().filter(is_wanted).collect();
    let packages: Vec<Package> =
        platform::COMPILER.iter().chain(wanted.iter().flat_map(|platform| platform.packages)).copied().collect();
    if let Some(missing) = tools::packages(&packages)? {
        bail!("{missing}");
    }
    let mut all = Vec::new();
    for platform in wanted {
        println!("== {}", platform.id());
        all.push(one(platform).with_context(|| format!("target {}", platform.id()))?);
    }
    if options.targets.is_empty() { chapter::write(&all) } else { Ok(()) }
}

/// Builds, runs what can be run, and measures.
fn one(platform: &'static Platform) -> Result<Findings> {
    let raw = build::archive(platform)?;
    let sizes = sizes::measure(platform, &raw)?;
    let (program, ran) = there(platform, &raw)?;
    let version = run::read(run::command(platform.emulator).arg("--version"))?;
    // QEMU says much more in parentheses and further lines.
    let version = version.lines().next().unwrap_or_default().split(" (").next().unwrap_or_default();
    let emulator = format!("`{}`: {version}", platform.emulator);
    println!("   ran on {emulator}");
    Ok(Findings { platform, sizes, program, ran, emulator })
}

/// Runs what can be run there, and says what that was.
fn there(platform: &Platform, raw: &Path) -> Result<(bare_metal::Told, String)> {
    let Some(binutils) = platform.binutils else {
        let module = c_tests::output("services.wasm")?;
        sizes::link(platform, raw, &bare_metal::WASM_EXPORTS, &module)?;
        return Ok((bare_metal::wasm(platform, platform.emulator, &module)?, "the example".to_owned()));
    };
    let archive = library::one_object(raw, &paths::output().join(platform.id()), binutils)?;
    library::check(&archive)?;
    println!("   no panic, no undefined symbol but mem*, only nf_* visible");
    if platform.is_bare_metal {
        let told = bare_metal::alone(platform, binutils, platform.emulator, &archive)?;
        return Ok((told, "the example, without an operating system".to_owned()));
    }
    let mut ran = c_tests_there(binutils, platform.emulator, &archive)?;
    let told = bare_metal::hosted(platform, binutils, platform.emulator, &archive)?;
    ran += ", the example";
    if consumer::run(platform)? {
        ran += ", a CMake project";
    }
    Ok((told, ran))
}

const STRICT: [&str; 5] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-O1"];

/// Compiles and runs every C test; they read the same pinned vectors as on this machine.
fn c_tests_there(binutils: &str, emulator: &str, archive: &Path) -> Result<String> {
    let sources = paths::of_kind("tests/c", "c")?;
    let mut options = Vec::new();
    if binutils.starts_with("s390x") && !multiplies(binutils, emulator)? {
        println!(
            "   NOT RUN: two checks of importance.c. This {emulator} multiplies single precision into double wrongly \
             (MDEBR; mended in QEMU 8.1)"
        );
        options.push("-DMDEBR_IS_WRONG");
    }
    for source in &sources {
        let program = c_tests::output(&format!("{binutils}c_test"))?;
        let mut compiler = run::command(format!("{binutils}gcc"));
        // The tests' own arithmetic, from which they know what to expect, must be in float and not fused. Of s390x, C99
        // makes it double.
        compiler.args(["-std=c99", "-static", "-ffp-contract=off", "-fexcess-precision=fast"]);
        compiler.args(["-Iinclude", "-Itests/c"]).args(STRICT).args(&options);
        run::check(compiler.arg(source).arg(archive).args(["-lm", "-o"]).arg(&program))?;
        run::check(run::command(emulator).arg(&program))?;
    }
    println!("   {} C tests passed under {emulator}", sources.len());
    let less = if options.is_empty() { "" } else { " without two checks, which this emulator computes wrongly" };
    Ok(format!("{} C tests{less}", sources.len()))
}

/// Whether the emulator has the instruction that importances are squared with.
fn multiplies(binutils: &str, emulator: &str) -> Result<bool> {
    let program = c_tests::output("mdebr")?;
    let mut compiler = run::command(format!("{binutils}gcc"));
    run::check(compiler.args(["-O1", "-static", "-march=z10", "report/src/targets/mdebr.c", "-o"]).arg(&program))?;
    Ok(run::command(emulator).arg(program).status().context("the emulator does not start")?.success())
}
