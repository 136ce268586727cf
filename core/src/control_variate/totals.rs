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
        units: [Units<R>; Config::MAX_CHANNELS],
    ) -> Self {
        let (mut totals, mut squares) = (PerChannel::<R>::default(), PerChannel::<R>::default());
        for group in groups {
            for channel in 0..group.channels() {
                totals[channel] += group.total(channel);
                squares[channel] += group.square(channel);
            }
        }
        let n = R::from_f64(samples as f64);
        let (mean, mut variance) = (totals.map(|total| total / n), PerChannel::default());
        let mut result = Self { units, mean, variance: None };
        for (channel, unit) in result.units.iter_mut().enumerate() {
            unit.offset += mean[channel];
            let spread = sums::spread(squares[channel], totals[channel], mean[channel]);
            variance[channel] = spread / result::mean_divisor(n);
        }
        result.variance = (samples > 1).then_some(variance);
        result
    }

    pub(crate) fn plain(&self) -> Outcome<R> {
        Outcome::plain(self.variance)
    }

    /// Turns an estimate in the sums' units into a correction of the plain mean.
    pub(crate) fn corrected(&self, mut outcome: Outcome<R>) -> Outcome<R> {
        for (correction, &mean) in outcome.correction.iter_mut().zip(self.mean.iter()) {
            *correction -= mean;
        }
        outcome
    }
}
