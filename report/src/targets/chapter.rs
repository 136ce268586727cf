//! docs/report/sizes.md and .json.

use super::{Findings, build};
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::write_chapter;
use crate::measure::output::Output;
use anyhow::Result;
use xtask::{paths, run};

pub(crate) fn write(all: &[Findings]) -> Result<()> {
    let mut chapter = Chapter::new("Code size and stack on other targets");
    targets(&mut chapter, all)?;
    services(&mut chapter, all);
    example(&mut chapter, all);
    let folder = paths::root().join("docs/report");
    let output = Output::new(&folder)?;
    write_chapter(&output, "sizes", &chapter.json())?;
    output.commit()?;
    println!("wrote docs/report/sizes.md and sizes.json");
    Ok(())
}

fn targets(chapter: &mut Chapter, all: &[Findings]) -> Result<()> {
    chapter.section("Targets", "");
    let compiler = run::read(run::command(build::RUSTC).arg("--version"))?;
    chapter.setting("compiler", compiler.trim().split(" (").next().unwrap_or_default());
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
    chapter.table("targets", "target | Rust's name | optimised | what ran | on", 5, rows.collect());
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
    chapter.table("text", &headings, 1, table(|size| size.text));
    chapter.section("Constants", "");
    chapter.table("rodata", &headings, 1, table(|size| size.rodata));
    let stateless = all.iter().flat_map(|findings| &findings.sizes).all(|size| size.data == 0);
    if stateless {
        chapter.setting("variables", "none");
    } else {
        chapter.section("Variables", "");
        chapter.table("variables", &headings, 1, table(|size| size.data));
    }
}

fn example(chapter: &mut Chapter, all: &[Findings]) {
    chapter.section("A program that calls every service", "");
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
