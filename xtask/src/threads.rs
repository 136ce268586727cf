//! The header's rules for threads under ThreadSanitizer, which watches the library too: it is built again,
//! instrumented.

use crate::c_tests::{STRICT, output};
use crate::outcome::Outcome;
use crate::{fuzz, library, paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const OPTION: &str = "-fsanitize=thread";
/// What a program exits with in which ThreadSanitizer has found something.
const FOUND: i32 = 66;
/// The rules that tests/threads/rules.cpp can break.
const BREAKABLE: [&str; 4] = ["accumulator", "table", "generator", "tile"];

pub fn run() -> Result<Outcome> {
    let Some(start) = Start::find()? else {
        return Ok(Outcome::NotRun(
            "this C++ compiler or this system cannot run programs with -fsanitize=thread; on 64-bit Linux gcc (Debian: \
             libtsan2) and clang can"
                .to_owned(),
        ));
    };
    let library = instrumented()?;

    let rules = output("tsan_rules")?;
    compile("tests/threads/rules.cpp", &library, &rules)?;
    start.check_clean(&rules, &[])?;
    for broken in BREAKABLE {
        let status = start.command(&rules).arg(broken).stdout(Stdio::null()).stderr(Stdio::null()).status();
        let status = status.context("cannot start the program")?;
        if status.code() != Some(FOUND) {
            bail!("ThreadSanitizer did not find the race of `rules {broken}` ({status})");
        }
    }
    println!("   rules kept: nothing found; each of {} broken: found", BREAKABLE.join(", "));

    let renderer = output("tsan_pathtracer")?;
    compile("examples_c/pathtracer.cpp", &library, &renderer)?;
    let picture = output("tsan_picture")?;
    let size = ["--width", "24", "--height", "24", "--spp", "16", "--threads", "3", "--output"];
    for options in [
        ["--accumulate", "4", "--sampler", "random", "--estimators", "mc,robust,k_fold,incremental"],
        ["--accumulate", "4", "--sampler", "tile", "--estimators", "mc,robust,k_fold,incremental"],
        ["--frame", "1", "--sampler", "tile", "--estimators", "mc,robust,shared,shared_k_fold"],
    ] {
        start.check_clean(&renderer, &[&size[..], &[picture.to_string_lossy().as_ref()], &options].concat())?;
    }
    println!("   the path tracer, three threads, accumulators merged, and fits shared: nothing found");
    Ok(Outcome::Passed)
}

/// How an instrumented program starts.
struct Start {
    /// ThreadSanitizer wants some addresses for itself, and those of a system that spreads its addresses widely may be
    /// in the way.
    fixed_addresses: bool,
}

impl Start {
    /// None if there is no way.
    fn find() -> Result<Option<Self>> {
        let (source, program) = (output("tsan.cpp")?, output("tsan")?);
        let text = "#include <thread>\nint main() { std::thread([] {}).join(); }\n";
        fs::write(&source, text).with_context(|| format!("cannot write {}", source.display()))?;
        let mut compiler = run::compiler("CXX", "c++");
        compiler.args([OPTION, "-pthread"]).arg(&source).arg("-o").arg(&program);
        let works = |command: &mut Command| {
            command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
        };
        if !works(&mut compiler) {
            return Ok(None);
        }
        let ways = [false, true].map(|fixed_addresses| Self { fixed_addresses });
        Ok(ways.into_iter().find(|way| works(&mut way.command(&program))))
    }

    fn command(&self, program: &Path) -> Command {
        if !self.fixed_addresses {
            return run::command(program);
        }
        let mut command = run::command("setarch");
        command.arg("-R").arg(program);
        command
    }

    fn check_clean(&self, program: &Path, arguments: &[&str]) -> Result<()> {
        let output = self.command(program).args(arguments).output().context("cannot start the program")?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let report: Vec<&str> = said.lines().filter(|line| !line.starts_with("progress")).take(60).collect();
            bail!("{} {}: {}\n{}", program.display(), arguments.join(" "), output.status, report.join("\n"));
        }
        Ok(())
    }
}

/// The library, compiled for ThreadSanitizer, and what its runtime may lack.
fn instrumented() -> Result<[PathBuf; 2]> {
    let (host, folder) = (fuzz::host()?, paths::output().join("tsan"));
    let mut cargo = run::cargo();
    cargo.args(["rustc", "--quiet", "--release", "--package", "noisefloor-capi", "--crate-type", "staticlib"]);
    cargo.args(["--target", &host, "--target-dir"]).arg(&folder);
    // A stable compiler refuses sanitizers otherwise. The precompiled part of Rust's core is not instrumented, which it
    // refuses too; nearly all that is used of it is inlined, and so is.
    cargo.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=thread -Cunsafe-allow-abi-mismatch=sanitizer");
    run::check(cargo.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1"))?;
    let archive = library::one_object(&folder.join(host).join("release/libnoisefloor.a"), &folder, "")?;
    let instrumented = library::names(&archive, &["--undefined-only"])?;
    if !instrumented.iter().any(|(_, name)| name == "__tsan_write8") {
        bail!("{} was compiled without ThreadSanitizer", archive.display());
    }
    let object = output("tsan_memory.o")?;
    let mut compiler = run::compiler("CC", "cc");
    compiler.arg("-std=c99").args(STRICT).args(["-fno-builtin", "-c"]);
    run::check(compiler.arg("tests/threads/tsan_memory.c").arg("-o").arg(&object))?;
    Ok([archive, object])
}

fn compile(source: &str, library: &[PathBuf; 2], program: &Path) -> Result<()> {
    let mut compiler = run::compiler("CXX", "c++");
    compiler.arg("-std=c++17").args(STRICT).args(["-g", OPTION, "-pthread", "-Iinclude"]);
    run::check(compiler.arg(source).args(library).arg("-o").arg(program))
}
