//! What was to be reached, and what was measured; the report judges it.

use crate::Run;
use crate::cells::{Cell, Set, geometric_mean, worst};
use crate::speed::{PEERS, SOLVE, Speed};
use noisefloor_bench::method::{LEAST_SQUARES, ROBUST};
use noisefloor_tests::statistics::Ratio;
use std::fmt::Write;

/// What the robust estimator may exceed the mean's RMSE by.
const WORST: f64 = 1.03;
/// Geometric means over the nine at (n, bound).
const MEANS: [(usize, f64); 4] = [(16, 0.52), (32, 0.31), (64, 0.22), (256, 0.16)];
/// (dims, n, nanoseconds per sample) at order 2 of the thesis authors' code, measured once on another machine.
const QUOTED: [(usize, usize, f64); 6] =
    [(2, 16, 111.0), (2, 64, 49.0), (2, 256, 33.0), (3, 16, 181.0), (3, 64, 75.0), (3, 256, 49.0)];
/// Shares of the quoted cost.
const SHARES: [(&str, f64); 2] = [(LEAST_SQUARES.name, 0.5), (ROBUST.name, 1.0)];
/// Nanoseconds for a solution of 6 unknowns.
const SOLVE_BOUND: f64 = 150.0;

/// Nanoseconds per sample at order 2.
fn find(run: &Run, dims: usize, n: usize, name: &str) -> f64 {
    let same = |speed: &&Speed| (speed.dims, speed.order, speed.n, speed.name) == (dims, 2, n, name);
    run.speeds.iter().find(same).map_or(f64::NAN, |speed| speed.ns)
}

/// What was to be reached, and what was measured.
pub(crate) struct Target {
    target: String,
    value: f64,
    /// Half of the 95 % interval; none for times.
    half_width: Option<f64>,
    unit: &'static str,
    /// Where it was measured, or what else took how long.
    note: String,
    bound: f64,
}

/// The table in Markdown.
pub(crate) fn table(run: &Run) -> String {
    let mut out = "| target | measured | bound |\n|---|---|---|\n".to_owned();
    for Target { target, value, half_width, unit, note, bound } in targets(run) {
        let value = match half_width {
            Some(half_width) => format!("{value:.3} ± {half_width:.3}"),
            None => format!("{value:.1} {unit}"),
        };
        let note = if note.is_empty() { note } else { format!(" ({note})") };
        let _ = writeln!(out, "| {target} | {value}{note} | {bound} |");
    }
    out
}

/// The same as comma-separated values.
pub(crate) fn csv(run: &Run) -> String {
    let mut out = "target;value;half_width;unit;note;bound\n".to_owned();
    for Target { target, value, half_width, unit, note, bound } in targets(run) {
        let half_width = half_width.map_or(String::new(), |half_width| format!("{half_width:.5}"));
        let _ = writeln!(out, "{target};{value:.5};{half_width};{unit};{note};{bound}");
    }
    out
}

fn targets(run: &Run) -> Vec<Target> {
    let mut all = Vec::new();
    let mut ratios = |target: String, ratio: Ratio, note: String, bound: f64| {
        let (value, half_width) = (ratio.value, Some(ratio.half_width));
        all.push(Target { target, value, half_width, unit: "ratio", note, bound });
    };
    let robust: Vec<&Cell> = run.cells.iter().filter(|cell| cell.method == ROBUST.name).collect();
    for degree in crate::cells::DEGREES {
        for set in Set::ALL {
            let of_set = robust.iter().copied().filter(|cell| cell.degree == degree && cell.set == set);
            let Some(cell) = worst(of_set) else { continue };
            let target = format!("robust, order {degree}: worst RMSE ratio to the mean, {}", set.name());
            ratios(target, cell.ratio, format!("{}, n = {}", cell.integrand, cell.n), WORST);
        }
    }
    for (n, bound) in MEANS {
        let nine = robust.iter().copied().filter(|cell| cell.degree == 3 && cell.set == Set::Nine && cell.n == n);
        let target = format!("robust, order 3: geometric mean over the nine, n = {n}");
        ratios(target, geometric_mean(nine), String::new(), bound);
    }
    let mut times = |target: String, value: f64, note: String, bound: f64| {
        all.push(Target { target, value, half_width: None, unit: "ns", note, bound });
    };
    for (name, share) in SHARES {
        for (dims, n, quoted) in QUOTED {
            let ns = find(run, dims, n, name);
            let peer = PEERS.map(|(name, _)| ns / find(run, dims, n, name));
            let note = format!("{:.2} of QR, {:.2} of Cholesky", peer[0], peer[1]);
            let target = format!("{name}, {dims}D order 2, n = {n}: per sample, {share} of {quoted} ns");
            times(target, ns, note, share * quoted);
        }
    }
    let solve = |name: &str| run.solves.iter().find(|solve| solve.0 == name).map_or(f64::NAN, |solve| solve.1);
    let note = format!("QR {:.0}, Cholesky {:.0}", solve(PEERS[0].0), solve(PEERS[1].0));
    times("solution of 6 unknowns, all of `Regressor::estimate`".to_owned(), solve(SOLVE), note, SOLVE_BOUND);
    all
}
