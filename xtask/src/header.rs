//! The generated C header.

use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;

/// Rewrites `include/noisefloor.h` from the `capi` crate.
pub(crate) fn write() -> Result<()> {
    let path = paths::header();
    fs::write(&path, generate()?).with_context(|| format!("cannot write {}", path.display()))
}

/// Fails if the committed header is not what the sources generate.
pub(crate) fn check_committed() -> Result<()> {
    let path = paths::header();
    let committed = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    if committed != generate()? {
        bail!("{} is not what capi/ generates: run `cargo xtask header` and commit the result", path.display());
    }
    Ok(())
}

/// Compiles each header alone, with every warning an error, in every language standard it promises.
pub(crate) fn check_compiles() -> Result<()> {
    let output = paths::output();
    fs::create_dir_all(&output).with_context(|| format!("cannot create {}", output.display()))?;
    for (header, variable, default, standard) in [
        ("noisefloor.h", "CC", "cc", "c99"),
        ("noisefloor.h", "CC", "cc", "c11"),
        ("noisefloor.h", "CXX", "c++", "c++11"),
        ("noisefloor.h", "CXX", "c++", "c++17"),
        ("noisefloor.hpp", "CXX", "c++", "c++17"),
    ] {
        let source = output.join(if variable == "CC" { "header_alone.c" } else { "header_alone.cpp" });
        // Twice: the include guard is part of what is checked.
        let text = format!("#include \"{header}\"\n#include \"{header}\"\nint main(void) {{ return 0; }}\n");
        fs::write(&source, text).with_context(|| format!("cannot write {}", source.display()))?;
        compile_alone(variable, default, standard, &source)?;
    }
    Ok(())
}

fn compile_alone(variable: &str, default: &str, standard: &str, source: &Path) -> Result<()> {
    run::check(
        run::compiler(variable, default)
            .arg(format!("-std={standard}"))
            .args(["-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only", "-Iinclude"])
            .arg(source),
    )
}

fn generate() -> Result<String> {
    let crate_dir = paths::root().join("capi");
    let config = cbindgen::Config::from_file(crate_dir.join("cbindgen.toml"))
        .map_err(|error| anyhow::anyhow!("capi/cbindgen.toml: {error}"))?;
    let bindings = cbindgen::Builder::new()
        .with_crate(&crate_dir)
        .with_config(config)
        .generate()
        .context("cbindgen could not read capi/")?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    String::from_utf8(text).context("cbindgen wrote a header that is not UTF-8")
}
