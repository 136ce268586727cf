//! Errors of samplers alone, by number of samples, raw and through three filters.

use crate::chapters::chapter::{Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::table::Table;
use anyhow::{Context, Result};

/// Columns of the program's table: raw errors, and those filtered by Gaussians of 1, 1.485 and 2.1 pixels.
const KERNELS: [&str; 4] = ["raw", "g1", "a", "g2"];
const FAMILIES: [&str; 2] = ["half-planes", "Gaussians"];

/// What the project wants its tiles to reach: dims, samples, sampler, kernel, family, bound.
const WANTED: &[(&str, &str, &str, &str, usize, f64)] = &[
    ("2", "1", "tile", "g2", 0, 0.095),
    ("2", "1", "tile", "g2", 1, 0.027),
    ("2", "4", "tile", "g2", 0, 0.044),
    ("2", "4", "tile", "g2", 1, 0.0045),
    ("2", "4", "tile", "raw", 0, 0.315),
    ("2", "16", "tile", "g2", 0, 0.024),
    ("2", "16", "tile", "g2", 1, 0.0006),
    ("2", "16", "tile", "raw", 0, 0.15),
    ("2", "1", "progressive tile", "g2", 0, 0.12),
    ("2", "1", "progressive tile", "g2", 1, 0.05),
    ("2", "4", "progressive tile", "g2", 0, 0.055),
    ("2", "4", "progressive tile", "g2", 1, 0.008),
    ("2", "4", "progressive tile", "raw", 0, 0.34),
    ("2", "16", "progressive tile", "g2", 0, 0.029),
    ("2", "16", "progressive tile", "g2", 1, 0.0015),
    ("2", "16", "progressive tile", "raw", 0, 0.165),
    ("4", "1", "tile", "g2", 0, 0.21),
    ("4", "4", "tile", "g2", 0, 0.14),
];

/// One value for each batch; empty where the sampler does not exist.
fn batches(table: &Table, dims: &str, spp: &str, sampler: &str, kernel: &str, family: &str) -> Result<Vec<f64>> {
    table.numbers_of(kernel, &[("dims", dims), ("spp", spp), ("sampler", sampler), ("family", family)])
}

pub(super) fn write(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    introduce(table, chapter)?;
    for dims in table.distinct("dims")? {
        chapter.section(&format!("Samplers alone, {dims} dims"), "");
        for kernel in KERNELS {
            errors(table, dims, kernel, chapter)?;
        }
    }
    for &(dims, spp, sampler, kernel, family, bound) in WANTED {
        let values = batches(table, dims, spp, sampler, kernel, FAMILIES[family])?;
        if values.is_empty() {
            continue;
        }
        let what = if kernel == "raw" { "raw error" } else { "filtered error, 2.1 pixels" };
        let statement = format!("{what}, {} of {dims} dims, {spp} spp, {sampler}", FAMILIES[family]);
        targets.at_most(&statement, "all pixels", Estimate::mean(&values), Unit::Number, bound);
    }
    Ok(())
}

fn introduce(table: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("How samplers alone are measured", "");
    let batches = table.distinct("batch")?.len();
    chapter.setting("batches", batches);
    let row = table.rows().next().context("no energies were measured")?;
    let integrands: usize = row.number("integrands")?;
    chapter.setting("integrands of each family, one sample", integrands * batches);
    Ok(())
}

fn errors(table: &Table, dims: &str, kernel: &str, chapter: &mut Chapter) -> Result<()> {
    let counts = table.distinct("spp")?;
    let pairs = FAMILIES.iter().flat_map(|family| counts.iter().map(move |spp| (*family, *spp)));
    let across: Vec<_> = pairs.map(|(family, spp)| (format!("{family}, {spp} spp"), (family, spp))).collect();
    let down = table.distinct("sampler")?.into_iter().map(|sampler| (row![sampler], sampler));
    chapter.grid("errors", &["sampler"], down, &across, |sampler, (family, spp)| {
        Ok(Figure::mean(&batches(table, dims, spp, sampler, kernel, family)?, Unit::Number).into())
    })
}
