//! The chapter of Mitsuba 3, which integrations/mitsuba/measure.py measures.

use super::prelude::*;
use super::statistics::{moments, student};
use crate::measure::running;
use itertools::iproduct;
use std::path::PathBuf;
use xtask::renderers;

/// One scene: the kernels of each take seconds to compile.
const QUICK: &str = "--scenes cornell --size 32 --seeds 3 --reference 512 --frames 16 --rounds 3";
const PLAIN: &str = "independent";
const DEFAULT: &str = "noisefloor";
/// Samples per pixel of the reference of the gradients.
const REFERENCE: &str = "256";

pub(super) fn write(report: &Report) -> Result<Chapter> {
    // What was measured before, by hand: it takes more than twenty minutes.
    let measured = std::env::var_os("NOISEFLOOR_MITSUBA").filter(|_| !report.plan.is_quick()).map(PathBuf::from);
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
    let read = |name: &str| Table::read(&folder, name);
    let mut chapter = report.described(&|name| match name {
        "over scenes" => over_scenes(&read("errors")?),
        "gradients" => gradients(&read("gradients")?),
        _ => read(name),
    })?;
    chapter.judge();
    Ok(chapter)
}

/// The geometric mean over all scenes of the error over that of Mitsuba's best sampler, seed by seed.
fn over_scenes(errors: &Table) -> Result<Table> {
    let mut all = Table::new("over scenes", "error | spp | ratio");
    let samplers = errors.distinct("sampler")?;
    for (error, spp) in iproduct!(["raw", "denoised"], errors.distinct("spp")?) {
        let mut ratios: Vec<Vec<f64>> = Vec::new();
        for scene in errors.distinct("scene")? {
            let of = |sampler| errors.of(&[("scene", scene), ("spp", spp), ("sampler", sampler)]).numbers(error);
            let others = samplers.iter().filter(|name| !name.starts_with(DEFAULT));
            let others = others.map(|name| of(name)).collect::<Result<Vec<_>>>()?;
            // Of a sampler that was not measured it is no number, which `min` passes over.
            let best = others.iter().map(|numbers| moments(numbers).0).fold(f64::INFINITY, f64::min);
            ratios.push(of(DEFAULT)?.into_iter().map(|own| own / best).collect());
        }
        for seed in 0..ratios.iter().map(Vec::len).min().unwrap_or(0) {
            let scenes: Vec<f64> = ratios.iter().map(|scene| scene[seed].max(1e-9)).collect();
            all.push([error, spp, &Estimate::geometric_mean(&scenes).value.to_string()]);
        }
    }
    Ok(all)
}

/// Of each derivative the spread over that of independent samples, and the bias in per cent, with its size.
fn gradients(measured: &Table) -> Result<Table> {
    let ends = |name: &str| ["", "_low", "_high"].map(|end| format!("{name}{end}")).join(" | ");
    let headings = ["spread", "bias", "size"].map(ends).join(" | ");
    let mut all = Table::new("gradients", &format!("parameter | spp | sampler | {headings}"));
    let of = |parameter, spp, sampler| {
        measured.of(&[("parameter", parameter), ("spp", spp), ("sampler", sampler)]).numbers("gradient")
    };
    let [counts, parameters, samplers] = ["spp", "parameter", "sampler"].map(|column| measured.distinct(column));
    for (spp, parameter, sampler) in iproduct!(counts?, parameters?, samplers?) {
        let (found, reference) = (of(parameter, spp, sampler)?, of(parameter, REFERENCE, "reference")?);
        if spp == REFERENCE || sampler == "reference" || found.is_empty() {
            continue;
        }
        let ((exact, reference_spread), (mean, spread)) = (moments(&reference), moments(&found));
        let reference_error = reference_spread / (reference.len() as f64).sqrt();
        let error = (spread * spread / found.len() as f64 + reference_error * reference_error).sqrt();
        let percent = 100.0 / exact.abs();
        let freedom = found.len() as f64 - 1.0;
        let quantile = student(0.025, freedom);
        let bias = Estimate::about((mean - exact) * percent, quantile * error * percent, found.len());
        // The logarithm of the ratio of two deviations of normal numbers has a variance of about 1 / freedom.
        let ratio = spread / moments(&of(parameter, spp, PLAIN)?).1;
        let above = ratio * (quantile / freedom.sqrt()).exp_m1();
        let ratio = Estimate::of_logarithm(ratio, above, found.len());
        let [near, far] = [f64::min, f64::max].map(|of| of(bias.low.abs(), bias.high.abs()));
        let least = if bias.low * bias.high < 0.0 { 0.0 } else { near };
        let size = Estimate { value: bias.value.abs(), low: least, high: far, ..bias };
        let ends = [ratio, bias, size].map(|of| [of.value, of.low, of.high].map(|end| end.to_string()));
        all.push([parameter, spp, sampler].into_iter().chain(ends.iter().flatten().map(String::as_str)));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three frames each: Student's quantile of two degrees of freedom, 4.303.
    #[test]
    fn intervals_of_gradients_are_students() -> Result<()> {
        let mut measured = Table::new("gradients", "parameter | spp | sampler | gradient");
        for (sampler, spp, frames) in
            [("reference", REFERENCE, [10, 10, 10]), (PLAIN, "4", [8, 10, 12]), (DEFAULT, "4", [10, 11, 12])]
        {
            frames.iter().for_each(|frame| measured.push(["red", spp, sampler, &frame.to_string()]));
        }
        let own = gradients(&measured)?.of(&[("sampler", DEFAULT)]);
        for (column, expected) in [
            ("spread", 0.5),
            ("spread_low", 0.5 * (-4.30265 / 2_f64.sqrt()).exp()),
            ("spread_high", 0.5 * (4.30265 / 2_f64.sqrt()).exp()),
            ("bias", 10.0),
            ("bias_low", 10.0 - 43.0265 / 3_f64.sqrt()),
            ("size_high", 10.0 + 43.0265 / 3_f64.sqrt()),
        ] {
            let found = own.numbers(column)?;
            assert!(found.len() == 1 && (found[0] - expected).abs() < 1e-4, "{column}: {found:?} for {expected}");
        }
        Ok(())
    }
}
