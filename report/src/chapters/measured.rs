//! What measurement programs write: kept in target/report/measured, so that a text can be written anew without
//! measuring again.

use super::index::Facts;
use anyhow::{Context, Result};
use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use xtask::paths;

fn folder(chapter: &str, sizes: &str) -> PathBuf {
    paths::target().join("report/measured").join(format!("{chapter}-{sizes}"))
}

/// How what is kept came about: beside it.
const RUN: &str = "run.json";

/// Records the run that has measured all of a chapter, if the chapter keeps anything.
pub(super) fn keep_run(facts: &Facts) -> Result<()> {
    keep_run_in(&folder(&facts.name, &facts.sizes), facts)
}

/// The facts of the run that measured what this one took from it. Without a record of it they are not known.
pub(super) fn earlier_run(facts: Facts) -> Result<Facts> {
    earlier_run_in(&folder(&facts.name, &facts.sizes), facts)
}

fn keep_run_in(folder: &Path, facts: &Facts) -> Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    let path = folder.join(RUN);
    fs::write(&path, serde_json::to_string_pretty(facts)?).with_context(|| format!("cannot write {}", path.display()))
}

fn earlier_run_in(folder: &Path, facts: Facts) -> Result<Facts> {
    let path = folder.join(RUN);
    let kept = Some(facts.date.clone());
    if !path.exists() {
        return Ok(Facts {
            seconds: None,
            processor_seconds: None,
            other_work: None,
            date: "unknown".to_owned(),
            kept,
            ..facts
        });
    }
    let earlier: Facts =
        serde_json::from_str(&read(&path)?).with_context(|| format!("{} is damaged; remove it", path.display()))?;
    // What the chapter is called is today's.
    Ok(Facts { name: facts.name, description: facts.description, kept, ..earlier })
}

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
        let folder = folder(chapter, sizes);
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
                "Taken from an earlier run of the same programs, whose date, times and other work the index has: {}.",
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

#[cfg(test)]
mod tests {
    use super::super::machine::Machine;
    use super::*;

    fn facts(date: &str, seconds: f64) -> Facts {
        let machine = Machine {
            processor: "one".to_owned(),
            cores: 2,
            clock: "steady".to_owned(),
            kernel: "linux".to_owned(),
            compilers: ["r", "c", "x"].map(str::to_owned),
        };
        let word = |word: &str| word.to_owned();
        let (name, description, sizes) = (word("tables"), word("Words"), word("full"));
        let (seconds, processor_seconds, other_work, date) = (Some(seconds), Some(seconds), Some(0.25), word(date));
        Facts { name, description, sizes, seconds, processor_seconds, other_work, date, machine, kept: None }
    }

    #[test]
    fn what_is_kept_has_the_time_of_the_run_that_measured() {
        let folder = tempfile::tempdir().expect("a folder");
        let unknown = earlier_run_in(folder.path(), facts("2000-02-01", 1.0)).expect("no record is no failure");
        assert!(
            unknown.seconds.is_none() && unknown.date == "unknown" && unknown.kept.as_deref() == Some("2000-02-01")
        );
        keep_run_in(folder.path(), &facts("2000-01-01", 600.0)).expect("writable");
        let known = earlier_run_in(folder.path(), facts("2000-02-01", 1.0)).expect("a record");
        assert_eq!(
            (known.seconds, known.date.as_str(), known.kept.as_deref()),
            (Some(600.0), "2000-01-01", Some("2000-02-01"))
        );
        // A chapter that keeps nothing has no folder, and gets none.
        let none = folder.path().join("none");
        keep_run_in(&none, &facts("2000-01-01", 1.0)).expect("nothing to do");
        assert!(!none.exists());
    }
}
