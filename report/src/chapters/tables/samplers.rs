//! Samplers: figures 5.19, 5.20 and 5.22, and fits shared by neighbouring pixels.

use super::Section;
use super::public::Public;
use crate::chapters::chapter::headings;
use crate::chapters::measurement::{BASELINE, Experiment, Outcome, SHARED, View};
use crate::chapters::prelude::*;
use crate::chapters::scenes;
use crate::measure::renderer::Sampler;
use crate::measure::samplers::{Choice, Tiles};
use crate::measure::score;
use std::path::Path;

const SCENES: [&str; 7] = ["dining", "dragon", "chopper", "microcity", "killeroos", "bathroom", "lens"];
const SPP: [u32; 3] = [1, 4, 16];
/// The library's samplers and what they are compared with first.
const OWN: [Choice; 5] = [Choice::Random, Choice::Sobol, Choice::Tile(2), Choice::Tile(4), Choice::Default];
const RANDOM: usize = 0;
const SOBOL: usize = 1;
const TILE: usize = 2;
/// One sampler's errors, a number for each seed.
pub(super) struct Errors {
    pub(super) raw: Vec<f64>,
    pub(super) filtered: Vec<f64>,
}

impl Errors {
    pub(super) fn new(outcome: &Outcome, estimator: &str) -> Result<Self> {
        let (raw, filtered) = outcome.seen(estimator)?.into_iter().map(|[raw, filtered]| (raw, filtered)).unzip();
        Ok(Self { raw, filtered })
    }
}

/// One scene at one number of samples.
struct Measured {
    scene: &'static str,
    spp: u32,
    /// In the order of the columns; None: there is no such sampler.
    alone: Vec<Option<Errors>>,
    shared: Vec<Option<Errors>>,
}

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Samplers", "figures 5.19 and 5.20");
    let plan = section.measurement.plan;
    let tiles = section.measurement.renderer.tiles()?;
    let public = Public::new(section.measurement);
    let mut all = Vec::new();
    for &scene in plan.some(&SCENES) {
        for &spp in plan.some(&SPP) {
            let one = measure(section, &tiles, &public, scene, spp)?;
            all.push(one);
        }
    }
    section.chapter.setting("relative errors are limited to", score::LIMIT);
    section.chapter.setting("filter's standard deviation, pixels", crate::measure::filter::SIGMA);
    let names = OWN.iter().skip(1).map(|choice| choice.label()).chain(public.labels());
    let columns = headings(&["scene", "samples", "random, relMSE x 1000"], names);
    let raw = all.iter().map(|one| error_row(one, |errors| &errors.raw)).collect();
    section.chapter.table("samplers, raw", &columns, 1, raw);
    let filtered = all.iter().map(|one| error_row(one, |errors| &errors.filtered)).collect();
    section.chapter.table("samplers, filtered", &columns, 1, filtered);
    write_shared(section, &all);
    aim(section, &all);
    Ok(())
}

fn measure(section: &Section, tiles: &Tiles, public: &Public, scene: &'static str, spp: u32) -> Result<Measured> {
    let view = View::new(scene, section.measurement.plan.tile_size);
    let dims = scenes::find(scene)?.dims;
    let seeds = section.measurement.plan.seeds;
    // Beyond four samples what a tile is compared with is Sobol's sequence; `--full` has the public samplers there too.
    let compared = spp <= 4 || section.measurement.plan.is_full();
    let files = if compared { public.files(spp, dims)? } else { Vec::new() };
    let mut wanted: Vec<Option<Experiment>> = Vec::new();
    for choice in OWN {
        // The tile of four dimensions is for scenes that have them.
        let fits = choice != Choice::Tile(4) || dims >= 3;
        let sampler = choice.sampler(spp, tiles).filter(|_| fits);
        // Shared fits are shown on the first three.
        let estimators: &[&str] = if choice == Choice::Tile(4) { &[BASELINE] } else { &[BASELINE, SHARED] };
        wanted.push(sampler.map(|sampler| Experiment { sampler, seeds, ..Experiment::new(view, spp, estimators) }));
    }
    for (index, _) in public.labels().enumerate() {
        let sampler = files.get(index).map(|file| Sampler::Table(Path::new(file)));
        wanted.push(sampler.map(|sampler| Experiment { sampler, seeds, ..Experiment::new(view, spp, &[BASELINE]) }));
    }
    let samplers = section.measurement.run_all(&wanted)?;
    let errors = |estimator: &str| -> Result<Vec<Option<Errors>>> {
        let each = samplers.iter().map(|outcome| -> Result<Option<Errors>> {
            let rendered = outcome.as_ref().filter(|outcome| outcome.of(estimator).is_ok());
            rendered.map(|outcome| Errors::new(outcome, estimator)).transpose()
        });
        each.collect()
    };
    let (alone, shared) = (errors(BASELINE)?, errors(SHARED)?);
    Ok(Measured { scene, spp, alone, shared })
}

fn error_row(one: &Measured, of: fn(&Errors) -> &Vec<f64>) -> Vec<Cell> {
    let random = one.alone[RANDOM].as_ref().map(of);
    let plain = random.map(|errors| {
        let errors: Vec<f64> = errors.iter().map(|error| 1e3 * error).collect();
        Figure::new(Estimate::median(&errors), Unit::RelMseE3)
    });
    let mut cells = row![one.scene, one.spp, plain];
    for errors in &one.alone[1..] {
        let ratio = errors.as_ref().zip(random).map(|(errors, random)| Estimate::ratio(of(errors), random));
        cells.push(ratio.map(|ratio| Figure::new(ratio, Unit::Ratio)).into());
    }
    cells
}

/// Shared fits over the same sampler's plain mean.
fn write_shared(section: &mut Section, all: &[Measured]) {
    section.chapter.section("Shared fits", "section 4.3.6, multi-pixel regression");
    let mut rows = Vec::new();
    for one in all {
        let mut cells = row![one.scene, one.spp];
        for index in [RANDOM, SOBOL, TILE] {
            let pair = one.shared[index].as_ref().zip(one.alone[index].as_ref());
            for of in [|errors: &Errors| errors.raw.clone(), |errors: &Errors| errors.filtered.clone()] {
                let ratio = pair.map(|(shared, alone)| Estimate::ratio(&of(shared), &of(alone)));
                cells.push(ratio.map(|ratio| Figure::new(ratio, Unit::Ratio)).into());
            }
        }
        rows.push(cells);
    }
    let columns = "scene | samples | random: raw | filtered | Owen-Sobol: raw | filtered | tile: raw | filtered";
    section.chapter.table("shared fits", columns, 1, rows);
}

fn aim(section: &mut Section, all: &[Measured]) {
    let targets = &mut *section.targets;
    let ratio = |own: &Option<Errors>, other: &Option<Errors>, of: fn(&Errors) -> &Vec<f64>| {
        own.as_ref().zip(other.as_ref()).map(|(own, other)| Estimate::ratio(of(own), of(other)))
    };
    for one in all {
        let (scene, spp) = (one.scene, one.spp);
        let (tile, sobol) = (&one.alone[TILE], &one.alone[SOBOL]);
        if spp <= 4 {
            if let Some(estimate) = ratio(tile, sobol, |errors| &errors.filtered) {
                let statement = format!("tile over Owen-Sobol, filtered, {spp} spp, direct light");
                targets.at_most(&statement, scene, estimate, Unit::Ratio, 0.5);
            }
            // The best of the public samplers in this scene.
            let best = one.alone[OWN.len()..].iter().flatten().map(|errors| Estimate::median(&errors.filtered).value);
            let best = best.fold(f64::INFINITY, f64::min);
            if let Some(public) = one.alone[OWN.len()..]
                .iter()
                .find(|errors| errors.as_ref().is_some_and(|errors| Estimate::median(&errors.filtered).value == best))
                && let Some(estimate) = ratio(tile, public, |errors| &errors.filtered)
            {
                let statement = format!("tile over the best public sampler, filtered, {spp} spp, direct light");
                targets.at_most(&statement, scene, estimate, Unit::Ratio, 1.0);
            }
            if let Some(estimate) = ratio(&one.shared[TILE], tile, |errors| &errors.raw) {
                let statement = format!("shared fits over the tile alone, raw, {spp} spp, direct light");
                targets.at_most(&statement, scene, estimate, Unit::Ratio, 0.5);
            }
        }
        if spp >= 4
            && let Some(estimate) = ratio(tile, sobol, |errors| &errors.raw)
        {
            let statement = format!("tile over Owen-Sobol, raw, {spp} spp");
            targets.at_most(&statement, scene, estimate, Unit::Ratio, 1.03);
        }
        if let Some(estimate) = ratio(&one.shared[TILE], tile, |errors| &errors.raw) {
            targets.at_most(
                &format!("shared fits over the tile alone, raw, {spp} spp"),
                scene,
                estimate,
                Unit::Ratio,
                1.01,
            );
        }
    }
}
