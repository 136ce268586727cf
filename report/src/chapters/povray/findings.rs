//! What disappoints, and why.

use super::measure::{Measured, Points, Way, find};
use crate::chapters::chapter::Chapter;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use anyhow::{Context, Result};

pub(super) fn write(chapter: &mut Chapter, all: &[Measured]) -> Result<()> {
    let ways = |scene: &str| -> Result<&[Way]> {
        let found = all.iter().find(|one| one.scene.name == scene);
        Ok(&found.with_context(|| format!("`{scene}` was not measured"))?.all)
    };
    let area = ways("area")?;
    let (k_fold, mean) = (find(area, 64, Points::Sobol, "k_fold")?, find(area, 64, Points::Sobol, "mc")?);
    let folds = Estimate::ratio(&k_fold.rel_mse, &mean.rel_mse);
    let folds = chapter.quote("k_fold over mean, area, Sobol, 64 spp", Figure::new(folds, Unit::Ratio));
    let (shared, alone) = (find(area, 4, Points::Tile, "shared")?, find(area, 4, Points::Tile, "mc")?);
    let shared = Estimate::ratio(&shared.rel_mse, &alone.rel_mse);
    let shared = chapter.quote("shared over tile alone, area, 4 spp", Figure::new(shared, Unit::Ratio));
    let worst_percent = chapter.setting("worst pixels, percent", 5);
    let concentrated =
        chapter.quote("error in the worst pixels, percent", Figure::exact(worst(all, alone)?, Unit::Percent));
    chapter.section("What disappoints", "");
    chapter.list(&[
        format!(
            "`k_fold` on Sobol points: {folds} of their mean's relMSE (`area`, 64 spp). A sample's fold is its number modulo the number of \
             folds; in Sobol's order these folds are strips of the first coordinate, into which the fits to the other folds extrapolate. The \
             same points in bit-reversed order, where folds are stratified, do not show it. On stratified samples, take the mean."
        ),
        format!(
            "Shared fits in `area`: {shared} of the tile alone (4 spp). The worst {worst_percent} % of one picture's pixels, at edges of shadows and \
             in highlights, hold {concentrated} % of the squared error, and there neighbours' integrands differ."
        ),
    ]);
    Ok(())
}

/// How many percent of the squared error the worst 5 % of the pixels hold.
fn worst(all: &[Measured], way: &Way) -> Result<f64> {
    let reference = &all.iter().find(|one| one.scene.name == "area").context("`area` was not measured")?.reference;
    let mut squares: Vec<f64> = reference.error_map(&way.image).iter().map(|error| error * error).collect();
    squares.sort_by(|a, b| b.total_cmp(a));
    Ok(100.0 * squares[..squares.len() / 20].iter().sum::<f64>() / squares.iter().sum::<f64>())
}
