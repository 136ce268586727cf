//! The C tests of `tests/c`: one program for each theme, compiled strictly, linked with the library, run.

use crate::outcome::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// What the sources are compiled as.
#[derive(Clone, Copy, PartialEq)]
pub enum Language {
    C99,
    /// The same C files as C++, where `check.h` includes noisefloor.hpp.
    Cpp17,
}

pub const STRICT: [&str; 5] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-O1"];
pub const SANITIZERS: [&str; 3] = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=undefined"];

/// Compiles and runs every `tests/c/*.c`, with more compiler options.
pub fn run(language: Language, options: &[&str], archive: &Path) -> Result<Outcome> {
    let sources = sources()?;
    check_coverage(&sources)?;
    each(&sources, |source| {
        let mut compiler = match language {
            Language::C99 => run::compiler("CC", "cc"),
            Language::Cpp17 => run::compiler("CXX", "c++"),
        };
        compiler.arg(if language == Language::C99 { "-std=c99" } else { "-std=c++17" }).args(STRICT).args(options);
        compiler.args(["-Iinclude", "-Itests/c"]);
        if language == Language::Cpp17 {
            compiler.args(["-x", "c++"]).arg(source).args(["-x", "none"]);
        } else {
            compiler.arg(source);
        }
        let program = output("c_test")?;
        run::check(compiler.arg(archive).args(["-lm", "-o"]).arg(&program))?;
        run::check(&mut run::command(program))
    })?;
    Ok(Outcome::Passed)
}

/// The test programs, in order.
pub fn sources() -> Result<Vec<PathBuf>> {
    let mut sources = Vec::new();
    for entry in fs::read_dir(paths::root().join("tests/c")).context("cannot read tests/c")? {
        let path = entry.context("cannot read tests/c")?.path();
        if path.extension().is_some_and(|extension| extension == "c") {
            sources.push(path);
        }
    }
    if sources.is_empty() {
        bail!("tests/c holds no test");
    }
    sources.sort();
    Ok(sources)
}

/// Fails unless every function of the header is called somewhere.
fn check_coverage(sources: &[PathBuf]) -> Result<()> {
    let read = |path: &Path| fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()));
    let header = read(&paths::header())?;
    let code = header.lines().filter(|line| !line.trim_start().starts_with("//"));
    let calls = |text: &str, name: &str| text.contains(&format!("{name}("));
    let tests = sources.iter().map(|source| read(source)).collect::<Result<Vec<_>>>()?;
    let mut missing = Vec::new();
    for name in
        code.filter_map(|line| line.split_once('(')).filter_map(|(before, _)| before.split([' ', '*']).next_back())
    {
        if name.starts_with("nf_") && !tests.iter().any(|text| calls(text, name)) {
            missing.push(name);
        }
    }
    if missing.is_empty() { Ok(()) } else { bail!("tests/c never calls {}", missing.join(", ")) }
}

/// As [`run()`], under the sanitizers, if the compiler has them.
pub fn sanitized(language: Language, archive: &Path) -> Result<Outcome> {
    if !has_sanitizers()? {
        return Ok(Outcome::NotRun(
            "the C compiler has no -fsanitize=address,undefined; gcc (Debian: libgcc-12-dev) and clang have".to_owned(),
        ));
    }
    run(language, &SANITIZERS, archive)
}

/// Whether the C compiler has [`SANITIZERS`].
pub fn has_sanitizers() -> Result<bool> {
    let source = output("sanitizers.c")?;
    fs::write(&source, "int main(void) { return 0; }\n")
        .with_context(|| format!("cannot write {}", source.display()))?;
    let program = output("sanitizers")?;
    let mut compiler = run::compiler("CC", "cc");
    compiler.args(SANITIZERS).arg(source).arg("-o").arg(&program).stdout(Stdio::null()).stderr(Stdio::null());
    Ok(compiler.status().is_ok_and(|status| status.success())
        && run::command(program).status().is_ok_and(|status| status.success()))
}

/// The test of noisefloor.hpp, where errors are thrown, where the caller turned that off, and where the compiler did.
pub fn wrapper(archive: &Path) -> Result<Outcome> {
    for options in [&[][..], &["-DNOISEFLOOR_NO_EXCEPTIONS"], &["-fno-exceptions", "-fno-rtti"]] {
        let program = output("wrapper_test")?;
        let mut compiler = run::compiler("CXX", "c++");
        compiler
            .arg("-std=c++17")
            .args(STRICT)
            .args(["-Wconversion", "-Wshadow", "-Iinclude", "-Itests/c"])
            .args(options);
        compiler.arg("tests/c/wrapper.cpp").arg(archive).arg("-o").arg(&program);
        run::check(&mut compiler)?;
        run::check(&mut run::command(program))?;
    }
    Ok(Outcome::Passed)
}

/// Where a program of a test goes.
pub fn output(name: &str) -> Result<PathBuf> {
    let folder = paths::output().join("test");
    fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    Ok(folder.join(name))
}

/// All of them, even if some fail; the error names those.
pub fn each(sources: &[PathBuf], mut action: impl FnMut(&Path) -> Result<()>) -> Result<()> {
    let mut failures = Vec::new();
    for source in sources {
        if let Err(error) = action(source) {
            println!("{error:#}");
            failures.push(source.file_name().unwrap_or(source.as_os_str()).to_string_lossy());
        }
    }
    if failures.is_empty() { Ok(()) } else { bail!("{} of {}: {}", failures.len(), sources.len(), failures.join(", ")) }
}
