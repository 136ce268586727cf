//! Interrupts: programs that are run get them too, and end; this one then removes its temporary files.

use anyhow::{Context, Result, bail};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What an interrupted run says.
pub(crate) const INTERRUPTED: &str = "interrupted; nothing was written";

/// Set once the user has interrupted.
pub(crate) type Interrupted = Arc<AtomicBool>;

pub(crate) fn catch() -> Result<Interrupted> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = interrupted.clone();
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("cannot catch interrupts")?;
    Ok(interrupted)
}

/// Fails once the user has interrupted.
pub(crate) fn check(interrupted: &AtomicBool) -> Result<()> {
    if interrupted.load(Ordering::Relaxed) {
        bail!(INTERRUPTED);
    }
    Ok(())
}
