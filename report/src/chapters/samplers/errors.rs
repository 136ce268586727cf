//! Errors of samplers alone, by number of samples, raw and through three filters.

use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::output::Output;
use crate::measure::plot::{Axis, Plot, Series};
use crate::measure::table::Table;
use anyhow::{Context, Result};

/// A column of the program's table, and what it is.
const KERNELS: [(&str, &str); 4] = [
    ("raw", "Single pixels, raw"),
    ("g1", "Filtered by a Gaussian of standard deviation 1 pixel"),
    ("a", "Filtered by a Gaussian of standard deviation 1.485 pixels"),
    ("g2", "Filtered by a Gaussian of standard deviation 2.1 pixels"),
];
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

/// What is measured of one sampler.
struct Energies<'a>(&'a Table);

impl Energies<'_> {
    /// One value for each batch; empty where the sampler does not exist.
    fn batches(&self, dims: &str, spp: &str, sampler: &str, kernel: &str, family: &str) -> Result<Vec<f64>> {
        let wanted = [("dims", dims), ("spp", spp), ("sampler", sampler), ("family", family)];
        self.0.rows().filter(|row| row.has(&wanted)).map(|row| row.number(kernel)).collect()
    }
}

pub(super) fn write(output: &Output, table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let energies = Energies(table);
    introduce(table, chapter)?;
    for dims in table.distinct("dims")? {
        chapter.section(&format!("Samplers alone, {dims} dims"), "");
        if dims == "2" {
            chapter.paragraph(
                "Mean squared errors over those of white noise. Random and Owen-scrambled Sobol points are as good in every pixel as in any \
                 image: their filtered errors are their raw ones. What is below them is blue.",
            );
        }
        for (kernel, title) in KERNELS {
            chapter.paragraph(&format!("{title}:"));
            errors(&energies, table, dims, kernel, chapter)?;
        }
        let file = format!("samplers-{dims}d.svg");
        output.write_text(&file, &plot(&energies, table, dims)?)?;
        chapter.picture(&file, &format!("filtered error against samples per pixel, {dims} dims"));
    }
    for &(dims, spp, sampler, kernel, family, bound) in WANTED {
        let values = energies.batches(dims, spp, sampler, kernel, FAMILIES[family])?;
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
    let batches = chapter.setting("batches", table.distinct("batch")?.len());
    let row = table.rows().next().context("no energies were measured")?;
    let integrands: usize = row.number("integrands")?;
    let integrands = chapter.setting("integrands of each family, one sample", integrands * batches);
    for (name, value) in [("widest", 2.1), ("middle", 1.485), ("narrowest", 1.0)] {
        chapter.setting(format!("standard deviation of the {name} filter, pixels"), value);
    }
    let confidence = chapter.setting("confidence, percent", 95);
    let side = chapter.setting("pixels on a side", 128);
    chapter.paragraph(&format!(
        "{side} x {side} pixels. Random half-planes (in more dimensions half-spaces) and Gaussian bumps, each the same in every pixel; \
         {batches} batches, {integrands} integrands of each family at one sample, fewer where samples are many. Each batch has its own \
         integrands, and seeds where a sampler has any; all samplers have the same integrands. Definitions: \
         [metrics.md](../metrics.md), tiles. A figure is the mean over batches; its {confidence} % interval is in the JSON."
    ));
    chapter.list(&[
        "random: the library's PCG. Owen-Sobol: crate `sobol_burley`, each pixel scrambled on its own.",
        "Heitz: the tables of E. Heitz et al. 2019 for as many samples, crate `blue-noise-sampler`. OpenQMC: crate `openqmc-rs`, three samplers.",
        "tile: the built-in tile that `recommend()` names; from 64 samples on, and wherever a tile has fewer than are drawn, continued. Four \
         dims of 16 samples are two domains of a tile of two dims.",
        "progressive tile: the first samples of `NF_TILE_128_16SPP_2D_PROGRESSIVE`, continued beyond 16.",
    ]);
    chapter.setting("year of the tables", 2019);
    chapter.setting("samples from which a tile of one is continued", 64);
    chapter.setting("samples of the progressive tile", 16);
    Ok(())
}

fn errors(energies: &Energies, table: &Table, dims: &str, kernel: &str, chapter: &mut Chapter) -> Result<()> {
    let counts = table.distinct("spp")?;
    let headings: Vec<String> =
        FAMILIES.iter().flat_map(|family| counts.iter().map(move |spp| format!("{family}, {spp} spp"))).collect();
    let columns: Vec<&str> = ["sampler"].into_iter().chain(headings.iter().map(String::as_str)).collect();
    let mut rows = Vec::new();
    for sampler in table.distinct("sampler")? {
        let mut cells: Vec<Cell> = row![sampler];
        for (family, spp) in FAMILIES.iter().flat_map(|family| counts.iter().map(move |spp| (family, spp))) {
            let values = energies.batches(dims, spp, sampler, kernel, family)?;
            cells.push(match values.is_empty() {
                true => Cell::Missing,
                false => Figure::brief(Estimate::mean(&values), Unit::Number).into(),
            });
        }
        if cells[1..].iter().any(|cell| matches!(cell, Cell::Figure(_))) {
            rows.push(cells);
        }
    }
    chapter.table("errors", &columns, 1, rows);
    Ok(())
}

/// The filtered error of half-planes: over white noise of as many samples, divided by them.
fn plot(energies: &Energies, table: &Table, dims: &str) -> Result<String> {
    let mut series = Vec::new();
    for (index, sampler) in table.distinct("sampler")?.into_iter().enumerate() {
        let (mut points, mut band) = (Vec::new(), Vec::new());
        for spp in table.distinct("spp")? {
            let values = energies.batches(dims, spp, sampler, "g2", FAMILIES[0])?;
            if values.is_empty() {
                continue;
            }
            let (of, count) = (Estimate::mean(&values), spp.parse::<f64>()?);
            points.push((count, of.value / count));
            band.push((count, of.low / count, of.high / count));
        }
        if !points.is_empty() {
            series.push(Series { name: sampler.to_owned(), points, band, colour: Some(index), ..Series::default() });
        }
    }
    let title = format!("Half-planes of {dims} dims, filtered by a Gaussian of 2.1 pixels");
    let axis = |label| Axis { label, logarithmic: true, range: None };
    let y = axis("mean squared error over that of one random sample");
    Plot { title: &title, x: axis("samples per pixel"), y, series: &series }.svg()
}
