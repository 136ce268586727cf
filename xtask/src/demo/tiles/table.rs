//! The table of samplers.

use super::measure::{Measured, baseline};
use super::plan::{Choice, ESTIMATORS};
use crate::demo::markdown;

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
        let ratio = |of: fn(&Measured) -> f64| plain.map_or(f64::NAN, |plain| of(one) / of(plain));
        let (raw, filtered) = (ratio(|one| one.score.raw), ratio(|one| one.score.filtered));
        // The plain mean's error falls as 1 / samples, that is as 1 / time.
        let time = ratio(|one| one.total_ns);
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

/// The ratios of one scene, a row for each number of samples and estimator: raw / filtered.
pub(crate) fn summary_rows(scene: &str, all: &[Measured]) -> Vec<[String; 8]> {
    let mut keys: Vec<(u32, &str)> = all.iter().map(|one| (one.spp, one.estimator)).collect();
    keys.sort_unstable_by_key(|&(spp, estimator)| (spp, estimator != ESTIMATORS[0]));
    keys.dedup();
    let row = |(spp, estimator): (u32, &str)| {
        let cell = |choice: Choice| {
            let one = all.iter().find(|one| (one.spp, one.estimator, one.choice) == (spp, estimator, choice));
            let plain = one.and_then(|one| baseline(all, one));
            one.zip(plain).map_or_else(
                || "-".to_owned(),
                |(one, plain)| {
                    let (raw, filtered) = (one.score.raw / plain.score.raw, one.score.filtered / plain.score.filtered);
                    format!("{raw:.3} / {filtered:.3}")
                },
            )
        };
        let [a, b, c, d, e] = SUMMARY.map(cell);
        [scene.to_owned(), spp.to_string(), estimator.to_owned(), a, b, c, d, e]
    };
    keys.into_iter().map(row).collect()
}

pub(crate) fn summary(rows: &[[String; 8]]) -> String {
    let samplers = SUMMARY.map(Choice::label);
    let [a, b, c, d, e] = samplers.each_ref().map(String::as_str);
    markdown::table(&["scene", "spp", "estimator", a, b, c, d, e], &[0, 2], rows.iter().cloned())
}

pub(crate) fn csv(rows: &[[String; 14]]) -> String {
    markdown::csv(&COLUMNS, rows.iter().cloned())
}
