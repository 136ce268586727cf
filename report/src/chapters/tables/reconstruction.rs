//! Reconstruction with a box and with a Gaussian: figure 5.22.

use super::Section;
use super::samplers::Errors;
use crate::chapters::chapter::row;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, Experiment, Outcome, View};
use crate::chapters::statistics::Estimate;
use crate::measure::samplers::Choice;
use anyhow::{Result, bail};

const SCENES: [&str; 2] = ["dining", "microcity"];
const SPP: [u32; 2] = [1, 4];
/// The first is what the others are compared with.
const SAMPLERS: [Choice; 4] = [Choice::Random, Choice::Sobol, Choice::Tile(2), Choice::Tile(4)];
const FILTERS: [(&str, &[&str]); 2] = [("box", &["--filter", "box"]), ("Gaussian", &["--filter", "gaussian"])];

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Box and Gaussian reconstruction", "figure 5.22");
    let plan = section.measurement.plan;
    let tiles = section.measurement.renderer.tiles()?;
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        for &(filter, options) in plan.some(&FILTERS) {
            let view = View { options, ..View::new(scene, plan.tile_size) };
            for &spp in plan.some(&SPP) {
                let experiment =
                    |sampler| Experiment { sampler, seeds: plan.seeds, ..Experiment::new(view, spp, &[BASELINE]) };
                let experiments = SAMPLERS.map(|choice| choice.sampler(spp, &tiles).map(experiment));
                let outcomes = section.measurement.run_all(&experiments)?;
                let errors = |outcome: &Option<Outcome>| {
                    outcome.as_ref().map(|outcome| Errors::new(outcome, BASELINE)).transpose()
                };
                let each = outcomes.iter().map(errors).collect::<Result<Vec<_>>>()?;
                let [Some(random), others @ ..] = &each[..] else { bail!("random samples were not rendered") };
                let mut cells = row![scene, filter, spp];
                for errors in others {
                    for of in [|errors: &Errors| errors.raw.clone(), |errors: &Errors| errors.filtered.clone()] {
                        let ratio = errors.as_ref().map(|errors| Estimate::ratio(&of(errors), &of(random)));
                        cells.push(ratio.map(|ratio| Figure::new(ratio, Unit::Ratio)).into());
                    }
                }
                rows.push(cells);
            }
        }
    }
    let columns = [
        "scene",
        "reconstruction",
        "samples",
        "Owen-Sobol: raw",
        "filtered",
        "tile 2D: raw",
        "filtered",
        "tile 4D: raw",
        "filtered",
    ];
    section.chapter.table("reconstruction", &columns, 2, rows);
    Ok(())
}
