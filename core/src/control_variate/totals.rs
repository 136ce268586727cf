//! What the sums of a stream say about its plain mean.

use super::config::Config;
use super::design::Units;
use super::per_channel::PerChannel;
use super::result::{self, Outcome};
use super::sums::{self, Sums};
use crate::real::Real;

pub(crate) struct Totals<R> {
    /// The sums' units, moved so that zero is the plain mean.
    pub(crate) units: [Units<R>; Config::MAX_CHANNELS],
    /// The plain mean in the sums' units.
    pub(crate) mean: PerChannel<R>,
    /// The plain mean's variance.
    pub(crate) variance: Option<PerChannel<R>>,
}

impl<R: Real> Totals<R> {
    /// Of groups of sums over so many samples together.
    pub(crate) fn new<'a>(
        groups: impl Iterator<Item = Sums<&'a [R]>>,
        samples: u64,
        mut units: [Units<R>; Config::MAX_CHANNELS],
    ) -> Self {
        let (mut totals, mut squares) = (PerChannel::default(), PerChannel::default());
        for group in groups {
            totals += group.totals();
            squares += group.squares();
        }
        let n = R::from_f64(samples as f64);
        let mean = totals.map(|total| total / n);
        for (unit, &mean) in units.iter_mut().zip(mean.iter()) {
            unit.offset += mean;
        }
        let variance = sums::spread(squares, totals, mean).map(|spread| spread / result::mean_divisor(n));
        Self { units, mean, variance: (samples > 1).then_some(variance) }
    }

    pub(crate) fn plain(&self) -> Outcome<R> {
        Outcome::plain(self.variance)
    }

    /// Turns an estimate in the sums' units into a correction of the plain mean.
    pub(crate) fn corrected(&self, outcome: Outcome<R>) -> Outcome<R> {
        Outcome { correction: outcome.correction - self.mean, ..outcome }
    }
}
