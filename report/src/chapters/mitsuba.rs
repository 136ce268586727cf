//! The chapter of Mitsuba 3, which integrations/mitsuba/measure.py measures.

use super::prelude::*;
use super::report::Report;
use super::statistics::moments;
use crate::measure::running;
use std::path::PathBuf;
use xtask::renderers;

/// One scene: the kernels of each take seconds to compile.
const QUICK: &str = "--scenes cornell --size 32 --seeds 3 --many 2 --reference 512 --frames 16 --rounds 3";
const PLAIN: &str = "independent";
const DEFAULT: &str = "noisefloor";
/// Of gradients, as integrations/mitsuba/README.md recommends.
const SCRAMBLED: &str = "noisefloor, scrambled";

pub(super) fn write(report: &Report) -> Result<Chapter> {
    // What was measured before, by hand: it takes a quarter of an hour.
    let measured = std::env::var_os("NOISEFLOOR_MITSUBA").map(PathBuf::from);
    let scratch = tempfile::tempdir()?;
    let folder = measured.clone().unwrap_or_else(|| scratch.path().to_owned());
    if measured.is_none() {
        let mut command = renderers::mitsuba()?;
        report.compiled();
        command.arg("integrations/mitsuba/measure.py").arg(&folder);
        if report.plan.is_quick() {
            command.args(QUICK.split(' '));
        }
        running::run(command, |_| Ok(()))?;
    }
    let picture = image::open(folder.join("pictures.png")).context("measure.py wrote no picture")?;
    report.output.write_picture("mitsuba.png", &picture.to_rgb8())?;
    let table = |name: &str| Table::read(&folder.join(format!("{name}.csv")), ';');
    let (mut chapter, mut targets) = report.described(&table)?;
    let errors = table("errors")?;
    over_scenes("raw error over the best's, geometric mean", &errors, "raw", &mut targets, (Side::AtMost, 1.03))?;
    let statement = "error after OIDN over the best's, geometric mean";
    over_scenes(statement, &errors, "denoised", &mut targets, (Side::Below, 1.0))?;
    chapter.section("Gradients");
    derivatives(&table("gradients")?, &mut chapter, &mut targets)?;
    targets.write(&mut chapter);
    Ok(chapter)
}

/// The geometric mean over all scenes of the error over that of Mitsuba's best sampler, seed by seed.
fn over_scenes(statement: &str, table: &Table, measure: &str, targets: &mut Targets, bound: (Side, f64)) -> Result<()> {
    let samplers = table.distinct("sampler")?;
    for spp in table.distinct("spp")? {
        let mut ratios: Vec<Vec<f64>> = Vec::new();
        for scene in table.distinct("scene")? {
            let of = |sampler| table.numbers_of(measure, &[("scene", scene), ("spp", spp), ("sampler", sampler)]);
            let others = samplers.iter().filter(|name| !name.starts_with(DEFAULT));
            let others = others.map(|name| of(name)).collect::<Result<Vec<_>>>()?;
            let means = others.iter().filter(|numbers| !numbers.is_empty()).map(|numbers| moments(numbers).0);
            let best = means.fold(f64::INFINITY, f64::min);
            ratios.push(of(DEFAULT)?.into_iter().map(|own| own / best).collect());
        }
        let seeds = ratios.iter().map(Vec::len).min().unwrap_or(0);
        let logarithms = |seed: usize| ratios.iter().map(move |scene| scene[seed].max(1e-9).ln());
        let means = (0..seeds).map(|seed| moments(&logarithms(seed).collect::<Vec<_>>()).0.exp());
        let estimate = Estimate::mean(&means.collect::<Vec<_>>());
        targets.add(statement, &format!("{spp} spp"), estimate, Unit::Ratio, bound);
    }
    Ok(())
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
                    targets.add("gradient: bias, per cent", parameter, size, Unit::Percent, (Side::Below, 0.1));
                }
            }
        }
    }
    let columns = "parameter | spp | sampler | spread over independent's | bias, %";
    chapter.table("gradients", columns, 3, rows);
    Ok(())
}
