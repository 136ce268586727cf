//! Compiling and running the path tracer, or another program that has its command line.

use super::running;
use anyhow::{Context, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use xtask::run;

/// The compiled program.
pub(crate) struct Renderer {
    program: PathBuf,
    tiles: Vec<String>,
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

impl Timing {
    pub(crate) fn frame(&self) -> f64 {
        self.sampling_ns_per_sample + self.estimating_ns_per_sample
    }
}

/// What is integrated, pixel by pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View<'a> {
    pub(crate) scene: &'a str,
    /// Pixels on a side.
    pub(crate) size: u32,
    pub(crate) frame: u32,
    /// Samples per pixel of each half of its reference.
    pub(crate) reference: u32,
}

/// One run of the program: renderings that differ in their seeds alone.
#[derive(Clone)]
pub(crate) struct Job<'a> {
    pub(crate) view: View<'a>,
    pub(crate) spp: u32,
    /// Total degree of the fits.
    pub(crate) order: u32,
    pub(crate) sampler: Sampler,
    /// None: a reference.
    pub(crate) estimators: Vec<&'a str>,
    /// The first of as many consecutive ones.
    pub(crate) seed: u64,
    pub(crate) seeds: u32,
    /// Further words of the command line.
    pub(crate) options: Vec<&'a str>,
}

impl<'a> Job<'a> {
    /// Order 2, random samples, one seed.
    pub(crate) fn new(view: View<'a>, spp: u32, estimators: &[&'a str]) -> Self {
        let (estimators, options) = (estimators.to_vec(), Vec::new());
        Self { view, spp, order: 2, sampler: sampler(&["random"]), estimators, seed: 1, seeds: 1, options }
    }

    pub(crate) fn is_random(&self) -> bool {
        self.sampler == sampler(&["random"])
    }
}

/// Where the sample points come from: words of the command line.
pub(crate) type Sampler = Vec<String>;

fn sampler(words: &[&str]) -> Sampler {
    [&["--sampler"], words].concat().into_iter().map(str::to_owned).collect()
}

/// A file of points that another program made.
pub(crate) fn table(file: &Path) -> Sampler {
    sampler(&["table", "--table", &file.to_string_lossy()])
}

/// As many threads as there are cores.
pub(crate) fn threads() -> u32 {
    std::thread::available_parallelism().map_or(1, |n| n.get().min(256) as u32)
}

/// Where a renderer leaves an estimator's images, one of each seed.
pub(crate) fn images(prefix: &Path, estimator: &str, job: &Job) -> impl Iterator<Item = PathBuf> {
    let seeds = job.seeds;
    (job.seed..job.seed + u64::from(seeds)).map(move |seed| match seeds {
        1 => prefix.with_extension(format!("{estimator}.pfm")),
        _ => prefix.with_extension(format!("{estimator}.{seed}.pfm")),
    })
}

impl Renderer {
    /// Takes a compiled program.
    pub(crate) fn new(program: PathBuf) -> Result<Self> {
        let help = run::read(run::command(&program).arg("--help"))?;
        let tiles = help.lines().find_map(|line| line.strip_prefix("tiles:")).unwrap_or_default();
        Ok(Self { program, tiles: tiles.split_whitespace().map(str::to_owned).collect() })
    }

    /// A sampler as tables call it; None if there is no such tile. `tile 2D`: that of so many dimensions which has as
    /// many samples as are drawn, or the next fewer.
    pub(crate) fn sampler(&self, name: &str, spp: u32) -> Option<Sampler> {
        let tile = |name: &str| self.tiles.iter().any(|tile| tile == name).then(|| sampler(&["tile", "--tile", name]));
        match (name, name.strip_prefix("tile ")) {
            (_, Some(dims)) => (0..=spp.ilog2()).rev().find_map(|power| tile(&format!("128_{}SPP_{dims}", 1 << power))),
            ("default" | "random", _) => Some(sampler(&[name])),
            ("Owen-Sobol", _) => Some(sampler(&["sobol"])),
            _ => tile(name),
        }
    }

    /// Renders to the files of [`images`]. The picture does not depend on the number of threads.
    pub(crate) fn render(&self, job: &Job, prefix: &Path, threads: u32) -> Result<Vec<Timing>> {
        let View { scene, size, frame, .. } = job.view;
        let mut command = run::command(&self.program);
        let size = size.to_string();
        command.args(["--scene", scene, "--width", &size, "--height", &size]);
        command.args(["--spp", &job.spp.to_string(), "--order", &job.order.to_string()]);
        command.args(["--seed", &job.seed.to_string(), "--frame", &frame.to_string()]);
        command.args(&job.sampler).args(&job.options);
        if job.seeds > 1 {
            command.args(["--seeds", &job.seeds.to_string()]);
        }
        command.args(["--threads", &threads.to_string(), "--output"]).arg(prefix);
        if job.estimators.is_empty() {
            command.arg("--reference");
        } else {
            command.args(["--estimators", &job.estimators.join(",")]);
        }
        let mut timings = Vec::new();
        let rendered = running::run(command, |line| {
            if !line.starts_with("progress ") {
                timings.push(serde_json::from_str(line).with_context(|| format!("the path tracer said `{line}`"))?);
            }
            Ok(())
        });
        rendered.with_context(|| format!("rendering `{scene}` failed"))?;
        Ok(timings)
    }
}
