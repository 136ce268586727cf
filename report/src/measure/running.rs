//! A program that runs: its lines are read as they come, and it does not outlive what reads them.

use super::interrupt;
use anyhow::{Context, Result, bail};
use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How soon an interrupt ends a program that says nothing.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs a program to its end, and returns what it wrote to the standard error. `take` sees each line of the standard
/// output as it comes. Where that fails, or the user interrupts, the program is ended.
pub(crate) fn run(
    mut command: Command,
    interrupted: &AtomicBool,
    mut take: impl FnMut(&str) -> Result<()>,
) -> Result<String> {
    let words: Vec<_> =
        [command.get_program()].into_iter().chain(command.get_args()).map(OsStr::to_string_lossy).collect();
    let line = words.join(" ");
    let (mut running, lines) = Running::start(&mut command).with_context(|| format!("cannot start {line}"))?;
    loop {
        interrupt::check(interrupted)?;
        match lines.recv_timeout(PATIENCE) {
            Ok(line) => take(&line.context("cannot read the program's output")?)?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    // It may have closed its output before its end; mostly just before.
    let mut pause = Duration::from_millis(1);
    let status = loop {
        interrupt::check(interrupted)?;
        match running.child.try_wait().context("the program was lost")? {
            Some(status) => break status,
            None => std::thread::sleep(pause),
        }
        pause = PATIENCE.min(2 * pause);
    };
    let errors = running.errors()?;
    interrupt::check(interrupted)?;
    if !status.success() {
        bail!("{line} failed, {status}\n{}", errors.trim());
    }
    Ok(errors)
}

/// Killed when dropped, if it still runs.
struct Running {
    child: Child,
    /// Reads what the program says of its errors: left in the pipe it would, beyond 64 kB, stop the program.
    errors: Option<JoinHandle<std::io::Result<Vec<u8>>>>,
}

/// Lines of the standard output, until the program closes it.
type Lines = mpsc::Receiver<std::io::Result<String>>;

impl Running {
    fn start(command: &mut Command) -> Result<(Self, Lines)> {
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        let errors = child.stderr.take().map(|mut stderr| {
            std::thread::spawn(move || {
                let mut bytes = Vec::new();
                stderr.read_to_end(&mut bytes).map(|_| bytes)
            })
        });
        let (sender, lines) = mpsc::channel();
        if let Some(stdout) = child.stdout.take() {
            // Nobody listens any more once the program is to end.
            std::thread::spawn(move || BufReader::new(stdout).lines().try_for_each(|line| sender.send(line)));
        }
        Ok((Self { child, errors }, lines))
    }

    /// What it wrote to the standard error.
    fn errors(&mut self) -> Result<String> {
        let bytes = match self.errors.take().map(JoinHandle::join) {
            Some(Ok(bytes)) => bytes.context("cannot read the program's errors")?,
            _ => Vec::new(),
        };
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Neither does anything to a process that has been waited for.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering;
    use std::time::Instant;

    fn shell(script: &str, interrupted: &AtomicBool, take: impl FnMut(&str) -> Result<()>) -> Result<String> {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        run(command, interrupted, take)
    }

    /// The process whose number the program said before it slept.
    fn is_gone(id: &str) -> bool {
        !std::path::Path::new(&format!("/proc/{id}/cmdline")).exists()
    }

    #[test]
    fn many_errors_do_not_stop_the_program() {
        // 300 kB of errors before the first line of output.
        let script = "i=0; while [ $i -lt 3000 ]; do printf '%0100d' 0 >&2; i=$((i + 1)); done; echo line";
        let mut lines = Vec::new();
        let errors = shell(script, &AtomicBool::new(false), |line| {
            lines.push(line.to_owned());
            Ok(())
        });
        assert!(lines == ["line"] && errors.is_ok_and(|errors| errors.len() == 300_000));
    }

    #[test]
    fn a_program_whose_output_is_wrong_is_ended() {
        let (start, mut id) = (Instant::now(), String::new());
        let result = shell("echo $$; exec sleep 60", &AtomicBool::new(false), |line| {
            id = line.to_owned();
            bail!("`{line}`")
        });
        assert!(result.is_err() && is_gone(&id), "process {id} still runs");
        assert!(start.elapsed().as_secs() < 30, "the program was waited for");
    }

    #[test]
    fn an_interrupt_ends_a_program_that_says_nothing() {
        for script in ["echo $$; exec sleep 60", "echo $$; exec >&-; exec sleep 60"] {
            let (start, mut id, interrupted) = (Instant::now(), String::new(), AtomicBool::new(false));
            let result = shell(script, &interrupted, |line| {
                id = line.to_owned();
                interrupted.store(true, Ordering::Relaxed);
                Ok(())
            });
            assert!(result.is_err_and(|error| error.to_string() == interrupt::INTERRUPTED) && is_gone(&id));
            assert!(start.elapsed().as_secs() < 30, "the program was waited for");
        }
    }

    #[test]
    fn a_failure_shows_the_command_and_what_it_said() {
        let error = shell("echo reason >&2; exit 3", &AtomicBool::new(false), |_| Ok(())).expect_err("it failed");
        let text = error.to_string();
        assert!(text.contains("sh -c") && text.contains("exit status: 3\nreason"), "{text}");
    }
}
