//! What a chapter takes: seconds, and seconds of processors; and what else the machine did meanwhile. On a busy machine
//! only the seconds of processors say something.

use std::cell::Cell;
use std::fs;
use std::time::Instant;

/// Linux counts processor time in hundredths of a second, whatever the kernel's own clock.
const TICKS_PER_SECOND: f64 = 100.0;

/// Runs from when it was made or restarted.
pub(super) struct Clock(Cell<Reading>);

#[derive(Clone, Copy)]
struct Reading {
    time: Instant,
    /// Processor time of this process and its children, and of the whole machine; None where the system does not say.
    own: Option<f64>,
    all: Option<f64>,
}

impl Reading {
    fn now() -> Self {
        let all = fs::read_to_string("/proc/stat").ok().and_then(|text| busy_seconds(&text));
        Self { time: Instant::now(), own: processor_seconds(), all }
    }
}

impl Clock {
    pub(super) fn start() -> Self {
        Self(Cell::new(Reading::now()))
    }

    pub(super) fn restart(&self) {
        self.0.set(Reading::now());
    }

    pub(super) fn seconds(&self) -> f64 {
        self.0.get().time.elapsed().as_secs_f64()
    }

    /// Of this process and those that it ran and that have ended; None where the system does not say.
    pub(super) fn processor_seconds(&self) -> Option<f64> {
        Some(processor_seconds()? - self.0.get().own?)
    }

    /// How many cores others kept busy meanwhile, on average; None where the system does not say.
    pub(super) fn other_work(&self) -> Option<f64> {
        let (since, now) = (self.0.get(), Reading::now());
        other_work(now.all? - since.all?, now.own? - since.own?, (now.time - since.time).as_secs_f64())
    }
}

/// Both of the same `seconds`. What the two files count differs by a few ticks, so that a quiet machine's may be
/// below 0.
fn other_work(all: f64, own: f64, seconds: f64) -> Option<f64> {
    (seconds > 0.0).then(|| ((all - own) / seconds).max(0.0))
}

/// proc(5), the first line of /proc/stat: user, nice, system, idle, iowait, irq, softirq, steal. All but idle and
/// iowait is work; stolen time is that of other guests of the same computer. The guests of this machine, which follow,
/// are in the user's time already.
fn busy_seconds(text: &str) -> Option<f64> {
    seconds(text.lines().next()?.strip_prefix("cpu ")?, &[0, 1, 2, 5, 6, 7])
}

/// proc(5): fields 14 to 17 are the user's and the system's time, and the same of children that were waited for.
fn processor_seconds() -> Option<f64> {
    // The second field, the program's name in parentheses, may hold spaces.
    seconds(fs::read_to_string("/proc/self/stat").ok()?.rsplit_once(')')?.1, &[11, 12, 13, 14])
}

/// The sum of these fields.
fn seconds(fields: &str, counted: &[usize]) -> Option<f64> {
    let fields: Vec<&str> = fields.split_whitespace().collect();
    let ticks = counted.iter().map(|&at| fields.get(at)?.parse::<f64>().ok());
    Some(ticks.sum::<Option<f64>>()? / TICKS_PER_SECOND)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn idle_cores_and_waiting_for_disks_are_no_work() {
        let text = "cpu  1000 200 300 90000 8000 50 60 70 900 0\ncpu0 1 1 1 1 1 1 1 1 0 0\n";
        let seconds = busy_seconds(text).expect("eight fields");
        assert!((seconds - 16.8).abs() < 1e-9, "{seconds}");
        for damaged in ["", "cpu 1 2 3", "cpu0 1 2 3 4 5 6 7 8", "cpu 1 2 3 4 5 six 7 8"] {
            assert!(busy_seconds(damaged).is_none(), "{damaged}");
        }
    }

    #[test]
    fn other_work_is_what_the_machine_did_beyond_ours() {
        // In ten seconds two cores worked 18, ours 12 of them.
        assert_eq!(other_work(18.0, 12.0, 10.0), Some(0.6));
        assert_eq!(other_work(11.9, 12.0, 10.0), Some(0.0));
        assert_eq!(other_work(1.0, 1.0, 0.0), None);
    }
}
