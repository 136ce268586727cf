//! What each service adds to a program that links nothing else: the archive linked for the service's functions alone,
//! unused sections dropped.

use super::platform::{Platform, Service};
use anyhow::{Context, Result, bail};
use object::{BinaryFormat, Object, ObjectSection, SectionKind};
use std::fs;
use std::path::{Path, PathBuf};
use xtask::{c_tests, paths, run};

/// Kinds of sections that a program would load: code, constants; and variables, initialised or not.
pub(crate) const KINDS: [&str; 3] = ["text", "rodata", "variables"];

/// Bytes of each of [`KINDS`] of a service, linked alone.
pub(crate) fn measure(platform: &Platform, archive: &Path, service: &Service) -> Result<[u64; 3]> {
    // As the ABI has them: GNU nm cannot read WebAssembly.
    let abi = paths::read("capi/abi.txt")?;
    let functions = abi.lines().filter_map(|line| line.strip_prefix("function ")?.split('(').next());
    let all = functions.filter_map(|line| line.rsplit([' ', '*']).next());
    let begins = |symbol: &str, with: &[String]| with.iter().any(|prefix| symbol.starts_with(prefix));
    let wanted = |symbol: &&str| begins(symbol, &service.functions) && !begins(symbol, &service.except);
    let functions: Vec<&str> = all.filter(wanted).collect();
    if functions.is_empty() {
        bail!("no function of \"{}\" in {}", service.name, archive.display());
    }
    let output = c_tests::output("sizes")?;
    link(platform, archive, &functions, &output)?;
    sections(&fs::read(&output).with_context(|| format!("cannot read {}", output.display()))?)
}

/// Links the archive for these functions alone.
pub(crate) fn link(platform: &Platform, archive: &Path, functions: &[impl AsRef<str>], output: &Path) -> Result<()> {
    let mut link = run::command(linker()?);
    let option = if platform.is_wasm() {
        link.args(["-flavor", "wasm", "--no-entry", "--gc-sections", "--strip-all"]);
        "--export"
    } else {
        link.args(["-flavor", "gnu", "--gc-sections", "--unresolved-symbols=ignore-all", "--entry=0"]);
        "--undefined"
    };
    for function in functions {
        link.arg(format!("{option}={}", function.as_ref()));
    }
    run::check(link.arg(archive).arg("-o").arg(output))
}

/// Bytes of a program's memory of code: its own, the library's and its constants, which its linker script puts into
/// .text.
pub(crate) fn program(path: &Path) -> Result<u64> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let file = object::File::parse(&*bytes).with_context(|| format!("{} is no program", path.display()))?;
    let text = file.section_by_name(".text").with_context(|| format!("{} has no .text", path.display()))?;
    Ok(text.size())
}

/// Sums of the sections that a program would load.
fn sections(bytes: &[u8]) -> Result<[u64; 3]> {
    let file = object::File::parse(bytes).context("the linker wrote no program")?;
    let (mut sizes, is_module) = ([0; 3], file.format() == BinaryFormat::Wasm);
    for section in file.sections() {
        let kind = match (section.kind(), section.name()) {
            (SectionKind::Text, _) => 0,
            // A module's constants and variables are one; what else is data there are numbers of the module's own.
            (SectionKind::Data, Ok("<data>")) if is_module => 1,
            (SectionKind::ReadOnlyData, Ok(".eh_frame")) | (_, Ok(".relro_padding")) => continue,
            _ if is_module => continue,
            (_, Ok(".data.rel.ro")) => 1,
            (SectionKind::ReadOnlyData | SectionKind::ReadOnlyString | SectionKind::ReadOnlyDataWithRel, _) => 1,
            (SectionKind::Data | SectionKind::UninitializedData, _) => 2,
            _ => continue,
        };
        sizes[kind] += section.size();
    }
    Ok(sizes)
}

/// LLVM's linker, which knows every target and comes with Rust.
fn linker() -> Result<PathBuf> {
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let root = run::read(run::command(compiler).args(["--print", "target-libdir"]))?;
    let linker = Path::new(root.trim()).with_file_name("bin/rust-lld");
    if !linker.exists() {
        bail!("no {}: rustup's Rust brings it", linker.display());
    }
    Ok(linker)
}

#[cfg(test)]
mod tests {
    use super::sections;

    #[test]
    fn sections_of_a_module_are_counted() {
        let global = [6, 6, 1, 0x7f, 1, 0x41, 0, 11];
        let module = [&b"\0asm\x01\0\0\0"[..], &[1, 1, 0], &global, &[10, 1, 0, 11, 1, 0]].concat();
        assert_eq!(sections(&module).unwrap(), [1, 1, 0]);
        assert!(sections(&module[..module.len() - 1]).is_err());
        assert!(sections(b"no program").is_err());
    }
}
