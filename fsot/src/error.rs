//! What can go wrong, said so that a person knows what to do.

use std::fmt::Display;
use std::io;
use std::path::PathBuf;

/// Why something was not done. No output is half-written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An argument, a file's content or a combination of both that cannot be used: the sentence says which value and
    /// why.
    #[error("{0}")]
    Input(String),
    /// A file could not be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Ctrl-C or another signal stopped the run: the sentence says how to continue it.
    #[error("{0}")]
    Stopped(String),
}

/// The result of everything here that can fail.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An [`Error::Input`].
    pub fn input(message: impl Into<String>) -> Error {
        Error::Input(message.into())
    }

    /// For `map_err`: what the system said, with the file it said it of.
    pub fn io(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Error {
        let path = path.into();
        move |source| Error::Io { path, source }
    }

    /// The same of a file that was to be written.
    pub fn write(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Error {
        let path = path.into();
        move |source| Error::Write { path, source }
    }
}

/// An [`Error::Input`] unless `good`.
pub(crate) fn check(good: bool, what: &str, value: impl Display, allowed: &str) -> Result<()> {
    if good { Ok(()) } else { Err(Error::input(format!("{what} is {value}; use {allowed}"))) }
}
