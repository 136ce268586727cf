//! Several runs of the path tracer at the same time. Loading a scene and small images with shared fits, which are one
//! bucket, keep one core of a run busy; runs beside each other keep all.

use super::renderer::{Job, Renderer, Timing, threads};
use anyhow::{Result, anyhow};
use indicatif::ProgressBar;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// What is rendered, and the files' prefix.
pub(crate) type Run<'a> = (Job<'a>, PathBuf);

/// [`Renderer::render`] of each, at most `most` at a time, which share the cores. In the order of the runs.
pub(crate) fn render(
    renderer: &Renderer,
    runs: &[Run],
    size: u32,
    most: u32,
    bar: &ProgressBar,
) -> Result<Vec<Vec<Timing>>> {
    let workers = most.min(threads()).min(runs.len() as u32).max(1);
    let each = threads() / workers;
    in_turn(runs.len(), workers, |index| {
        let (job, prefix) = &runs[index];
        // A bar's position can be set by one run only.
        let timings = renderer.render_with(each, job, size, prefix, &ProgressBar::hidden())?;
        bar.inc(job.work);
        Ok(timings)
    })
}

/// What `action` makes of 0, 1, ... `count` - 1, with so many threads; the first failure, once those that run have
/// ended.
fn in_turn<T: Send>(count: usize, workers: u32, action: impl Fn(usize) -> Result<T> + Sync) -> Result<Vec<T>> {
    let next = AtomicUsize::new(0);
    let work = || -> Result<Vec<(usize, T)>> {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return Ok(done);
            }
            // After a failure the others begin nothing new.
            done.push((index, action(index).inspect_err(|_| next.store(count, Ordering::Relaxed))?));
        }
    };
    let mut all = Vec::with_capacity(count);
    thread::scope(|scope| -> Result<()> {
        let running: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        let ended: Vec<_> = running.into_iter().map(|one| one.join().map_err(|_| anyhow!("a thread ended"))).collect();
        for one in ended {
            all.extend(one??);
        }
        Ok(())
    })?;
    all.sort_by_key(|(index, _)| *index);
    Ok(all.into_iter().map(|(_, value)| value).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;

    #[test]
    fn results_come_in_the_order_of_the_runs() {
        let squares = in_turn(100, 7, |index| Ok(index * index)).expect("nothing fails");
        assert!(squares.iter().enumerate().all(|(index, &square)| square == index * index) && squares.len() == 100);
        assert!(in_turn(0, 2, |_| Ok(())).expect("nothing to do").is_empty());
    }

    #[test]
    fn a_failure_is_told_and_ends_the_rest() {
        let begun = AtomicUsize::new(0);
        let result = in_turn(1000, 1, |index| {
            begun.fetch_add(1, Ordering::Relaxed);
            if index == 3 { bail!("number {index}") } else { Ok(()) }
        });
        assert_eq!(result.expect_err("the fourth fails").to_string(), "number 3");
        assert_eq!(begun.load(Ordering::Relaxed), 4);
    }
}
