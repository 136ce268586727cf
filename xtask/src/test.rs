//! `cargo xtask test`: everything that decides whether a change is right.

use crate::outcome::Outcome;
use crate::{
    abi, c_tests, columns, embree, examples, fit, fuzz, header, house, install, instructions, library, links,
    path_tracer, python, release, report, run, threads, tools, train_mlp, valgrind,
};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Args)]
pub struct Options {
    /// Only the steps whose heading contains this
    filter: Option<String>,
    /// A step that cannot run here is a failure
    #[arg(long)]
    strict: bool,
}

pub fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    tools::ensure()?;
    // Before the steps: many of them link it, and the benches compile to more with it.
    println!("building the C library");
    let archive = library::build().map_err(|error| format!("{error:#}"));
    let archive = || -> Result<PathBuf> {
        archive.clone().map_err(|error| anyhow::anyhow!("the C library could not be built: {error}"))
    };
    let mut steps = Steps { options, passed: 0, failed: Vec::new(), not_run: Vec::new(), left_out: 0 };
    steps.run("formatting (cargo fmt --check)", || {
        run::check(run::cargo().args(["fmt", "--all", "--check"]))?;
        Ok(Outcome::Passed)
    });
    steps.run("lines of at most 120 columns", columns::check);
    steps.run("lints (cargo clippy, warnings are errors)", || {
        let mut clippy = run::cargo();
        clippy.args(["clippy", "--quiet", "--workspace", "--all-targets", "--", "-D", "warnings"]);
        run::check(&mut clippy)?;
        Ok(Outcome::Passed)
    });
    steps.run("include/noisefloor.h is what capi/ generates", || {
        header::check_committed()?;
        Ok(Outcome::Passed)
    });
    steps.run("capi/abi.txt: functions, layouts and constants of the C ABI are as promised", abi::check);
    steps.run("headers alone: C99, C11, C++11, C++17, C++20, every warning an error", || {
        header::check_compiles()?;
        Ok(Outcome::Passed)
    });
    steps.run("the C library: no panic, no undefined symbol but mem*, only nf_* visible", || {
        library::check(&archive()?)?;
        Ok(Outcome::Passed)
    });
    // The benches have none.
    steps.run("Rust tests of the library (cargo test)", || {
        let mut test = run::cargo();
        test.args(["test", "--profile", "suite", "--workspace", "--no-fail-fast"]);
        test.args(["--exclude", "xtask", "--exclude", "noisefloor-report", "--exclude", "noisefloor-bench"]);
        run::check(&mut test)?;
        Ok(Outcome::Passed)
    });
    // Its dependencies are compiled already, in the profile that compiles fast, not the one that runs fast.
    steps.run("Rust tests of xtask and the report (cargo test)", || {
        let mut test = run::cargo();
        test.args(["test", "--profile", "xtask", "--package", "xtask", "--package", "noisefloor-report"]);
        run::check(&mut test)?;
        Ok(Outcome::Passed)
    });
    steps.run("Rust documentation, warnings are errors", || {
        let mut doc = run::cargo();
        doc.args(["doc", "--quiet", "--workspace", "--no-deps", "--document-private-items"]);
        run::check(doc.env("RUSTDOCFLAGS", "-D warnings"))?;
        Ok(Outcome::Passed)
    });
    steps.run("each feature of the core alone, without std", || {
        each_feature()?;
        Ok(Outcome::Passed)
    });
    steps.run("fuzz targets: committed inputs", fuzz::replay);
    steps.run("C tests as C99", || c_tests::run(c_tests::Language::C99, &[], &archive()?));
    steps.run("C tests under the address and undefined-behaviour sanitizers", || {
        c_tests::sanitized(c_tests::Language::C99, &archive()?)
    });
    steps.run("C tests under valgrind: no wrong address, no undefined value, no leak", || valgrind::run(&archive()?));
    steps.run("threads under valgrind: an accumulator each is no race, a shared one is", || {
        valgrind::threads(&archive()?)
    });
    steps.run("threads under ThreadSanitizer: the rules kept, each of them broken, and a renderer", threads::run);
    steps
        .run("C tests as C++17, including noisefloor.hpp", || c_tests::run(c_tests::Language::Cpp17, &[], &archive()?));
    steps.run("C++ wrapper, with and without exceptions", || c_tests::wrapper(&archive()?));
    steps.run(
        "installed: CMake and pkg-config projects, C and C++, shared and static, either alone, part of another project",
        install::test::projects,
    );
    steps.run("installed: examples_c as a project of its own", install::test::examples);
    steps.run("examples_c/integrate.c", || examples::integrate(&archive()?, "integrate.c"));
    steps.run("examples_c/image.cpp", || examples::integrate(&archive()?, "image.cpp"));
    steps.run("examples_c/shared.c", || examples::integrate(&archive()?, "shared.c"));
    steps.run("examples_c/shards.c: four processes", || examples::shards(&archive()?));
    steps.run("examples_c/pathtracer.cpp: every scene, estimator, sampler and tile, 32 x 32 pixels", || {
        path_tracer::check(&archive()?)
    });
    steps.run(
        "parts of examples_c/pathtracer: intersections, lights, surfaces, the image plane, paths, MIS, the program",
        || path_tracer::parts(&archive()?),
    );
    steps.run("tests/embree: Embree meets the same surfaces as the path tracer's own tree", || {
        embree::agreement(&archive()?)
    });
    steps.run("tests/embree: every scene, three samplers, 32 x 32 pixels", || embree::scenes(&archive()?));
    steps.run("tests/povray: POV-Ray's pictures as integrands, every estimator and sampler, 32 x 32 pixels", || {
        report::check("povray")
    });
    steps.run("cargo xtask report --quick: every number of the text is in the JSON", || report::check("embree"));
    steps.run("examples_c/renderers: samplers behind pbrt-v4's and Mitsuba 3's interfaces", || {
        examples::renderers(&archive()?)
    });
    steps.run("examples_c/python: ctypes declarations, tests and a training loop", || python::run(&archive()?));
    steps.run(
        "cargo xtask report --quick: tables, gradients, estimators, known integrands, samplers, point sets",
        || report::check("chapters"),
    );
    steps.run("instruction counts: none above the committed report's by 3 %", || instructions::check(&archive()?));
    steps.run("examples_c/train_mlp.c: digits", || train_mlp::digits(&archive()?));
    steps.run("examples_c/fit_polynomial.c: short runs", || fit::polynomial(&archive()?));
    steps.run("examples_c/fit_image.cpp: short runs", || fit::photograph(&archive()?));
    steps.run("POV-Ray's patch: well formed, its licence stated, and our side of it compiles", || {
        report::check("patch")
    });
    steps.run("links between documents lead somewhere", links::check);
    steps.run(
        "cargo package: every published package is complete and below the registry's limit",
        release::package::check,
    );
    steps.run("THIRD_PARTY.md: the licences of all dependencies, each allowed", release::licences::check);
    steps.run("versions: Rust's and the project's, as the texts say", release::versions::check);
    steps.run("sizes: product, tools, documents", house::print);
    steps.run("README.md opens with a part of examples_c/image.cpp", examples::readme);
    steps.run("C code in docs/ that includes the header compiles", examples::documents);
    steps.finish(start)
}

struct Steps<'a> {
    options: &'a Options,
    passed: usize,
    failed: Vec<&'static str>,
    /// What this machine lacks something for.
    not_run: Vec<&'static str>,
    left_out: usize,
}

impl Steps<'_> {
    /// Runs one step; the others follow even if it fails.
    fn run(&mut self, heading: &'static str, action: impl FnOnce() -> Result<Outcome>) {
        if self.options.filter.as_ref().is_some_and(|filter| !heading.contains(filter.as_str())) {
            self.left_out += 1;
            return;
        }
        println!("\n== {heading}");
        let start = Instant::now();
        match action() {
            Ok(Outcome::Passed) => {
                println!("   ok ({:.1} s)", start.elapsed().as_secs_f64());
                self.passed += 1;
            }
            Ok(Outcome::NotRun(why)) => {
                println!("   NOT RUN: {why}");
                self.not_run.push(heading);
            }
            Err(error) => {
                println!("   FAILED ({:.1} s): {error:#}", start.elapsed().as_secs_f64());
                self.failed.push(heading);
            }
        }
    }

    fn finish(self, start: Instant) -> Result<()> {
        println!("\ntotal {:.0} s", start.elapsed().as_secs_f64());
        if self.left_out > 0 {
            println!("{} steps left out, as asked", self.left_out);
        }
        for heading in &self.failed {
            println!("failed: {heading}");
        }
        for heading in &self.not_run {
            println!("not run: {heading}");
        }
        println!("{} passed, {} failed, {} not run", self.passed, self.failed.len(), self.not_run.len());
        if self.options.strict && !self.not_run.is_empty() {
            bail!("{} steps could not run, and --strict was given", self.not_run.len());
        }
        if self.passed == 0 && self.failed.is_empty() && self.not_run.is_empty() {
            bail!("no step ran: no heading contains the word that was given");
        }
        if !self.failed.is_empty() {
            bail!("{} of the steps above failed", self.failed.len());
        }
        Ok(())
    }
}

/// Builds the core with no feature, and with each alone.
fn each_feature() -> Result<()> {
    let metadata = run::read(run::cargo().args(["metadata", "--no-deps", "--format-version", "1"]))?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata).context("cargo metadata wrote no JSON")?;
    let packages = metadata["packages"].as_array().map_or(&[][..], Vec::as_slice);
    let core = packages.iter().find(|package| package["name"] == "noisefloor").context("there is no `noisefloor`")?;
    let features = core["features"].as_object().context("`noisefloor` has no features")?;
    let names = features.keys().map(String::as_str).filter(|name| *name != "default");
    for feature in [""].into_iter().chain(names) {
        println!("   --no-default-features --features \"{feature}\"");
        let mut build = run::cargo();
        build.args(["build", "--quiet", "--package", "noisefloor", "--no-default-features", "--features", feature]);
        run::check(build.env("RUSTFLAGS", "-D warnings"))?;
    }
    Ok(())
}
