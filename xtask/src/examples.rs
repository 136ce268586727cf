//! The programs of `examples_c`, compiled as their reader would, and run; and the README that shows one of them.

use crate::c_tests::{SANITIZERS, has_sanitizers, output};
use crate::outcome::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;

pub const STRICT: [&str; 6] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-O2", "-Iinclude"];

/// Compiles `examples_c/SOURCE` with the library, as C99 or C++17 by its extension.
pub fn compile(source: &str, options: &[&str], archive: &Path, program: &Path) -> Result<()> {
    let (mut compiler, standard) = match source.ends_with(".c") {
        true => (run::compiler("CC", "cc"), "-std=c99"),
        false => (run::compiler("CXX", "c++"), "-std=c++17"),
    };
    let source = Path::new("examples_c").join(source);
    compiler.arg(standard).args(options).arg(source).arg(archive).args(["-lm", "-o"]).arg(program);
    run::check(&mut compiler)
}

/// A program that prints an error of the mean and one of the estimate's, which must be the smaller.
pub fn integrate(archive: &Path, name: &str) -> Result<Outcome> {
    let program = output(name.split('.').next().unwrap_or(name))?;
    compile(name, &STRICT, archive, &program)?;
    let text = run::read(&mut run::command(&program))?;
    print!("{text}");
    let error = |name: &str| -> Result<f64> {
        let line = text.lines().find(|line| line.starts_with(name));
        let value = line.and_then(|line| line.split_whitespace().last()).and_then(|word| word.parse().ok());
        value.with_context(|| format!("the example printed no error of `{name}`"))
    };
    let (mean, ours) = (error("mean")?.abs(), error("noisefloor")?.abs());
    if ours >= mean {
        bail!("the estimate's error {ours} is not below the mean's, {mean}");
    }
    Ok(Outcome::Passed)
}

/// Every block of C in a document that includes the header is a whole piece of code: it compiles as it stands.
pub fn documents() -> Result<Outcome> {
    let mut compiled = 0;
    for file in paths::documents("docs")? {
        let text = fs::read_to_string(&file).with_context(|| format!("cannot read {}", file.display()))?;
        let blocks = text.split("\n```c\n").skip(1).filter_map(|rest| rest.split_once("\n```"));
        for (block, _) in blocks.filter(|(block, _)| block.contains("#include \"noisefloor.h\"")) {
            let source = output("document.c")?;
            fs::write(&source, format!("{block}\n")).with_context(|| format!("cannot write {}", source.display()))?;
            let mut compiler = run::compiler("CC", "cc");
            compiler.arg("-std=c99").args(STRICT).arg("-c").arg(&source).arg("-o").arg(output("document.o")?);
            run::check(&mut compiler).with_context(|| format!("code in {}", file.display()))?;
            compiled += 1;
        }
    }
    println!("   {compiled} pieces of code");
    if compiled == 0 {
        bail!("no document has a block of C that includes the header");
    }
    Ok(Outcome::Passed)
}

/// examples_c/renderers: each program prints pairs of errors of which the second must be the smaller.
pub fn renderers(archive: &Path) -> Result<Outcome> {
    let strict = [&STRICT[..], &["-Wconversion", "-Wshadow"]].concat();
    for (name, pairs) in [
        ("pbrt_sampler", [("independent", "tile"), ("tile", "noisefloor")]),
        ("mitsuba_sampler", [("independent", "tile"), ("mean", "noisefloor")]),
    ] {
        let program = output(name)?;
        compile(&format!("renderers/{name}.cpp"), &strict, archive, &program)?;
        let text = run::read(&mut run::command(&program))?;
        print!("{text}");
        let error = |name: &str| -> Result<f64> {
            let line = text.lines().find_map(|line| line.strip_prefix(name));
            let value = line.and_then(|rest| rest.trim().parse().ok());
            value.with_context(|| format!("the example printed no error of `{name}`"))
        };
        for (larger, smaller) in pairs {
            let (larger_error, smaller_error) = (error(larger)?, error(smaller)?);
            if smaller_error >= larger_error {
                bail!(
                    "{name}: the error of `{smaller}`, {smaller_error}, is not below that of `{larger}`, {larger_error}"
                );
            }
        }
    }
    if has_sanitizers()? {
        println!("   under the sanitizers");
        for name in ["pbrt_sampler", "mitsuba_sampler"] {
            let program = output(&format!("{name}_sanitized"))?;
            compile(&format!("renderers/{name}.cpp"), &[&STRICT[..], &SANITIZERS].concat(), archive, &program)?;
            run::read(&mut run::command(&program))?;
        }
    }
    Ok(Outcome::Passed)
}

/// shards.c: its processes check their estimates themselves.
pub fn shards(archive: &Path) -> Result<Outcome> {
    if !cfg!(unix) {
        return Ok(Outcome::NotRun("the example uses fork and pipe, which POSIX systems have".to_owned()));
    }
    let program = output("shards")?;
    compile("shards.c", &STRICT, archive, &program)?;
    run::check(&mut run::command(&program))?;
    Ok(Outcome::Passed)
}

/// README.md's first block of code is a part of image.cpp, letter by letter, and the two commands that do all the
/// set-up follow.
pub fn readme() -> Result<Outcome> {
    let read = |name: &str| fs::read_to_string(paths::root().join(name)).with_context(|| format!("cannot read {name}"));
    let (text, program) = (read("README.md")?, read("examples_c/image.cpp")?);
    let part = program.split_once("    // README begin\n").and_then(|(_, rest)| rest.split_once("    // README end\n"));
    let (part, _) = part.context("examples_c/image.cpp has no part between `README begin` and `README end`")?;
    let part: String = part.lines().map(|line| format!("{}\n", line.strip_prefix("    ").unwrap_or(line))).collect();
    let block = text.split_once("```cpp\n").and_then(|(before, rest)| (!before.contains("```")).then_some(rest));
    let block = block.and_then(|rest| rest.split_once("```")).context("README.md does not open with a block of C++")?;
    if block.0 != part {
        bail!("README.md's first block of code is not the part of examples_c/image.cpp that it shows");
    }
    for command in ["\ncargo xtask demo ", "\ncargo xtask test "] {
        if !block.1.contains(command) {
            bail!("README.md does not say `{}`", command.trim());
        }
    }
    Ok(Outcome::Passed)
}
