//! Fits to all pixels of a group but one, for each pixel.

use super::super::config::{Config, Estimator, Ridge};
use super::super::design::Units;
use super::super::per_channel::get;
use super::super::ridge;
use super::super::samples::Reader;
use super::bright::Limits;
use super::choice::{Spreads, Weights, last_only};
use super::members::Members;
use super::terms::Terms;
use crate::arena::Arena;
use crate::basis::{Basis, Shape};
use crate::error::Error;
use crate::lanes::{LANES, Lanes};
use crate::linalg::{ldlt, packed_len, row};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// Ridge strength per sample if the caller gives none.
const STRENGTH: f64 = 0.003;

/// Whether pixels of `n` samples are few enough to leave their samples out of one factor of `columns` columns.
fn has_few(n: usize, columns: usize) -> bool {
    n == 1 || 4 * n <= columns
}

/// Numbers that a fit with so many columns takes.
fn size_of_fit(config: &Config, terms: &Terms, columns: usize, pixels: usize, n: usize) -> Option<usize> {
    let (channels, fixed) = (config.channels, terms.fixed());
    let sums = packed_len(columns) + columns * channels;
    let (each, scratch) = if has_few(n, columns) {
        let each = n.checked_mul(columns + channels)?;
        (each, n * (columns + fixed + channels + 1) + 2 * packed_len(n))
    } else {
        (sums, columns + sums)
    };
    let each = each.checked_add(fixed + (terms.ends.len() + 1) * channels)?;
    let lanes = pixels.div_ceil(LANES).checked_mul(each)?.checked_add(scratch)?.checked_mul(LANES)?;
    lanes.checked_add(sums + columns + fixed * columns)
}

/// Everything that the fits of a call have in common.
pub(super) struct Problem<'a> {
    pub(super) config: &'a Config,
    pub(super) shape: Shape,
    pub(super) basis: &'a Basis,
    pub(super) reader: Reader<'a>,
    /// Samples of a pixel.
    pub(super) n: usize,
    /// What the values of a pixel are divided by before the fit, a row for each pixel; empty: 1.
    pub(super) factors: &'a [f32],
}

/// What the fits of a group have in common.
pub(super) struct Setting<'s, R> {
    pub(super) terms: &'s Terms,
    pub(super) units: [Units<R>; Config::MAX_CHANNELS],
    /// Panel after panel the lanes of [`Members::places`], zero for pixels that are left out of all fits.
    places: &'s [Lanes<R>],
    /// Whether there are such pixels.
    pub(super) leaves_out: bool,
}

impl<R> Setting<'_, R> {
    /// Panels of pixels with their places.
    #[inline(always)]
    pub(super) fn places(&self) -> impl Iterator<Item = &[Lanes<R>]> {
        rows(self.places, self.terms.fixed())
    }

    /// Groups of lanes in a panel's estimates.
    #[inline(always)]
    pub(super) fn estimates(&self, channels: usize) -> usize {
        (self.terms.ends.len() + 1) * channels
    }
}

/// What a group's fits say.
pub(super) struct Group<'a, R> {
    pub(super) units: [Units<R>; Config::MAX_CHANNELS],
    /// Panel after panel: the plain means of all channels, then each fit's estimates.
    estimates: &'a [Lanes<R>],
    channels: usize,
    pub(super) spreads: Spreads<R>,
}

impl<R: Real> Group<'_, R> {
    /// What the mixture adds to the plain mean of member `index`: zero if that is not finite.
    #[inline(always)]
    pub(super) fn correction(&self, index: usize, weights: &Weights<R>, channel: usize) -> R {
        let fits = self.spreads.fits;
        let start = index / LANES * (fits + 1) * self.channels + channel;
        let at = |fit: usize| {
            let lanes = self.estimates.get(start + fit * self.channels);
            lanes.and_then(|lanes| lanes.get(index % LANES)).copied().unwrap_or(R::ZERO)
        };
        let plain = at(0);
        let mut sum = R::ZERO;
        for (fit, weight) in weights.iter().enumerate().take(fits + 1).skip(1) {
            sum += get(weight, channel) * (at(fit) - plain);
        }
        if sum.is_finite() { sum } else { R::ZERO }
    }
}

impl<'a> Problem<'a> {
    /// Which columns a fit to these pixels has.
    #[inline(always)]
    pub(super) fn terms(&self, members: &Members<'_>) -> Terms {
        Terms::new(self.config, &self.shape, members.axes(), members.len.saturating_mul(self.n), self.is_single_fit())
    }

    /// Whether there is one candidate, all of whose columns are used.
    pub(super) fn is_single_fit(&self) -> bool {
        self.config.estimator == Estimator::LeaveOneOut || matches!(self.config.ridge, Ridge::Fixed(_))
    }

    /// Numbers that [`Problem::fit`] takes for at most so many pixels.
    pub(super) fn size(config: &Config, shape: &Shape, axes: usize, pixels: usize, n: usize) -> Option<usize> {
        let terms = Terms::new(config, shape, axes, pixels.checked_mul(n)?, false);
        // Fewer pixels may have fewer columns, and then go the other way.
        let sizes = terms.fewer_columns(shape).map(|columns| size_of_fit(config, &terms, columns, pixels, n));
        sizes.into_iter().try_fold(0, |largest, size| Some(size?.max(largest)))
    }

    /// Fits to all members but one, for each of them, of which there are at least two. Members beyond `limits` are in
    /// no fit, and so corrected by one to all others: what corrects a pixel does not depend on whether it is beyond
    /// them.
    #[inline(always)]
    pub(super) fn fit<'b, R: Real>(
        &self,
        members: &Members<'_>,
        terms: &Terms,
        limits: Option<&Limits>,
        arena: &mut Arena<'b, R>,
    ) -> Result<Group<'b, R>, Error> {
        let channels = self.config.channels;
        let fixed = terms.fixed();
        let panels = members.len.div_ceil(LANES);
        let places = arena.take_lanes(panels * fixed)?;
        for (panel, out) in rows_mut(places, fixed).enumerate() {
            for (out, place) in out.iter_mut().zip(members.places(panel * LANES)) {
                *out = place;
            }
        }
        let mut used = members.len;
        if let Some(limits) = limits {
            for index in (0..members.len).filter(|&index| !self.is_within(limits, members.pixel(index))) {
                used -= 1;
                for place in places.iter_mut().skip(index / LANES * fixed).take(fixed) {
                    place[index % LANES] = R::ZERO;
                }
            }
        }
        let setting = Setting { terms, units: self.units(members, limits), places, leaves_out: limits.is_some() };
        let estimates = arena.take_lanes(panels * setting.estimates(channels))?;
        if self.n == 1 {
            // A copy of its own: loops over one sample vanish.
            self.by_one_factor(members, &setting, 1, estimates, arena)?;
        } else if has_few(self.n, terms.columns()) {
            self.by_one_factor(members, &setting, self.n, estimates, arena)?;
        } else {
            self.by_factor_each(members, &setting, estimates, arena)?;
        }
        let spreads = Spreads::new(used, places, fixed, estimates, terms.ends.len(), channels, setting.leaves_out);
        Ok(Group { units: setting.units, estimates, channels, spreads })
    }

    /// How far the mean and the fits are trusted, by a group that has at least two members.
    #[inline(always)]
    pub(super) fn weights<R: Real>(&self, group: &Group<'_, R>) -> Weights<R> {
        if self.is_single_fit() { last_only(group.spreads.fits) } else { group.spreads.weights(self.config.channels) }
    }

    /// What a pixel's values are divided by. Black says nothing about what it multiplies: 1.
    #[inline(always)]
    pub(super) fn factor(&self, pixel: usize, channel: usize) -> f64 {
        let factor = self.factors.get(pixel * self.config.channels + channel).copied().unwrap_or(1.0);
        if factor > 0.0 { f64::from(factor) } else { 1.0 }
    }

    /// As for one pixel's samples: the zero at the first value and, for a narrow type, the unit near the largest.
    #[inline(always)]
    fn units<R: Real>(&self, members: &Members<'_>, limits: Option<&Limits>) -> [Units<R>; Config::MAX_CHANNELS] {
        let is_used = |pixel: usize| limits.is_none_or(|limits| self.is_within(limits, pixel));
        let mut units = [Units::default(); Config::MAX_CHANNELS];
        if R::NARROW {
            let mut largest = [0.0f64; Config::MAX_CHANNELS];
            for pixel in (0..members.len).map(|index| members.pixel(index)).filter(|&pixel| is_used(pixel)) {
                for sample in pixel * self.n..(pixel + 1) * self.n {
                    let values = self.reader.values::<f64>(&self.reader.get(sample));
                    for (channel, largest) in largest.iter_mut().enumerate().take(self.config.channels) {
                        *largest = largest.max(Real::abs(get(&values, channel) / self.factor(pixel, channel)));
                    }
                }
            }
            for (unit, largest) in units.iter_mut().zip(largest) {
                unit.exponent = Real::exponent(largest).clamp(-126, 126);
            }
        }
        let mut pixels = (0..members.len).map(|index| members.pixel(index));
        let pixel = pixels.find(|&pixel| is_used(pixel)).unwrap_or(0);
        let first = self.reader.values::<f64>(&self.reader.get(pixel * self.n));
        for (channel, (unit, value)) in units.iter_mut().zip(first).enumerate().take(self.config.channels) {
            unit.offset = R::from_f64(libm::scalbn(value / self.factor(pixel, channel), -unit.exponent));
        }
        units
    }

    /// Adds what ridge a fit to `samples` samples has to the diagonal of the sums of products.
    #[inline(always)]
    pub(super) fn add_ridge<R: Real>(&self, terms: &Terms, samples: usize, gram: &mut [R], penalties: &mut [R]) {
        let count = gram.first().copied().unwrap_or(R::ONE);
        let mean_square = |j: usize| row(gram, j).last().copied().unwrap_or(R::ZERO) / count;
        terms.penalties(self.config, self.basis, mean_square, penalties);
        let strength = match self.config.ridge {
            Ridge::Fixed(_) => ridge::single::<R>(self.config.ridge),
            Ridge::Default | Ridge::Auto => STRENGTH,
        };
        let strength = R::from_f64(strength) * R::from_usize(samples);
        ldlt::add_diagonal(gram, terms.columns(), |j| strength * penalties.get(j).copied().unwrap_or(R::ONE));
    }
}
