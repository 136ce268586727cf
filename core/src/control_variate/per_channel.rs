//! A number for each channel, and arithmetic channel by channel; those of channels that are not there are zero and
//! ignored.

use super::config::Config;
use crate::matrix::copy;
use crate::real::Real;
use core::array;
use core::ops::{Add, AddAssign, Index, IndexMut, Mul, Sub};

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PerChannel<R>(pub(crate) [R; Config::MAX_CHANNELS]);

impl<R: Copy> PerChannel<R> {
    pub(crate) fn map<T>(self, f: impl FnMut(R) -> T) -> PerChannel<T> {
        PerChannel(self.0.map(f))
    }

    /// What `f` makes of two numbers of each channel.
    pub(crate) fn zip<S: Copy, T>(self, other: PerChannel<S>, f: impl Fn(R, S) -> T) -> PerChannel<T> {
        PerChannel(array::from_fn(|channel| f(self[channel], other[channel])))
    }
}

impl<R: Real> PerChannel<R> {
    /// The same for all.
    pub(crate) fn all(value: R) -> Self {
        Self([value; Config::MAX_CHANNELS])
    }

    /// What `f` says of each of so many channels.
    pub(crate) fn of(channels: usize, f: impl Fn(usize) -> R) -> Self {
        let mut all = Self::default();
        for (channel, out) in all.0.iter_mut().enumerate().take(channels) {
            *out = f(channel);
        }
        all
    }

    /// A row that has one number for each channel.
    pub(crate) fn from_row(row: &[R]) -> Self {
        let mut all = Self::default();
        copy(&mut all.0, row);
        all
    }
}

macro_rules! operator {
    ($trait:ident $name:ident) => {
        impl<R: Real> $trait for PerChannel<R> {
            type Output = Self;

            fn $name(self, other: Self) -> Self {
                self.zip(other, R::$name)
            }
        }
    };
}

operator! { Add add }
operator! { Sub sub }
operator! { Mul mul }

impl<R: Real> Mul<R> for PerChannel<R> {
    type Output = Self;

    fn mul(self, factor: R) -> Self {
        self.map(|value| value * factor)
    }
}

impl<R: Real> AddAssign for PerChannel<R> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

// No channel is beyond the last; the remainder shows that to the compiler.

impl<R> Index<usize> for PerChannel<R> {
    type Output = R;

    fn index(&self, channel: usize) -> &R {
        &self.0[channel % Config::MAX_CHANNELS]
    }
}

impl<R> IndexMut<usize> for PerChannel<R> {
    fn index_mut(&mut self, channel: usize) -> &mut R {
        &mut self.0[channel % Config::MAX_CHANNELS]
    }
}
