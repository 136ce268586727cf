//! Which samples correct which.
//!
//! Folds are runs of samples in the order they came in: an aligned run of 2^m points of a Sobol sequence, in its own or
//! in Gray code order, and of a tile is as even as the whole, and folds of other lengths are nearly. Of folds that took
//! every k-th sample each would be one side of the cube, and what corrects it a fit to the other sides. Independent
//! samples are the same in every order.

use core::num::NonZeroUsize;

/// Which samples are meant: a run of them, or all others.
#[derive(Clone, Copy)]
pub(crate) struct Subset {
    start: usize,
    end: usize,
    is_run: bool,
}

impl Subset {
    /// All: none is left out.
    pub(crate) const ALL: Self = Self { start: 0, end: 0, is_run: false };

    /// One of the folds of `n` samples that are all there: a run, all of the same length but for one sample.
    pub(crate) fn fold(index: usize, folds: NonZeroUsize, n: usize) -> Self {
        let (each, more) = (n / folds, n % folds);
        let start = |index: usize| index * each + index.min(more);
        Self { start: start(index), end: start(index + 1), is_run: true }
    }

    pub(crate) fn others(self) -> Self {
        Self { is_run: !self.is_run, ..self }
    }

    pub(crate) fn is_all(self) -> bool {
        !self.is_run && self.start == self.end
    }

    pub(crate) fn contains(self, index: usize) -> bool {
        (self.start..self.end).contains(&index) == self.is_run
    }

    /// How many of `n` samples.
    pub(crate) fn len(self, n: usize) -> usize {
        let run = self.end - self.start;
        if self.is_run { run } else { n - run }
    }
}

/// The shortest run of a stream.
const RUN: u64 = 4;

/// The fold of sample `index` of a stream whose end nobody knows.
///
/// Runs grow with the stream: with P the power of two next to the number of folds, the first 4 P samples are P runs of
/// 4, the next 4 P samples are P runs too, the next 8 P, and so on, and runs go to the folds in turn.
pub(crate) fn of_stream(index: u64, folds: NonZeroUsize) -> usize {
    let index = index / RUN;
    let bits = folds.get().next_power_of_two().trailing_zeros();
    let octave = (index >> bits).checked_ilog2().map_or(0, |octave| octave + 1);
    // Runs of the octaves before, and of this one.
    let run = if octave == 0 { index } else { (u64::from(octave) << bits) + (index >> (octave - 1)) - (1 << bits) };
    run as usize % folds
}

/// By how many folds those of another stream are moved on before ours get their samples, from the sizes of both: so
/// that the folds are as even as can be.
pub(crate) fn rotation(folds: NonZeroUsize, ours: impl Fn(usize) -> f64, theirs: impl Fn(usize) -> f64) -> usize {
    let moved = |fold: usize, rotation: usize| (fold + rotation) % folds;
    // The sum of the squared sizes, but for what no rotation changes.
    let crowding = |rotation| (0..folds.get()).map(|fold| ours(moved(fold, rotation)) * theirs(fold)).sum::<f64>();
    let each = (0..folds.get()).map(|rotation| (rotation, crowding(rotation)));
    each.min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(best, _)| best)
}
