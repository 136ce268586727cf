//! Ctrl-C, SIGTERM and SIGHUP: at once, unless there is something to save or to complete first.

use crate::process::status;
use fsot::error::{Error, Result};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of a stopped run.
pub(crate) const EXIT: u8 = 130;

/// Its number where there is such a signal.
const SIGHUP: i32 = 1;

/// Whether the next signal ends the program: nobody watches, or one has come before.
static ENDS: AtomicBool = AtomicBool::new(true);
static HANDLERS: Once = Once::new();

/// While it exists, the first signal only sets [`stopped`](Watch::stopped); a second one ends the program. Whoever has
/// it looks before it is gone: the next counts anew.
pub(crate) struct Watch(());

impl Watch {
    pub(crate) fn start() -> Result<Watch> {
        let mut result = Ok(());
        HANDLERS.call_once(|| {
            result = [SIGINT, SIGTERM].into_iter().chain(hangup()).try_for_each(|signal| {
                flag::register_conditional_shutdown(signal, i32::from(EXIT), &ENDS)?;
                flag::register(signal, &ENDS).map(drop)
            });
        });
        result.map_err(|error: std::io::Error| Error::Input(format!("cannot watch for Ctrl-C: {error}")))?;
        ENDS.store(false, Ordering::SeqCst);
        Ok(Watch(()))
    }

    pub(crate) fn stopped(&self) -> bool {
        ENDS.load(Ordering::SeqCst)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        ENDS.store(true, Ordering::SeqCst);
    }
}

/// The signal of a terminal that closes, where the system says that it is not ignored: `nohup` must work.
fn hangup() -> Option<i32> {
    let ignored = u64::from_str_radix(&status("SigIgn")?, 16).ok()?;
    (ignored & 1 == 0).then_some(SIGHUP)
}
