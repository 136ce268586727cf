//! The chapter of samplers, and of samplers with estimators.

use super::figure::significant;
use super::prelude::*;
use super::{Report, program};

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let tables = program::measure(report)?;
    let mut targets = Targets::default();
    let mut chapter = Chapter::new("Samplers, alone and with estimators");
    errors(&tables.read("energies")?, &mut chapter, &mut targets)?;
    draws(&tables.read("draws")?, &mut chapter, &mut targets)?;
    decisions(&tables.read("decisions")?, &mut chapter)?;
    targets.write(&mut chapter);
    Ok(chapter)
}

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

/// Errors of samplers alone, by number of samples, raw and through three filters. A sampler that does not exist has no
/// value.
fn errors(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let batches = |dims, spp, sampler, kernel, family| {
        table.numbers_of(kernel, &[("dims", dims), ("spp", spp), ("sampler", sampler), ("family", family)])
    };
    chapter.section("How samplers alone are measured", "");
    let count = table.distinct("batch")?.len();
    chapter.setting("batches", count);
    let integrands: usize = table.rows().next().context("no energies were measured")?.number("integrands")?;
    chapter.setting("integrands of each family, one sample", integrands * count);
    let counts = table.distinct("spp")?;
    let pairs = FAMILIES.iter().flat_map(|family| counts.iter().map(move |spp| (*family, *spp)));
    let across: Vec<_> = pairs.map(|(family, spp)| (format!("{family}, {spp} spp"), (family, spp))).collect();
    for dims in table.distinct("dims")? {
        chapter.section(&format!("Samplers alone, {dims} dims"), "");
        for kernel in KERNELS {
            let down = table.distinct("sampler")?.into_iter().map(|sampler| (row![sampler], sampler));
            chapter.grid("errors", (1, "sampler"), down, &across, |sampler, (family, spp)| {
                Ok(Figure::mean(&batches(dims, spp, sampler, kernel, family)?, Unit::Number).into())
            })?;
        }
    }
    for &(dims, spp, sampler, kernel, family, bound) in WANTED {
        let values = batches(dims, spp, sampler, kernel, FAMILIES[family])?;
        if !values.is_empty() {
            let what = if kernel == "raw" { "raw error" } else { "filtered error, 2.1 pixels" };
            let statement = format!("{what}, {} of {dims} dims, {spp} spp, {sampler}", FAMILIES[family]);
            targets.at_most(&statement, "all pixels", Estimate::mean(&values), Unit::Number, bound);
        }
    }
    Ok(())
}

/// The public sampler that the library's draws are to be as fast as.
const PEER: &str = "OpenQMC lattice-bn";
/// What draws go through.
const DOORS: [&str; 3] = ["Rust", "C ABI", "C ABI by pixel"];

/// What a draw costs.
fn draws(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Nanoseconds of a draw", "");
    chapter.setting("rounds", table.distinct("round")?.len());
    let counts = table.headings("spp", |spp| format!("{spp} spp"))?;
    let times = |dims: &str, spp: &str, sampler: &str, door: &str| {
        table.numbers_of("ns", &[("dims", dims), ("spp", spp), ("sampler", sampler), ("door", door)])
    };
    for dims in table.distinct("dims")? {
        let samplers = table.distinct("sampler")?;
        let down = samplers.iter().flat_map(|sampler| DOORS.map(|door| (row![*sampler, door], (*sampler, door))));
        chapter.grid("draws", (2, "sampler | through"), down, &counts, |(sampler, door), spp| {
            Ok(Figure::median(&times(dims, spp, sampler, door)?, Unit::Nanoseconds).into())
        })?;
        for (door, sampler) in DOORS.into_iter().flat_map(|door| ["tile", "progressive tile"].map(|of| (door, of))) {
            for (_, spp) in counts.iter().filter(|(_, spp)| *spp != "64") {
                let (own, peer) = (times(dims, spp, sampler, door)?, times(dims, spp, PEER, "Rust")?);
                if !own.is_empty() && !peer.is_empty() {
                    let statement = format!("time of a draw over that of {PEER}, {dims} numbers, {door}");
                    let place = format!("{sampler}, {spp} spp");
                    targets.at_most(&statement, &place, Estimate::ratio(&own, &peer), Unit::Ratio, 1.0);
                }
            }
        }
    }
    Ok(())
}

/// What `recommend()` says, and whether this run agrees.
fn decisions(table: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("What is recommended", "");
    let counts = table.headings("n", |n| format!("n = {n}"))?;
    let (dims, kinds) = (table.distinct("dims")?, table.kinds(&["samples", "neighbours"])?);
    let down = dims.iter().flat_map(|dims| kinds.iter().map(move |of| (row![*dims, of[0], of[1]], (*dims, of))));
    chapter.grid("recommended", (3, "dims | samples | neighbours"), down, &counts, |(dims, of), n| {
        let wanted = [("dims", *dims), ("samples", of[0]), ("neighbours", of[1]), ("n", *n)];
        Ok(match table.rows().find(|row| row.has(&wanted)) {
            Some(row) if of[1].is_empty() => name(row, "recommended")?.into(),
            Some(row) => choice(row, "recommended", ["raw", "filtered"])?.into(),
            None => Cell::Missing,
        })
    })?;
    // Where something else was better by more than its noise.
    let mut rows = Vec::new();
    for row in table.rows().filter(|row| row.number::<f64>("excess_low").is_ok_and(|low| low > 1.0)) {
        let [value, low, high] = ["excess", "excess_low", "excess_high"].map(|column| row.number(column));
        rows.push(row![
            row.word("dims")?,
            row.word("n")?,
            row.word("samples")?,
            row.word("neighbours")?,
            choice(row, "recommended", ["raw", "filtered"])?,
            choice(row, "best", ["best_raw", "best_filtered"])?,
            Figure::new(Estimate { value: value?, low: low?, high: high?, seeds: 2 }, Unit::Ratio)
        ]);
    }
    chapter.quote("decisions", Figure::count(table.rows().count()));
    chapter.quote("decisions where another was better", Figure::count(rows.len()));
    let largest = table.numbers("excess")?.into_iter().fold(1.0, f64::max);
    chapter.quote("largest excess of a recommendation", Figure::exact(largest, Unit::Ratio));
    if !rows.is_empty() {
        let columns = "dims | n | samples | neighbours | recommended | better | excess";
        chapter.table("better than recommended", columns, 6, rows);
    }
    Ok(())
}

fn name(row: Row<'_>, column: &str) -> Result<String> {
    Ok(row.word(column)?.replace(';', ","))
}

/// What is chosen, and its errors, of which two digits hold.
fn choice(row: Row<'_>, column: &str, errors: [&str; 2]) -> Result<String> {
    let [raw, filtered] = errors.map(|error| row.number(error).map(|error| significant(error, 2)));
    Ok(format!("{}: {}, {}", name(row, column)?, raw?, filtered?))
}
