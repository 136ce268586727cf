//! What tests the C library from outside, described by tests/CMakeLists.txt: built by CMake, run by CTest.

use crate::tools::{self, Missing, Package};
use crate::{library, paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::PathBuf;

pub const PYTHON: Package = Package { name: "python3", file: "python3" };
/// Debian's cmake does without make unless asked.
pub const CMAKE: [Package; 2] = [Package { name: "cmake", file: "cmake" }, Package { name: "make", file: "make" }];

/// Builds and runs the tests with this label of a preset of tests/CMakePresets.json, which need these packages.
pub fn run(preset: &str, label: &str, needed: &[Package]) -> Result<()> {
    build(preset, label, needed)?;
    let mut test = run::command("ctest");
    test.args(["--verbose", "--no-tests=error", "--label-regex", &format!("^{label}$"), "--test-dir"]);
    test.arg(folder(preset));
    if preset == "valgrind" {
        // One thread runs at a time, and slowly; nothing is written.
        test.args(["--parallel", "2"]);
    }
    let output = test.output().context("cannot start ctest")?;
    let text = String::from_utf8_lossy(&output.stdout);
    // What the programs say follows the number of their test, and what ctest does with them too.
    let said = text.lines().filter_map(|line| line.split_once(": ")).filter(|(number, line)| {
        let is_ctest = ["Test command:", "Working Directory:", "Environment variables:", "Test timeout", " "];
        number.parse::<u32>().is_ok() && !is_ctest.iter().any(|start| line.starts_with(start))
    });
    said.for_each(|(_, line)| println!("   {line}"));
    if !output.status.success() {
        let failed = text.split_once("The following tests").map_or(&text[..], |(_, list)| list);
        bail!("{}{}", failed.trim(), String::from_utf8_lossy(&output.stderr));
    }
    // Not what the ctest of an installed project says.
    let counts = text.lines().filter(|line| line.contains("tests passed") && !line.contains(": "));
    counts.for_each(|line| println!("   {preset}: {line}"));
    Ok(())
}

/// As [`run()`], and what there is of it under the sanitizers, if the compiler has them.
pub fn run_twice(label: &str, needed: &[Package]) -> Result<()> {
    run("default", label, needed)?;
    match run("asan", label, needed) {
        Err(why) if why.is::<Missing>() => println!("   not under the sanitizers: {why}"),
        result => result?,
    }
    Ok(())
}

/// Builds what a label needs.
pub fn build(preset: &str, label: &str, needed: &[Package]) -> Result<()> {
    tools::packages(&[&CMAKE[..], needed].concat())?;
    let mut configure = run::command("cmake");
    configure.args(["-S", "tests", "--preset", preset, "-B"]).arg(folder(preset));
    configure.args(library::settings().map(|setting| format!("-D{setting}")));
    let output = configure.output().context("cannot start cmake")?;
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!("tests/CMakeLists.txt, preset {preset}:\n{said}");
    }
    if let Some(why) = said.lines().find_map(|line| line.strip_prefix("NOT RUN: ")) {
        bail!(Missing(why.to_owned()));
    }
    let mut build = run::command("cmake");
    build.arg("--build").arg(folder(preset)).args(["--parallel", "2", "--target", label]);
    run::read(&mut build).map(drop)
}

/// Where CMake puts what it makes for a preset.
pub fn folder(preset: &str) -> PathBuf {
    paths::output().join("tests").join(preset)
}

/// Where a program of a test goes.
pub fn output(name: &str) -> Result<PathBuf> {
    let folder = paths::output().join("test");
    fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    Ok(folder.join(name))
}
