//! The table of samplers.

use super::measure::{Measured, baseline, find, ratios};
use super::plan::{ESTIMATORS, Scene};
use crate::measure::markdown;
use crate::measure::samplers::Choice;

const HEADINGS: [&str; 13] = [
    "scene",
    "spp",
    "sampler",
    "estimator",
    "relMSE",
    "ratio",
    "filtered relMSE",
    "ratio",
    "low frequencies",
    "drawing ns",
    "total ns",
    "ratio, same time",
    "filtered, same time",
];

const COLUMNS: [&str; 14] = [
    "scene",
    "spp",
    "sampler",
    "estimator",
    "rel_mse",
    "ratio",
    "filtered_rel_mse",
    "filtered_ratio",
    "low_frequencies",
    "drawing_ns_per_sample",
    "total_ns_per_sample",
    "ratio_same_time",
    "filtered_ratio_same_time",
    "tile",
];

const WORDS: [usize; 3] = [0, 2, 3];

/// The columns of the summary.
const SUMMARY: [Choice; 5] = [Choice::Random, Choice::Sobol, Choice::Tile(2), Choice::Tile(4), Choice::Progressive];

/// The rows of one scene.
pub(crate) fn rows(scene: &str, all: &[Measured]) -> Vec<[String; 14]> {
    let row = |one: &Measured| {
        let plain = baseline(all, one);
        let [raw, filtered] = ratios(one, plain);
        // The plain mean's error falls as 1 / samples, that is as 1 / time.
        let time = plain.map_or(f64::NAN, |plain| one.total_ns / plain.total_ns);
        [
            scene.to_owned(),
            one.spp.to_string(),
            one.choice.label(),
            one.estimator.to_owned(),
            format!("{:.3e}", one.score.raw),
            format!("{raw:.3}"),
            format!("{:.3e}", one.score.filtered),
            format!("{filtered:.3}"),
            format!("{:.3}", one.score.low),
            format!("{:.1}", one.drawing_ns),
            format!("{:.0}", one.total_ns),
            format!("{:.3}", raw * time),
            format!("{:.3}", filtered * time),
            one.tile.clone(),
        ]
    };
    all.iter().map(row).collect()
}

pub(crate) fn markdown(rows: &[[String; 14]]) -> String {
    let shown = rows.iter().map(|row| std::array::from_fn::<_, 13, _>(|column| row[column].clone()));
    markdown::table(&HEADINGS, &WORDS, shown)
}

fn cell([raw, filtered]: [f64; 2]) -> String {
    format!("{raw:.3} / {filtered:.3}")
}

/// The ratios of one scene to random samples' plain mean, a row for each number of samples and estimator: raw /
/// filtered.
pub(crate) fn summary_rows(scene: &str, all: &[Measured]) -> Vec<[String; 8]> {
    let row = |(spp, estimator): (u32, &str)| {
        let cells = SUMMARY.map(|choice| {
            let one = find(all, choice, spp, estimator);
            one.map_or_else(|| "-".to_owned(), |one| cell(ratios(one, baseline(all, one))))
        });
        let [a, b, c, d, e] = cells;
        [scene.to_owned(), spp.to_string(), estimator.to_owned(), a, b, c, d, e]
    };
    spps(all).into_iter().flat_map(|spp| ESTIMATORS.map(|estimator| (spp, estimator))).map(row).collect()
}

pub(crate) fn summary(rows: &[[String; 8]]) -> String {
    let samplers = SUMMARY.map(Choice::label);
    let [a, b, c, d, e] = samplers.each_ref().map(String::as_str);
    markdown::table(&["scene", "spp", "estimator", a, b, c, d, e], &[0, 2], rows.iter().cloned())
}

fn spps(all: &[Measured]) -> Vec<u32> {
    let mut spps: Vec<u32> = all.iter().map(|one| one.spp).collect();
    spps.sort_unstable();
    spps.dedup();
    spps
}

/// What shared fits gain with each sampler in one scene, a row for each number of samples.
pub(crate) fn shared_rows(scene: &Scene, all: &[Measured]) -> Vec<[String; 9]> {
    let [mean, .., shared] = ESTIMATORS;
    let row = |spp: u32| {
        let cells = SUMMARY.map(|choice| {
            let one = find(all, choice, spp, shared);
            one.map_or_else(|| "-".to_owned(), |one| cell(ratios(one, find(all, choice, spp, mean))))
        });
        let [a, b, c, d, e] = cells;
        let time = |estimator| {
            find(all, Choice::Tile(2), spp, estimator)
                .map_or_else(|| "-".to_owned(), |one| format!("{:.0}", one.total_ns))
        };
        [scene.name.to_owned(), spp.to_string(), a, b, c, d, e, time(mean), time(shared)]
    };
    spps(all).into_iter().map(row).collect()
}

/// The largest raw error of shared fits over that of the same sampler's plain mean.
pub(crate) fn largest_shared_ratio(all: &[Measured]) -> f64 {
    let [mean, .., shared] = ESTIMATORS;
    let fits = all.iter().filter(|one| one.estimator == shared);
    fits.map(|one| ratios(one, find(all, one.choice, one.spp, mean))[0]).fold(0.0, f64::max)
}

pub(crate) fn shared(rows: &[[String; 9]]) -> String {
    let samplers = SUMMARY.map(Choice::label);
    let [a, b, c, d, e] = samplers.each_ref().map(String::as_str);
    let times = ["tile 2D, plain mean: ns per sample", "shared: ns per sample"];
    let [plain, shared] = times;
    markdown::table(&["scene", "spp", a, b, c, d, e, plain, shared], &[0], rows.iter().cloned())
}

pub(crate) fn csv(rows: &[[String; 14]]) -> String {
    markdown::csv(&COLUMNS, rows.iter().cloned())
}
