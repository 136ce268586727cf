//! Progress bars.

use anyhow::Result;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use std::sync::LazyLock;
use std::time::Duration;

/// All bars of the process, one below the other: a whole run's, and that of the part that is being measured.
static BARS: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// `work` in any unit that is proportional to time.
pub(crate) fn bar(work: u64) -> Result<ProgressBar> {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} of about {duration}  {msg}")?;
    let bar = BARS.add(ProgressBar::new(work).with_style(style));
    bar.enable_steady_tick(Duration::from_millis(200));
    Ok(bar)
}
