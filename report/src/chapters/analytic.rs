//! The chapter of what can be told only where integrals and gradients are known exactly.

use super::chapter::headings;
use super::prelude::*;
use super::{Report, program};

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let tables = program::measure(report)?;
    let mut targets = Targets::default();
    let mut chapter = Chapter::new("Known integrands and gradients");
    tiles(&mut chapter, &mut targets, &tables.read("tiles")?)?;
    hard(&mut chapter, &mut targets, &tables.read("hard")?)?;
    bias(&mut chapter, &tables.read("bias")?)?;
    continued(&mut chapter, &tables.read("continued")?)?;
    gradients(&mut chapter, &tables.read("polynomial")?, &tables.read("classifier")?)?;
    gradient_bias(&mut chapter, &tables.read("gradient_bias")?)?;
    targets.write(&mut chapter);
    Ok(chapter)
}

fn number(values: &[f64]) -> Option<Figure> {
    Figure::mean(values, Unit::Number)
}

fn once(values: &[f64]) -> Option<Figure> {
    Figure::once(values, Unit::Number)
}

/// Largest RMSE over the mean's where fits cannot help.
const HARD: f64 = 1.03;
/// Samples, then the largest errors over white noise's: of each of [`ERRORS`].
const GAINS: [(&str, [f64; 4]); 2] = [("1", [0.25, 0.17, 0.13, 0.055]), ("4", [0.22, 0.16, 0.048, 0.009])];
/// The program's columns, and their names.
const ERRORS: [(&str, &str); 4] = [
    ("half_planes", "half-planes"),
    ("bumps", "bumps"),
    ("half_planes_blurred", "half-planes, filtered"),
    ("bumps_blurred", "bumps, filtered"),
];

/// Fits shared by pixels, on a tile's samples.
fn tiles(chapter: &mut Chapter, targets: &mut Targets, table: &Table) -> Result<()> {
    chapter.section("Shared fits on a tile's samples", "");
    let count = |samples: &str| table.find(&[("samples", samples)])?.number::<u32>("count");
    chapter.setting("half-planes, and bumps", count("1")?);
    chapter.setting("the same at 16 samples", count("16")?);
    let kinds = table.kinds(&["samples", "integrands"])?;
    let each = kinds.iter().flat_map(|kind| {
        ERRORS.map(|(error, name)| {
            (row![kind[0], kind[1], name], ([("samples", kind[0]), ("integrands", kind[1])], error))
        })
    });
    let methods = table.headings("method", str::to_owned)?;
    let lead = (3, "samples | integrands | error");
    chapter.grid("shared fits on tiles", lead, each, &methods, |(kind, error), method| {
        Ok(once(&table.numbers_of(error, &[&kind[..], &[("method", method)]].concat())?).into())
    })?;
    for (samples, bounds) in GAINS {
        for ((error, name), bound) in ERRORS.into_iter().zip(bounds) {
            let keys = [("samples", samples), ("integrands", "the same everywhere"), ("method", "8 x 8, order 4")];
            let estimate = Estimate::exact(table.find(&keys)?.number(error)?);
            let statement =
                format!("shared fits on a tile of {samples} spp, order 4, over independent samples: {name}");
            targets.at_most(&statement, "windows of 8 x 8", estimate, Unit::Number, bound);
        }
    }
    Ok(())
}

/// Fits shared by pixels that have little to share.
fn hard(chapter: &mut Chapter, targets: &mut Targets, table: &Table) -> Result<()> {
    chapter.section("Shared fits where neighbours have little to share", "");
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let counts = table.distinct("n")?;
    for of in table.distinct("of")? {
        let mut worst = (Estimate::exact(0.0), String::new());
        for scene in table.distinct("scene")? {
            let mut cells = row![scene, of];
            for &n in &counts {
                let row = table.find(&[("of", of), ("scene", scene), ("n", n)])?;
                let ratio = row.ratio("images")?;
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
    chapter.table("hard scenes", &headings(&["scene", "as"], counts.iter().map(|n| format!("n = {n}"))), 2, rows);
    Ok(())
}

/// What is left after chance is taken away may be nothing.
fn bias(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("The bias of shared fits", "");
    let words = ["samples", "n", "estimator"];
    let down = table.rows().map(|row| {
        let mut cells: Vec<Cell> = words.map(|word| row.word(word).unwrap_or_default().into()).to_vec();
        cells.push(format!("{0} x {0}", row.word("window").unwrap_or_default()).into());
        (cells, row)
    });
    let columns = ["typical", "largest", "chance"].map(|name| (name, name));
    chapter.grid("bias", (4, "samples | a pixel | estimator | window"), down, &columns, |row, column| {
        Ok(once(&[row.number(column)?]).into())
    })
}

fn continued(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("Samples beyond a tile's", "");
    let first = table.rows().next().context("the program has measured no tile")?;
    chapter.setting("integrands of each kind", first.number::<u32>("count")?);
    let down = ["spp", "tile", "integrands", "samples"].map(|key| (key, key));
    chapter.pivot("continued tiles", table, &down, ("times", "n / spp = {}"), ("error", number))
}

/// The program's columns of several tables.
const SOLVERS: [&str; 3] = ["balance", "plain", "ridge"];
const ONE: &str = "one table of norms";

/// Optimal MIS beside importance sampling.
fn gradients(chapter: &mut Chapter, polynomial: &Table, classifier: &Table) -> Result<()> {
    chapter.section("Optimal MIS gradients", "");
    let counts = polynomial.distinct("techniques")?;
    let first = *counts.first().context("the program has measured no techniques")?;
    let several = counts.iter().flat_map(|count| SOLVERS.map(|solver| (*count, solver)));
    let several = several.map(|(count, solver)| (row![format!("{count} signed tables, {solver}")], (count, solver)));
    let down = [(row![ONE], (first, "one"))].into_iter().chain(several);
    let steps = polynomial.headings("steps", |steps| format!("{steps} steps"))?;
    chapter.grid("polynomial", (1, "tables"), down, &steps, |(count, solver), steps| {
        Ok(number(&polynomial.numbers_of(solver, &[("steps", steps), ("techniques", count)])?).into())
    })?;
    let several = SOLVERS.map(|solver| (row![format!("10 signed tables, {solver}")], solver));
    let down = [(row![ONE], "one")].into_iter().chain(several);
    let (batches, steps) = (classifier.distinct("batch")?, classifier.distinct("steps")?);
    let kinds = batches.iter().flat_map(|batch| steps.iter().map(move |steps| [*batch, *steps]));
    let across: Vec<_> = kinds.map(|of| (format!("batch {}, {} steps", of[0], of[1]), of)).collect();
    chapter.grid("classifier", (1, "tables"), down, &across, |solver, of| {
        Ok(once(&classifier.numbers_of(solver, &[("batch", of[0]), ("steps", of[1])])?).into())
    })
}

fn gradient_bias(chapter: &mut Chapter, table: &Table) -> Result<()> {
    let down = table.distinct("batch")?.into_iter().map(|batch| (row![format!("batch {batch}")], batch));
    let what = [("bias", "bias"), ("RMS error", "error")];
    let solvers = ["ridge", "plain"].into_iter();
    let across: Vec<_> =
        solvers.flat_map(|solver| what.map(|(word, column)| (format!("{solver}: {word}"), (solver, column)))).collect();
    chapter.grid("gradient bias", (1, "batch"), down, &across, |batch, (solver, column)| {
        Ok(once(&table.numbers_of(column, &[("batch", batch), ("solver", solver)])?).into())
    })
}
