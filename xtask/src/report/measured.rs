//! What measurement programs write: kept in target/report/measured, so that a text can be written anew without measuring again.

use crate::paths;
use anyhow::{Context, Result};
use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of one chapter's measurements.
pub(crate) struct Measured {
    folder: PathBuf,
    reuse: bool,
    /// What was taken from an earlier run.
    reused: RefCell<Vec<String>>,
}

impl Measured {
    /// `reuse`: where an earlier run has left a file, it is taken as it is.
    pub(crate) fn new(chapter: &str, sizes: &str, reuse: bool) -> Result<Self> {
        let folder = paths::target().join("report/measured").join(format!("{chapter}-{sizes}"));
        fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
        Ok(Self { folder, reuse, reused: RefCell::default() })
    }

    /// The file of this name, or what `measure` returns, which is kept under the name.
    pub(crate) fn text(&self, name: &str, measure: impl FnOnce() -> Result<String>) -> Result<String> {
        let path = self.folder.join(name);
        if self.reuse && path.exists() {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            self.reused.borrow_mut().push(stem);
            return read(&path);
        }
        self.text_anew(name, measure()?)
    }

    /// Keeps a text under this name, and returns it.
    pub(crate) fn text_anew(&self, name: &str, text: String) -> Result<String> {
        let path = self.folder.join(name);
        let part = path.with_extension("part");
        let keep = || fs::write(&part, &text).and_then(|()| fs::rename(&part, &path));
        keep().with_context(|| format!("cannot write {}", path.display()))?;
        Ok(text)
    }

    /// A text that was kept.
    pub(crate) fn kept(&self, name: &str) -> Result<String> {
        read(&self.folder.join(name))
    }

    /// For the text: the times of this run are not those of what was taken from an earlier one.
    pub(crate) fn note(&self) -> Option<String> {
        let reused = self.reused.borrow();
        (!reused.is_empty()).then(|| {
            format!(
                "Taken from an earlier run of the same programs, which this run's time does not hold: {}.",
                reused.join(", ")
            )
        })
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }
}

pub(crate) fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}
