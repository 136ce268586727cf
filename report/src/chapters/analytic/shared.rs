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
    let count = |samples: &str| table.find(&[("samples", samples)])?.number::<u32>("count");
    chapter.setting("half-planes, and bumps", count("1")?);
    chapter.setting("the same at 16 samples", count("16")?);
    let methods = table.headings("method", str::to_owned)?;
    let (integrands, samples) = (table.distinct("integrands")?, table.distinct("samples")?);
    let kinds = integrands.iter().flat_map(|of| samples.iter().map(move |samples| (*of, *samples)));
    let each = kinds.flat_map(|(of, samples)| {
        let errors = ERRORS.into_iter().zip(NAMES);
        errors.map(move |(error, name)| (row![samples, of, name], (of, samples, error)))
    });
    chapter.grid("shared fits on tiles", &["samples", "integrands", "error"], each, &methods, |of, method| {
        let (integrands, samples, error) = of;
        let found = table.find(&[("samples", *samples), ("integrands", integrands), ("method", method)])?;
        Ok(Figure::exact(found.number(error)?, Unit::Number).into())
    })?;
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
    let mut rows: Vec<Vec<Cell>> = Vec::new();
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
        chapter.quote(format!("worst ratio, {of}s"), Figure::new(worst.0, Unit::Ratio));
    }
    let columns = headings(&["scene", "as"], counts.iter().map(|n| format!("n = {n}")));
    chapter.table("hard scenes", &columns, 2, rows);
    Ok(())
}

pub(super) fn bias(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("The bias of shared fits", "");
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
