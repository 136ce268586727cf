//! The chapter's tables.

use super::measure::{Measured, Points, SPP, Way, find};
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::tables::targets::Targets;
use crate::povray::scenes::{Decision, Scene};
use anyhow::Result;

/// Errors of a way to render, seed by seed.
type Errors = fn(&Way) -> &[f64];

fn raw(way: &Way) -> &[f64] {
    &way.rel_mse
}

fn filtered(way: &Way) -> &[f64] {
    &way.filtered
}

/// Two tables: the errors, and as they are seen.
pub(super) fn scene(chapter: &mut Chapter, scene: &Scene, all: &[Way]) -> Result<()> {
    chapter.section(&format!("Scene `{}`: {}", scene.name, scene.shows), "");
    chapter.paragraph("relMSE times a thousand of `mc` with random samples; all else over it:");
    errors(chapter, "errors", scene, all, raw)?;
    chapter.paragraph("The same of the filtered errors:");
    errors(chapter, "filtered errors", scene, all, filtered)
}

fn errors(chapter: &mut Chapter, name: &'static str, scene: &Scene, all: &[Way], of: Errors) -> Result<()> {
    let estimators = scene.estimators();
    let mut rows = Vec::new();
    for spp in SPP {
        let plain = find(all, spp, Points::Random, "mc")?;
        for points in Points::of(scene) {
            let mut cells: Vec<Cell> = row![spp, points.name()];
            for estimator in &estimators {
                let way = find(all, spp, points, estimator)?;
                cells.push(if std::ptr::eq(way, plain) {
                    Figure::new(Estimate::median(of(way)), Unit::RelMseE3).into()
                } else {
                    Figure::new(Estimate::ratio(of(way), of(plain)), Unit::Ratio).into()
                });
            }
            rows.push(cells);
        }
    }
    let columns: Vec<&str> = ["spp", "points"].into_iter().chain(estimators.iter().copied()).collect();
    chapter.table(name, &columns, 2, rows);
    Ok(())
}

/// What was to be reached, as far as the oracle can say.
pub(super) fn judge(targets: &mut Targets, scene: &Scene, all: &[Way]) -> Result<()> {
    let light_alone = scene.axes.iter().all(|&axis| axis == Decision::Light);
    let mut at_most = |statement: &str, of: Errors, spp, [a, b]: [(Points, &str); 2], bound: f64| -> Result<()> {
        let (own, other) = (find(all, spp, a.0, a.1)?, find(all, spp, b.0, b.1)?);
        let statement = statement.replace('#', &spp.to_string());
        targets.at_most(&statement, scene.name, Estimate::ratio(of(own), of(other)), Unit::Ratio, bound);
        Ok(())
    };
    let (mean, default) = ((Points::Random, "mc"), (Points::Random, "robust"));
    let (tile, sobol, shared) = ((Points::Tile, "mc"), (Points::Sobol, "mc"), (Points::Tile, "shared"));
    for spp in [16, 64] {
        at_most("default over plain mean, # spp", raw, spp, [default, mean], 1.01)?;
    }
    if light_alone {
        at_most("default over plain mean, one light, # spp", raw, 16, [default, mean], 0.6)?;
        at_most("default over plain mean, one light, # spp", raw, 64, [default, mean], 0.4)?;
        for spp in [1, 4] {
            at_most("filtered error of tile over Sobol, # spp", filtered, spp, [tile, sobol], 0.5)?;
            at_most("shared fits over tile alone, # spp", raw, spp, [shared, tile], 0.5)?;
        }
    }
    for spp in [4, 16] {
        at_most("tile over Sobol, # spp", raw, spp, [tile, sobol], 1.03)?;
    }
    for spp in [1, 4] {
        at_most("shared fits no worse than tile alone, # spp", raw, spp, [shared, tile], 1.01)?;
    }
    Ok(())
}

pub(super) fn models(chapter: &mut Chapter, all: &[Measured]) -> Result<()> {
    chapter.section("What lies between the cells", "");
    chapter.paragraph(
        "Constant cells are POV-Ray's own values, but steps that no smooth function follows. Interpolated linearly between the cells' centres, \
         and constant beyond the outermost, the integrand has no steps and the same exact mean. The default's relMSE over the plain mean's, \
         random samples:",
    );
    let mut rows = Vec::new();
    for one in all {
        for (model, ways) in [("constant", &one.all), ("linear", &one.linear)] {
            let mut cells: Vec<Cell> = row![one.scene.name, model];
            for spp in SPP {
                let [own, plain] = ["robust", "mc"].map(|name| find(ways, spp, Points::Random, name));
                cells.push(Figure::new(Estimate::ratio(raw(own?), raw(plain?)), Unit::Ratio).into());
            }
            rows.push(cells);
        }
    }
    let headings = SPP.map(|spp| format!("{spp} spp"));
    let columns: Vec<&str> = ["scene", "between"].into_iter().chain(headings.iter().map(String::as_str)).collect();
    chapter.table("models", &columns, 2, rows);
    Ok(())
}

pub(super) fn times(chapter: &mut Chapter, all: &[Measured]) -> Result<()> {
    chapter.section("What the estimators cost", "");
    chapter.paragraph("Nanoseconds per sample and thread, three channels, random samples:");
    let mut rows = Vec::new();
    for one in all {
        for estimator in one.scene.estimators() {
            let mut cells: Vec<Cell> = row![one.scene.name, estimator];
            for spp in SPP {
                let way = find(&one.all, spp, Points::Random, estimator)?;
                cells.push(Figure::brief(Estimate::median(&way.nanoseconds), Unit::Nanoseconds).into());
            }
            rows.push(cells);
        }
    }
    let headings = SPP.map(|spp| format!("{spp} spp"));
    let columns: Vec<&str> = ["scene", "estimator"].into_iter().chain(headings.iter().map(String::as_str)).collect();
    chapter.table("times", &columns, 2, rows);
    Ok(())
}
