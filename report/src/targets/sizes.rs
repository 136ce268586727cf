//! What each service adds to a program that links nothing else: the archive linked for the service's functions alone,
//! unused sections dropped.

use super::platform::Platform;
use super::wasm;
use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, SectionKind};
use std::fs;
use std::path::{Path, PathBuf};
use xtask::{c_tests, paths, run};

/// A service and how the names of its functions begin; `except` takes some away.
struct Service {
    name: &'static str,
    functions: &'static [&'static str],
    except: &'static [&'static str],
}

const SERVICES: [Service; 12] = [
    Service {
        name: "control variates: one pixel",
        functions: &["nf_cv_"],
        except: &["nf_cv_image", "nf_cv_accumulator"],
    },
    Service { name: "control variates: shared fits", functions: &["nf_cv_image"], except: &[] },
    Service { name: "control variates: streaming", functions: &["nf_cv_accumulator"], except: &[] },
    Service { name: "recommendations", functions: &["nf_recommend"], except: &[] },
    Service { name: "MIS heuristics", functions: &["nf_mis_"], except: &[] },
    Service { name: "optimal MIS", functions: &["nf_omis_"], except: &["nf_omis_weights"] },
    Service {
        name: "tiles, without built-in ones",
        functions: &["nf_tile_"],
        except: &["nf_tile_64_", "nf_tile_128_"],
    },
    Service { name: "default sampler, with its table", functions: &["nf_sampler_"], except: &[] },
    Service { name: "random numbers", functions: &["nf_rng_"], except: &[] },
    Service { name: "minibatches: tables", functions: &["nf_table_", "nf_shard", "nf_shuffle"], except: &[] },
    Service { name: "minibatches: importances", functions: &["nf_importance_"], except: &[] },
    Service { name: "minibatches: gradients", functions: &["nf_gradient_", "nf_omis_weights"], except: &[] },
];

/// Bytes.
pub(crate) struct Size {
    pub(crate) service: &'static str,
    pub(crate) text: u64,
    pub(crate) rodata: u64,
    /// Variables, initialised or not.
    pub(crate) data: u64,
}

/// Of each service, linked alone.
pub(crate) fn measure(platform: &Platform, archive: &Path) -> Result<Vec<Size>> {
    // As the ABI has them: GNU nm cannot read WebAssembly.
    let abi = paths::read("capi/abi.txt")?;
    let functions = abi.lines().filter_map(|line| line.strip_prefix("function ")?.split('(').next());
    let all: Vec<&str> = functions.filter_map(|line| line.rsplit([' ', '*']).next()).collect();
    let begins = |symbol: &str, with: &[&str]| with.iter().any(|prefix| symbol.starts_with(prefix));
    let mut sizes = Vec::new();
    for service in &SERVICES {
        let wanted = |symbol: &&str| begins(symbol, service.functions) && !begins(symbol, service.except);
        let functions: Vec<_> = all.iter().copied().filter(wanted).collect();
        if functions.is_empty() {
            bail!("no function of \"{}\" in {}", service.name, archive.display());
        }
        let output = c_tests::output("sizes")?;
        link(platform, archive, &functions, &output)?;
        let bytes = fs::read(&output).with_context(|| format!("cannot read {}", output.display()))?;
        sizes.push(if platform.is_wasm() {
            wasm::size(service.name, &bytes)?
        } else {
            sections(service.name, &bytes)?
        });
    }
    Ok(sizes)
}

/// Links the archive for these functions alone.
pub(crate) fn link(platform: &Platform, archive: &Path, functions: &[&str], output: &Path) -> Result<()> {
    let mut link = run::command(linker()?);
    let option = if platform.is_wasm() {
        link.args(["-flavor", "wasm", "--no-entry", "--gc-sections", "--strip-all"]);
        "--export"
    } else {
        link.args(["-flavor", "gnu", "--gc-sections", "--unresolved-symbols=ignore-all", "--entry=0"]);
        "--undefined"
    };
    for function in functions {
        link.arg(format!("{option}={function}"));
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
fn sections(service: &'static str, bytes: &[u8]) -> Result<Size> {
    let file = object::File::parse(bytes).context("the linker wrote no program")?;
    let mut size = Size { service, text: 0, rodata: 0, data: 0 };
    for section in file.sections() {
        match section.kind() {
            SectionKind::Text => size.text += section.size(),
            SectionKind::ReadOnlyData | SectionKind::ReadOnlyString | SectionKind::ReadOnlyDataWithRel
                if section.name() != Ok(".eh_frame") =>
            {
                size.rodata += section.size();
            }
            SectionKind::Data | SectionKind::UninitializedData => size.data += section.size(),
            _ => {}
        }
    }
    Ok(size)
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
