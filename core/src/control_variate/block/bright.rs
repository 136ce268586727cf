//! Pixels whose values lie far from those of all others: fireflies, small highlights.
//!
//! A fit has seen them, and even a fit that is hardly trusted then moves the other pixels by more than their own error.
//! So where the mean is trusted most, such pixels are left out of the fits to others.

use super::super::config::Config;
use super::super::per_channel::get;
use super::choice::Weights;
use super::fit::Problem;
use super::members::Members;
use crate::real::Real;

/// One of so many pixels may be set aside at each end, rounded up.
const SHARE: usize = 16;
/// No more are.
const MOST: usize = 16;
/// Fewer pixels do not say what is usual.
const FEWEST: usize = 8;
/// How far from the others a value is, in units of their range, that its pixel is left out.
const FAR: f64 = 8.0;
/// The least trust in the mean: where fits are better, rare bright values are what they explain.
const DOUBT: f64 = 0.5;

/// What values of each channel are not too far from the others, from lowest to highest.
#[derive(Clone, Copy)]
pub(super) struct Limits([[f64; 2]; Config::MAX_CHANNELS]);

/// The highest values.
struct Highest {
    /// In falling order.
    values: [f64; MOST + 1],
    /// The index of the last that is wanted.
    last: usize,
}

impl Highest {
    fn new(last: usize) -> Self {
        Self { values: [f64::NEG_INFINITY; MOST + 1], last }
    }

    /// The lowest of them.
    fn least(&self) -> f64 {
        self.values.get(self.last).copied().unwrap_or(f64::INFINITY)
    }

    #[inline(always)]
    fn add(&mut self, mut value: f64) {
        // Most are not among them.
        if value <= self.least() {
            return;
        }
        for place in self.values.iter_mut().take(self.last + 1) {
            if value > *place {
                core::mem::swap(place, &mut value);
            }
        }
    }
}

impl Problem<'_> {
    /// How far values of `members` may be from those of `judges`, if any is too far. Where a judge itself is too far
    /// and fits are trusted, they explain it, and keep such values.
    pub(super) fn limits<R: Real>(
        &self,
        judges: &Members<'_>,
        members: &Members<'_>,
        weights: &Weights<R>,
    ) -> Option<Limits> {
        let mut limits = Limits([[f64::NEG_INFINITY, f64::INFINITY]; Config::MAX_CHANNELS]);
        if judges.len < FEWEST || self.is_single_fit() {
            return None;
        }
        let aside = judges.len.div_ceil(SHARE).min(MOST);
        let [plain, ..] = weights;
        let mut any = false;
        let is_halved = judges.len < members.len;
        for (channel, limits) in limits.0.iter_mut().enumerate().take(self.config.channels) {
            let mean_is_doubted = get(plain, channel).to_f64() < DOUBT;
            if mean_is_doubted && !is_halved {
                continue;
            }
            let (mut highest, mut lowest) = (Highest::new(aside), Highest::new(aside));
            for index in 0..judges.len {
                let [low, high] = self.range(judges.pixel(index), channel);
                highest.add(high);
                lowest.add(-low);
            }
            let (low, high) = (-lowest.least(), highest.least());
            let far = FAR * (high - low);
            let near = [low - far, high + far];
            let is_far = -lowest.values[0] < near[0] || highest.values[0] > near[1];
            if !is_far || !mean_is_doubted {
                *limits = near;
            }
            any |= is_far || is_halved;
        }
        if !any {
            return None;
        }
        (0..members.len).any(|index| !self.is_within(&limits, members.pixel(index))).then_some(limits)
    }

    /// Whether all values of a pixel are within the limits.
    pub(super) fn is_within(&self, limits: &Limits, pixel: usize) -> bool {
        let mut all = limits.0.iter().enumerate().take(self.config.channels);
        all.all(|(channel, &[lowest, highest])| {
            let [low, high] = self.range(pixel, channel);
            lowest <= low && high <= highest
        })
    }

    /// A pixel's lowest and highest value, as fits see them.
    fn range(&self, pixel: usize, channel: usize) -> [f64; 2] {
        let factor = self.factor(pixel, channel);
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for sample in 0..self.n {
            let value = self.reader.value(pixel * self.n + sample, channel) / factor;
            range = [range[0].min(value), range[1].max(value)];
        }
        range
    }
}
