//! Which columns a shared fit has, and which of them each candidate uses.

use super::super::config::{Config, Estimator};
use super::super::ridge;
use super::call::Call;
use super::products::*;
use crate::basis::{Basis, MAX_ORDER};
use heapless::Vec;

/// The most candidates: one for each degree, one with every slice's own functions, one with all columns.
pub(super) const MAX_FITS: usize = MAX_ORDER + 2;
/// Coefficients change across a group where each column has more samples than this. Real scenes' change little, and
/// every sample pays for the columns.
const SAMPLES_OF_COLUMN: usize = 4;
/// No products that make more columns than this.
const MOST_COLUMNS: usize = 192;
/// Relative penalty of the values' trend along an axis: next to none.
const TREND_PENALTY: f32 = 1e-3;
/// Penalty of a product with an axis, relative to that of the function.
const MOVING_PENALTY: f32 = 8.0;

/// Ridge strength per sample if the caller gives none.
const STRENGTH: f64 = 0.003;

/// What penalties of a fit to so many samples are multiplied by.
pub(super) fn scale(config: &Config, samples: &Eight) -> Eight {
    let strength = ridge::strength::<f32>(config.ridge, STRENGTH) as f32;
    samples.map(|samples| strength * Real::max(samples, 0.0))
}

/// Columns of a fit, in this order, so that each candidate is a prefix: the constant and the pixels' axes, which follow
/// the signal and correct nothing; the basis, degree by degree; and those of degree 1 times each axis, for
/// integrands that change across the block.
#[derive(Clone, Debug, Default)]
pub(super) struct Terms {
    /// Axes along which the pixels differ.
    pub(super) axes: usize,
    /// Of the basis.
    pub(super) functions: usize,
    /// How many of them, the first ones, have products with the axes.
    pub(super) moving: usize,
    /// For each candidate the number of columns.
    pub(super) ends: Vec<usize, MAX_FITS>,
    /// Slices whose own columns are none of these, and how many columns of its own each has, for each candidate.
    pub(super) slices: usize,
    pub(super) own: Vec<usize, MAX_FITS>,
    /// How many functions a slice has copies of.
    copies: usize,
    /// Whether slices' indicators have products with the axes.
    has_slopes: bool,
    /// Whether an edge is the last candidate.
    pub(super) has_edges: bool,
}

impl Terms {
    /// For fits to so many pixels of a call; perhaps with an edge.
    pub(super) fn new(call: &Call<'_>, pixels: usize, has_edges: bool) -> Self {
        let (config, shape, axes) = (call.config, &call.shape, call.windows.axes());
        let (functions, fixed) = (shape.columns(), 1 + axes);
        let (slices, copies) = shape.slices_apart();
        // What is known corrects alone: a fit to values that depend on it has seen its own pixel.
        let is_known_alone = call.image.has_known() && config.estimator == Estimator::LeaveOneOut;
        if is_known_alone || functions + slices == 0 {
            return Self { axes, has_edges, ..Self::default() };
        }
        let samples = pixels.saturating_mul(call.n);
        let mut terms = Self { axes, functions, slices, copies, has_edges, ..Self::default() };
        let moving = shape.up_to_degree(1);
        let columns = fixed + functions + slices * (1 + copies) + axes * (moving + slices);
        if axes > 0 && columns <= MOST_COLUMNS && SAMPLES_OF_COLUMN * columns < samples {
            terms.moving = moving;
            terms.has_slopes = slices > 0;
        }
        let (last, all_own) = (terms.columns(), terms.all_own());
        let mut end = |columns: usize, own: usize| {
            if terms.ends.last().is_none_or(|&last| last < columns) || terms.own.last().is_none_or(|&last| last < own) {
                // There is room for all: degrees, copies, products.
                let _ = (terms.ends.push(columns), terms.own.push(own));
            }
        };
        if !call.is_single_fit() {
            let own = usize::from(slices > 0);
            for degree in 1..=config.order {
                end(fixed + shape.up_to_degree(degree), own);
            }
            end(fixed + functions, if slices > 0 { 1 + copies } else { 0 });
        }
        end(last, all_own);
        terms
    }

    pub(super) fn candidates(&self) -> usize {
        self.ends.len() + usize::from(self.has_edges)
    }

    /// The constant and the axes.
    pub(super) fn fixed(&self) -> usize {
        1 + self.axes
    }

    pub(super) fn columns(&self) -> usize {
        self.fixed() + self.functions + self.axes * self.moving
    }

    /// Columns of sums of pixels' means: where slices are apart, as many as trends need.
    pub(super) fn of_means(&self) -> usize {
        if self.slices > 0 { self.fixed() } else { self.columns() }
    }

    /// Columns of sums of what is within pixels.
    pub(super) fn of_deviations(&self) -> usize {
        if self.slices > 0 { 0 } else { self.columns() }
    }

    /// Values of sums by slices, of `n` samples of each pixel: of several also the pixels' means.
    pub(super) fn of_slices(&self, values: usize, n: usize) -> usize {
        if self.slices == 0 { 0 } else { values * n.min(2) }
    }

    /// A slice's own columns: its indicator, its copies, and its indicator times each axis.
    pub(super) fn all_own(&self) -> usize {
        let slopes = if self.has_slopes { self.axes } else { 0 };
        if self.slices > 0 { 1 + self.copies + slopes } else { 0 }
    }

    /// Which column a slice's own one is, but for a factor, where a sample is of the slice; and the square of that.
    pub(super) fn source(&self, own: usize) -> (usize, f32) {
        let count = self.slices as f32;
        match own.checked_sub(1) {
            Some(copy) if copy < self.copies => (self.fixed() + copy, count),
            Some(after) => (1 + after - self.copies, count * count / (count - 1.0)),
            None => (0, count * count / (count - 1.0)),
        }
    }

    /// The columns that change within a pixel: what the function is multiplied by, and which function it is.
    pub(super) fn changing<'p>(&self, places: &'p [Four]) -> impl Iterator<Item = (&'p Four, usize)> + use<'p> {
        let (functions, moving) = (self.functions, self.moving);
        places.iter().enumerate().flat_map(move |(axis, place)| {
            (0..if axis == 0 { functions } else { moving }).map(move |function| (place, function))
        })
    }

    /// Makes the products of functions with the pixels' places along each axis.
    #[inline(always)]
    pub(super) fn multiply(&self, places: &[Four], functions: &[Four], products: &mut [Four]) {
        for (products, axis) in rows_mut(products, self.moving).zip(places.iter().skip(1)) {
            for (out, function) in products.iter_mut().zip(functions) {
                *out = times(function, axis);
                lanes::keep_together();
            }
        }
    }

    /// The penalty of each column, relative to the strength times the number of samples.
    pub(super) fn penalties(&self, basis: &Basis, out: &mut [f32]) {
        let (own, rest) = halves_mut(out, self.fixed());
        for (index, penalty) in own.iter_mut().enumerate() {
            *penalty = if index == 0 { 0.0 } else { TREND_PENALTY };
        }
        let (functions, products) = halves_mut(rest, self.functions);
        basis.penalties(functions);
        for (penalty, &function) in products.iter_mut().zip(first(functions, self.moving).iter().cycle()) {
            *penalty = MOVING_PENALTY * function;
        }
    }

    /// The penalty of a slice's own column, by those of the others and that of a function of degree 1.
    pub(super) fn own_penalty(&self, own: usize, penalties: &[f32], linear: f32) -> f32 {
        match self.source(own) {
            (0, _) => linear,
            (source, _) if source < self.fixed() => MOVING_PENALTY * linear,
            (source, _) => at(penalties, source),
        }
    }
}
