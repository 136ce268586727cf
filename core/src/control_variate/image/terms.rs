//! Which columns a shared fit has, and which of them each candidate uses.

use super::super::config::Config;
use super::super::ridge;
use super::products::{Four, zip_four};
use crate::basis::{Basis, MAX_ORDER, Shape};
use crate::lanes;
use crate::real::Real;
use crate::rows::rows_mut;
use heapless::Vec;

/// The most candidates: one for each degree, one with every slice's own functions, one with all columns.
pub(super) const MAX_FITS: usize = MAX_ORDER + 2;
/// The pixels' axes: x, y and frames.
pub(super) const MAX_AXES: usize = 3;
/// The highest degree of the functions whose coefficients may change across a group.
const MOVING_DEGREE: usize = 2;
/// No products that make more columns than this.
const MOST_COLUMNS: usize = 192;
/// Relative penalty of the values' trend along an axis: next to none.
const TREND_PENALTY: f64 = 1e-3;
/// Penalty of a product with an axis, relative to that of the function.
const MOVING_PENALTY: f64 = 8.0;

/// Columns of a fit, in this order, so that each candidate is a prefix: the constant and the pixels' axes, which follow
/// the signal and correct nothing; control functions and basis, degree by degree; and low-degree functions times each
/// axis, for integrands that change across the block.
#[derive(Clone, Debug, Default)]
pub(super) struct Terms {
    /// Axes along which the pixels differ.
    pub(super) axes: usize,
    /// Control functions and basis.
    pub(super) functions: usize,
    /// Where among the functions those with products begin, and how many they are.
    pub(super) moving: (usize, usize),
    /// For each candidate the number of columns.
    pub(super) ends: Vec<usize, MAX_FITS>,
}

impl Terms {
    /// For a fit to `samples` samples of pixels that differ along `axes` axes. With `all`, one candidate: every column.
    #[inline(always)]
    pub(super) fn new(config: &Config, shape: &Shape, axes: usize, samples: usize, all: bool) -> Self {
        let functions = config.controls + shape.columns();
        let fixed = 1 + axes;
        let mut terms = Self { axes, functions, moving: (config.controls, 0), ends: Vec::new() };
        if functions == 0 {
            return terms;
        }
        // As many degrees as leave two samples to each column.
        for degree in 1..=MOVING_DEGREE.min(config.order.saturating_sub(1)).max(1) {
            let moving = shape.up_to_degree(degree);
            let columns = fixed + functions + axes * moving;
            if axes > 0 && columns <= MOST_COLUMNS && 2 * columns <= samples {
                terms.moving.1 = moving;
            }
        }
        let mut end = |columns: usize| {
            if !all && terms.ends.last().is_none_or(|&last| last < columns) {
                // There is room for all: degrees, copies, products.
                let _ = terms.ends.push(columns);
            }
        };
        for degree in 1..=config.order {
            end(fixed + config.controls + shape.up_to_degree(degree));
        }
        end(fixed + functions);
        end(fixed + functions + axes * terms.moving.1);
        if all {
            let _ = terms.ends.push(terms.columns());
        }
        terms
    }

    /// The constant and the axes alone: no candidates.
    pub(super) fn without_fits(axes: usize) -> Self {
        Self { axes, ..Self::default() }
    }

    /// The constant and the axes.
    #[inline(always)]
    pub(super) fn fixed(&self) -> usize {
        1 + self.axes
    }

    /// All columns.
    #[inline(always)]
    pub(super) fn columns(&self) -> usize {
        self.fixed() + self.functions + self.axes * self.moving.1
    }

    /// The columns that change within a pixel: what the function is multiplied by, and which function it is.
    #[inline(always)]
    pub(super) fn changing<'p>(&self, places: &'p [Four]) -> impl Iterator<Item = (&'p Four, usize)> + use<'p> {
        let (functions, (first, count)) = (self.functions, self.moving);
        places.iter().enumerate().flat_map(move |(axis, place)| {
            let range = if axis == 0 { 0..functions } else { first..first + count };
            range.map(move |function| (place, function))
        })
    }

    /// Makes the products of functions with the pixels' places along each axis.
    #[inline(always)]
    pub(super) fn multiply(&self, places: &[Four], functions: &[Four], products: &mut [Four]) {
        let (first, count) = self.moving;
        let moving = functions.get(first..first + count).unwrap_or_default();
        for (products, axis) in rows_mut(products, count).zip(places.iter().skip(1)) {
            for (out, function) in products.iter_mut().zip(moving) {
                *out = zip_four(function, axis, |function, axis| lanes::zip(function, axis, |a, b| a * b));
                lanes::keep_together();
            }
        }
    }

    /// The penalty of each column, relative to the strength times the number of samples.
    #[inline(always)]
    pub(super) fn penalties<R: Real>(
        &self,
        config: &Config,
        basis: &Basis,
        mean_square: impl Fn(usize) -> R,
        out: &mut [R],
    ) {
        let fixed = self.fixed();
        let (own, rest) = out.split_at_mut_checked(fixed).unwrap_or((&mut [], &mut []));
        for (index, penalty) in own.iter_mut().enumerate() {
            *penalty = if index == 0 { R::ZERO } else { R::from_f64(TREND_PENALTY) };
        }
        let (functions, products) = rest.split_at_mut_checked(self.functions).unwrap_or((&mut [], &mut []));
        ridge::penalties(config, basis, |j| mean_square(fixed + j), functions);
        let (first, count) = self.moving;
        let moving = functions.get(first..first + count).unwrap_or(&[]);
        for (penalty, &function) in products.iter_mut().zip(moving.iter().cycle()) {
            *penalty = R::from_f64(MOVING_PENALTY) * function;
        }
    }
}
