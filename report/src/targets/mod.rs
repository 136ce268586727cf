//! `cargo xtask targets`: the library on other processors, with and without an operating system, run under QEMU or
//! Wine; and its size there.

mod bare_metal;
mod build;
mod platform;
mod sizes;

use crate::chapters::described::Description;
use crate::chapters::plan::{Extent, Plan};
use crate::chapters::{chapter::Chapter, write_chapter};
use crate::measure::output::Output;
use crate::measure::table::Table;
use anyhow::{Context, Result, bail};
use clap::Args;
use platform::{Platform, Targets};
use std::path::Path;
use xtask::tools::Package;
use xtask::{c_tests, library, paths, run, tools};

#[derive(Args)]
pub(crate) struct Options {
    /// Only this target; can be given several times. docs/report/sizes.md is written when all are built
    #[arg(long = "target", value_name = "TRIPLE")]
    targets: Vec<String>,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let all = Targets::read()?;
    if let Some(unknown) = options.targets.iter().find(|name| all.platforms.iter().all(|known| known.triple != **name))
    {
        let known: Vec<&str> = all.platforms.iter().map(|known| known.triple.as_str()).collect();
        bail!("`{unknown}` is none of the targets that this knows: {}", known.join(", "));
    }
    let is_wanted = |platform: &&Platform| options.targets.is_empty() || options.targets.contains(&platform.triple);
    let wanted: Vec<&Platform> = all.platforms.iter().filter(is_wanted).collect();
    let packages = all.packages.iter().chain(wanted.iter().flat_map(|platform| &platform.packages));
    tools::packages(&packages.copied().collect::<Vec<Package>>())?;
    let mut ran = Table::new("targets", "target | Rust's name | optimised | what ran | on");
    let mut sizes = Table::new("sizes", "target | kind | service | bytes");
    let mut example = Table::new("example", "target | call | bytes");
    for platform in wanted {
        println!("== {}", platform.id());
        let measured = one(platform, &all, &mut ran, &mut sizes, &mut example);
        measured.with_context(|| format!("target {}", platform.id()))?;
    }
    if options.targets.is_empty() { write(&[ran, sizes, example]) } else { Ok(()) }
}

/// docs/report/sizes.md and .json.
fn write(tables: &[Table]) -> Result<()> {
    let plan = Plan::new(Extent::Default)?;
    let description: Description = plan.read("sizes")?;
    let mut chapter = Chapter::new(description.names("sizes", &plan)[1]);
    let find = |name: &str| tables.iter().find(|table| table.name == name).cloned().context("no such table");
    description.write(&find, &mut chapter, &plan)?;
    let compiler = run::read(run::command(run::DEBIANS[1]).arg("--version"))?;
    chapter.setting("compiler", compiler.trim().split(" (").next().unwrap_or_default());
    if !find("sizes")?.distinct("kind")?.contains(&sizes::KINDS[2]) {
        chapter.setting("variables", "none");
    }
    let output = Output::new(&paths::root().join("docs/report"))?;
    write_chapter(&output, "sizes", &chapter.json(), &|_| true)?;
    output.commit(&[])?;
    println!("wrote docs/report/sizes.md and sizes.json");
    Ok(())
}

/// Builds, runs what can be run, and measures.
fn one(platform: &Platform, all: &Targets, ran: &mut Table, sizes: &mut Table, example: &mut Table) -> Result<()> {
    let raw = build::archive(platform)?;
    // How large code is matters where memory is scarce, which it is not on Windows.
    for service in all.services.iter().filter(|_| !platform.is_windows()) {
        let found = sizes::measure(platform, &raw, service)?;
        // A line of variables stands there only if there are any.
        let found = sizes::KINDS.into_iter().zip(found).filter(|(kind, bytes)| *kind != "variables" || *bytes > 0);
        found.for_each(|(kind, bytes)| sizes.push([&platform.name, kind, &service.name, &bytes.to_string()]));
    }
    let (told, what) = there(platform, all, &raw)?;
    let calls = told.stacks.into_iter().map(|(call, depth)| (format!("`{call}`"), depth.into()));
    for (call, bytes) in calls.chain(told.image.map(|bytes| ("image".to_owned(), bytes))) {
        example.push([&platform.name, &call, &bytes.to_string()]);
    }
    let version = run::read(platform.emulate().arg("--version"))?;
    // QEMU says much more in parentheses and further lines.
    let version = version.lines().next().unwrap_or_default().split(" (").next().unwrap_or_default();
    let emulator = format!("`{}`: {version}", platform.emulator);
    println!("   ran on {emulator}");
    let triple = format!("`{}`", platform.triple);
    ran.push([&platform.name, &triple, &platform.opt_level, &what, &emulator]);
    Ok(())
}

/// Runs what can be run there, and says what that was.
fn there(platform: &Platform, all: &Targets, raw: &Path) -> Result<(bare_metal::Told, String)> {
    let Some(binutils) = &platform.binutils else {
        let module = c_tests::output("services.wasm")?;
        sizes::link(platform, raw, &all.exports, &module)?;
        return Ok((bare_metal::wasm(platform, &module)?, "the example".to_owned()));
    };
    let archive = library::one_object(raw, &paths::output().join(platform.id()), &format!("{binutils}ar"))?;
    library::check(&archive, platform.board.is_some().then_some(raw))?;
    println!("   no panic, no undefined symbol but mem* and the compiler's, only nf_* visible in the object");
    if let Some(board) = &platform.board {
        let told = bare_metal::alone(platform, board, binutils, raw)?;
        return Ok((told, "the example, without an operating system".to_owned()));
    }
    let mut ran = c_tests_there(platform, binutils, &archive)?;
    let mut told = bare_metal::Told::default();
    // It measures its stack by means of POSIX.
    if !platform.is_windows() {
        told = bare_metal::hosted(platform, binutils, &archive)?;
        ran += ", the example";
    }
    if let Some(toolchain) = &platform.toolchain {
        build::consumer(platform, toolchain)?;
        ran += ", a CMake project";
    }
    Ok((told, ran))
}

const STRICT: [&str; 5] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-O1"];

/// Compiles and runs every C test; they read the same pinned vectors as on this machine.
fn c_tests_there(platform: &Platform, binutils: &str, archive: &Path) -> Result<String> {
    let sources = paths::of_kind("tests/c", "c")?;
    let mut options = Vec::new();
    if binutils.starts_with("s390x") && !multiplies(platform, binutils)? {
        println!(
            "   NOT RUN: a check of importance.c. This emulator multiplies single precision into double wrongly \
             (MDEBR; mended in QEMU 8.1)"
        );
        options.push("-DMDEBR_IS_WRONG");
    }
    for source in &sources {
        // On Windows programs are called so, and elsewhere they may be.
        let program = c_tests::output(&format!("{binutils}c_test.exe"))?;
        let mut compiler = run::command(format!("{binutils}gcc"));
        // The tests' own arithmetic, from which they know what to expect, must be in float and not fused. Of s390x, C99
        // makes it double.
        compiler.args(["-std=c99", "-static", "-ffp-contract=off", "-fexcess-precision=fast"]);
        compiler.args(["-Iinclude", "-Itests/c"]).args(STRICT).args(&options);
        run::check(compiler.arg(source).arg(archive).args(["-lm", "-o"]).arg(&program))?;
        run::check(platform.emulate().arg(&program))?;
    }
    println!("   {} C tests passed under {}", sources.len(), platform.emulator);
    let less = if options.is_empty() { "" } else { " without one check, which this emulator computes wrongly" };
    Ok(format!("{} C tests{less}", sources.len()))
}

/// Whether the emulator has the instruction that importances are squared with.
fn multiplies(platform: &Platform, binutils: &str) -> Result<bool> {
    let program = c_tests::output("mdebr")?;
    let mut compiler = run::command(format!("{binutils}gcc"));
    run::check(compiler.args(["-O1", "-static", "-march=z10", "report/src/targets/mdebr.c", "-o"]).arg(&program))?;
    Ok(platform.emulate().arg(program).status().context("the emulator does not start")?.success())
}
