//! What a call computes, and of what.

use super::super::config::{Config, Estimator, Ridge};
use super::super::samples::Reader;
use super::pixels::{Image, Windows};
use crate::basis::{Basis, Shape};

/// What all groups of a call have in common.
#[derive(Clone, Copy)]
pub(super) struct Call<'a> {
    pub(super) config: &'a Config,
    pub(super) image: &'a Image<'a>,
    pub(super) windows: Windows,
    /// Pixels that are given, in all frames.
    pub(super) pixels: usize,
    pub(super) shape: Shape,
    /// Samples of a pixel.
    pub(super) n: usize,
    /// How many the arrays hold, of which these are the first.
    pub(super) held: usize,
    pub(super) basis: &'a Basis,
    pub(super) reader: Reader<'a>,
}

impl Call<'_> {
    /// Whether there is one candidate, all of whose columns are used.
    pub(super) fn is_single_fit(&self) -> bool {
        self.config.estimator == Estimator::LeaveOneOut || matches!(self.config.ridge, Ridge::Fixed(_))
    }

    /// Values of a sample that fits are made to: of each channel f and, with something known, f less its part of that.
    pub(super) fn values(&self) -> usize {
        if self.image.has_known() { 2 * self.config.channels } else { self.config.channels }
    }

    /// Whether groups without an edge of a shadow are corrected: not by edges alone.
    pub(super) fn fits_without_edges(&self) -> bool {
        self.image.has_known() || self.shape.columns() + self.shape.slices_apart().0 > 0
    }

    /// In how many turns pixels are chosen for: in two, halves of them choose for each other.
    pub(super) fn turns(&self) -> usize {
        if self.config.estimator == Estimator::KFold && !self.is_single_fit() { 2 } else { 1 }
    }

    /// Whether colours, or halves of them, are corrected by fits to others.
    pub(super) fn has_colours(&self) -> bool {
        self.n > 1 || self.turns() > 1
    }

    /// Whether the standard error is that of the group's estimates, instead of the pixel's plain mean times the root of
    /// the gain: one sample has none, and stratified samples a smaller one than they seem to.
    pub(super) fn error_is_the_groups(&self) -> bool {
        self.n == 1 || self.config.stratified
    }
}
