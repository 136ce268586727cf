//! How far pixels' values follow what is known of their samples, by the other pixels of their group.
//!
//! With a sample's unshadowed contribution a and A its integral over u, a pixel's mean f - beta (a - A) has the
//! integral of f for every beta that has not seen the pixel. Of the others' means, beta = sum w (f - v A) (a - A) / sum
//! w (a - A)^2 with w = 1 / A^2 and v = sum f / A over sum a / A, the share of the light that arrives: at least 0, at
//! most v.

use super::Call;
use super::batch::{Batch, Eight, NONE, only};
use super::groups::Groups;
use crate::arena::Arena;
use crate::error::Error;
use crate::lanes::{self, LANES};
use crate::real::Real;
use core::hint::black_box;

/// Integrals count as at least this much of the group's largest: what else arrives would decide where they are small.
const LEAST: f32 = 0.01;
/// Values beyond so many integrals say nothing about others.
const MOST: f32 = (1_u64 << 40) as f32;
/// What others leave of a sum when a pixel is taken from it must be at least this of it.
const ROUNDING: f32 = 1e-5;

/// Of a pixel, relative to its integral: its mean, what is known, how far that is from its integral.
type Relative = [Eight; 3];

/// Sums over pixels.
#[derive(Clone, Copy, Default)]
struct Sums {
    mean: Eight,
    known: Eight,
    square: Eight,
    mean_product: Eight,
    integral_product: Eight,
}

impl Sums {
    /// Those of one pixel.
    #[inline(always)]
    fn one([mean, known, apart]: &Relative) -> Self {
        let product = |a: &Eight| lanes::zip(a, apart, |a, b| a * b);
        let integral = lanes::zip(known, apart, |known, apart| known - apart);
        Self {
            mean: *mean,
            known: *known,
            square: product(apart),
            mean_product: product(mean),
            integral_product: product(&integral),
        }
    }

    #[inline(always)]
    fn zip(&self, other: &Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self {
            mean: lanes::zip(&self.mean, &other.mean, &f),
            known: lanes::zip(&self.known, &other.known, &f),
            square: lanes::zip(&self.square, &other.square, &f),
            mean_product: lanes::zip(&self.mean_product, &other.mean_product, &f),
            integral_product: lanes::zip(&self.integral_product, &other.integral_product, &f),
        }
    }

    fn joined(&self) -> Self {
        let join = |sum: &Eight| [lanes::sum(sum); LANES];
        Self {
            mean: join(&self.mean),
            known: join(&self.known),
            square: join(&self.square),
            mean_product: join(&self.mean_product),
            integral_product: join(&self.integral_product),
        }
    }

    /// The coefficient by these pixels, of `all` less one.
    #[inline(always)]
    fn coefficient(&self, all: &Self) -> Eight {
        let (known, square) = (lanes::divisor(&self.known), lanes::divisor(&self.square));
        let mut coefficient = NONE;
        for l in 0..LANES {
            // Behind a black box, or compilers divide where nothing is, too.
            let share = black_box(self.mean[l] / known[l]);
            let slope = black_box((self.mean_product[l] - share * self.integral_product[l]) / square[l]);
            let is_known = self.known[l] > all.known[l] * ROUNDING && self.square[l] > all.square[l] * ROUNDING;
            coefficient[l] = if is_known { Real::max(Real::min(slope, share), 0.0) } else { 0.0 };
        }
        coefficient
    }
}

/// Numbers for each slot and channel while coefficients are computed.
pub(super) const RELATIVE: usize = 3;

impl Batch<'_> {
    /// Computes the coefficient of each slot and channel.
    #[inline(always)]
    pub(super) fn relate(
        &mut self,
        call: &Call<'_>,
        groups: &Groups<'_>,
        arena: &mut Arena<'_, f32>,
    ) -> Result<(), Error> {
        let channels = call.config.channels;
        let mut arena = arena.scratch();
        let (relatives, _) = arena.take_lanes(RELATIVE * self.slots)?.as_chunks_mut::<RELATIVE>();
        let inverse = 1.0 / call.n as f32;
        for channel in 0..channels {
            let mut largest = NONE;
            for slot in 0..self.slots {
                let mut integral = NONE;
                for (lane, integral) in integral.iter_mut().enumerate() {
                    if let Some((pixel, _)) = self.pixel(call, groups, lane, slot) {
                        *integral = call.integral(pixel, channel);
                    }
                }
                let inside = self.inside.get(slot).copied().unwrap_or(NONE);
                largest = lanes::zip(&largest, &only(&inside, &integral), Real::max);
                if let Some(out) = self.integrals.get_mut(slot * channels + channel) {
                    *out = integral;
                }
            }
            if self.is_joined {
                largest = [largest.into_iter().fold(0.0, Real::max); LANES];
            }
            let mut sums = Sums::default();
            for (slot, relative) in relatives.iter_mut().enumerate() {
                let (mut mean, mut known) = (NONE, NONE);
                for lane in 0..LANES {
                    let Some((pixel, _)) = self.pixel(call, groups, lane, slot) else { continue };
                    for sample in pixel * call.n..(pixel + 1) * call.n {
                        mean[lane] += call.value(pixel, sample, channel) * inverse;
                        known[lane] += call.known(pixel, sample, channel) * inverse;
                    }
                }
                let integral = self.integrals.get(slot * channels + channel).copied().unwrap_or(NONE);
                let inside = self.inside.get(slot).copied().unwrap_or(NONE);
                let unit = lanes::zip(&integral, &largest, |integral, largest| Real::max(integral, largest * LEAST));
                let unit = lanes::divisor(&unit);
                let over = |value: &Eight| lanes::zip(value, &unit, |value, unit| black_box(value / unit));
                let apart = lanes::zip(&known, &integral, |known, integral| known - integral);
                let all = [over(&mean), over(&known), over(&apart)];
                let mut counts = inside;
                for l in 0..LANES {
                    let is_usual = all.iter().all(|value| Real::abs(value[l]) < MOST);
                    counts[l] = if integral[l] > 0.0 && is_usual { inside[l] } else { 0.0 };
                }
                *relative = all.map(|value| only(&counts, &value));
                sums = sums.zip(&Sums::one(relative), |sum, one| sum + one);
            }
            let sums = if self.is_joined { sums.joined() } else { sums };
            for (slot, relative) in relatives.iter().enumerate() {
                let coefficient = sums.zip(&Sums::one(relative), |sum, one| sum - one).coefficient(&sums);
                let integral = self.integrals.get(slot * channels + channel).copied().unwrap_or(NONE);
                if let Some(out) = self.coefficients.get_mut(slot * channels + channel) {
                    *out = only(&integral, &coefficient);
                }
            }
        }
        Ok(())
    }
}
