//! A program that runs: its lines are read as they come, and it does not outlive what reads them.

use anyhow::{Context, Result};
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;

/// Killed when dropped, if it still runs.
pub(super) struct Running {
    child: Child,
    /// Reads what the program says of its errors: left in the pipe it would, beyond 64 kB, stop the program.
    errors: Option<JoinHandle<std::io::Result<Vec<u8>>>>,
}

impl Running {
    pub(super) fn start(mut command: Command) -> Result<Self> {
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        let errors = child.stderr.take().map(|mut stderr| {
            std::thread::spawn(move || {
                let mut bytes = Vec::new();
                stderr.read_to_end(&mut bytes).map(|_| bytes)
            })
        });
        Ok(Self { child, errors })
    }

    /// Hands every line of the standard output to `take`, until the program closes it or `take` fails.
    pub(super) fn read_lines(&mut self, mut take: impl FnMut(&str) -> Result<()>) -> Result<()> {
        let Some(stdout) = self.child.stdout.take() else { return Ok(()) };
        for line in BufReader::new(stdout).lines() {
            take(&line.context("cannot read the program's output")?)?;
        }
        Ok(())
    }

    /// How it ended, and what it wrote to the standard error.
    pub(super) fn finish(mut self) -> Result<(ExitStatus, String)> {
        let status = self.child.wait().context("the program was lost")?;
        let bytes = match self.errors.take().map(JoinHandle::join) {
            Some(Ok(bytes)) => bytes.context("cannot read the program's errors")?,
            _ => Vec::new(),
        };
        Ok((status, String::from_utf8_lossy(&bytes).into_owned()))
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
    use anyhow::bail;
    use std::time::Instant;

    fn shell(script: &str) -> Running {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        Running::start(command).expect("a shell")
    }

    #[test]
    fn many_errors_do_not_stop_the_program() {
        // 300 kB of errors before the first line of output.
        let mut running = shell("i=0; while [ $i -lt 3000 ]; do printf '%0100d' 0 >&2; i=$((i + 1)); done; echo line");
        let mut lines = Vec::new();
        running
            .read_lines(|line| {
                lines.push(line.to_owned());
                Ok(())
            })
            .expect("readable");
        let (status, errors) = running.finish().expect("it ends");
        assert!(status.success() && lines == ["line"] && errors.len() == 300_000);
    }

    #[test]
    fn a_program_whose_output_is_wrong_is_ended() {
        let start = Instant::now();
        let mut running = shell("echo nonsense; exec sleep 60");
        let id = running.child.id();
        assert!(running.read_lines(|line| bail!("`{line}`")).is_err());
        drop(running);
        assert!(start.elapsed().as_secs() < 30, "the program was waited for");
        assert!(!std::path::Path::new(&format!("/proc/{id}/cmdline")).exists(), "it still runs");
    }
}
