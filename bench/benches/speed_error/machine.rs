//! What the figures were measured on.

use std::fs;
use std::time::{Duration, Instant};

/// A description for the report's head.
pub(crate) struct Machine {
    started: Instant,
    pub(crate) elapsed: Duration,
    pub(crate) processor: String,
    pub(crate) threads: usize,
    load_before: Option<f64>,
    load_after: Option<f64>,
}

impl Machine {
    pub(crate) fn now() -> Self {
        let information = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = information.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        Self {
            started: Instant::now(),
            elapsed: Duration::ZERO,
            processor: model.map_or(std::env::consts::ARCH, |(_, name)| name).to_owned(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            load_before: load(),
            load_after: None,
        }
    }

    pub(crate) fn finish(&mut self) {
        self.elapsed = self.started.elapsed();
        self.load_after = load();
    }

    /// The one-minute load average before and after; this run, single-threaded, is 1 of the latter.
    pub(crate) fn load(&self) -> String {
        let text = |load: Option<f64>| load.map_or("unknown".to_owned(), |load| format!("{load:.2}"));
        format!("{} before, {} after", text(self.load_before), text(self.load_after))
    }
}

fn load() -> Option<f64> {
    fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}
