//! The C library: one relocatable object, so that nothing but `nf_*` is visible and nothing is undefined.

use crate::{paths, run, tools};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};

/// What a C library always provides, and compilers call without being asked; on Windows to grow the stack.
const ALLOWED_UNDEFINED: [&str; 5] = ["memcpy", "memmove", "memset", "memcmp", "___chkstk_ms"];

/// Builds the archive and returns its path.
///
/// capi/cmake/object.cmake, which does the same where CMake builds it, says why cargo's own archive is not the one.
pub fn build() -> Result<PathBuf> {
    tools::packages(&tools::C)?;
    let host = host()?;
    // As capi/cmake/target.cmake has it, which then finds it done.
    let kind = ["rustc", "--release", "--lib", "--package", "noisefloor-capi", "--crate-type", "staticlib"];
    run::compile(run::cargo().args(kind).args(["--target", &host]))?;
    one_object(&paths::target().join(host).join("release/libnoisefloor.a"), &paths::output(), "ar")
}

/// This machine, as Rust calls it.
fn host() -> Result<String> {
    let version = run::read(run::cargo().arg("-vV"))?;
    version.lines().find_map(|line| line.strip_prefix("host: ")).map(str::to_owned).context("cargo names no host")
}

/// Of capi/CMakeLists.txt, so that it has what cargo made already.
pub fn settings() -> [String; 2] {
    let cargo = run::cargo().get_program().to_string_lossy().into_owned();
    [format!("NOISEFLOOR_CARGO={cargo}"), format!("NOISEFLOOR_CARGO_TARGET_DIR={}", paths::target().display())]
}

/// Makes cargo's archive `raw` into one of a single object, in the folder `output`, by `ar` or what does its work.
pub fn one_object(raw: &Path, output: &Path, ar: &str) -> Result<PathBuf> {
    // Complete or not at all, also while another program links the one in place or makes it too.
    let scratch = output.join(format!("scratch.{}", std::process::id()));
    fs::create_dir_all(&scratch).with_context(|| format!("cannot create {}", scratch.display()))?;
    let members = run::read(run::command(ar).arg("t").arg(raw))?;
    let own: Vec<&str> = members.lines().filter(|name| name.starts_with("noisefloor-")).collect();
    ensure!(own.len() == 1, "{} has {} objects of noisefloor instead of one", raw.display(), own.len());
    run::check(run::command(ar).current_dir(&scratch).arg("x").arg(raw).args(&own))?;
    fs::rename(scratch.join(own[0]), scratch.join("noisefloor.o"))?;
    run::check(run::command(ar).current_dir(&scratch).args(["rcsD", "libnoisefloor.a", "noisefloor.o"]))?;
    let new = scratch.join("libnoisefloor.a");
    let archive = output.join("libnoisefloor.a");
    // What links the library is not built anew where nothing has changed.
    let modified = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
    let is_newer = modified(&archive).is_some_and(|built| modified(raw).is_some_and(|raw| raw <= built));
    if !is_newer || fs::read(&archive).ok() != fs::read(&new).ok() {
        fs::rename(&new, &archive).with_context(|| format!("cannot replace {}", archive.display()))?;
    }
    fs::remove_dir_all(&scratch).with_context(|| format!("cannot remove {}", scratch.display()))?;
    Ok(archive)
}

/// Fails if the archive needs anything beyond what compilers call, exports more than `nf_*`, or can panic. It may
/// also need what cargo's own archive `builtins` has: arithmetic that a processor has no instructions for.
pub fn check(archive: &Path, builtins: Option<&Path>) -> Result<()> {
    let symbols = names(archive, &[])?;
    let panics: Vec<_> = symbols.iter().filter(|(_, name)| name.contains("panic")).collect();
    ensure!(panics.is_empty(), "the library can panic: {panics:?}");
    let there = builtins.map_or_else(|| Ok(Vec::new()), |archive| names(archive, &["--defined-only"]))?;
    for (kind, name) in &symbols {
        let (is_needed, is_seen) = (["U", "w", "v"].contains(&&**kind), kind.chars().all(char::is_uppercase));
        let may_be_needed = ALLOWED_UNDEFINED.contains(&name.as_str()) || there.iter().any(|(_, there)| there == name);
        ensure!(!is_needed || may_be_needed, "the library needs `{name}` from elsewhere");
        ensure!(is_needed || !is_seen || name.starts_with("nf_"), "the library exports `{name}`");
    }
    let is_there = symbols.iter().any(|(kind, name)| kind == "T" && name == "nf_abi_version");
    ensure!(is_there, "no nf_abi_version in {}: the symbol check looked at the wrong file", archive.display());
    Ok(())
}

/// (kind, name) of every symbol, with nm's one-letter kinds.
pub fn names(archive: &Path, options: &[&str]) -> Result<Vec<(String, String)>> {
    // Debian's nm loads LLVM's plugin, which then says "no symbols".
    let text = run::read(run::command("nm").arg("--plugin=/none").args(options).arg(archive))?;
    let row = |line: &str| {
        let mut words = line.split_whitespace().rev();
        let name = words.next()?.to_owned();
        let kind = words.next()?.to_owned();
        (kind.len() == 1).then_some((kind, name))
    };
    Ok(text.lines().filter_map(row).collect())
}
