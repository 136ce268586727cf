//! What estimating costs beside sampling, as "Computation Time" in the thesis's section 4.3.5.

use super::Section;
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, Renderings, SHARED, View};
use crate::chapters::prelude::*;

const SCENES: [&str; 6] = ["killeroos", "bathroom", "dining", "chopper", "microcity", "duck"];
const ESTIMATORS: [&str; 4] = [BASELINE, DEFAULT, LEAST_SQUARES, SHARED];
/// As many camera rays as samples, as renderers trace them, or one for each pixel.
const EACH: &str = "many";
const RAYS: [(&str, &[&str]); 2] = [(EACH, &["--filter", "box"]), ("one", &[])];

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Overhead", "section 4.3.5, computation time");
    let plan = section.measurement.plan;
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        for (rays, options) in RAYS {
            for &spp in plan.spp.iter().filter(|&&spp| spp <= 64) {
                // Fifteen dimensions and two more are beyond what can be regressed at order 2.
                let options = if scene == "duck" { &[options, &["--regressed", "15"]].concat() } else { options };
                // Of a few milliseconds each; seeds make the interval.
                let size = match scene {
                    "duck" => plan.small / 2,
                    _ if plan.is_full() => plan.small,
                    _ => plan.small * 3 / 4,
                };
                let view = View::new(scene, size);
                let experiment = Experiment { seeds: plan.seeds, options, ..Experiment::new(view, spp, &ESTIMATORS) };
                let renderings = section.measurement.render(&[experiment])?.swap_remove(0);
                let plain = find(&renderings, BASELINE)?;
                let frame = plain.nanoseconds(|t| t.sampling_ns_per_sample + t.estimating_ns_per_sample);
                let mut cells: Vec<Cell> = row![scene, rays, spp, Figure::brief(frame, Unit::Nanoseconds)];
                for estimator in &ESTIMATORS[1..] {
                    let part = overhead(find(&renderings, estimator)?, plain);
                    cells.push(Figure::new(part, Unit::Percent).into());
                    if rays == EACH && *estimator != SHARED && spp == plan.middle() {
                        let label = if *estimator == DEFAULT { "default" } else { "least squares" };
                        let statement =
                            format!("overhead of the {label}, order 2, {spp} spp, a camera ray per sample, percent");
                        section.targets.at_most(&statement, scene, part, Unit::Percent, 10.0);
                    }
                }
                rows.push(cells);
            }
        }
    }
    let columns = "scene | camera rays of a pixel | samples | frame, ns per sample | default, % | least squares, % \
                   | shared fits, %";
    section.chapter.table("overhead", columns, 2, rows);
    Ok(())
}

fn find<'a>(all: &'a [Renderings], estimator: &str) -> Result<&'a Renderings> {
    all.iter().find(|one| one.estimator == estimator).with_context(|| format!("`{estimator}` was not rendered"))
}

fn overhead(own: &Renderings, plain: &Renderings) -> Estimate {
    let pairs = own.timings.iter().zip(&plain.timings);
    let parts = pairs.map(|(own, plain)| {
        let frame = plain.sampling_ns_per_sample + plain.estimating_ns_per_sample;
        100.0 * (own.estimating_ns_per_sample - plain.estimating_ns_per_sample) / frame
    });
    Estimate::median(&parts.collect::<Vec<_>>())
}
