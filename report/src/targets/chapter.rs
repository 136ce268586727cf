//! docs/report/sizes.md and .json.

use super::{Findings, build};
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;
use xtask::{paths, run};

pub(crate) fn write(all: &[Findings]) -> Result<()> {
    let mut chapter = Chapter::new("Code size and stack on other targets");
    chapter.paragraph(
        "What a program grows by that links one service and nothing else: the release build of the C library, linked for \
         that service's functions with unused sections dropped. Services share code, so that two together are smaller than \
         the sum. `cargo xtask targets` builds all of this, runs it and writes this file.",
    );
    targets(&mut chapter, all)?;
    services(&mut chapter, all);
    example(&mut chapter, all);
    let folder = paths::root().join("docs/report");
    let json = serde_json::to_string_pretty(&chapter.json()).context("the chapter is no JSON")?;
    replace(&folder, "sizes.md", chapter.markdown())?;
    replace(&folder, "sizes.json", &format!("{json}\n"))?;
    println!("wrote docs/report/sizes.md and sizes.json");
    Ok(())
}

fn targets(chapter: &mut Chapter, all: &[Findings]) -> Result<()> {
    chapter.section("Targets", "");
    let compiler = run::read(run::command(build::RUSTC).arg("--version"))?;
    chapter.paragraph(&format!(
        "Compiled by {}. Optimisation is cargo's `opt-level`: `s` where memory is scarce, 3 elsewhere. \"Float alone\" is the \
         library without its feature `double`: control variates in single precision only. What ran gave the same bits as \
         this machine.",
        compiler.trim().split(" (").next().unwrap_or_default()
    ));
    let rows = all.iter().map(|findings| {
        let platform = findings.platform;
        row![
            platform.name,
            format!("`{}`", platform.triple),
            platform.opt_level,
            findings.ran.as_str(),
            findings.emulator.as_str()
        ]
    });
    chapter.table("targets", &["target", "Rust's name", "optimised", "what ran", "on"], 5, rows.collect());
    Ok(())
}

fn services(chapter: &mut Chapter, all: &[Findings]) {
    let names: Vec<&str> = all.iter().map(|findings| findings.platform.name).collect();
    let headings: Vec<&str> = [&["service"], &names[..]].concat();
    let count = all.first().map_or(0, |first| first.sizes.len());
    let table = |size: fn(&super::Size) -> u64| -> Vec<Vec<Cell>> {
        let row = |at: usize| {
            let name = all.first().map_or("", |first| first.sizes[at].service);
            std::iter::once(Cell::from(name))
                .chain(all.iter().map(|findings| bytes(size(&findings.sizes[at]))))
                .collect()
        };
        (0..count).map(row).collect()
    };
    chapter.section("Instructions", "");
    chapter.paragraph(
        "Bytes of .text; of WebAssembly of the code section. The estimator is a field of the configuration, so that a program \
         that calls `nf_cv_estimate` has all of them.",
    );
    chapter.table("text", &headings, 1, table(|size| size.text));
    families(chapter, all);
    chapter.section("Constants", "");
    chapter.paragraph(
        "Bytes of .rodata; of WebAssembly of the data section. The built-in tiles are not counted: a program that loads one \
         by `nf_tile_from_bytes` brings that alone, one that calls `nf_tile_builtin` has all that the library was built with.",
    );
    chapter.table("rodata", &headings, 1, table(|size| size.rodata));
    let stateless = all.iter().flat_map(|findings| &findings.sizes).all(|size| size.data == 0);
    if stateless {
        chapter.paragraph("Variables (.data, .bss): on these targets the library keeps none.");
    } else {
        chapter.section("Variables", "");
        chapter.paragraph("Bytes of .data and .bss.");
        chapter.table("variables", &headings, 1, table(|size| size.data));
    }
}

fn families(chapter: &mut Chapter, all: &[Findings]) {
    chapter.section("Of which families of estimators take", "");
    chapter.paragraph(
        "Bytes of instructions of a program that calls `nf_cv_estimate` alone, by the modules that its functions are named \
         after; a function that was compiled into another counts there.",
    );
    let known: Vec<&Findings> = all.iter().filter(|findings| !findings.families.is_empty()).collect();
    let names: Vec<&str> = known.iter().map(|findings| findings.platform.name).collect();
    let headings: Vec<&str> = [&["family"], &names[..]].concat();
    let parts = known.first().map_or(0, |first| first.families.len());
    let row = |at: usize| {
        let name = known.first().map_or("", |first| first.families[at].0);
        std::iter::once(Cell::from(name)).chain(known.iter().map(|findings| bytes(findings.families[at].1))).collect()
    };
    chapter.table("families", &headings, 1, (0..parts).map(row).collect());
}

fn example(chapter: &mut Chapter, all: &[Findings]) {
    chapter.section("A program that calls every service", "");
    chapter.paragraph(
        "`examples_c/bare_metal`. Bytes of stack of each call, measured by painting it: 64 samples of 2 dimensions, order 2, \
         the robust estimator; an accumulator in single precision; optimal MIS of 3 techniques; a table of 100 items with a \
         batch of 8. Of WebAssembly only the stack in the module's memory. Image: instructions and constants of the whole \
         program, where it stands alone, its tile of 16 KiB included.",
    );
    let names: Vec<&str> = all.iter().map(|findings| findings.platform.name).collect();
    let headings: Vec<&str> = [&["call"], &names[..]].concat();
    let mut calls: Vec<&str> = Vec::new();
    for (call, _) in all.iter().flat_map(|findings| &findings.program.stacks) {
        if !calls.contains(&call.as_str()) {
            calls.push(call);
        }
    }
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for call in calls {
        let stack = |findings: &Findings| -> Cell {
            let found = findings.program.stacks.iter().find(|(name, _)| name == call);
            found.map_or(Cell::Missing, |(_, depth)| bytes((*depth).into()))
        };
        rows.push(std::iter::once(Cell::from(format!("`{call}`"))).chain(all.iter().map(stack)).collect());
    }
    let image = |findings: &Findings| findings.program.image.map_or(Cell::Missing, bytes);
    rows.push(std::iter::once(Cell::from("image")).chain(all.iter().map(image)).collect());
    chapter.table("example", &headings, 1, rows);
}

fn bytes(value: u64) -> Cell {
    Cell::from(Figure::exact(value as f64, Unit::Count))
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
