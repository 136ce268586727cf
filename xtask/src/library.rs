//! The C library: one relocatable object, so that nothing but `nf_*` is visible and nothing is undefined.

use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};

/// What a C library always provides, and compilers call without being asked.
const ALLOWED_UNDEFINED: [&str; 4] = ["memcpy", "memmove", "memset", "memcmp"];

/// Builds the archive and returns its path.
///
/// Cargo's own archive also exports compiler-builtins (`fmodf`, `cbrt`, ...), which then shadow the C library's. So its
/// objects are linked into one, unused sections dropped, and every symbol but the API made local.
pub(crate) fn build() -> Result<PathBuf> {
    run::check(run::cargo().args(["build", "--quiet", "--release", "--package", "noisefloor-capi"]))?;
    let raw = paths::target().join("release/libnoisefloor.a");
    let output = paths::output();
    fs::create_dir_all(&output).with_context(|| format!("cannot create {}", output.display()))?;
    let object = output.join("noisefloor.o");
    let archive = output.join("libnoisefloor.a");
    let mut link = run::command("ld");
    link.args(["-r", "--gc-sections", "-o"]).arg(&object);
    for symbol in api_symbols(&raw)? {
        link.args(["-u", &symbol]);
    }
    run::check(link.arg(&raw))?;
    run::check(
        run::command("objcopy")
            .args(["--wildcard", "--keep-global-symbol=nf_*", "--strip-debug", "-R", ".eh_frame", "-R", ".llvmbc"])
            .arg(&object),
    )?;
    // `ar` adds to an archive that exists, and another program may be linking the one in place.
    let new = output.join("libnoisefloor.a.new");
    match fs::remove_file(&new) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(error).with_context(|| format!("cannot replace {}", new.display()));
        }
        _ => {}
    }
    run::check(run::command("ar").arg("rcs").arg(&new).arg(&object))?;
    // What links the library is not built anew where nothing has changed.
    let modified = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
    let is_newer = modified(&archive).is_some_and(|built| modified(&raw).is_some_and(|raw| raw <= built));
    if is_newer && fs::read(&archive).ok() == fs::read(&new).ok() {
        fs::remove_file(&new).with_context(|| format!("cannot remove {}", new.display()))?;
        return Ok(archive);
    }
    fs::rename(&new, &archive).with_context(|| format!("cannot replace {}", archive.display()))?;
    Ok(archive)
}

/// Fails if the archive needs anything beyond the four memory functions, exports more than `nf_*`, or can panic.
pub(crate) fn check(archive: &Path) -> Result<()> {
    let symbols = names(archive, &[])?;
    let panics: Vec<_> = symbols.iter().filter(|(_, name)| name.contains("panic")).collect();
    if !panics.is_empty() {
        bail!("the library can panic: {panics:?}");
    }
    for (kind, name) in &symbols {
        if kind == "U" && !ALLOWED_UNDEFINED.contains(&name.as_str()) {
            bail!("the library needs `{name}` from elsewhere");
        }
        if kind.chars().all(char::is_uppercase) && kind != "U" && !name.starts_with("nf_") {
            bail!("the library exports `{name}`");
        }
    }
    if !symbols.iter().any(|(kind, name)| kind == "T" && name == "nf_abi_version") {
        bail!("no nf_abi_version in {}: the symbol check looked at the wrong file", archive.display());
    }
    Ok(())
}

fn api_symbols(archive: &Path) -> Result<Vec<String>> {
    let symbols = names(archive, &["--defined-only", "--extern-only"])?;
    Ok(symbols.into_iter().map(|(_, name)| name).filter(|name| name.starts_with("nf_")).collect())
}

/// (kind, name) of every symbol, with nm's one-letter kinds.
fn names(archive: &Path, options: &[&str]) -> Result<Vec<(String, String)>> {
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
