//! What the benchmarks share: the C functions, how its estimators are configured, their command line, and
//! where results go.

/// Declares functions of the archive. Where there is none they stand for nothing, and `c_abi::LINKED` says so.
macro_rules! c_functions {
    ($(fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)?;)*) => {
        #[cfg(archive)]
        unsafe extern "C" {
            $(fn $name($($argument: $kind),*) $(-> $result)?;)*
        }
        $(
            #[cfg(not(archive))]
            #[allow(clippy::too_many_arguments, reason = "as in C")]
            unsafe fn $name($(_: $kind),*) $(-> $result)? {
                panic!("libnoisefloor.a is missing: run `cargo xtask library`")
            }
        )*
    };
}

pub mod c_abi;
pub mod c_sampler;
pub mod c_table;
pub mod c_tile;
pub mod method;

use anyhow::{Context, Result};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
pub use method::{Method, Prepared};
use std::fs;
use std::path::{Path, PathBuf};

/// The command line of the programs that write tables.
#[derive(Parser)]
pub struct Options {
    /// Few repetitions: whether everything works, not the figures
    #[arg(long)]
    quick: bool,
    /// Four or eight times the repetitions
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Where the tables go, instead of to a folder in target/
    #[arg(long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// What cargo adds
    #[arg(long, hide = true)]
    bench: bool,
}

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Whether everything works, not the figures.
    Quick,
    Default,
    Full,
}

impl Options {
    pub fn extent(&self) -> Extent {
        match (self.quick, self.full) {
            (true, _) => Extent::Quick,
            (_, true) => Extent::Full,
            _ => Extent::Default,
        }
    }

    /// Writes files, each whole or not at all, and says where; `folder` is their place in cargo's target folder.
    pub fn write(&self, folder: &str, files: &[(&str, String)]) -> Result<()> {
        let folder = self.output.clone().unwrap_or_else(|| output(folder));
        files.iter().try_for_each(|(name, text)| write(&folder.join(name), text))?;
        println!("{} tables: {}", files.len(), folder.display());
        Ok(())
    }
}

impl Extent {
    /// What is `count` in a default run: a fortieth, or four times as much.
    pub fn of(self, count: usize) -> usize {
        self.choose((count / 40).max(1), count, 4 * count)
    }

    /// One of these.
    pub fn choose<T>(self, quick: T, default: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Default => default,
            Self::Full => full,
        }
    }
}

/// A bar of so many steps.
pub fn bar(steps: usize) -> Result<ProgressBar> {
    let style = ProgressStyle::with_template("{elapsed_precise} {wide_bar} {pos}/{len} {msg}")?;
    Ok(ProgressBar::new(steps as u64).with_style(style))
}

/// The folder of this name in cargo's target folder.
pub fn output(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    target.join(name)
}

/// Writes a file, whole or not at all, and before it the folder that it goes into if there is none.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let mut new = path.as_os_str().to_owned();
    new.push(".new");
    let written = fs::write(&new, content).and_then(|()| fs::rename(&new, path));
    written.with_context(|| format!("cannot write {}", path.display()))
}
