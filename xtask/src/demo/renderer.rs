//! Compiling and running the path tracer.

use super::plan::{Plan, Scene};
use crate::{library, paths, run};
use anyhow::{Context, Result, bail};
use indicatif::ProgressBar;
use serde::Deserialize;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// The compiled path tracer.
pub(crate) struct Renderer {
    program: PathBuf,
}

/// One line of the path tracer's output: how long one estimator took, in seconds summed over the threads.
#[derive(Deserialize, Clone)]
pub(crate) struct Timing {
    pub(crate) estimator: String,
    pub(crate) total_seconds: f64,
    pub(crate) sampling_ns_per_sample: f64,
    pub(crate) estimating_ns_per_sample: f64,
}

/// One run of the path tracer.
pub(crate) struct Job<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) spp: u32,
    pub(crate) seed: u64,
    /// Empty: a reference.
    pub(crate) estimators: &'a [&'a str],
    /// Where the images go: `PREFIX.ESTIMATOR.pfm`.
    pub(crate) prefix: &'a Path,
}

impl Renderer {
    /// Builds the library and the program that links it.
    pub(crate) fn build() -> Result<Self> {
        let archive = library::build()?;
        let program = paths::output().join("pathtracer");
        let mut compiler = run::compiler("CXX", "c++");
        compiler.args(["-O2", "-std=c++17", "-Wall", "-Wextra", "-Iinclude", "examples_c/pathtracer.cpp"]);
        run::check(compiler.arg(&archive).args(["-pthread", "-o"]).arg(&program))?;
        Ok(Self { program })
    }

    /// Renders, moving `bar` forward by `work` in total.
    pub(crate) fn render(&self, plan: &Plan, job: &Job, bar: &ProgressBar, work: u64) -> Result<Vec<Timing>> {
        let mut command = run::command(&self.program);
        let size = plan.size.to_string();
        command.args(["--scene", job.scene.name, "--width", &size, "--height", &size]);
        command.args(["--spp", &job.spp.to_string(), "--order", &job.scene.order.to_string()]);
        command.args(["--seed", &job.seed.to_string(), "--threads", &plan.threads.to_string(), "--output"]);
        command.arg(job.prefix);
        if job.estimators.is_empty() {
            command.arg("--reference");
        } else {
            command.args(["--estimators", &job.estimators.join(",")]);
        }
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot start {}", self.program.display()))?;

        let start = bar.position();
        let mut timings = Vec::new();
        if let Some(stdout) = child.stdout.take() {
            for line in BufReader::new(stdout).lines() {
                let line = line.context("cannot read the path tracer's output")?;
                if let Some(part) = line.strip_prefix("progress ") {
                    let part: f64 = part.parse().with_context(|| format!("the path tracer said `{line}`"))?;
                    bar.set_position(start + (part * work as f64) as u64);
                } else {
                    timings
                        .push(serde_json::from_str(&line).with_context(|| format!("the path tracer said `{line}`"))?);
                }
            }
        }
        let mut message = String::new();
        if let Some(mut stderr) = child.stderr.take() {
            stderr.read_to_string(&mut message).context("cannot read the path tracer's errors")?;
        }
        let status = child.wait().context("the path tracer was lost")?;
        if !status.success() {
            bail!("rendering `{}` failed, {status}\n{}", job.scene.name, message.trim());
        }
        bar.set_position(start + work);
        Ok(timings)
    }
}
