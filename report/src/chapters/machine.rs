//! What the figures are measured on.

use serde_json::{Value, json};
use std::fs;
use xtask::run;

const UNKNOWN: &str = "unknown";

/// What stays as it is between two runs on one machine: how the clock is governed, and its limits; the compilers of
/// Rust, C and C++.
pub(super) fn read() -> Value {
    let information = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = information.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let kernel = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    let compilers = [run::command("rustc"), run::compiler("CC", "cc"), run::compiler("CXX", "c++")];
    let compilers = compilers.map(|mut compiler| {
        let text = run::read(compiler.arg("--version")).unwrap_or_default();
        text.lines().next().unwrap_or(UNKNOWN).to_owned()
    });
    json!({
        "processor": model.map_or(std::env::consts::ARCH, |(_, name)| name).trim(),
        "cores": std::thread::available_parallelism().map_or(1, usize::from),
        "clock": clock(),
        "kernel": format!("{} {}", std::env::consts::OS, kernel.trim()),
        "compilers": compilers,
    })
}

/// The first core's governor and limits. A guest of a virtual machine sees none of them.
fn clock() -> String {
    let read = |name: &str| fs::read_to_string(format!("/sys/devices/system/cpu/cpu0/cpufreq/{name}")).ok();
    let megahertz = |name: &str| Some(format!("{:.0}", read(name)?.trim().parse::<f64>().ok()? / 1000.0));
    match (read("scaling_governor"), megahertz("scaling_min_freq"), megahertz("scaling_max_freq")) {
        (Some(governor), Some(low), Some(high)) => format!("governor {}, {low} to {high} MHz", governor.trim()),
        _ => "not readable".to_owned(),
    }
}

/// Today's date, in universal time.
pub(super) fn date() -> String {
    let date = run::read(run::command("date").args(["-u", "+%Y-%m-%d"])).unwrap_or_default();
    if date.trim().is_empty() { UNKNOWN.to_owned() } else { date.trim().to_owned() }
}
