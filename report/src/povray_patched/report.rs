//! The chapter: what was compared, how, and what came of it.

use super::Options;
use super::checks::Checks;
use super::measure::{METHODS, Measured, RANDOM, STOCK, Series};
use super::scenes::SCENES;
use super::sheet;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::write_chapter;
use crate::measure::output::Output;
use crate::measure::score::Score;
use anyhow::Result;

pub(crate) fn write(output: &Output, options: &Options, checks: &Checks, measured: &Measured) -> Result<()> {
    let mut chapter = Chapter::new("POV-Ray, patched");
    introduction(&mut chapter, options, checks);
    for (index, scene) in SCENES.iter().enumerate() {
        chapter.section(scene.name, "");
        table(&mut chapter, options, measured, index);
    }
    outcome(&mut chapter, options, measured);
    models(&mut chapter, measured);
    output.write_picture("povray_patched.png", &sheet::draw(measured, options.spp[0]))?;
    write_chapter(output, "povray_patched", &chapter.json())
}

fn introduction(chapter: &mut Chapter, options: &Options, checks: &Checks) {
    chapter.setting("width", options.width);
    chapter.setting("height", options.height());
    chapter.setting("pictures of each kind", options.seeds);
    chapter.setting("samples of each half of a reference", options.reference);
    chapter.quote("pictures unchanged", Figure::exact(checks.unchanged as f64, Unit::Count));
    chapter.quote("point lights", Figure::exact(f64::from(checks.frames), Unit::Count));
    chapter.quote("difference from point lights", Figure::exact(checks.difference, Unit::Sigmas));
    chapter.quote("brightness with radiosity", Figure::exact(checks.radiosity, Unit::Percent));
    chapter.setting("examples", super::checks::EXAMPLES as u64);
}

fn table(chapter: &mut Chapter, options: &Options, measured: &Measured, scene: usize) {
    let mut rows = Vec::new();
    for &spp in &options.spp {
        let Some(random) = measured.find(scene, RANDOM, spp) else { continue };
        for (number, method) in METHODS.iter().enumerate() {
            let Some(series) = measured.find(scene, number, spp) else { continue };
            rows.push(line(spp, method.name, series, random, number));
        }
    }
    let columns = ["spp", "method", "1e-3 relMSE", "to random", "1e-3 filtered", "filtered, to random", "CPU seconds"];
    chapter.table("povray_patched", &columns, 2, rows);
}

fn line(spp: u32, name: &'static str, series: &Series, random: &Series, method: usize) -> Vec<Cell> {
    let of = |series: &Series, value: fn(&Score) -> f64| -> Vec<f64> { series.scores.iter().map(value).collect() };
    let error = |value: fn(&Score) -> f64| {
        let scaled: Vec<f64> = of(series, value).iter().map(|error| 1e3 * error).collect();
        Figure::new(Estimate::median(&scaled), Unit::RelMseE3)
    };
    let ratio = |value: fn(&Score) -> f64| {
        let (ours, theirs) = (of(series, value), of(random, value));
        // Stock pictures have no seeds to be paired by.
        let estimate = if method == STOCK {
            let middle = Estimate::median(&theirs).value;
            Estimate::median(&ours.iter().map(|error| error / middle).collect::<Vec<_>>())
        } else {
            Estimate::ratio(&ours, &theirs)
        };
        (method != RANDOM).then(|| Figure::new(estimate, Unit::Ratio))
    };
    let raw: fn(&Score) -> f64 = |score| score.raw;
    let filtered: fn(&Score) -> f64 = |score| score.filtered;
    let seconds = Figure::brief(Estimate::median(&series.cpu_seconds), Unit::Percent);
    row![spp, name, error(raw), ratio(raw), error(filtered), ratio(filtered), seconds]
}

/// What the tables say together: the range of one method's relMSE over another's, at the same samples.
fn outcome(chapter: &mut Chapter, options: &Options, measured: &Measured) {
    chapter.section("What the tables say", "");
    let mut range = |ours: &str, theirs: &str| {
        let index = |name: &str| METHODS.iter().position(|method| method.name == name);
        let ratio = |scene: usize, spp: u32| -> Option<f64> {
            let raw = |name| -> Option<Vec<f64>> {
                let series = measured.find(scene, index(name)?, spp)?;
                Some(series.scores.iter().map(|score| score.raw).collect())
            };
            Some(Estimate::median(&raw(ours)?).value / Estimate::median(&raw(theirs)?).value)
        };
        let pairs = (0..SCENES.len()).flat_map(|scene| options.spp.iter().map(move |&spp| (scene, spp)));
        let ratios: Vec<f64> = pairs.filter_map(|(scene, spp)| ratio(scene, spp)).collect();
        let mut quote = |end: &str, value: f64| {
            chapter.quote(format!("{ours} / {theirs}, {end}"), Figure::exact(value, Unit::Ratio))
        };
        quote("least", ratios.iter().copied().fold(f64::INFINITY, f64::min));
        quote("most", ratios.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    };
    for (ours, theirs) in [
        ("tile", "stock"),
        ("sobol", "stock"),
        ("tile", "sobol"),
        ("random, accumulator", "random"),
        ("random, estimate", "random"),
        ("random, estimate", "random, accumulator"),
        ("tile, estimate", "tile"),
    ] {
        range(ours, theirs);
    }
}

fn models(chapter: &mut Chapter, measured: &Measured) {
    chapter.section("Two models of an area light", "");
    let rows = measured.models.iter().map(|model| {
        row![
            model.scene,
            Figure::exact(1e3 * model.rel_mse, Unit::RelMseE3),
            Figure::exact(100.0 * model.largest, Unit::Percent)
        ]
    });
    let columns = ["scene", "1e-3 relMSE", "largest difference, % of the brightest value"];
    chapter.table("models", &columns, 1, rows.collect());
}
