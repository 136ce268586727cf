//! Standard error, and readers that have gone. `eprintln!` would panic for them, in the middle of a run.

use fsot::Error;
use fsot::error::Result;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// The exit code after a reader of the output has gone: what a shell says of a program that SIGPIPE ends.
pub(crate) const GONE: u8 = 141;

/// How errors name standard output.
pub(crate) const STANDARD_OUTPUT: &str = "standard output";

/// Prints a line to standard error.
///
/// # Errors
/// Its reader has gone. That a disk is full is none: what is made matters more than what is said of it.
pub(crate) fn say(line: &str) -> Result<()> {
    // As one piece, so that the lines of two programs do not mix.
    match std::io::stderr().lock().write_all(format!("{line}\n").as_bytes()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(Error::write("standard error")(error)),
        _ => Ok(()),
    }
}

/// The output whose reader has gone, if that is the error.
fn gone(error: &Error) -> Option<&Path> {
    match error {
        Error::Write { path, source } if source.kind() == ErrorKind::BrokenPipe => Some(path),
        _ => None,
    }
}

/// Whether an error is that the reader of an output has gone.
pub(crate) fn is_gone(error: &Error) -> bool {
    gone(error).is_some()
}

/// Whether it is that a program such as `head` has read all that it wants of standard output: nothing is said of that.
pub(crate) fn is_cut(error: &Error) -> bool {
    gone(error).is_some_and(|path| [STANDARD_OUTPUT, "-", "/dev/stdout"].iter().any(|name| path == Path::new(name)))
}
