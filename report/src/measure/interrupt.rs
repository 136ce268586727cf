//! Interrupts: programs that are run get them too, and end; this one then removes its temporary files.

use anyhow::{Context, Result, bail};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// What an interrupted run says.
pub(crate) const INTERRUPTED: &str = "interrupted; nothing was written";

/// Set once the user has interrupted.
pub(crate) type Interrupted = Arc<AtomicBool>;

/// Can be called again: there is one handler for the whole process.
pub(crate) fn catch() -> Result<Interrupted> {
    static CAUGHT: OnceLock<Interrupted> = OnceLock::new();
    if let Some(interrupted) = CAUGHT.get() {
        return Ok(interrupted.clone());
    }
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = interrupted.clone();
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("cannot catch interrupts")?;
    Ok(CAUGHT.get_or_init(|| interrupted).clone())
}

/// Fails once the user has interrupted.
pub(crate) fn check(interrupted: &AtomicBool) -> Result<()> {
    if interrupted.load(Ordering::Relaxed) {
        bail!(INTERRUPTED);
    }
    Ok(())
}
