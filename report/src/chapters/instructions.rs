//! The chapter of instruction counts.

use super::Report;
use super::chapter::{Cell, Chapter, row};
use super::figure::{Figure, Unit};
use anyhow::{Result, bail};
use xtask::{instructions, library, tools};

pub(super) fn write(report: &Report) -> Result<()> {
    if let Some(missing) = tools::packages(&instructions::PACKAGES)? {
        bail!("the chapter needs valgrind. {missing}");
    }
    let program = instructions::compile(&library::build()?)?;
    report.compiled();
    let counted = instructions::count(&program)?;

    let mut chapter = Chapter::new("Instructions of the hottest functions");
    let compiler = chapter.setting("compiler", counted.compiler.as_str()).to_owned();
    let vector_units = chapter.setting("vector units", counted.vector_units.as_str()).to_owned();
    chapter.paragraph(
        "Made by `cargo xtask report`; machine-readable in `instructions.json`; the program is `bench/instructions.c`. Instructions of the C \
         functions as valgrind's callgrind counts them: the same in every run, so that a change of the code shows on a busy machine where \
         times do not. `cargo xtask test` counts again and fails where a function takes 3 % more, if the compiler is the same. \
         Counts are no times: an instruction that waits for memory counts as one.",
    );
    chapter.setting("tolerance, percent", 3);
    chapter.paragraph(&format!(
        "Compiled by {compiler}. Vector units that the library found under valgrind, which knows none wider than AVX2: {vector_units}."
    ));
    let rows = counted.counts.into_iter().map(|count| -> Vec<Cell> {
        row![count.name, count.unit, Figure::exact(count.instructions, Unit::Instructions)]
    });
    chapter.table("counts", &["function", "per", "instructions"], 2, rows.collect());
    let (dims, items, techniques, parameters) =
        (chapter.setting("dims", 2), chapter.setting("items", 60_000), chapter.setting("techniques", 8), 1000);
    let (order, batch) = (chapter.setting("order", 2), chapter.setting("batch", 64));
    let (width, spp) = (chapter.setting("width of the image", 16), chapter.setting("samples per pixel", 4));
    chapter.setting("parameters", parameters);
    let sixteen = chapter.setting("samples per pixel of the larger tile", 16);
    chapter.list(&[
        format!(
            "`nf_cv_estimate`: {dims} dimensions, order {order}, one channel; the number is that of samples. `nf_cv_accumulator_add`: a sample a \
             call. `nf_cv_image_estimate`: {width} x {width} pixels of {spp} samples, overlapping windows."
        ),
        format!(
            "`nf_sampler_draw`: a pixel's sampler and {dims} numbers of a tile of as many dims and {spp} samples per pixel; `domain`: of a child \
             domain. `4 of 4 dims`, `4 of 2 dims`: four numbers of the pixel's own domain, of tiles of 4 and {sixteen} samples. `two domains`: {dims} \
             numbers of each of two child domains, {sixteen} samples per pixel."
        ),
        format!(
            "`nf_sampler_fill`: {dims} numbers of one sample of each pixel of a part of an image in one call; `two domains`: {dims} of each of two, \
             all {sixteen} samples of each pixel, which share their hashes."
        ),
        format!("`nf_table_draw`, `nf_table_update`: batches of {batch} from {items} items, weights included."),
        format!(
            "`nf_mis_balance`, `nf_omis_weights`: {techniques} techniques, {batch} samples. `nf_gradient_estimate`: the same with explicit gradients of \
             {parameters} parameters."
        ),
    ]);
    report.write(&chapter)
}
