//! Compiling and running the path tracer, or another program that has its command line.

use super::running;
use super::samplers::Tiles;
use anyhow::{Context, Result};
use indicatif::ProgressBar;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use xtask::{library, paths, run};

/// The compiled program.
pub(crate) struct Renderer {
    program: PathBuf,
}

/// One line of the program's output: how long one estimator took, in seconds summed over the threads.
#[derive(Deserialize, Clone)]
pub(crate) struct Timing {
    pub(crate) estimator: String,
    pub(crate) total_seconds: f64,
    /// Making the points and tracing them.
    pub(crate) sampling_ns_per_sample: f64,
    pub(crate) estimating_ns_per_sample: f64,
}

/// One run of the program.
#[derive(Clone, Copy)]
pub(crate) struct Job<'a> {
    pub(crate) scene: &'a str,
    pub(crate) spp: u32,
    /// Total degree of the fits.
    pub(crate) order: u32,
    pub(crate) seed: u64,
    /// Renderings with as many consecutive seeds, in one process.
    pub(crate) seeds: u32,
    pub(crate) frame: u32,
    pub(crate) sampler: Sampler<'a>,
    /// Empty: a reference.
    pub(crate) estimators: &'a [&'a str],
    /// Further words of the command line.
    pub(crate) options: &'a [&'a str],
    /// What it adds to the progress bar.
    pub(crate) work: u64,
}

/// Where the sample points come from.
#[derive(Clone, Copy)]
pub(crate) enum Sampler<'a> {
    /// The library's own.
    Default,
    Random,
    Sobol,
    /// A built-in tile's name, or a file.
    Tile(&'a str),
    /// A file of points that another program made.
    Table(&'a Path),
}

/// As many threads as there are cores.
pub(crate) fn threads() -> u32 {
    std::thread::available_parallelism().map_or(1, |n| n.get().min(256) as u32)
}

/// Where a renderer leaves an estimator's images, one of each seed from `first` on.
pub(crate) fn images(prefix: &Path, estimator: &str, first: u64, seeds: u32) -> impl Iterator<Item = PathBuf> {
    (first..first + u64::from(seeds)).map(move |seed| match seeds {
        1 => prefix.with_extension(format!("{estimator}.pfm")),
        _ => prefix.with_extension(format!("{estimator}.{seed}.pfm")),
    })
}

impl Renderer {
    /// Builds the library and the program that links it.
    pub(crate) fn build() -> Result<Self> {
        let archive = library::build()?;
        let program = paths::output().join("pathtracer");
        let mut compiler = run::compiler("CXX", "c++");
        compiler.args(["-O2", "-std=c++17", "-Wall", "-Wextra", "-Iinclude", "examples_c/pathtracer.cpp"]);
        run::compile(compiler.arg(&archive).args(["-pthread", "-o"]).arg(&program))?;
        Ok(Self::new(program))
    }

    /// Runs a program that is there already.
    pub(crate) fn new(program: PathBuf) -> Self {
        Self { program }
    }

    /// The names of the tiles that the library carries.
    pub(crate) fn tiles(&self) -> Result<Tiles> {
        let help = run::read(run::command(&self.program).arg("--help"))?;
        let line = help.lines().find_map(|line| line.strip_prefix("tiles:")).unwrap_or_default();
        Ok(Tiles(line.split_whitespace().map(str::to_owned).collect()))
    }

    /// Renders `size` x `size` pixels to the files of [`images`], with as many threads as there are cores.
    pub(crate) fn render(&self, job: &Job, size: u32, prefix: &Path, bar: &ProgressBar) -> Result<Vec<Timing>> {
        self.render_with(threads(), job, size, prefix, bar)
    }

    /// The same with so many threads; the picture does not depend on them.
    pub(crate) fn render_with(
        &self,
        threads: u32,
        job: &Job,
        size: u32,
        prefix: &Path,
        bar: &ProgressBar,
    ) -> Result<Vec<Timing>> {
        let mut command = run::command(&self.program);
        let size = size.to_string();
        command.args(["--scene", job.scene, "--width", &size, "--height", &size]);
        command.args(["--spp", &job.spp.to_string(), "--order", &job.order.to_string()]);
        command.args(["--seed", &job.seed.to_string(), "--frame", &job.frame.to_string()]);
        match job.sampler {
            Sampler::Default => command.args(["--sampler", "default"]),
            Sampler::Random => command.args(["--sampler", "random"]),
            Sampler::Sobol => command.args(["--sampler", "sobol"]),
            Sampler::Tile(tile) => command.args(["--sampler", "tile", "--tile", tile]),
            Sampler::Table(file) => command.args(["--sampler", "table", "--table"]).arg(file),
        };
        if job.seeds > 1 {
            command.args(["--seeds", &job.seeds.to_string()]);
        }
        command.args(job.options);
        command.args(["--threads", &threads.to_string(), "--output"]).arg(prefix);
        if job.estimators.is_empty() {
            command.arg("--reference");
        } else {
            command.args(["--estimators", &job.estimators.join(",")]);
        }
        let start = bar.position();
        let mut timings = Vec::new();
        let rendered = running::run(command, |line| {
            if let Some(part) = line.strip_prefix("progress ") {
                let part: f64 = part.parse().with_context(|| format!("the path tracer said `{line}`"))?;
                bar.set_position(start + (part * job.work as f64) as u64);
            } else {
                timings.push(serde_json::from_str(line).with_context(|| format!("the path tracer said `{line}`"))?);
            }
            Ok(())
        });
        rendered.with_context(|| format!("rendering `{}` failed", job.scene))?;
        bar.set_position(start + job.work);
        Ok(timings)
    }
}
