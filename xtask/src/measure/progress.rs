//! The progress bar.

use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// `work` in any unit that is proportional to time.
pub(crate) fn bar(work: u64) -> Result<ProgressBar> {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} of about {duration}  {msg}")?;
    let bar = ProgressBar::new(work).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    Ok(bar)
}
