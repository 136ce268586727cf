//! Eight pixels side by side: what fits read of their samples.

use super::super::config::Config;
use super::fit::{Problem, Setting};
use super::members::Members;
use crate::basis::MAX_DIMS;
use crate::lanes::{self, LANES, Lanes};
use crate::real::Real;
use crate::rows::rows_mut;

/// The largest value of a narrow type, in units of the largest that is used.
const MOST: f64 = (1_u64 << 56) as f64;

/// Eight pixels.
pub(super) struct Panel {
    pixels: [usize; LANES],
    /// How many of them there are.
    used: usize,
}

/// Zero where a panel's places are: in unused lanes, and for pixels that are left out.
#[inline(always)]
pub(super) fn only_used<R: Real>(value: &Lanes<R>, places: &[Lanes<R>]) -> Lanes<R> {
    let ones = places.first().copied().unwrap_or([R::ZERO; LANES]);
    lanes::zip(value, &ones, |value, one| if one > R::ZERO { value } else { R::ZERO })
}

impl Problem<'_> {
    #[inline(always)]
    pub(super) fn panel(&self, members: &Members<'_>, start: usize) -> Panel {
        let used = LANES.min(members.len.saturating_sub(start));
        let mut pixels = [0; LANES];
        for (lane, pixel) in pixels.iter_mut().enumerate().take(used) {
            *pixel = members.pixel(start + lane);
        }
        Panel { pixels, used }
    }

    /// Writes sample `sample` of a panel's pixels: their columns, and their values in `units`. Zero in unused lanes,
    /// and where `places` are zero as well.
    #[inline(always)]
    pub(super) fn load<R: Real>(
        &self,
        setting: &Setting<'_, R>,
        panel: &Panel,
        sample: usize,
        places: &[Lanes<R>],
        columns: &mut [Lanes<R>],
        values: &mut [Lanes<R>],
    ) {
        let mut x = [[R::ZERO; LANES]; MAX_DIMS];
        let mut h = [[R::ZERO; LANES]; Config::MAX_CONTROLS];
        self.gather(setting, panel, sample, (&mut x, &mut h), values);
        self.expand(setting, panel, places, &x, &h, columns);
        if setting.leaves_out {
            for value in values.iter_mut() {
                *value = only_used(value, places);
            }
        }
    }

    /// Reads sample `sample` of a panel's pixels. Zero in unused lanes.
    #[inline(always)]
    fn gather<R: Real>(
        &self,
        setting: &Setting<'_, R>,
        panel: &Panel,
        sample: usize,
        (x, h): (&mut [Lanes<R>; MAX_DIMS], &mut [Lanes<R>; Config::MAX_CONTROLS]),
        values: &mut [Lanes<R>],
    ) {
        let [first, .., last] = panel.pixels;
        // Neighbours in a row, as most are.
        if panel.used == LANES && last == first + LANES - 1 && self.factors.is_empty() && self.reader.is_simple() {
            let mut f = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
            self.reader.rows(first * self.n + sample, self.n, x, &mut f);
            for ((out, f), unit) in values.iter_mut().zip(&f).zip(&setting.units) {
                *out = f.map(|f| (if R::NARROW { f.scale(-unit.exponent) } else { f }) - unit.offset);
            }
            return;
        }
        for value in values.iter_mut() {
            *value = [R::ZERO; LANES];
        }
        for (lane, &pixel) in panel.pixels.iter().enumerate().take(panel.used) {
            let sample = self.reader.get(pixel * self.n + sample);
            sample.put(lane, x, h);
            let f = self.reader.values::<f64>(&sample);
            for (channel, ((out, value), unit)) in values.iter_mut().zip(f).zip(&setting.units).enumerate() {
                let mut value = value;
                if !self.factors.is_empty() {
                    value /= self.factor(pixel, channel);
                }
                if R::NARROW {
                    // Only pixels that are left out have values far beyond the unit; their squares fit too.
                    value = libm::scalbn(value, -unit.exponent).clamp(-MOST, MOST);
                }
                if let Some(out) = out.get_mut(lane) {
                    *out = R::from_f64(value) - unit.offset;
                }
            }
        }
    }

    /// A panel's columns at positions `x` with control functions `h`. Zero in unused lanes.
    #[inline(always)]
    fn expand<R: Real>(
        &self,
        setting: &Setting<'_, R>,
        panel: &Panel,
        places: &[Lanes<R>],
        x: &[Lanes<R>; MAX_DIMS],
        h: &[Lanes<R>; Config::MAX_CONTROLS],
        columns: &mut [Lanes<R>],
    ) {
        let terms = setting.terms;
        let (fixed, rest) = columns.split_at_mut_checked(terms.fixed()).unwrap_or((&mut [], &mut []));
        for (out, place) in fixed.iter_mut().zip(places) {
            *out = *place;
        }
        let (functions, products) = rest.split_at_mut_checked(terms.functions).unwrap_or((&mut [], &mut []));
        self.reader.columns(self.basis, x, h, functions);
        if panel.used < LANES || setting.leaves_out {
            for column in functions.iter_mut() {
                *column = only_used(column, places);
            }
        }
        let (first, count) = terms.moving;
        let moving = functions.get(first..first + count).unwrap_or(&[]);
        for (products, axis) in rows_mut(products, count).zip(places.iter().skip(1)) {
            for (out, function) in products.iter_mut().zip(moving) {
                *out = lanes::zip(function, axis, |a, b| a * b);
            }
        }
    }
}
