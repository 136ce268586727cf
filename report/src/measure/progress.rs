//! Progress bars.

use anyhow::Result;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle, WeakProgressBar};
use std::io::{IsTerminal, stderr};
use std::sync::LazyLock;
use std::thread;
use std::time::Duration;

/// All bars of the process, one below the other: a whole run's, and that of the part that is being measured.
static BARS: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// `work` in any unit that is proportional to time.
pub(crate) fn bar(work: u64) -> Result<ProgressBar> {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} of about {duration}  {msg}")?;
    let bar = BARS.add(ProgressBar::new(work).with_style(style));
    bar.enable_steady_tick(Duration::from_millis(200));
    if !stderr().is_terminal() {
        let weak = bar.downgrade();
        thread::spawn(move || tell(&weak));
    }
    Ok(bar)
}

/// A line every ten seconds, where nobody sees a bar move.
fn tell(bar: &WeakProgressBar) {
    loop {
        thread::sleep(Duration::from_secs(10));
        let Some(bar) = bar.upgrade().filter(|bar| !bar.is_finished()) else { return };
        let percent = 100 * bar.position() / bar.length().unwrap_or(1).max(1);
        println!("   {percent:>3} % after {} s  {}", bar.elapsed().as_secs(), bar.message());
    }
}
