//! The chapter of the POV-Ray oracle.

mod bias;
mod findings;
mod measure;
mod sheet;
mod tables;

use super::Report;
use super::chapter::{Chapter, row};
use super::targets::Targets;
use crate::measure::interrupt;
use crate::measure::progress;
use crate::povray::oracle::{Model, Oracle};
use crate::povray::scenes::{SCENES, Scene};
use crate::povray::{PACKAGES, version};
use anyhow::{Result, bail};
use measure::{Measured, Measurement, SPP};
use xtask::{library, tools};

/// Total degree of the polynomials.
const ORDER: u32 = 2;
/// Pixels on a side of the pictures that the tests render, which serve for a quick look too.
const SMALL: u32 = 32;
/// And of those of a default report.
const MIDDLE: u32 = 40;
/// Pixels on a side at most: stacks of larger pictures take gigabytes.
const LARGEST: u32 = 128;

/// Sizes of a report, or of a quick look.
struct Sizes {
    size: u32,
    seeds: u32,
    cells: fn(&Scene) -> &'static [u32],
}

pub(super) fn write(report: &Report) -> Result<()> {
    if let Some(missing) = tools::packages(&PACKAGES)? {
        bail!("the chapter needs POV-Ray. {missing}");
    }
    let oracle = Oracle::build(&library::build()?, report.interrupted.clone())?;
    report.compiled();
    let (size, cells): (u32, fn(&Scene) -> &'static [u32]) = match report.plan.size {
        ..SMALL => (SMALL, |scene| scene.small),
        size if report.plan.is_full() => (size.min(LARGEST), |scene| scene.full),
        _ => (MIDDLE, |scene| scene.report),
    };
    let sizes = Sizes { size, seeds: report.plan.seeds, cells };
    let mut chapter = Chapter::new("Control variates and tiles on what POV-Ray computes");
    introduce(&sizes, &mut chapter)?;
    let mut body = Chapter::default();
    let (mut targets, mut all) = (Targets::default(), Vec::new());
    for scene in &SCENES {
        let view = oracle.view(scene, cells(scene), size)?;
        interrupt::check(&report.interrupted)?;
        let bar = progress::bar(measure::work(scene, sizes.seeds))?;
        bar.set_message(scene.name);
        let measurement = Measurement { oracle: &oracle, scene, view: &view, seeds: sizes.seeds, bar: &bar };
        let measured = measurement.everything(Model::Cells)?;
        let linear = measurement.default(Model::Linear)?;
        bar.finish_and_clear();
        tables::scene(&mut body, scene, &measured)?;
        tables::judge(&mut targets, scene, &measured)?;
        report.large.write_image(&format!("povray-{}", scene.name), &view.reference.image, &view.reference)?;
        all.push(Measured { scene, reference: view.reference, all: measured, linear });
    }
    bias::write(report, &oracle, &mut body, &mut targets)?;
    targets.write_summary(&mut chapter);
    findings::write(&mut chapter, &all)?;
    tables::models(&mut body, &all)?;
    tables::times(&mut body, &all)?;
    sheet::write(report.output, &all)?;
    chapter.picture("povray.png", "each scene by the plain mean, by control variates and by tiles, and its exact mean");
    chapter.append(body);
    targets.write_all(&mut chapter);
    report.write(&chapter)
}

fn introduce(sizes: &Sizes, chapter: &mut Chapter) -> Result<()> {
    let version = version()?;
    chapter.setting("POV-Ray", version.as_str());
    let size = chapter.setting("pixels on a side", sizes.size);
    let seeds = chapter.setting("seeds", sizes.seeds);
    let order = chapter.setting("order", ORDER);
    let confidence = chapter.setting("confidence, percent", 95);
    let bits = chapter.setting("bits", 16);
    chapter.paragraph(&format!(
        "Made by `cargo xtask report`; machine-readable in `povray.json`. The integrands are another renderer's: unmodified {version}. A \
         scene is an animation whose every frame is the picture of one cell of a grid over the unit cube: an area light is the point of it \
         for the cell's centre, a lens a pinhole at its point, a moving object stands where it is at that time. The stack of frames, \
         {size} x {size} pixels, linear, {bits} bits, is the integrand, constant in each cell; its mean is exact, and no reference is \
         rendered. Scenes and program: `tests/povray`."
    ));
    chapter.list(&[
        format!(
            "A figure is the median over {seeds} seeds, and in brackets its {confidence} % confidence interval (bootstrap). Ratios are taken \
             seed by seed."
        ),
        "relMSE: mean over the pixels of (I - R)^2 / (R^2 + eps), of luminance, eps a hundredth of the squared mean of R. \
         Filtered: relative errors, limited to five, are first filtered as the eye does, by a Gaussian."
            .to_owned(),
        format!(
            "Estimators as `pathtracer --help` names them: `mc` the plain mean, `robust` the default, for each colour channel; total degree \
             of the polynomials {order}. For stratified samples (Sobol, tiles) `robust` is the plain mean by design. `shared` has one fit for \
             the neighbours on a surface; `slices` is told which light was picked."
        ),
        "Tile: the library's tile of two dimensions with as many samples, or the next fewer; \"tile, joint\" its tile of four, where scenes have \
         more than two dimensions."
            .to_owned(),
    ]);
    let grid = |scene: &Scene| (sizes.cells)(scene).iter().map(u32::to_string).collect::<Vec<_>>().join(" x ");
    let rows = SCENES.iter().map(|scene| row![scene.name, scene.shows, grid(scene)]).collect();
    chapter.table("scenes", &["scene", "shows; integral over", "cells"], 2, rows);
    for spp in SPP {
        chapter.setting(format!("{spp} samples per pixel"), spp);
    }
    Ok(())
}
