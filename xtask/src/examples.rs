//! The programs of `examples_c`, and the documents that show code.

use crate::c_tests::output;
use crate::outcome::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;

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

/// Every block of C in a document that includes the header is a whole piece of code: it compiles as it stands.
pub fn documents() -> Result<Outcome> {
    let mut compiled = 0;
    let source = output("document.c")?;
    for file in paths::of_kind("docs", "md")? {
        let text = paths::read(&file)?;
        let blocks = text.split("\n```c\n").skip(1).filter_map(|rest| rest.split_once("\n```"));
        for (block, _) in blocks.filter(|(block, _)| block.contains("#include \"noisefloor.h\"")) {
            fs::write(&source, format!("{block}\n")).with_context(|| format!("cannot write {}", source.display()))?;
            let mut compiler = run::compiler("CC", "cc");
            compiler.args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O2", "-Iinclude", "-c", "-o"]);
            run::check(compiler.arg(output("document.o")?).arg(&source))
                .with_context(|| format!("code in {}", file.display()))?;
            compiled += 1;
        }
    }
    println!("   {compiled} pieces of code");
    if compiled == 0 {
        bail!("no document has a block of C that includes the header");
    }
    Ok(Outcome::Passed)
}

/// README.md's first block of code is a part of image.cpp, letter by letter, and the two commands that do all the
/// set-up follow.
pub fn readme() -> Result<Outcome> {
    let (text, program) = (paths::read("README.md")?, paths::read("examples_c/image.cpp")?);
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
