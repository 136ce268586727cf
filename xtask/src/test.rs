//! `cargo xtask test`: everything that decides whether a change is right.

use crate::c_tests::{self, PYTHON};
use crate::tools::{self, Missing, Package};
use crate::{fuzz, instructions, library, playground, python, renderers, run, start, texts};
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use std::process::Command;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

const PKG_CONFIG: Package = Package { name: "pkg-config", file: "pkg-config" };
/// Devices in software, and what programs for them are made with.
const DEVICES: [Package; 11] = [
    PYTHON,
    Package { name: "clang", file: "clang" },
    Package { name: "spirv-cross", file: "spirv-cross" },
    Package { name: "spirv-tools", file: "spirv-opt" },
    Package { name: "glslang-tools", file: "glslangValidator" },
    Package { name: "libvulkan-dev", file: "/usr/include/vulkan/vulkan.h" },
    Package { name: "mesa-vulkan-drivers", file: "/usr/share/doc/mesa-vulkan-drivers/copyright" },
    Package { name: "chromium-common", file: "/usr/lib/chromium/vk_swiftshader_icd.json" },
    Package { name: "opencl-c-headers", file: "/usr/include/CL/cl.h" },
    Package { name: "ocl-icd-opencl-dev", file: "/usr/share/doc/ocl-icd-opencl-dev/copyright" },
    Package { name: "pocl-opencl-icd", file: "/etc/OpenCL/vendors/pocl.icd" },
];

#[derive(Args)]
pub struct Options {
    /// Only the steps whose heading contains this
    filter: Option<String>,
    /// A step that cannot run here is a failure
    #[arg(long)]
    strict: bool,
    /// Those steps alone that go on beside the others
    #[arg(long, hide = true)]
    beside: bool,
}

pub fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    tools::ensure()?;
    let mut steps =
        Steps { options, passed: 0, failed: Vec::new(), not_run: Vec::new(), left_out: Vec::new(), among: Vec::new() };
    if options.beside {
        beside(&mut steps);
        return steps.finish(start);
    }
    let mut cargo = run::cargo();
    cargo.args(["test", "--profile", "suite", "--no-fail-fast"]).args(start::OTHERS);
    let library_tests = steps.begin("Rust tests of the library (cargo test)", cargo);
    if options.filter.is_none() {
        // Before the steps: many link it, and the benches compile to more with it. Where that fails, they say so.
        println!("building the C library");
        _ = library::build();
    }
    let mut xtask = run::command(std::env::current_exe()?);
    xtask.args(["test", "--beside"]).args(options.strict.then_some("--strict"));
    let others = options.filter.is_none().then(|| steps.begin("steps that went on beside those above", xtask));
    steps.cargo("formatting (cargo fmt --check)", &["fmt", "--all", "--check"], None);
    steps.run("lines of at most 120 columns", texts::columns);
    let clippy = ["clippy", "--quiet", "--profile", "xtask", "--workspace", "--all-targets", "--", "-D", "warnings"];
    steps.cargo("lints (cargo clippy, warnings are errors)", &clippy, None);
    steps.start("the headers are what capi/ generates", "release", "header");
    steps.start("capi/abi.txt: functions, layouts and constants of the C ABI are as promised", "release", "abi");
    steps.c("headers alone: C99, C11, C++11, C++17, C++20, every warning an error", "default", "headers", &[]);
    steps.run("the C library: no panic, only mem* undefined, only nf_* visible", || {
        library::check(&library::build()?, None)
    });
    // Their dependencies are compiled already, in the profile that compiles fast, not the one that runs fast.
    let test = [&["test", "--profile", "xtask"][..], &start::TOOLS].concat();
    steps.cargo("Rust tests of xtask, release and the report (cargo test)", &test, None);
    let doc = ["doc", "--quiet", "--profile", "xtask", "--workspace", "--no-deps", "--document-private-items"];
    steps.cargo("Rust documentation, warnings are errors", &doc, Some(("RUSTDOCFLAGS", "-D warnings")));
    steps.run("each feature of the core alone, without std", each_feature);
    steps.c("C tests as C99", "default", "c99", &[]);
    steps.c("C tests under the address and undefined-behaviour sanitizers", "asan", "c99", &[]);
    steps.c("C tests as C++17, including noisefloor.hpp", "default", "cpp17", &[]);
    steps.c("noisefloor_sampler.h on devices: the bits of the library", "default", "gpu", &DEVICES);
    steps.c("C++ wrapper, with and without exceptions", "default", "wrapper", &[]);
    steps.c("installed: projects of CMake and pkg-config, C, C++", "default", "installed_projects", &[PKG_CONFIG]);
    steps.c("installed: examples_c as a project of its own", "default", "installed_examples", &[]);
    steps.c("examples_c/integrate.c", "default", "integrate", &[]);
    steps.c("examples_c/image.cpp", "default", "image", &[]);
    steps.c("examples_c/shared.c", "default", "shared", &[]);
    steps.c("examples_c/strips.cpp: threads get the bits of one call", "default", "strips", &[]);
    steps.c("examples_c/shards.c: four processes", "default", "shards", &[]);
    steps.c("examples_c/pathtracer: every scene, estimator, sampler and tile", "default", "pathtracer", &[PYTHON]);
    steps.c("examples_c/pathtracer: its parts one by one", "default", "pathtracer_parts", &[]);
    let (rays, all) = (renderers::embree_packages(), [&renderers::embree_packages()[..], &[PYTHON]].concat());
    steps.c("tests/embree: the surfaces of the path tracer's own tree", "default", "embree_agreement", &rays);
    steps.c("tests/embree: every scene, three samplers, 32 x 32 pixels", "default", "embree_scenes", &all);
    steps.c("tests/povray: pictures as integrands, every estimator", "default", "povray", &renderers::POVRAY);
    steps.start("cargo xtask report --quick: the path tracer on Embree", "report", "embree");
    steps.start("cargo xtask report --quick: tables, gradients, estimators, samplers, points", "report", "chapters");
    steps.run("instruction counts: at most the report's and 3 %", || instructions::check(&library::build()?));
    for (heading, label) in [
        ("examples_c/renderers: samplers behind pbrt-v4's and Mitsuba 3's interfaces", "renderers"),
        ("examples_c/train_mlp.c: digits", "train_mlp"),
        ("examples_c/fit_polynomial.c: short runs", "fit_polynomial"),
        ("examples_c/fit_image.cpp: short runs", "fit_image"),
    ] {
        steps.run(heading, || c_tests::run_twice(label, &[PYTHON]));
    }
    steps.c("POV-Ray's patch: well formed, licensed, our side compiles", "default", "povray_patch", &[PYTHON]);
    steps.run("links between documents lead somewhere", texts::links);
    steps.start("cargo package: each is complete and below the registry's limit", "release", "packages");
    steps.start("THIRD_PARTY.md: the licences of all dependencies, each allowed", "release", "licences");
    steps.start("versions: Rust's and the project's, as the texts say", "release", "versions");
    steps.run("sizes: product, tools, documents", texts::sizes);
    steps.run("README.md opens with a part of examples_c/image.cpp", texts::readme);
    steps.c("C code in docs/ that includes the header compiles", "default", "documents", &[PYTHON]);
    match others {
        Some(others) => steps.end(others),
        None => beside(&mut steps),
    }
    steps.end(library_tests);
    steps.finish(start)
}

/// Steps that write nowhere where the others do.
fn beside(steps: &mut Steps) {
    let valgrind = instructions::PACKAGES;
    steps.run("fuzz targets: committed inputs", fuzz::replay);
    steps.c("C tests under valgrind: no wrong address, no undefined value, no leak", "valgrind", "c99", &valgrind);
    steps.c("threads under valgrind: an accumulator each, and a shared one", "valgrind", "threads", &valgrind);
    steps.c("threads under ThreadSanitizer: rules kept, rules broken, a renderer", "tsan", "tsan", &[]);
    steps.run("docs/playground in headless Chromium: small, fast, the library's numbers", playground::test);
    steps.run("python: the wheel, its tests with NumPy and PyTorch, docs/python.md, examples_c/python", python::test);
    steps.start("cargo xtask report --quick: the Python package", "report", "python");
    steps.start("cargo xtask report --quick: Mitsuba 3", "report", "mitsuba");
    let heading = "integrations/mitsuba: Mitsuba 3 from the package index draws the library's bits";
    steps.run(heading, || run::check(renderers::mitsuba()?.arg("integrations/mitsuba/test_mitsuba.py")));
}

/// What a command said and how it ended; after how long.
type Heard = (Result<(String, Result<()>)>, Duration);

/// What goes on beside other steps: many of these leave a core idle.
struct Beside {
    heading: &'static str,
    /// None: it was left out.
    running: Option<JoinHandle<Heard>>,
}

struct Steps<'a> {
    options: &'a Options,
    passed: usize,
    failed: Vec<&'static str>,
    /// What this machine lacks something for.
    not_run: Vec<&'static str>,
    left_out: Vec<&'static str>,
    /// What the steps that went on beside others say of those that failed or were not run.
    among: Vec<String>,
}

impl Steps<'_> {
    fn is_wanted(&self, heading: &str) -> bool {
        self.options.filter.as_ref().is_none_or(|filter| heading.contains(filter.as_str()))
    }

    fn begin(&self, heading: &'static str, mut command: Command) -> Beside {
        let start = Instant::now();
        let hear = move || (run::hear(&mut command), start.elapsed());
        Beside { heading, running: self.is_wanted(heading).then(|| thread::spawn(hear)) }
    }

    /// Waits for what was begun.
    fn end(&mut self, Beside { heading, running }: Beside) {
        let mut among = Vec::new();
        self.run(heading, || {
            let ended = running.and_then(|thread| thread.join().ok());
            let (heard, taken) = ended.context("it did not end")?;
            let (said, result) = heard?;
            println!("{said}   {:.1} s, most of them beside the steps above", taken.as_secs_f64());
            let is_named = |line: &&str| line.starts_with("failed: ") || line.starts_with("not run: ");
            among.extend(said.lines().filter(is_named).map(str::to_owned));
            result?;
            ensure!(among.is_empty(), Missing("some of them, as said above".to_owned()));
            Ok(())
        });
        self.among.extend(among);
    }

    /// Runs one step; the others follow even if it fails.
    fn run(&mut self, heading: &'static str, action: impl FnOnce() -> Result<()>) {
        if !self.is_wanted(heading) {
            self.left_out.push(heading);
            return;
        }
        println!("\n== {heading}");
        let start = Instant::now();
        match action() {
            Ok(()) => {
                println!("   ok ({:.1} s)", start.elapsed().as_secs_f64());
                self.passed += 1;
            }
            Err(why) if why.is::<Missing>() => {
                println!("   NOT RUN: {why}");
                self.not_run.push(heading);
            }
            Err(error) => {
                println!("   FAILED ({:.1} s): {error:#}", start.elapsed().as_secs_f64());
                self.failed.push(heading);
            }
        }
    }

    /// A command of cargo's, with a variable of its environment.
    fn cargo(&mut self, heading: &'static str, arguments: &[&str], variable: Option<(&str, &str)>) {
        self.run(heading, || run::check(run::cargo().args(arguments).envs(variable)));
    }

    /// What `release` or `report` checks.
    fn start(&mut self, heading: &'static str, folder: &str, step: &str) {
        self.run(heading, || start::check(folder, step));
    }

    /// The tests of tests/CMakeLists.txt that have this label.
    fn c(&mut self, heading: &'static str, preset: &str, label: &str, needed: &[Package]) {
        self.run(heading, || c_tests::run(preset, label, needed));
    }

    fn finish(self, start: Instant) -> Result<()> {
        println!("\ntotal {:.0} s", start.elapsed().as_secs_f64());
        if !self.left_out.is_empty() {
            println!("{} steps left out, as asked", self.left_out.len());
        }
        for heading in &self.failed {
            println!("failed: {heading}");
        }
        for heading in &self.not_run {
            println!("not run: {heading}");
        }
        self.among.iter().for_each(|line| println!("   {line}"));
        println!("{} passed, {} failed, {} not run", self.passed, self.failed.len(), self.not_run.len());
        let may_end = self.not_run.is_empty() || !self.options.strict;
        ensure!(may_end, "{} steps could not run, and --strict was given", self.not_run.len());
        if self.passed == 0 && self.failed.is_empty() && self.not_run.is_empty() {
            let word = self.options.filter.as_deref().unwrap_or_default();
            bail!("no heading contains `{word}`; they are\n   {}", self.left_out.join("\n   "));
        }
        ensure!(self.failed.is_empty(), "{} of the steps above failed", self.failed.len());
        Ok(())
    }
}

/// Checks the core with no feature, and with each alone.
fn each_feature() -> Result<()> {
    let packages = run::packages()?;
    let core = packages.iter().find(|package| package["name"] == "noisefloor").context("there is no `noisefloor`")?;
    let features = core["features"].as_object().context("`noisefloor` has no features")?;
    let names = features.keys().map(String::as_str).filter(|name| *name != "default");
    for feature in [""].into_iter().chain(names) {
        println!("   --no-default-features --features \"{feature}\"");
        let mut check = run::cargo();
        check.args(["check", "--quiet", "--profile", "xtask", "--package", "noisefloor", "--no-default-features"]);
        check.args(["--features", feature]);
        run::check(check.env("RUSTFLAGS", "-D warnings"))?;
    }
    Ok(())
}
