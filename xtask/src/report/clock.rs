//! What a chapter takes: seconds, and seconds of processors. On a busy machine only the latter say something.

use std::cell::Cell;
use std::fs;
use std::time::Instant;

/// Linux counts processor time in hundredths of a second, whatever the kernel's own clock.
const TICKS_PER_SECOND: f64 = 100.0;

/// Runs from when it was made or restarted.
pub(super) struct Clock(Cell<(Instant, Option<f64>)>);

impl Clock {
    pub(super) fn start() -> Self {
        Self(Cell::new((Instant::now(), processor_seconds())))
    }

    pub(super) fn restart(&self) {
        self.0.set((Instant::now(), processor_seconds()));
    }

    pub(super) fn seconds(&self) -> f64 {
        self.0.get().0.elapsed().as_secs_f64()
    }

    /// Of this process and those that it ran and that have ended; None where the system does not say.
    pub(super) fn processor_seconds(&self) -> Option<f64> {
        Some(processor_seconds()? - self.0.get().1?)
    }
}

/// proc(5): fields 14 to 17 are the user's and the system's time, and the same of children that were waited for.
fn processor_seconds() -> Option<f64> {
    let line = fs::read_to_string("/proc/self/stat").ok()?;
    // The second field, the program's name in parentheses, may hold spaces.
    let (_, fields) = line.rsplit_once(')')?;
    let ticks: Option<Vec<f64>> = fields.split_whitespace().skip(11).take(4).map(|field| field.parse().ok()).collect();
    Some(ticks.filter(|ticks| ticks.len() == 4)?.iter().sum::<f64>() / TICKS_PER_SECOND)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_of_this_process_and_of_children_counts() {
        if !cfg!(target_os = "linux") {
            return;
        }
        let clock = Clock::start();
        let before = clock.processor_seconds().expect("Linux says");
        let work = "i=0; while [ $i -lt 100000 ]; do i=$((i + 1)); done";
        assert!(std::process::Command::new("sh").args(["-c", work]).status().expect("a shell").success());
        assert!(clock.processor_seconds().expect("Linux says") > before, "a child's loop takes more than a tick");
        clock.restart();
        assert!(clock.seconds() < 1.0);
    }
}
