//! Runs an optimisation: cost, progress, checkpoints, interruption.

use crate::common::Common;
use crate::interrupt::Watch;
use crate::process::status;
use crate::say::{is_gone, say};
use fsot::checkpoint::{self, Problem};
use fsot::counted::counted;
use fsot::error::{Error, Result};
use fsot::output::{self, Outputs};
use fsot::run::Optimization;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use serde::Serialize;
use serde_json::{Value, json};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::{Builder, TempPath};

/// Steps are measured for this long before the cost is announced.
const MEASURED: Duration = Duration::from_millis(250);
/// Without a terminal, a line is printed this often.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// A run that took longer is saved until its outputs are in place, in case that fails.
const WORTH_SAVING: Duration = Duration::from_secs(5);
/// The energy shown is a moving average over about this many steps: that of a single step depends on its directions.
const AVERAGED: f64 = 32.0;
/// Parts of the progress bar.
const BAR: u64 = 1000;

/// A finished run, whose checkpoint stays until [`finish`].
#[derive(Debug)]
#[must_use]
pub(crate) struct Run {
    /// Steps in all.
    pub(crate) iterations: u64,
    /// Steps that an earlier, interrupted run had taken.
    pub(crate) resumed_at: u64,
    /// Time that this run took.
    pub(crate) seconds: f64,
    /// The moving average of the energy at the end; none if no step was left to take.
    pub(crate) energy: Option<f64>,
    problem: Problem,
    checkpoint: PathBuf,
    /// Whether the checkpoint is this run's: continued from, or saved.
    saved: bool,
    end: End,
}

/// Where the state of a run that ended is.
#[derive(Debug)]
enum End {
    /// The run was short.
    Unsaved,
    Checkpoint,
    /// Where the system has temporary files: the checkpoint could not be written. It is removed when it is dropped.
    Spare(TempPath),
    Failed(Error),
}

impl End {
    /// Where the state is, which is then kept, and what the same command takes to continue from there.
    fn keep(&mut self, checkpoint: &Path) -> Option<(String, String)> {
        match self {
            End::Unsaved | End::Failed(_) => None,
            End::Checkpoint => Some((checkpoint.display().to_string(), String::new())),
            End::Spare(path) => {
                path.disable_cleanup(true);
                let place = path.display().to_string();
                let again = format!(" with --checkpoint {place}");
                Some((place, again))
            }
        }
    }
}

impl Run {
    /// A line of a report.
    pub(crate) fn describe(&self, text: &mut String) {
        let energy = self.energy.map_or(String::new(), |energy| format!(", energy {energy:.3e} at the end"));
        let resumed = if self.resumed_at > 0 { format!(", continued at {}", self.resumed_at) } else { String::new() };
        let steps = counted(self.iterations, "step");
        text.push_str(&format!("  {steps}{resumed} in {:.2} s{energy}\n", self.seconds));
    }

    /// Of an error after the last step, how the outputs are made without taking the steps again.
    pub(crate) fn kept(&mut self, error: Error) -> Error {
        if is_gone(&error) || matches!(self.end, End::Unsaved) {
            return error;
        }
        let again = match self.end.keep(&self.checkpoint) {
            None => "The finished run could not be saved either".to_owned(),
            Some((place, again)) => {
                format!("The finished run is saved in {place}: run the same command again{again} to write what it made")
            }
        };
        Error::Input(format!("{error}. {again}"))
    }

    /// What [`describe`](Run::describe) says, for a report in JSON.
    pub(crate) fn json(&self) -> Value {
        json!({
            "iterations": self.iterations, "resumed_at": self.resumed_at, "seconds": self.seconds,
            "energy": self.energy, "fingerprint": self.problem.fingerprint(),
        })
    }
}

/// Takes all steps that are left. `problem` describes everything that the result depends on.
///
/// # Errors
/// A checkpoint that cannot be used; with the state saved, [`Error::Stopped`] after Ctrl-C, and what [`say`] returns if
/// nobody reads standard error any more.
pub(crate) fn drive(optimization: &mut dyn Optimization, problem: &impl Serialize, common: &Common) -> Result<Run> {
    let problem = Problem::new(problem)?;
    let checkpoint = common.checkpoint(&problem);
    // One that was not asked for stops nothing.
    let unnamed = || output::check([checkpoint.as_path()], []).err();
    let unwritable = if common.named_checkpoint().is_none() { unnamed() } else { None };
    let resumed = checkpoint::resume(&checkpoint, &problem, optimization).map_err(|error| match error {
        Error::Input(why) => Error::Input(format!("{why}. Remove it to start anew, or name another with --checkpoint")),
        error => error,
    })?;
    let watch = Watch::start()?;
    let mut progress = Progress::new(common, &*optimization);
    if let Some(error) = &unwritable {
        progress.say(&format!("warning: no checkpoint can be saved: {error}; --checkpoint names another place"));
    }
    if resumed {
        progress.say(&format!("continuing from {} at step {}", checkpoint.display(), optimization.iteration()));
    }
    let every = Duration::try_from_secs_f64(common.checkpoint_every).unwrap_or(Duration::MAX);
    let mut last = Instant::now();
    let (mut saved, mut can_save) = (resumed, unwritable.is_none());
    loop {
        // After the last step, too: what follows may take long, and the same command begins there.
        if progress.unheard.is_some() || watch.stopped() {
            progress.clear();
            return Err(leave(optimization, &checkpoint, &problem, progress.unheard));
        }
        if optimization.iteration() >= optimization.iterations() {
            break;
        }
        let energy = optimization.advance();
        progress.step(&*optimization, energy);
        if energy.is_some() && last.elapsed() >= every && can_save {
            match checkpoint::save(&checkpoint, &problem, optimization) {
                Ok(()) => saved = true,
                Err(error) => {
                    progress.say(&format!("warning: no checkpoint can be saved: {error}"));
                    can_save = false;
                }
            }
            last = Instant::now();
        }
    }
    progress.clear();
    let seconds = progress.start.elapsed();
    let mut end = End::Unsaved;
    if resumed || seconds >= WORTH_SAVING.min(every) {
        // A full disk is about to be reported by whoever writes the output.
        end = save(&checkpoint, &problem, optimization);
        saved |= matches!(end, End::Checkpoint);
    }
    if watch.stopped() {
        return Err(leave(optimization, &checkpoint, &problem, None));
    }
    Ok(Run {
        iterations: optimization.iterations(),
        resumed_at: progress.first,
        seconds: seconds.as_secs_f64(),
        energy: progress.energy,
        problem,
        checkpoint,
        saved,
        end,
    })
}

/// Saves the state of a run that ends here, if need be in another place.
fn save(checkpoint: &Path, problem: &Problem, optimization: &dyn Optimization) -> End {
    let Err(error) = checkpoint::save(checkpoint, problem, optimization) else { return End::Checkpoint };
    let spare = || {
        let file = Builder::new().prefix("fsot-").suffix(".checkpoint").tempfile().ok()?.into_temp_path();
        checkpoint::save(&file, problem, optimization).ok()?;
        Some(file)
    };
    spare().map_or(End::Failed(error), End::Spare)
}

/// Adds a command's outputs and puts them in place, then removes its run's checkpoint.
///
/// # Errors
/// As [`Outputs::add`] and [`Outputs::commit`], and where the finished run is saved; [`Error::Stopped`] if Ctrl-C came
/// meanwhile, with the outputs in place.
pub(crate) fn finish(run: &mut Run, add: impl FnOnce(&mut Outputs) -> Result<()>) -> Result<()> {
    let mut outputs = Outputs::new();
    add(&mut outputs).map_err(|error| run.kept(error))?;
    let watch = Watch::start()?;
    outputs.commit().map_err(|error| run.kept(error))?;
    // Meanwhile another run may have saved its state under the same name.
    if run.saved {
        checkpoint::remove(&run.checkpoint, &run.problem);
    }
    if watch.stopped() { Err(Error::Stopped("stopped; the outputs are in place".to_owned())) } else { Ok(()) }
}

/// Saves the state of a run that ends here, and says so, unless there is another reason.
fn leave(optimization: &dyn Optimization, path: &Path, problem: &Problem, why: Option<Error>) -> Error {
    let [done, all] = [optimization.iteration(), optimization.iterations()];
    if done == 0 {
        let nothing = "stopped before the first step was done: there is nothing to continue";
        return why.unwrap_or_else(|| Error::Stopped(nothing.to_owned()));
    }
    let mut end = save(path, problem, optimization);
    if let End::Failed(error) = end {
        return Error::Input(format!("stopped, and the state could not be saved: {error}"));
    }
    let (place, again) = end.keep(path).unwrap_or_default();
    why.unwrap_or_else(|| {
        Error::Stopped(format!(
            "stopped at step {done} of {all}; the state is saved in {place}. Run the same command again{again} to \
             continue"
        ))
    })
}

struct Progress {
    start: Instant,
    first: u64,
    /// The work that was done before.
    before: f64,
    energy: Option<f64>,
    announced: bool,
    quiet: bool,
    bar: Option<ProgressBar>,
    line: Instant,
    /// Why nobody reads what is said.
    unheard: Option<Error>,
}

impl Progress {
    fn new(common: &Common, optimization: &dyn Optimization) -> Progress {
        Progress {
            start: Instant::now(),
            first: optimization.iteration(),
            before: optimization.work()[0],
            energy: None,
            announced: common.quiet,
            quiet: common.quiet,
            bar: None,
            line: Instant::now(),
            unheard: None,
        }
    }

    fn say(&mut self, text: &str) {
        match &self.bar {
            _ if self.quiet => {}
            Some(bar) => bar.println(text),
            None => {
                if let Err(error) = say(text) {
                    self.unheard = Some(error);
                }
            }
        }
    }

    fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }

    /// After a step, whose energy there is then, or a part of one.
    fn step(&mut self, optimization: &dyn Optimization, energy: Option<f64>) {
        let [done, all] = [optimization.iteration(), optimization.iterations()];
        let work = optimization.work();
        if let Some(energy) = energy {
            let weight = 1.0 / (done.saturating_sub(self.first) as f64).clamp(1.0, AVERAGED);
            self.energy = Some(self.energy.map_or(energy, |average| average + weight * (energy - average)));
        }
        if self.quiet {
            return;
        }
        if !self.announced && (self.start.elapsed() >= MEASURED || done == all) {
            self.announce(done, all, work);
        }
        if let Some(bar) = &self.bar {
            let [done, all] = work;
            bar.set_position((done / all * BAR as f64) as u64);
            bar.set_message(self.message(work));
        } else if self.announced && self.line.elapsed() >= LINE_EVERY {
            self.line = Instant::now();
            self.say(&format!("step {done} of {all}, {}", self.message(work)));
        }
    }

    fn message(&self, work: [f64; 2]) -> String {
        let energy = self.energy.map_or("-".to_owned(), |energy| format!("{energy:.3e}"));
        format!("energy {energy}, {} left", HumanDuration(self.left(work)))
    }

    /// Says what the run costs, extrapolated from its first steps, and starts the bar if there is a terminal.
    fn announce(&mut self, done: u64, all: u64, work: [f64; 2]) {
        self.announced = true;
        let threads = rayon::current_num_threads();
        let total = self.start.elapsed().saturating_add(self.left(work));
        let duration = if total.as_secs() < 2 {
            format!("{:.1} seconds", total.as_secs_f64())
        } else {
            HumanDuration(total).to_string()
        };
        let memory = peak_memory().map_or(String::new(), |mebibytes| format!(", {mebibytes} MiB of memory"));
        let [steps, threads] = [counted(all - self.first, "step"), counted(threads, "thread")];
        self.say(&format!("{steps}, about {duration} on {threads}{memory}"));
        if std::io::stderr().is_terminal() && done < all {
            let style = ProgressStyle::with_template("{wide_bar} {percent}% {msg}");
            let bar = ProgressBar::new(BAR);
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            self.bar = Some(bar);
        }
        self.line = Instant::now();
    }

    /// How long the rest of the work takes, if it goes on as until now.
    fn left(&self, [done, all]: [f64; 2]) -> Duration {
        let seconds = self.start.elapsed().as_secs_f64() / (done - self.before) * (all - done);
        Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
    }
}

/// The most memory this process has used, in MiB, where the system tells.
fn peak_memory() -> Option<u64> {
    let kibibytes: u64 = status("VmHWM")?.trim_end_matches("kB").trim().parse().ok()?;
    Some(kibibytes.div_ceil(1024))
}
