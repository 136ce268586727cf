//! docs/report/sizes.md and .json.

use super::Findings;
use crate::paths;
use crate::report::chapter::{Cell, Chapter};
use crate::report::figure::{Figure, Unit};
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;

pub(crate) fn write(all: &[Findings]) -> Result<()> {
    let mut chapter = Chapter::new("Code size and stack");
    chapter.paragraph(
        "What a program grows by that links one service and nothing else: the release build of the C library, linked for \
         that service's functions with unused sections dropped. Services share code, so that two together are smaller than \
         the sum. Optimised for speed, every common number of dimensions and order compiled on its own. \
         `cargo xtask targets` measures this.",
    );
    let bytes = |value: u64| Cell::from(Figure::exact(value as f64, Unit::Count));
    chapter.section("Instructions and constants", "");
    chapter.paragraph(
        "Bytes of instructions + constants (.text + .rodata). Of WebAssembly the module's whole size. The built-in tiles are \
         data of their own, not counted here: a program that loads one by `nf_tile_from_bytes` brings that alone.",
    );
    let names: Vec<&str> = all.iter().map(|findings| findings.platform.name).collect();
    let services = all.first().map_or(0, |first| first.sizes.len());
    let table = |size: fn(&super::Size) -> u64| -> Vec<Vec<Cell>> {
        let row = |at: usize| {
            let name = all.first().map_or("", |first| first.sizes[at].service);
            std::iter::once(Cell::from(name))
                .chain(all.iter().map(|findings| bytes(size(&findings.sizes[at]))))
                .collect()
        };
        (0..services).map(row).collect()
    };
    let headings: Vec<&str> = [&["service"], &names[..]].concat();
    chapter.table("code", &headings, 1, table(|size| size.text + size.rodata));
    chapter.section("Constants alone", "");
    chapter.paragraph("Bytes of .rodata, which is part of the above; of WebAssembly it is not known apart.");
    chapter.table("constants", &headings, 1, table(|size| size.rodata));
    chapter.section("Variables", "");
    let stateless = all.iter().flat_map(|findings| &findings.sizes).all(|size| size.data == 0);
    chapter.paragraph(if stateless {
        "Bytes of .data and .bss: on these targets the library keeps none."
    } else {
        "Bytes of .data and .bss."
    });
    chapter.table("variables", &headings, 1, table(|size| size.data));
    chapter.section("Stack", "");
    chapter.paragraph(
        "Bytes of stack of each call in `examples_c/bare_metal/services.c` on an emulated Cortex-M4F, measured by painting \
         it: 64 samples of 2 dimensions, order 2, the robust estimator; an accumulator in single precision; optimal MIS of 3 \
         techniques; a table of 100 items with a batch of 8.",
    );
    let stacks = all.iter().flat_map(|findings| &findings.stacks);
    let rows = stacks.map(|(call, depth)| vec![Cell::from(call.as_str()), bytes((*depth).into())]).collect();
    chapter.table("stack", &["call", "bytes"], 1, rows);
    let folder = paths::root().join("docs/report");
    let json = serde_json::to_string_pretty(&chapter.json()).context("the chapter is no JSON")?;
    replace(&folder, "sizes.md", chapter.markdown())?;
    replace(&folder, "sizes.json", &format!("{json}\n"))?;
    println!("wrote docs/report/sizes.md and sizes.json");
    Ok(())
}

/// Written beside, then renamed.
fn replace(folder: &Path, name: &str, text: &str) -> Result<()> {
    let write = || {
        let new = folder.join(format!(".{name}.new"));
        fs::write(&new, text)?;
        fs::rename(new, folder.join(name))
    };
    write().with_context(|| format!("cannot write {}", folder.join(name).display()))
}
