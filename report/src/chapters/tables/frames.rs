//! What fits that pixels share gain in a frame: at equal samples, at equal time, and from what cost of a sample on.

use super::Section;
use super::samplers::Errors;
use crate::chapters::measurement::{BASELINE, Experiment, Outcome, SHARED, View};
use crate::chapters::prelude::*;
use crate::measure::samplers::Choice;

const SCENES: [&str; 8] = ["dining", "chopper", "dragon", "microcity", "animation", "killeroos", "bathroom", "lens"];
const SPP: [u32; 3] = [1, 4, 16];
const SAMPLERS: [Choice; 2] = [Choice::Random, Choice::Default];
/// As the program calls them, and the table.
const METHODS: [(&str, &str); 4] = [
    (SHARED, "shared fits"),
    ("shared_blocks", "the same side by side"),
    ("shared_known", "with known light"),
    ("known", "known light alone"),
];

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Shared fits at equal time", "");
    let plan = section.measurement.plan;
    let tiles = section.measurement.renderer.tiles()?;
    let [a, b, c, d] = METHODS.map(|(name, _)| name);
    let estimators = [BASELINE, a, b, c, d];
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        for &spp in plan.some(&SPP) {
            for choice in SAMPLERS {
                let Some(sampler) = choice.sampler(spp, &tiles) else { continue };
                let view = View::new(scene, plan.tile_size);
                let experiment =
                    Experiment { sampler, seeds: plan.seeds, order: 3, ..Experiment::new(view, spp, &estimators) };
                let outcome = section.measurement.run(&experiment)?;
                for (name, label) in METHODS {
                    rows.push(one(&outcome, name, row![scene, spp, choice.label(), label])?);
                }
            }
        }
    }
    let columns = "scene | samples | sampler | method | raw | filtered | same time | adds, ns per sample | pays \
                   from, ns";
    section.chapter.table("shared fits at equal time", columns, 4, rows);
    Ok(())
}

fn one(outcome: &Outcome, name: &str, mut cells: Vec<Cell>) -> Result<Vec<Cell>> {
    let [own, plain] = [Errors::new(outcome, name)?, Errors::new(outcome, BASELINE)?];
    let raw = Estimate::ratio(&own.raw, &plain.raw);
    let (of, mean) = (outcome.of(name)?, outcome.of(BASELINE)?);
    let pairs = of.timings.iter().zip(&mean.timings);
    let added = pairs.map(|(own, mean)| own.estimating_ns_per_sample - mean.estimating_ns_per_sample);
    let added = Estimate::median(&added.collect::<Vec<_>>());
    let errors = own.raw.iter().zip(&plain.raw).map(|(own, plain)| own / plain);
    let same_time = errors.zip(outcome.time_ratios(name)?).map(|(error, time)| error * time);
    let same_time = Estimate::median(&same_time.collect::<Vec<_>>());
    let from = if raw.value < 1.0 { added.value * raw.value / (1.0 - raw.value) } else { f64::INFINITY };
    cells.extend(row![
        Figure::new(raw, Unit::Ratio),
        Figure::new(Estimate::ratio(&own.filtered, &plain.filtered), Unit::Ratio),
        Figure::new(same_time, Unit::Ratio),
        Figure::new(added, Unit::Nanoseconds),
        Figure::exact(from, Unit::Nanoseconds)
    ]);
    Ok(cells)
}
