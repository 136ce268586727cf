//! Rendering an animation with many POV-Rays at once.

use super::scenes::Scene;
use super::startup;
use anyhow::{Context, Result, bail};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use xtask::{paths, run};

/// POV-Ray sleeps most of the time between two small frames: many processes share a core well.
const PROCESSES: u32 = 32;
/// The longest sample vector that stack.inc knows.
const AXES: usize = 4;

/// What POV-Ray says of itself.
pub(crate) fn version() -> Result<String> {
    // It goes to the standard error, and the licence follows.
    let output = run::command("povray").arg("--version").output().context("cannot start povray")?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = text.lines().find(|line| line.contains("POV-Ray")).context("povray does not tell its version")?;
    Ok(line.trim().to_owned())
}

/// The folder of the scenes.
pub(crate) fn folder() -> PathBuf {
    paths::root().join("tests/povray/scenes")
}

/// Where frame `number`, from 0, of `count` is.
pub(crate) fn path(out: &Path, number: usize, count: usize) -> PathBuf {
    let digits = count.to_string().len();
    out.join(format!("frame{:0digits$}.ppm", number + 1))
}

/// Renders `count` frames of a scene whose sample vector has `cells` along its axes, `size` x `size` pixels each.
pub(crate) fn render(scene: &Scene, cells: &[u32], count: usize, size: u32, out: &Path) -> Result<()> {
    let count = u32::try_from(count).context("too many frames")?;
    let processes = PROCESSES.min(count);
    let mut running = Running(Vec::new());
    for process in 0..processes {
        let log = out.join(format!("log{process}"));
        let mut command = run::command("povray");
        command.current_dir(folder()).arg(format!("{}.pov", scene.name));
        command.args([format!("+W{size}"), format!("+H{size}")]);
        // Linear values of 16 bits, one ray through each pixel's centre, whatever the user's own settings are.
        command.args(["+FP16", "File_Gamma=1.0", "-A", "Dither=off", "Quality=9", "Output_Alpha=off", "-D", "+WT1"]);
        command.args(["+KFI1".to_owned(), format!("+KFF{count}")]);
        let range = [count * process / processes + 1, count * (process + 1) / processes];
        command.args([format!("+SF{}", range[0]), format!("+EF{}", range[1])]);
        for axis in 0..AXES {
            command.arg(format!("Declare=Cells_{axis}={}", cells.get(axis).unwrap_or(&1)));
        }
        command.arg(format!("+O{}", out.join("frame").display()));
        command.stdin(Stdio::null()).stdout(Stdio::null());
        running.0.push(Process { child: start(&mut command, &log)?, command, log });
    }
    running.wait(scene)
}

/// What it says goes to `log`, anew.
fn start(command: &mut Command, log: &Path) -> Result<Child> {
    let messages = File::create(log).with_context(|| format!("cannot create {}", log.display()))?;
    command.stderr(messages).spawn().context("cannot start povray")
}

struct Process {
    child: Child,
    command: Command,
    log: PathBuf,
}

impl Process {
    /// Waits for it, which is running; it may have to be started again.
    fn finish(&mut self, scene: &Scene) -> Result<(ExitStatus, String)> {
        let mut running = true;
        startup::retry(scene.name, || {
            if !std::mem::take(&mut running) {
                self.child = start(&mut self.command, &self.log)?;
            }
            let status = self.child.wait().context("povray was lost")?;
            let text = fs::read(&self.log).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
            Ok((status, text.unwrap_or_default()))
        })
    }
}

/// They end with this.
struct Running(Vec<Process>);

impl Running {
    fn wait(&mut self, scene: &Scene) -> Result<()> {
        for process in &mut self.0 {
            let (status, text) = process.finish(scene)?;
            if !status.success() {
                // What went wrong stands before "Fatal error"; the credits and settings before that are long.
                let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
                bail!(
                    "povray {}.pov failed, {status}:\n{}",
                    scene.name,
                    lines[lines.len().saturating_sub(6)..].join("\n")
                );
            }
        }
        Ok(())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        for process in &mut self.0 {
            // Neither does anything to a process that has been waited for.
            let _ = process.child.kill();
            let _ = process.child.wait();
        }
    }
}
