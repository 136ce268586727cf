//! A number for each channel; those of channels that are not there are zero and ignored.

use super::Config;
use crate::real::Real;

/// A number for each channel.
pub(crate) type PerChannel<R> = [R; Config::MAX_CHANNELS];

/// One channel's number.
#[inline(always)]
pub(crate) fn get<R: Real>(values: &PerChannel<R>, channel: usize) -> R {
    values.get(channel).copied().unwrap_or(R::ZERO)
}

/// Sets one channel's number.
#[inline(always)]
pub(crate) fn set<R: Real>(values: &mut PerChannel<R>, channel: usize, value: R) {
    if let Some(slot) = values.get_mut(channel) {
        *slot = value;
    }
}

/// Adds to one channel's number.
#[inline(always)]
pub(crate) fn add<R: Real>(values: &mut PerChannel<R>, channel: usize, value: R) {
    if let Some(slot) = values.get_mut(channel) {
        *slot += value;
    }
}
