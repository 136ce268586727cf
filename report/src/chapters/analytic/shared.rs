//! Fits shared by pixels.

use crate::chapters::chapter::{Cell, Chapter, headings, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::table::Table;
use anyhow::Result;

/// Largest RMSE over the mean's where fits cannot help.
const HARD: f64 = 1.03;
/// Samples, then the largest errors over white noise's: half-planes and bumps, and the same filtered.
const GAINS: [(&str, [f64; 4]); 2] = [("1", [0.25, 0.17, 0.13, 0.055]), ("4", [0.22, 0.16, 0.048, 0.009])];
/// The columns that hold them.
const ERRORS: [&str; 4] = ["half_planes", "bumps", "half_planes_blurred", "bumps_blurred"];
const NAMES: [&str; 4] = ["half-planes", "bumps", "half-planes, filtered", "bumps, filtered"];

pub(super) fn tiles(chapter: &mut Chapter, targets: &mut Targets, table: &Table) -> Result<()> {
    chapter.section("Shared fits on a tile's samples", "");
    let deviation = chapter.setting("the filter's standard deviation, pixels", 2.1);
    let pixels = chapter.setting("pixels over which integrands move and scale", 32);
    let count = |samples: &str| table.find(&[("samples", samples)])?.number::<u32>("count");
    let few = chapter.setting("half-planes, and bumps", count("1")?);
    let many = chapter.setting("the same at 16 samples", count("16")?);
    let most = chapter.setting("samples of the tiles with fewer integrands", 16);
    chapter.paragraph(&format!(
        "Mean squared errors relative to independent samples without a fit: of {few} half-planes and {few} Gaussian bumps ({many} each at {most} samples), on the \
         samples of the shipped tile of as many samples in each pixel, raw and filtered by a Gaussian of {deviation} pixels. Integrands are the same in \
         every pixel, or move back and forth and scale by half along {pixels} pixels. Windows overlap by half unless they lie side by side.",
    ));
    let methods = table.distinct("method")?;
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for integrands in table.distinct("integrands")? {
        for samples in table.distinct("samples")? {
            for (error, name) in ERRORS.into_iter().zip(NAMES) {
                let mut cells = row![samples, integrands, name];
                for &method in &methods {
                    let keys = [("samples", samples), ("integrands", integrands), ("method", method)];
                    cells.push(Figure::exact(table.find(&keys)?.number(error)?, Unit::Number).into());
                }
                rows.push(cells);
            }
        }
    }
    let columns = [&["samples", "integrands", "error"][..], &methods].concat();
    chapter.table("shared fits on tiles", &columns, 3, rows);
    for (samples, bounds) in GAINS {
        for ((error, name), bound) in ERRORS.into_iter().zip(NAMES).zip(bounds) {
            let keys = [("samples", samples), ("integrands", "the same everywhere"), ("method", "8 x 8, order 4")];
            let value = table.find(&keys)?.number(error)?;
            let statement =
                format!("shared fits on a tile of {samples} spp, order 4, over independent samples: {name}");
            targets.at_most(&statement, "windows of 8 x 8", Estimate::exact(value), Unit::Number, bound);
        }
    }
    Ok(())
}

pub(super) fn hard(chapter: &mut Chapter, targets: &mut Targets, table: &Table) -> Result<()> {
    chapter.section("Shared fits where neighbours have little to share", "");
    let side = chapter.setting("pixels on a side of a scene", 12);
    let confidence = chapter.setting("confidence, percent", 95);
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let mut said = Vec::new();
    let counts = table.distinct("n")?;
    for of in table.distinct("of")? {
        let mut worst = (Estimate::exact(0.0), String::new());
        for scene in table.distinct("scene")? {
            let mut cells = row![scene, of];
            for &n in &counts {
                let row = table.find(&[("of", of), ("scene", scene), ("n", n)])?;
                let (value, half): (f64, f64) = (row.number("ratio")?, row.number("half_width")?);
                let ratio = Estimate::of_logarithm(value, half, row.number("images")?);
                let place = format!("{scene}, n = {n}");
                let statement = format!("shared fits over the mean where they cannot help, {of}s: RMSE");
                targets.at_most(&statement, &place, ratio, Unit::Ratio, HARD);
                cells.push(Figure::brief(ratio, Unit::Ratio).into());
                if ratio.high > worst.0.high {
                    worst = (ratio, place);
                }
            }
            rows.push(cells);
        }
        chapter.setting(format!("worst place, {of}s"), worst.1.as_str());
        let ratio = chapter.quote(format!("worst ratio, {of}s"), Figure::new(worst.0, Unit::Ratio));
        said.push(format!("{of}s {ratio} ({})", worst.1));
    }
    chapter.paragraph(&format!(
        "RMSE over that of the plain means of the same samples, which are independent: the default, order 3, {side} x {side} pixels, which share fits as an image, or \
         in no order, as a block. Intervals of {confidence} % are in the JSON. With the highest upper end: {}.",
        said.join("; ")
    ));
    chapter.setting("order of the fits", 3);
    let columns = headings(&["scene", "as"], counts.iter().map(|n| format!("n = {n}")));
    chapter.table("hard scenes", &columns, 2, rows);
    Ok(())
}

pub(super) fn bias(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("The bias of shared fits", "");
    let (count, side) =
        (chapter.setting("integrands of the bias", 24), chapter.setting("window of a tile's samples", 8));
    chapter.paragraph(&format!(
        "Over the RMSE, root mean square over {count} half-planes and bumps and the largest of them, without what chance adds, which stands beside them; order 3, one \
         window. Independent samples: leave-one-out and K-fold are exactly unbiased. A tile's samples, {side} x {side} of its pixels with all values shifted \
         at random, are not independent, so that no estimator is.",
    ));
    let rows: Vec<Vec<Cell>> = table
        .rows()
        .map(|row| {
            // What is left after chance is taken away may be nothing.
            let figure = |heading: &str| -> Result<Option<Figure>> {
                let value: f64 = row.number(heading)?;
                Ok(value.is_finite().then(|| Figure::exact(value, Unit::Number)))
            };
            Ok(row![
                row.word("samples")?,
                row.word("n")?,
                row.word("estimator")?,
                format!("{0} x {0}", row.word("window")?),
                figure("typical")?,
                figure("largest")?,
                figure("chance")?
            ])
        })
        .collect::<Result<_>>()?;
    chapter.table("bias", &["samples", "a pixel", "estimator", "window", "typical", "largest", "chance"], 4, rows);
    Ok(())
}
