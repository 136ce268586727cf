//! What the caller hands over: positions, values, and control functions at those positions.

use super::config::{Color, Config, NonFinite};
use super::folds::Subset;
use super::per_channel::PerChannel;
use crate::basis::{Basis, MAX_DIMS};
use crate::error::{Error, ensure};
use crate::lanes::{LANES, Lanes};
use crate::matrix::{first, from, halves_mut, row_at};
use crate::real::Real;
use core::ops::Range;

/// Rec. 709 luminance of linear RGB.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// `n` samples in caller arrays.
#[derive(Clone, Copy, Debug, Default)]
pub struct Samples<'a> {
    /// Positions in [0, 1], `n` rows of `Config::stride` numbers (`Config::dims` if that is 0); the last row may end
    /// after `dims` numbers.
    pub u: &'a [f32],
    /// Integrand over density, `n` rows of `Config::channels` numbers.
    pub f: &'a [f32],
    /// Control functions (4.18) at the positions, `n` rows of `Config::controls` numbers. Empty without any.
    pub controls: &'a [f32],
    /// The exact integral of each control function.
    pub control_integrals: &'a [f32],
}

impl<'a> Samples<'a> {
    /// Samples without control functions.
    #[inline]
    pub const fn new(u: &'a [f32], f: &'a [f32]) -> Self {
        Self { u, f, controls: &[], control_integrals: &[] }
    }

    /// Checks the arrays' lengths and every number that is read.
    ///
    /// # Errors
    /// What [`estimate`](super::estimate) says of its samples.
    pub fn check(&self, config: &Config) -> Result<(), Error> {
        Reader::new(config, *self)?.check()
    }
}

/// Samples whose lengths were checked, read one at a time.
#[derive(Clone, Copy, Default)]
pub(crate) struct Reader<'a> {
    pub(crate) samples: Samples<'a>,
    n: usize,
    dims: usize,
    stride: usize,
    inputs: usize,
    controls: usize,
    luminance: bool,
    skip: bool,
}

pub(crate) struct Sample<'a> {
    u: &'a [f32],
    f: &'a [f32],
    h: &'a [f32],
}

impl<'a> Reader<'a> {
    /// # Errors
    /// [`Error::Length`] if the arrays' lengths do not belong together, [`Error::NoSamples`] if they are empty,
    /// [`Error::Range`] if there are more than 32 bits count.
    pub(crate) fn new(config: &Config, samples: Samples<'a>) -> Result<Self, Error> {
        let n = samples.f.len().checked_div(config.channels).unwrap_or(0);
        ensure(n > 0 || !samples.f.is_empty(), Error::NoSamples)?;
        let stride = config.step();
        // The last row may end early: all but one need a whole stride.
        let needed = (n.max(1) - 1).checked_mul(stride).and_then(|len| len.checked_add(config.dims));
        let lengths_fit = samples.f.len() == n * config.channels
            && needed.is_some_and(|needed| samples.u.len() >= needed)
            && samples.u.len() <= n.saturating_mul(stride)
            && samples.controls.len() == n.saturating_mul(config.controls)
            && samples.control_integrals.len() == config.controls;
        ensure(lengths_fit, Error::Length)?;
        ensure(u32::try_from(n).is_ok(), Error::Range)?;
        ensure(samples.control_integrals.iter().all(|value| value.is_finite()), Error::NotFinite)?;
        Ok(Self {
            samples,
            n,
            dims: config.dims,
            stride,
            inputs: config.channels,
            controls: config.controls,
            luminance: config.color == Color::LuminanceRatio,
            skip: config.non_finite == NonFinite::Skip,
        })
    }

    /// Some of the samples, one after another.
    pub(crate) fn part(&self, samples: Range<usize>) -> Self {
        let rows = |values: &'a [f32], width: usize| {
            let rest = from(values, samples.start * width);
            // The last row of `u` may end early.
            first(rest, rest.len().min(samples.len() * width))
        };
        let Samples { u, f, controls, control_integrals } = self.samples;
        let (u, f, controls) = (rows(u, self.stride), rows(f, self.inputs), rows(controls, self.controls));
        Self { samples: Samples { u, f, controls, control_integrals }, n: samples.len(), ..*self }
    }

    /// How many samples the arrays hold.
    pub(crate) fn len(&self) -> usize {
        self.n
    }

    /// How many values of a sample are regressed.
    pub(crate) fn channels(&self) -> usize {
        if self.luminance { 1 } else { self.inputs }
    }

    /// Sample `index`, whatever it holds.
    pub(crate) fn get(&self, index: usize) -> Sample<'a> {
        let start = index * self.stride;
        Sample {
            u: first(from(self.samples.u, start), self.dims),
            f: row_at(self.samples.f, self.inputs, index),
            h: row_at(self.samples.controls, self.controls, index),
        }
    }

    /// Checks every sample. After this, all samples that [`Reader::is_used`] accepts are finite and in range.
    pub(crate) fn check(&self) -> Result<(), Error> {
        // Branch-free over the values: one flag for everything, and the reason is looked for only if it is down.
        let mut fine = true;
        if self.stride == self.dims {
            for &u in self.samples.u {
                fine &= (0.0..=1.0).contains(&u);
            }
        } else {
            for index in 0..self.n {
                for u in self.get(index).u {
                    fine &= (0.0..=1.0).contains(u);
                }
            }
        }
        for values in [self.samples.f, self.samples.controls] {
            for value in values {
                fine &= value.is_finite();
            }
        }
        if fine { Ok(()) } else { self.explain() }
    }

    #[cold]
    #[inline(never)]
    fn explain(&self) -> Result<(), Error> {
        (0..self.n)
            .map(|index| self.get(index))
            .filter(|sample| !self.skip || sample.is_finite())
            .try_for_each(|sample| sample.check())
    }

    /// Whether sample `index` of the subset counts.
    fn is_used(&self, index: usize, subset: Subset) -> bool {
        subset.contains(index) && (!self.skip || self.get(index).is_finite())
    }

    /// Calls `visit` with each used sample in order and returns their number.
    pub(crate) fn each(&self, subset: Subset, mut visit: impl FnMut(&Sample<'a>)) -> usize {
        let mut used = 0;
        for index in 0..self.n {
            if self.is_used(index, subset) {
                visit(&self.get(index));
                used += 1;
            }
        }
        used
    }

    /// The first used sample.
    pub(crate) fn first(&self, subset: Subset) -> Option<Sample<'a>> {
        (0..self.n).find(|&index| self.is_used(index, subset)).map(|index| self.get(index))
    }

    /// Reads up to `LANES` used samples from index `next` on, and returns how many there were.
    // As `Design::load`: without, estimates of one pixel take 3 to 7 % more instructions, image fits 3 %.
    #[inline(always)]
    pub(crate) fn panel<R: Real>(
        &self,
        subset: Subset,
        next: &mut usize,
        x: &mut [Lanes<R>; MAX_DIMS],
        h: &mut [Lanes<R>; Config::MAX_CONTROLS],
        f: &mut [Lanes<R>; Config::MAX_CHANNELS],
    ) -> usize {
        // Samples that are positions and values, all of which count.
        let is_simple = subset.is_all() && !self.skip && !self.luminance && self.controls == 0;
        if is_simple && self.n - *next >= LANES {
            transpose(from(self.samples.u, *next * self.stride), self.stride, self.dims, x);
            transpose(from(self.samples.f, *next * self.inputs), self.inputs, self.inputs, f);
            *next += LANES;
            return LANES;
        }
        let mut lane = 0;
        while lane < LANES && *next < self.n {
            let index = *next;
            *next += 1;
            if self.is_used(index, subset) {
                let sample = self.get(index);
                sample.put(lane, x, h);
                for (f, value) in f.iter_mut().zip(self.values::<R>(&sample).0) {
                    f[lane % LANES] = value;
                }
                lane += 1;
            }
        }
        lane
    }

    /// The values of a sample that are regressed: its channels, or its luminance.
    pub(crate) fn values<R: Real>(&self, sample: &Sample<'_>) -> PerChannel<R> {
        let mut values = PerChannel::default();
        if self.luminance {
            values[0] = R::from(luminance(sample.f));
        } else {
            for (value, &f) in values.0.iter_mut().zip(sample.f) {
                *value = R::from(f);
            }
        }
        values
    }

    /// Writes the positions of samples from each `first` on to the lanes from `lane` on, a group of lanes for each
    /// step.
    pub(crate) fn put_positions<R: Real, const L: usize>(
        &self,
        first: &[usize; LANES],
        count: usize,
        lane: usize,
        x: &mut [Lanes<R, L>; MAX_DIMS],
    ) {
        for (own, first) in first.iter().enumerate() {
            let mut rows = from(self.samples.u, first * self.stride);
            // Four at a time, without a look for each whether it is there.
            if let (2, 2, 4, Some(next)) = (self.dims, self.stride, count, rows.first_chunk::<8>()) {
                for (step, &[a, b]) in next.as_chunks().0.iter().enumerate() {
                    let lane = lane + step * LANES + own;
                    [x[0][lane % L], x[1][lane % L]] = [a, b].map(R::from);
                }
                continue;
            }
            for step in 0..count {
                let lane = lane + step * LANES + own;
                match (self.dims, rows) {
                    (2, &[a, b, ..]) => [x[0][lane % L], x[1][lane % L]] = [a, b].map(R::from),
                    (3, &[a, b, c, ..]) => {
                        [x[0][lane % L], x[1][lane % L], x[2][lane % L]] = [a, b, c].map(R::from);
                    }
                    _ => x.iter_mut().zip(rows).take(self.dims).for_each(|(x, &u)| x[lane % L] = R::from(u)),
                }
                rows = from(rows, self.stride);
            }
        }
    }

    /// Evaluates control functions and basis at `L` positions; `x` has a group of lanes for each coordinate, `h` one
    /// for each control function, and `out` one for each column, control functions first.
    #[inline(always)]
    pub(crate) fn columns<R: Real, const L: usize>(
        &self,
        basis: &Basis,
        x: &[Lanes<R, L>; MAX_DIMS],
        h: &[Lanes<R, L>; Config::MAX_CONTROLS],
        out: &mut [Lanes<R, L>],
    ) {
        let (controls, functions) = halves_mut(out, self.controls);
        for ((out, h), &integral) in controls.iter_mut().zip(h).zip(self.samples.control_integrals) {
            *out = h.map(|h| h - R::from(integral));
        }
        basis.evaluate(x, functions);
    }

    /// For a luminance-ratio estimate, a sample's colour and its luminance.
    pub(crate) fn colour(&self, sample: &Sample<'_>) -> Option<PerChannel<f64>> {
        match (self.luminance, sample.f) {
            (true, &[red, green, blue]) => Some(PerChannel([red, green, blue, luminance(sample.f)].map(f64::from))),
            _ => None,
        }
    }

    /// For a luminance-ratio estimate, the mean colour of the used samples and its luminance.
    pub(crate) fn mean_colour(&self) -> Option<PerChannel<f64>> {
        if !self.luminance {
            return None;
        }
        let mut sums = PerChannel::default();
        let used = self.each(Subset::ALL, |sample| sums += self.colour(sample).unwrap_or_default());
        Some(sums.map(|sum| sum / used.max(1) as f64))
    }
}

impl<'a> Sample<'a> {
    /// Without control functions.
    pub(crate) fn new(u: &'a [f32], f: &'a [f32]) -> Self {
        Self { u, f, h: &[] }
    }

    fn is_finite(&self) -> bool {
        [self.u, self.f, self.h].iter().all(|values| values.iter().all(|value| value.is_finite()))
    }

    /// # Errors
    /// [`Error::NotFinite`], or [`Error::Range`] for a position outside [0, 1].
    pub(crate) fn check(&self) -> Result<(), Error> {
        ensure(self.is_finite(), Error::NotFinite)?;
        ensure(self.u.iter().all(|u| (0.0..=1.0).contains(u)), Error::Range)
    }

    /// Writes the position and the control functions to lane `lane`.
    pub(crate) fn put<R: Real, const L: usize>(
        &self,
        lane: usize,
        x: &mut [Lanes<R, L>; MAX_DIMS],
        h: &mut [Lanes<R, L>; Config::MAX_CONTROLS],
    ) {
        for (x, &u) in x.iter_mut().zip(self.u) {
            x[lane % L] = R::from(u);
        }
        for (h, &value) in h.iter_mut().zip(self.h) {
            h[lane % L] = R::from(value);
        }
    }
}

/// The first `width` numbers of each of eight rows, `stride` apart, as groups of lanes.
#[inline(always)]
fn transpose<R: Real>(rows: &[f32], stride: usize, width: usize, out: &mut [Lanes<R>]) {
    match width {
        1 => transpose_exact::<R, 1>(rows, stride, out),
        2 => transpose_exact::<R, 2>(rows, stride, out),
        3 => transpose_exact::<R, 3>(rows, stride, out),
        _ => {
            for lane in 0..LANES {
                let row = from(rows, lane * stride);
                for (out, &value) in out.iter_mut().zip(row).take(width) {
                    out[lane] = R::from(value);
                }
            }
        }
    }
}

#[inline(always)]
fn transpose_exact<R: Real, const WIDTH: usize>(rows: &[f32], stride: usize, out: &mut [Lanes<R>]) {
    let Some(out) = out.first_chunk_mut::<WIDTH>() else { return };
    let mut columns = [[R::ZERO; LANES]; WIDTH];
    for lane in 0..LANES {
        if let Some(row) = rows.get(lane * stride..).and_then(<[f32]>::first_chunk::<WIDTH>) {
            for (column, &value) in columns.iter_mut().zip(row) {
                column[lane] = R::from(value);
            }
        }
    }
    *out = columns;
}

/// Rec. 709 luminance, rounded once.
fn luminance(rgb: &[f32]) -> f32 {
    let sum: f64 = rgb.iter().zip(LUMINANCE).map(|(&c, weight)| f64::from(c) * weight).sum();
    sum as f32
}
