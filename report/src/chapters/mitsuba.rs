//! The chapter of Mitsuba 3, which integrations/mitsuba/measure.py measures.

use super::prelude::*;
use super::statistics::{moments, student};
use crate::measure::running;
use itertools::{Itertools, iproduct};
use std::path::PathBuf;
use xtask::{paths, renderers};

/// One scene: the kernels of each take seconds to compile.
const QUICK: &str = "--scenes cornell --size 32 --seeds 3 --reference 512 --frames 16 --rounds 3";
/// What measure.py measures one by one.
const PARTS: [&str; 4] = ["errors", "gradients", "fits", "times"];
const PLAIN: &str = "independent";
const DEFAULT: &str = "noisefloor";
/// Samples per pixel of the reference of the gradients.
const REFERENCE: &str = "256";

pub(super) fn write(report: &Report) -> Result<Chapter> {
    // What was measured before, in parts: it takes more than twenty minutes, and scalar frames need the plugin.
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
    let (parts, run) = earlier(&paths::json(folder.join("run.json"))?)?;
    if measured.is_some() {
        chapter.setting("measured in parts", parts);
        _ = report.earlier.set(run);
    }
    chapter.judge();
    Ok(chapter)
}

/// What measure.py says of its parts: each with its date and seconds, in words; and how all of it came about.
fn earlier(run: &Value) -> Result<(String, Value)> {
    let parts = run.as_object().context("run.json has no parts")?;
    let of = |name: &str| parts.get(name).with_context(|| format!("run.json: `{name}` was not measured"));
    let all = PARTS.iter().map(|name| of(name)).collect::<Result<Vec<_>>>()?;
    let machines: Vec<&Value> = all.iter().map(|part| &part["machine"]).unique().collect();
    let [machine] = machines[..] else { bail!("run.json: parts of {} machines", machines.len()) };
    let date = |part: &&Value| part["date"].as_str().map(str::to_owned);
    let dates = all.iter().map(date).collect::<Option<Vec<_>>>().context("run.json: a part without a date")?;
    let sum = |what: &str| all.iter().map(|part| part[what].as_f64()).sum::<Option<f64>>();
    let words = PARTS.iter().zip(&all).zip(&dates).map(|((name, part), date)| {
        format!("{name} on {date} in {:.0} s", part["seconds"].as_f64().unwrap_or(f64::NAN))
    });
    let words = words.collect::<Vec<_>>().join(", ");
    let date = dates.iter().sorted().dedup().join(", ");
    let [seconds, processor_seconds] = ["seconds", "processor_seconds"].map(sum);
    let run = json!({ "date": date, "seconds": seconds, "processor_seconds": processor_seconds, "other_work": null,
                      "machine": machine });
    Ok((words, run))
}

/// The geometric mean over all scenes of the error over that of Mitsuba's best sampler. Seed by seed what both are off
/// by gives the interval. That the same numbers say which is best makes the ratio larger, if anything.
fn over_scenes(errors: &Table) -> Result<Table> {
    let mut all = Table::new("over scenes", "error | spp | ratio | ratio_low | ratio_high");
    let samplers = errors.distinct("sampler")?;
    for (error, spp) in iproduct!(["raw", "denoised"], errors.distinct("spp")?) {
        let (mut logarithms, mut off): (Vec<f64>, Vec<Vec<f64>>) = Default::default();
        for scene in errors.distinct("scene")? {
            let of = |sampler| errors.of(&[("scene", scene), ("spp", spp), ("sampler", sampler)]).numbers(error);
            let own = of(DEFAULT)?;
            let others = samplers.iter().filter(|name| !name.starts_with(DEFAULT));
            let others = others.map(|name| of(name)).collect::<Result<Vec<_>>>()?;
            // Some were not measured.
            let others = others.iter().filter(|of| !of.is_empty()).map(|of| (moments(of).0, of));
            let Some((best, numbers)) = others.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            let mean = moments(&own).0;
            logarithms.push((mean / best).ln());
            off.push(own.iter().zip(numbers).map(|(a, b)| a / mean - b / best).collect());
        }
        let seeds = off.iter().map(Vec::len).min().unwrap_or(0);
        let mean = |numbers: &[f64]| numbers.iter().sum::<f64>() / numbers.len() as f64;
        let logarithm = mean(&logarithms);
        let of = |seed: usize| mean(&off.iter().map(|off| off[seed]).collect::<Vec<_>>());
        let each: Vec<f64> = (0..seeds).map(|seed| logarithm + of(seed)).collect();
        let Estimate { low, high, .. } = Estimate::mean(&each);
        let ends = [logarithm, low, high].map(|end| end.exp().to_string());
        all.push([error, spp].into_iter().chain(ends.iter().map(String::as_str)));
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

    #[test]
    fn what_was_measured_before_has_its_own_date_and_machine() -> Result<()> {
        let part = |date, seconds| json!({"date": date, "seconds": seconds, "machine": {"processor": "Nine"}});
        let mut run = json!({"errors": part("2001-02-04", 60.4), "gradients": part("2001-02-03", 30.0),
                             "fits": part("2001-02-04", 9.6), "times": part("2001-02-04", 5.0)});
        let (parts, all) = earlier(&run)?;
        assert_eq!((&all["date"], &all["seconds"]), (&json!("2001-02-03, 2001-02-04"), &json!(105.0)));
        assert!(all["machine"]["processor"] == "Nine" && all["processor_seconds"].is_null(), "{all}");
        assert!(parts.starts_with("errors on 2001-02-04 in 60 s, gradients on 2001-02-03 in 30 s"), "{parts}");
        run["times"]["machine"] = json!({"processor": "Ten"});
        assert!(earlier(&run).is_err(), "of two machines");
        run.as_object_mut().map(|parts| parts.remove("times"));
        assert!(earlier(&run).is_err(), "a part was not measured");
        Ok(())
    }

    /// Of two scenes the errors of one go along with the best's, so that the other's interval is that of both, halved.
    #[test]
    fn the_best_sampler_s_errors_spread_too() -> Result<()> {
        let mut errors = Table::new("errors", "scene | spp | sampler | raw | denoised");
        for (scene, sampler, numbers) in [
            ("a", "ldsampler", [1.0, 2.0, 3.0]),
            ("a", DEFAULT, [0.5, 1.0, 1.5]),
            ("b", "ldsampler", [0.5, 1.0, 1.5]),
            ("b", "independent", [7.0, 8.0, 9.0]),
            ("b", DEFAULT, [2.0, 2.0, 2.0]),
        ] {
            numbers.iter().for_each(|number| errors.push([scene, "4", sampler, &number.to_string(), "1"]));
        }
        let raw = over_scenes(&errors)?.of(&[("error", "raw")]);
        let half = 4.302_652_7 * 0.25 / 3_f64.sqrt();
        for (column, expected) in [("ratio", 1.0), ("ratio_low", (-half).exp()), ("ratio_high", half.exp())] {
            let found = raw.numbers(column)?;
            assert!(found.len() == 1 && (found[0] - expected).abs() < 1e-6, "{column}: {found:?} for {expected}");
        }
        Ok(())
    }

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
