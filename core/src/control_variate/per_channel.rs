//! A number for each channel; those of channels that are not there are zero and ignored.

use super::config::Config;
use core::ops::{Deref, DerefMut, Index, IndexMut};

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PerChannel<R>(pub(crate) [R; Config::MAX_CHANNELS]);

impl<R> PerChannel<R> {
    #[inline]
    pub(crate) fn map<T>(self, f: impl FnMut(R) -> T) -> PerChannel<T> {
        PerChannel(self.0.map(f))
    }
}

impl<R> Deref for PerChannel<R> {
    type Target = [R; Config::MAX_CHANNELS];

    #[inline]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<R> DerefMut for PerChannel<R> {
    #[inline]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

// No channel is beyond the last; the remainder shows that to the compiler.

impl<R> Index<usize> for PerChannel<R> {
    type Output = R;

    #[inline]
    fn index(&self, channel: usize) -> &R {
        &self.0[channel % Config::MAX_CHANNELS]
    }
}

impl<R> IndexMut<usize> for PerChannel<R> {
    #[inline]
    fn index_mut(&mut self, channel: usize) -> &mut R {
        &mut self.0[channel % Config::MAX_CHANNELS]
    }
}
