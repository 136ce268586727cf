//! The chapter: what was compared, how, and what came of it.

use super::Options;
use super::checks::Checks;
use super::measure::{METHODS, Measured, RANDOM, STOCK, Series};
use super::scenes::{Kind, SCENES};
use super::sheet;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::check::numbers_are_recorded;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::pictures::write_small;
use crate::chapters::statistics::Estimate;
use crate::measure::output::Output;
use crate::measure::score::Score;
use anyhow::Result;

pub(crate) fn write(output: &Output, options: &Options, checks: &Checks, measured: &Measured) -> Result<()> {
    let mut chapter = Chapter::new("POV-Ray, patched");
    introduction(&mut chapter, options, checks);
    for (index, scene) in SCENES.iter().enumerate() {
        chapter.section(scene.name, "");
        chapter.paragraph(&format!("{}.", scene.description));
        table(&mut chapter, options, measured, index);
    }
    outcome(&mut chapter, options, measured);
    models(&mut chapter, measured);
    chapter.section("Pictures", "");
    let spp = options.spp[0];
    chapter.picture("povray_patched.png", "POV-Ray's examples, stock and patched");
    let json = serde_json::to_string_pretty(&chapter.json())? + "\n";
    numbers_are_recorded(chapter.markdown(), &json)?;
    output.write_text("povray_patched.md", chapter.markdown())?;
    output.write_text("povray_patched.json", &json)?;
    write_small(output, "povray_patched.png", &sheet::draw(measured, spp))
}

fn introduction(chapter: &mut Chapter, options: &Options, checks: &Checks) {
    let width = chapter.setting("width", options.width);
    let height = chapter.setting("height", options.height());
    let seeds = chapter.setting("pictures of each kind", options.seeds);
    let reference = chapter.setting("samples of each half of a reference", options.reference);
    let version = chapter.setting("POV-Ray", "3.7.0.10");
    let sigma = chapter.setting("standard deviation of the filter", 2.1);
    let confidence = chapter.setting("confidence in percent", 95);
    let bits = chapter.setting("bits", 16);
    chapter.paragraph(&format!(
        "POV-Ray {version} with a patch that draws its samples from noisefloor, against the same version as Debian built it, on \
         examples that come with it. Made by `cargo xtask povray --report`; `tests/povray/patched/README.md` says what the \
         patch does, and under which licence. Pictures of {width} x {height} pixels, linear, {bits} bits. relMSE on luminance, \
         with respect to a reference in two halves of {reference} scrambled Sobol points per pixel each, made by the patched \
         program with plain means; `filtered`: of the error filtered by a Gaussian of {sigma} pixels. Medians of {seeds} \
         pictures, with {confidence} % confidence intervals; ratios are to independent random samples at the same number of \
         samples, seed by seed."
    ));
    let unchanged = chapter.quote("pictures unchanged", Figure::exact(checks.unchanged as f64, Unit::Count));
    let frames = chapter.quote("point lights", Figure::exact(f64::from(checks.frames), Unit::Count));
    let difference = chapter.quote("difference from point lights", Figure::exact(checks.difference, Unit::Sigmas));
    let radiosity = chapter.quote("brightness with radiosity", Figure::exact(checks.radiosity, Unit::Percent));
    let unit = chapter.setting("largest value of a channel", 65535);
    let count = chapter.setting("examples", super::checks::EXAMPLES as u64);
    chapter.list(&[
        format!("With noisefloor off, {unchanged} pictures of {count} examples were those of Debian's program, bit for bit."),
        format!(
            "An area light that is sampled at the cells of a grid equals the mean of {frames} pictures by stock POV-Ray, with a point \
             light at each cell: the largest difference was {difference} of {unit}, which rounding explains."
        ),
        "Pictures do not depend on the number of threads.".to_owned(),
        format!(
            "With radiosity, its directions drawn from a tile, the mean of each channel is stock POV-Ray's within {radiosity} %."
        ),
    ]);
    chapter.paragraph(
        "`stock`: POV-Ray as it is, with exactly that many samples: `blur_samples` with no early end, or a full, jittered grid. \
         Its grids are scaled to cover the light, which they otherwise exceed by half a cell on each side. \
         `random`, `sobol`, `tile`: the patched program's plain means. `accumulator`: one streaming accumulator per pixel, robust. \
         `estimate`: what `nf_recommend` says for those samples.",
    );
}

fn table(chapter: &mut Chapter, options: &Options, measured: &Measured, scene: usize) {
    let mut rows = Vec::new();
    for &spp in &options.spp {
        chapter.setting(format!("samples per pixel, {spp}"), spp);
        let Some(random) = measured.find(scene, RANDOM, spp) else { continue };
        for (number, method) in METHODS.iter().enumerate() {
            let Some(series) = measured.find(scene, number, spp) else { continue };
            rows.push(line(spp, method.name, series, random, number));
        }
    }
    let columns = ["spp", "method", "1e-3 relMSE", "to random", "1e-3 filtered", "filtered, to random", "CPU seconds"];
    chapter.table("povray_patched", &columns, 2, rows);
    if SCENES[scene].kind == Kind::Lens {
        chapter.paragraph(
            "Stock POV-Ray has one picture for each number of samples: its focal blur has no seed. Its lens is a hexagon of points \
             while these are few, and a disc only in the limit, which is part of its error here.",
        );
    }
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
    let mut range = |ours: &str, theirs: &str| -> String {
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
        let low = quote("least", ratios.iter().copied().fold(f64::INFINITY, f64::min));
        let high = quote("most", ratios.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        format!("{low} to {high}")
    };
    let points = [
        format!(
            "Tiles have {} of stock POV-Ray's relMSE, Sobol points {}.",
            range("tile", "stock"),
            range("sobol", "stock")
        ),
        format!(
            "Tiles have {} of the Sobol points' relMSE: beyond a tile's own samples it is continued as a sequence, and the Sobol \
             points stratify four numbers together, the tiles two. In pixels as coarse as these, neighbours probably integrate functions \
             too different for a blue error to filter away.",
            range("tile", "sobol")
        ),
        format!(
            "An accumulator per pixel leaves {} of independent samples' relMSE.",
            range("random, accumulator", "random")
        ),
        format!(
            "What `nf_recommend` says for pixels that may share their fits leaves {} of it: {} of what the accumulators leave. Where it \
             is worse, it shares fits between pixels of a penumbra, each of which is a discontinuity elsewhere; probably so because in pictures this small \
             the windows of fits are large beside the shadows' edges.",
            range("random, estimate", "random"),
            range("random, estimate", "random, accumulator")
        ),
        format!("On tiles it changes next to nothing: {} of the tiles' relMSE.", range("tile, estimate", "tile")),
    ];
    chapter.list(&points);
    chapter.paragraph(
        "CPU seconds are tracing alone, on a machine that was busy with other work: they tell orders of magnitude. A patched sample traces \
         the ray from the eye anew, so that an area light costs more than in stock POV-Ray, which traces that ray once.",
    );
}

fn models(chapter: &mut Chapter, measured: &Measured) {
    chapter.section("Two models of an area light", "");
    chapter.paragraph(
        "Stock POV-Ray averages the shadow over an area light's points and shades from its centre; above, the patched program did \
         the same, so that all had one reference. Its default is to shade from the point that casts the shadow, as a light of that \
         shape would; a spotlight's cone then starts at that point, too. How far the two pictures are apart, both converged:",
    );
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
