//! How far pixels' values follow what is known of their samples, by the other pixels of their group.
//!
//! With a sample's unshadowed contribution a and A its integral over u, a pixel's mean f - beta (a - A) has the
//! integral of f for every beta that has not seen the pixel. Of the others' means, beta = sum w (f - v A) (a - A) / sum
//! w (a - A)^2 with w = 1 / A^2 and v = sum f / A over sum a / A, the share of the light that arrives: at least 0, at
//! most v, and at most 1. Where more arrives than is known, v says little.

use super::batch::Batch;
use super::products::*;
use core::hint::black_box;

/// Integrals count as at least this much of the group's largest: what else arrives would decide where they are small.
const LEAST: f32 = 0.01;
/// Values beyond so many integrals say nothing about others.
const MOST: f32 = (1_u64 << 20) as f32;
/// The least sum of known values, relative to integrals, that something can follow.
const FAINT: f32 = 1.0 / MOST;

/// Of some pixels, relative to their integrals, sums of: f; a; (a - A)^2; f (a - A); A (a - A).
type Sums = [Eight; 5];

/// Of one pixel, by its f, its a and a - A.
fn products([mean, known, apart]: &[Eight; 3]) -> Sums {
    let times = |a: &Eight| product(a, apart);
    let integral = minus(known, apart);
    [*mean, *known, times(apart), times(mean), times(&integral)]
}

fn both(a: &Sums, b: &Sums) -> Sums {
    let mut sums = *a;
    sums.iter_mut().zip(b).for_each(|(sum, b)| *sum = plus(sum, b));
    sums
}

/// In each lane, the sum of the others.
fn other_lanes(sum: &Eight) -> Eight {
    let mut others = NONE;
    for (l, out) in others.iter_mut().enumerate() {
        for (_, value) in sum.iter().enumerate().filter(|&(lane, _)| lane != l) {
            *out += value;
        }
    }
    others
}

/// The coefficient by some pixels.
fn coefficient([mean, known, square, mean_product, integral_product]: &Sums) -> Eight {
    let known_divisor = lanes::divisor(&known.map(|known| Real::max(known, FAINT)));
    let square_divisor = lanes::divisor(&square.map(|square| Real::max(square, FAINT * FAINT)));
    let mut coefficient = NONE;
    for l in 0..LANES {
        // Behind a black box, or compilers divide where nothing is, too.
        let share = black_box(mean[l] / known_divisor[l]);
        let slope = black_box((mean_product[l] - share * integral_product[l]) / square_divisor[l]);
        let follows = known[l] > FAINT && square[l] > FAINT * FAINT && slope > 0.0;
        coefficient[l] = if follows { Real::min(slope, Real::max(Real::min(share, 1.0), 0.0)) } else { 0.0 };
    }
    coefficient
}

impl Batch<'_> {
    /// Sums of each slot alone, and of all before it, if something is known.
    pub(super) fn related<'a>(&self, arena: &mut Arena<'a, f32>) -> [&'a mut [Sums]; 2] {
        let slots = if self.call.image.has_known() { self.len.saturating_mul(AT_ONCE) } else { 0 };
        [0; 2].map(|_| arena.take_lanes(slots.saturating_mul(Sums::default().len())).as_chunks_mut().0)
    }

    /// Computes the coefficient of each slot and channel.
    #[inline(always)]
    pub(super) fn relate(&mut self, arena: &mut Arena<'_, f32>) {
        let call = self.call;
        let [own, before] = self.related(&mut arena.scratch());
        let inside = self.inside.as_flattened();
        let inverse = 1.0 / call.n as f32;
        let [all_coefficients, all_integrals] = [&mut self.coefficients, &mut self.integrals].map(core::mem::take);
        let channels = rows_mut(all_coefficients, inside.len()).zip(rows_mut(all_integrals, inside.len()));
        for (channel, (coefficients, integrals)) in channels.enumerate() {
            let mut largest = NONE;
            for (slot, (inside, integral)) in inside.iter().zip(integrals.iter_mut()).enumerate() {
                let pixels = self.pixels((slot / AT_ONCE, slot % AT_ONCE));
                *integral = call.gather(call.image.known_integrals, &pixels, (1, 0), channel);
                largest = lanes::zip(&largest, &only(inside, integral), Real::max);
            }
            if self.is_joined {
                largest = [largest.into_iter().fold(0.0, Real::max); LANES];
            }
            let mut all = Sums::default();
            for (slot, (own, before)) in own.iter_mut().zip(before.iter_mut()).enumerate() {
                let inside = at(inside, slot);
                let (mut mean, mut known) = (NONE, NONE);
                let pixels = self.pixels((slot / AT_ONCE, slot % AT_ONCE));
                for sample in 0..call.n {
                    for (sum, values) in [(&mut mean, call.reader.samples.f), (&mut known, call.image.known)] {
                        let value = call.gather(values, &pixels, (call.held, sample), channel);
                        *sum = plus(sum, &value.map(|value| value * inverse));
                    }
                }
                let integral = at(integrals, slot);
                let unit = lanes::zip(&integral, &largest, |integral, largest| Real::max(integral, largest * LEAST));
                let unit = lanes::divisor(&unit);
                let values = [mean, known, minus(&known, &integral)];
                let mut counts = inside;
                for l in 0..LANES {
                    // Not the quotients, which may overflow.
                    let is_usual = values.iter().all(|value| Real::abs(value[l]) * (1.0 / MOST) < unit[l]);
                    counts[l] = if integral[l] > 0.0 && is_usual { inside[l] } else { 0.0 };
                }
                let over = |value: &Eight| lanes::zip(value, &unit, |value, unit| black_box(value / unit));
                *own = products(&values.map(|value| over(&only(&counts, &value))));
                (*before, all) = (all, both(&all, own));
            }
            // Sums of all pixels but one, without a difference: that would hold digits of the one.
            let mut others = if self.is_joined { all.map(|sum| other_lanes(&sum)) } else { Sums::default() };
            let slots = own.iter().zip(before.iter()).zip(coefficients.iter_mut().zip(integrals.iter()));
            for ((own, before), (out, integral)) in slots.rev() {
                *out = only(integral, &coefficient(&both(before, &others)));
                others = both(&others, own);
            }
        }
        (self.coefficients, self.integrals) = (all_coefficients, all_integrals);
    }
}
