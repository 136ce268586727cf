//! The chapter of Mitsuba 3, which integrations/mitsuba/measure.py measures.

use super::Report;
use super::chapter::{Cell, Chapter, headings, row};
use super::figure::{Figure, Unit};
use super::statistics::Estimate;
use super::targets::Targets;
use crate::measure::running;
use crate::measure::table::Table;
use anyhow::{Context, Result, anyhow};
use std::path::PathBuf;
use xtask::mitsuba;

const PLAIN: &str = "independent";
const DEFAULT: &str = "noisefloor";
/// Of gradients, as integrations/mitsuba/README.md recommends.
const SCRAMBLED: &str = "noisefloor, scrambled";
/// For denoisers, as docs/choosing.md recommends.
const DENOISED: &str = "noisefloor";
const MEASURES: [(&str, &str); 3] = [("raw", "Raw"), ("filtered", "Filtered"), ("denoised", "After OIDN")];

pub(super) fn write(report: &Report) -> Result<Chapter> {
    // What was measured before, by hand: it takes a quarter of an hour.
    let measured = std::env::var_os("NOISEFLOOR_MITSUBA").map(PathBuf::from);
    let scratch = tempfile::tempdir()?;
    let folder = measured.clone().unwrap_or_else(|| scratch.path().to_owned());
    if measured.is_none() {
        let python = mitsuba::environment()?.map_err(|why| anyhow!("{why}"))?;
        report.compiled();
        let mut command = mitsuba::command(python);
        command.arg("integrations/mitsuba/measure.py").arg(&folder);
        if report.plan.option() == Some("--quick") {
            command.args("--size 32 --seeds 3 --many 2 --reference 512 --frames 16 --rounds 3".split(' '));
        }
        running::run(command, |_| Ok(()))?;
    }
    let errors = Table::read(&folder.join("errors.csv"), ';')?;
    let gradients = Table::read(&folder.join("gradients.csv"), ';')?;
    let picture = image::open(folder.join("pictures.png")).context("measure.py wrote no picture")?;
    report.output.write_picture("mitsuba.png", &picture.to_rgb8())?;
    let mut chapter = Chapter::new("Samplers in Mitsuba 3");
    let mut targets = Targets::default();
    chapter.setting("seeds", errors.only("spp", "1")?.distinct("seed")?.len());
    chapter.setting("seeds of 64 samples", errors.only("spp", "64")?.distinct("seed")?.len());
    for (measure, title) in MEASURES {
        chapter.section(title, "");
        ratios(&errors, measure, &mut chapter, &mut targets)?;
    }
    chapter.section("Time", "");
    times(&Table::read(&folder.join("times.csv"), ';')?, &mut chapter, &mut targets)?;
    chapter.section("Image fits", "");
    fits(&Table::read(&folder.join("fits.csv"), ';')?, &mut chapter)?;
    chapter.section("Gradients", "");
    derivatives(&gradients, &mut chapter, &mut targets)?;
    targets.write(&mut chapter);
    Ok(chapter)
}

/// Each over the mean of another's: their mean is a ratio of means, whose interval is that of the numerator's over seeds.
fn over(own: &[f64], other: &[f64]) -> Vec<f64> {
    let mean = other.iter().sum::<f64>() / other.len() as f64;
    own.iter().map(|value| value / mean).collect()
}

fn ratios(table: &Table, measure: &'static str, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let (scenes, counts) = (table.distinct("scene")?, table.distinct("spp")?);
    let samplers: Vec<&str> = table.distinct("sampler")?.into_iter().filter(|&name| name != PLAIN).collect();
    let mut rows = Vec::new();
    for &spp in &counts {
        let mut of_scenes: Vec<Vec<f64>> = Vec::new();
        for &scene in &scenes {
            // Seed by seed.
            let of = |sampler| table.numbers_of(measure, &[("scene", scene), ("spp", spp), ("sampler", sampler)]);
            let plain = of(PLAIN)?;
            let mut cells: Vec<Cell> = row![scene, spp, Figure::exact(Estimate::mean(&plain).value, Unit::Error)];
            let mut best: Option<(f64, Vec<f64>)> = None;
            for &sampler in &samplers {
                let own = of(sampler)?;
                if own.is_empty() {
                    cells.push(Cell::Missing);
                    continue;
                }
                let ratio = Estimate::mean(&over(&own, &plain));
                cells.push(Figure::new(ratio, Unit::Ratio).into());
                if !sampler.starts_with(DEFAULT) && best.as_ref().is_none_or(|(value, _)| ratio.value < *value) {
                    best = Some((ratio.value, own));
                }
            }
            rows.push(cells);
            // Independent samples are one of Mitsuba's samplers, too.
            let best = best.filter(|(value, _)| *value < 1.0).map_or(plain, |(_, own)| own);
            let own = of(if measure == "denoised" { DENOISED } else { DEFAULT })?;
            let bound = match (measure, spp) {
                ("filtered", "1" | "4" | "16") => 0.85,
                ("raw", "1" | "4" | "16") => 1.15,
                _ => 1.05,
            };
            let (ratios, place) = (over(&own, &best), format!("{scene}, {spp} spp"));
            let ratio = Estimate::mean(&ratios);
            of_scenes.push(ratios);
            let statement = format!("{measure} error over the best Mitsuba sampler's, {bound} at most");
            targets.at_most(&statement, &place, ratio, Unit::Ratio, bound);
        }
        let seeds = of_scenes.iter().map(Vec::len).min().unwrap_or(0);
        let mean = |seed: usize| {
            let logarithms = of_scenes.iter().map(|ratios| ratios[seed].max(1e-9).ln());
            (logarithms.sum::<f64>() / of_scenes.len() as f64).exp()
        };
        let all = Estimate::mean(&(0..seeds).map(mean).collect::<Vec<_>>());
        let place = format!("{spp} spp");
        match measure {
            "raw" => targets.at_most("raw error over the best's, geometric mean", &place, all, Unit::Ratio, 1.03),
            "denoised" => {
                targets.below("error after OIDN over the best's, geometric mean", &place, all, Unit::Ratio, 1.0)
            }
            _ => {}
        }
    }
    let columns = headings(&["scene", "spp", PLAIN], samplers.iter().map(|&name| name.to_owned()));
    chapter.table(measure, &columns, 2, rows);
    Ok(())
}

fn times(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let samplers: Vec<&str> = table.distinct("sampler")?.into_iter().filter(|&name| name != PLAIN).collect();
    let mut rows = Vec::new();
    for scene in table.distinct("scene")? {
        let seconds = |sampler| table.numbers_of("seconds", &[("scene", scene), ("sampler", sampler)]);
        let mut cells: Vec<Cell> = row![scene];
        for &sampler in &samplers {
            let ratio = Estimate::ratio(&seconds(sampler)?, &seconds(PLAIN)?);
            cells.push(Figure::new(ratio, Unit::Ratio).into());
            if sampler == DEFAULT {
                targets.at_most("time of an LLVM frame over independent's", scene, ratio, Unit::Ratio, 1.05);
            }
        }
        rows.push(cells);
    }
    chapter.table("times", &headings(&["scene"], samplers.iter().map(|&name| name.to_owned())), 1, rows);
    Ok(())
}

/// Errors and times over those of the same samples without fits; their product is the error at equal time.
fn fits(table: &Table, chapter: &mut Chapter) -> Result<()> {
    let mut rows = Vec::new();
    for scene in table.distinct("scene")? {
        for spp in table.distinct("spp")? {
            for kind in table.distinct("kind")?.into_iter().filter(|&kind| kind != "plain") {
                let of = |measure, kind| table.numbers_of(measure, &[("scene", scene), ("spp", spp), ("kind", kind)]);
                if of("raw", kind)?.is_empty() {
                    continue;
                }
                let ratio = |measure| -> Result<Estimate> {
                    Ok(Estimate::mean(&over(&of(measure, kind)?, &of(measure, "plain")?)))
                };
                let (raw, filtered) = (ratio("raw")?, ratio("filtered")?);
                let time = Estimate::ratio(&of("seconds", kind)?, &of("seconds", "plain")?);
                let at_equal_time = Figure::exact(raw.value * time.value, Unit::Ratio);
                let figures = [raw, filtered, time].map(|estimate| Figure::new(estimate, Unit::Ratio));
                let [raw, filtered, time] = figures;
                rows.push(row![scene, spp, kind, raw, filtered, time, at_equal_time]);
            }
        }
    }
    let columns = ["scene", "spp", "integrator", "raw", "filtered", "time", "raw, equal time"];
    chapter.table("fits", &columns, 3, rows);
    Ok(())
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> (f64, f64) {
    let (count, mean) = (values.len() as f64, values.iter().sum::<f64>() / values.len() as f64);
    (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt())
}

fn derivatives(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let column = |parameter, spp, sampler| {
        table.numbers_of("gradient", &[("parameter", parameter), ("spp", spp), ("sampler", sampler)])
    };
    let mut rows = Vec::new();
    for spp in table.distinct("spp")?.into_iter().filter(|&spp| spp != "256") {
        for parameter in table.distinct("parameter")? {
            let reference = column(parameter, "256", "reference")?;
            let (exact, spread) = moments(&reference);
            let reference_error = spread / (reference.len() as f64).sqrt();
            let (_, plain) = moments(&column(parameter, spp, PLAIN)?);
            for sampler in table.distinct("sampler")?.into_iter().filter(|&name| name != "reference") {
                let found = column(parameter, spp, sampler)?;
                if found.is_empty() {
                    continue;
                }
                let (mean, spread) = moments(&found);
                let error = (spread * spread / found.len() as f64 + reference_error * reference_error).sqrt();
                let percent = 100.0 / exact.abs();
                let (bias, half) = ((mean - exact) * percent, 1.96 * error * percent);
                let seeds = found.len();
                let bias = Estimate { value: bias, low: bias - half, high: bias + half, seeds };
                // Of the ratio of two deviations of normal numbers.
                let ratio = spread / plain;
                let half = 1.96 * ratio / (seeds as f64 - 1.0).sqrt();
                let ratio = Estimate { value: ratio, low: ratio - half, high: ratio + half, seeds };
                rows.push(row![
                    parameter,
                    spp,
                    sampler,
                    Figure::new(ratio, Unit::Ratio),
                    Figure::new(bias, Unit::Percent)
                ]);
                if sampler == SCRAMBLED && spp == "1" {
                    let size = Estimate {
                        value: bias.value.abs(),
                        low: if bias.low * bias.high < 0.0 { 0.0 } else { bias.low.abs().min(bias.high.abs()) },
                        high: bias.low.abs().max(bias.high.abs()),
                        seeds,
                    };
                    targets.at_most("gradient: spread over independent's", parameter, ratio, Unit::Ratio, 0.75);
                    targets.below("gradient: bias, per cent", parameter, size, Unit::Percent, 0.1);
                }
            }
        }
    }
    let columns = ["parameter", "spp", "sampler", "spread over independent's", "bias, %"];
    chapter.table("gradients", &columns, 3, rows);
    Ok(())
}
