//! How many instructions the library's hottest functions take: counted by callgrind, so the same on a busy machine.

use crate::paths::{self, elements};
use crate::run;
use crate::tools::{self, Package};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::path::{Path, PathBuf};

pub const PACKAGES: [Package; 1] = [Package { name: "valgrind", file: "valgrind" }];
/// The committed counts.
const REPORT: &str = "docs/report/instructions.json";
/// By how much a count may exceed the committed one, percent.
const TOLERANCE: f64 = 3.0;

/// What bench/instructions.c says of a case, and its count.
pub struct Count {
    pub name: String,
    /// What the count is divided by: a sample, a draw, ...
    pub unit: String,
    pub instructions: f64,
}

/// All counts, and what they depend on besides the library's sources.
pub struct Counts {
    pub compiler: String,
    /// Those that the processor has, as far as valgrind knows them.
    pub vector_units: String,
    pub counts: Vec<Count>,
}

/// Compiles bench/instructions.c; counting then takes a second for each case.
pub fn compile(archive: &Path) -> Result<PathBuf> {
    let program = paths::output().join("instructions");
    let mut compiler = run::compiler("CC", "cc");
    compiler.args(["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror", "-Iinclude"]);
    run::check(compiler.arg("bench/instructions.c").arg(archive).arg("-o").arg(&program))?;
    Ok(program)
}

pub fn count(program: &Path) -> Result<Counts> {
    let list = run::read(run::command("valgrind").args(["--quiet", "--tool=none"]).arg(program))?;
    let mut lines = list.lines();
    let units = lines.next().and_then(|line| line.strip_prefix("vector units,"));
    let vector_units = units.context("bench/instructions.c did not say which vector units there are")?.to_owned();
    let counts: Vec<Count> = lines.map(|line| count_case(program, line)).collect::<Result<_>>()?;
    if counts.is_empty() {
        bail!("bench/instructions.c has no cases");
    }
    let compiler = run::read(run::command("rustc").arg("--version"))?.trim().to_owned();
    Ok(Counts { compiler, vector_units, counts })
}

/// `line`: name, repetitions, parts in each, unit.
fn count_case(program: &Path, line: &str) -> Result<Count> {
    let words: Vec<&str> = line.split(',').collect();
    let [name, repeat, parts, unit] = words[..] else { bail!("`{line}` is no case of bench/instructions.c") };
    let number = |word: &str| word.parse::<f64>().with_context(|| format!("`{line}`: `{word}` is no number"));
    let mut valgrind = run::command("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=measured"]);
    let output = valgrind.arg(program).arg(name).output().context("cannot start valgrind")?;
    let text = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!("valgrind and case `{name}` failed, {}\n{}", output.status, text.trim());
    }
    let collected = text.lines().find_map(|line| line.split_once("Collected : ")).map(|(_, count)| count.trim());
    let collected: f64 = collected.and_then(|count| count.parse().ok()).context("valgrind wrote no count")?;
    if collected == 0.0 {
        bail!("case `{name}`: valgrind counted nothing; does the program still have its function `measured`?");
    }
    Ok(Count {
        name: name.to_owned(),
        unit: unit.to_owned(),
        instructions: collected / number(repeat)? / number(parts)?,
    })
}

/// Fails where a function takes more instructions than the committed report says, or only one of them has the case.
/// With another compiler they are only told.
pub fn check(archive: &Path) -> Result<()> {
    tools::packages(&PACKAGES)?;
    let committed = paths::json(REPORT)?;
    let now = count(&compile(archive)?)?;
    let changes = changes(&committed, &now)?;
    changes.iter().for_each(|change| println!("   {change}"));
    let setting = |name: &str| committed["settings"][name].as_str().unwrap_or("unknown").to_owned();
    let (compiler, units) = (setting("compiler"), setting("vector units"));
    if compiler != now.compiler || units != now.vector_units {
        println!(
            "   counted with {compiler} and vector units {units} before, with {} and {} now: told, not judged",
            now.compiler, now.vector_units
        );
        return Ok(());
    }
    let worse: Vec<_> = changes.into_iter().filter(|change| !change.contains(BETTER)).collect();
    if !worse.is_empty() {
        bail!("{}. If that is meant: `cargo xtask report --only instructions`, and commit {REPORT}", worse.join("; "));
    }
    Ok(())
}

const BETTER: &str = "less than the report's";

/// What differs by more than the tolerance, and what is not in both, as sentences.
fn changes(committed: &Value, now: &Counts) -> Result<Vec<String>> {
    let table = elements(&committed["tables"]).iter().find(|table| table["name"] == "counts");
    let rows = elements(&table.context("the report has no table of counts")?["rows"]);
    let mut sentences = Vec::new();
    let gone =
        rows.iter().filter_map(|row| row[0].as_str()).filter(|name| now.counts.iter().all(|one| one.name != *name));
    sentences.extend(gone.map(|name| format!("`{name}`: in the report, and no case of bench/instructions.c")));
    for Count { name, instructions, .. } in &now.counts {
        let row = rows.iter().find(|row| row[0] == name.as_str());
        let Some(before) = row.and_then(|row| row[2]["value"].as_f64()) else {
            sentences.push(format!("`{name}`: {instructions:.1} instructions, of which the report knows nothing"));
            continue;
        };
        let change = 100.0 * (instructions / before - 1.0);
        if change.abs() > TOLERANCE {
            let word = if change > 0.0 { "more than the report's" } else { BETTER };
            sentences
                .push(format!("`{name}`: {instructions:.1} instructions, {:.1} % {word} {before:.1}", change.abs()));
        }
    }
    Ok(sentences)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(instructions: f64) -> Counts {
        let count = Count { name: "f".to_owned(), unit: "call".to_owned(), instructions };
        Counts { compiler: String::new(), vector_units: String::new(), counts: vec![count] }
    }

    #[test]
    fn a_regression_is_found() {
        let committed = r#"{"tables": [{"name": "counts", "rows": [["f", "call", {"value": 100.0}]]}]}"#;
        let committed: Value = serde_json::from_str(committed).expect("JSON");
        assert!(changes(&committed, &counts(102.9)).expect("a table").is_empty());
        let more = changes(&committed, &counts(104.0)).expect("a table");
        assert!(more.len() == 1 && !more[0].contains(BETTER), "{more:?}");
        let less = changes(&committed, &counts(90.0)).expect("a table");
        assert!(less.len() == 1 && less[0].contains(BETTER), "{less:?}");
        let mut renamed = counts(100.0);
        renamed.counts[0].name.push('g');
        assert_eq!(changes(&committed, &renamed).expect("a table").len(), 2);
        assert!(changes(&Value::Null, &counts(1.0)).is_err());
    }
}
