//! Ctrl-C: at once, unless there is something to save or to complete first.
//!
//! SIGTERM and SIGHUP are left as they are, so that `nohup` works; the last periodic checkpoint then counts.

use fsot::error::{Error, Result};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// The exit code of a stopped run.
pub(crate) const EXIT: u8 = 130;

static WATCHES: AtomicU32 = AtomicU32::new(0);
static STOPPED: AtomicBool = AtomicBool::new(false);
static HANDLER: Once = Once::new();

/// While one exists, the first Ctrl-C only sets [`stopped`](Watch::stopped); a second one ends the program. Whoever has
/// one looks before it is gone: the next counts anew.
pub(crate) struct Watch(());

impl Watch {
    pub(crate) fn start() -> Result<Watch> {
        let mut result = Ok(());
        HANDLER.call_once(|| {
            result = ctrlc::set_handler(|| {
                if WATCHES.load(Ordering::SeqCst) == 0 || STOPPED.swap(true, Ordering::SeqCst) {
                    std::process::exit(i32::from(EXIT));
                }
            });
        });
        result.map_err(|error| Error::Input(format!("cannot watch for Ctrl-C: {error}")))?;
        if WATCHES.load(Ordering::SeqCst) == 0 {
            STOPPED.store(false, Ordering::SeqCst);
        }
        WATCHES.fetch_add(1, Ordering::SeqCst);
        Ok(Watch(()))
    }

    pub(crate) fn stopped(&self) -> bool {
        STOPPED.load(Ordering::SeqCst)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        WATCHES.fetch_sub(1, Ordering::SeqCst);
    }
}
