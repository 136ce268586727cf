//! Options that subcommands share, and how they report.

use crate::say::{STANDARD_OUTPUT, say};
use clap::{Args, ValueEnum};
use fsot::checkpoint::Problem;
use fsot::{Error, error::Result, optimize, output};
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The options of everything that optimises.
#[derive(Args, Clone, Debug)]
pub(crate) struct Common {
    /// The file to write; an older one is replaced when the new one is complete
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// The same seed gives the same bytes, whatever the machine and the number of threads [default: 1]
    #[arg(long)]
    seed: Option<u64>,
    /// How long to optimise [default: standard]
    #[arg(long, value_enum)]
    quality: Option<Quality>,
    /// How long to optimise, in steps; overrides --quality
    #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(u64).range(1..))]
    iterations: Option<u64>,
    /// Where an interrupted run is saved, and continued from [default: OUT.checkpoint]
    #[arg(long, value_name = "FILE")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, hide = true)]
    pub(crate) checkpoint_every: f64,
    /// Print nothing but errors, and with --json the report
    #[arg(long, short)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) report: Report,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

/// How a report is printed.
#[derive(Args, Clone, Debug)]
pub(crate) struct Report {
    /// Print the report as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// How many threads to work on.
#[derive(Args, Clone, Debug)]
pub(crate) struct Threads {
    /// Threads to work on [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = thread_count)]
    threads: Option<usize>,
}

/// How long to optimise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Quality {
    /// To try things out
    Draft,
    /// Good
    Standard,
    /// Several times longer for the last few percent
    High,
}

fn thread_count(text: &str) -> std::result::Result<usize, String> {
    match text.parse() {
        Ok(count @ 1..=1024) => Ok(count),
        _ => Err("give 1 to 1024, or leave it out to use every core".to_owned()),
    }
}

impl Threads {
    /// Runs `work` with rayon's work done by that many threads.
    pub(crate) fn install<R: Send>(&self, work: impl FnOnce() -> Result<R> + Send) -> Result<R> {
        let mut builder = rayon::ThreadPoolBuilder::new();
        if let Some(count) = self.threads {
            builder = builder.num_threads(count);
        }
        let pool = builder.build().map_err(|error| Error::Input(format!("cannot start the threads: {error}")))?;
        pool.install(work)
    }
}

impl Report {
    /// Prints a report, the text or with --json the value: to standard output, or to standard error if that may be one
    /// of the `outputs`.
    pub(crate) fn print<'a>(
        &self,
        outputs: impl IntoIterator<Item = &'a Path>,
        text: &str,
        json: &Value,
    ) -> Result<()> {
        let text = if self.json { format!("{json:#}") } else { text.to_owned() };
        if outputs.into_iter().any(output::is_stream) {
            return say(text.trim_end());
        }
        let mut stdout = std::io::stdout().lock();
        let written = writeln!(stdout, "{}", text.trim_end()).and_then(|()| stdout.flush());
        written.map_err(Error::write(STANDARD_OUTPUT))
    }
}

impl Common {
    /// Whether no report is printed.
    pub(crate) fn is_silent(&self) -> bool {
        self.quiet && !self.report.json
    }

    /// What --seed says.
    pub(crate) fn seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }

    /// What --quality and --iterations ask for.
    pub(crate) fn effort(&self) -> optimize::Quality {
        self.given_effort().unwrap_or_default()
    }

    /// What --quality or --iterations ask for, if either is given.
    pub(crate) fn given_effort(&self) -> Option<optimize::Quality> {
        match (self.iterations, self.quality) {
            (Some(iterations), _) => Some(optimize::Quality::Iterations(iterations)),
            (None, quality) => quality.map(|quality| match quality {
                Quality::Draft => optimize::Quality::Draft,
                Quality::Standard => optimize::Quality::Standard,
                Quality::High => optimize::Quality::High,
            }),
        }
    }

    /// What --seed says, if it is given.
    pub(crate) fn given_seed(&self) -> Option<u64> {
        self.seed
    }

    /// Where a run is saved: beside the output, or in the working folder if the output is a pipe or a device, by a name
    /// that no other problem's run has.
    pub(crate) fn checkpoint(&self, problem: &Problem) -> PathBuf {
        let unnamed = || format!("fsot-{}.checkpoint", &problem.fingerprint()[..16]).into();
        self.named_checkpoint().unwrap_or_else(unnamed)
    }

    /// The same, if it does not depend on the problem: [`check_outputs`](Self::check_outputs) has seen it.
    pub(crate) fn named_checkpoint(&self) -> Option<PathBuf> {
        let beside = || (!output::is_stream(&self.out)).then(|| self.out.with_added_extension("checkpoint"));
        self.checkpoint.clone().or_else(beside)
    }

    /// Fails if one of these files, the output or the checkpoint could not be written, or is an input: call it before
    /// the work.
    pub(crate) fn check_outputs<'a>(
        &self,
        more: impl IntoIterator<Item = &'a Path>,
        inputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<()> {
        let checkpoint = self.named_checkpoint();
        if let Some(checkpoint) = checkpoint.as_deref().filter(|path| output::is_stream(path)) {
            return Err(Error::Input(format!(
                "--checkpoint {}: a checkpoint is read again, so it must be a file: give another name",
                checkpoint.display()
            )));
        }
        let mut paths = vec![self.out.as_path()];
        paths.extend(checkpoint.as_deref());
        for path in more {
            paths.push(path);
        }
        output::check(paths, inputs)
    }

    /// Prints what was made, unless --quiet without --json; `more` are the outputs beside OUT.
    pub(crate) fn print<'a>(
        &'a self,
        more: impl IntoIterator<Item = &'a Path>,
        text: &str,
        json: &Value,
    ) -> Result<()> {
        if self.is_silent() { Ok(()) } else { self.report.print(more.into_iter().chain([&*self.out]), text, json) }
    }
}
