//! Fits shared by neighbouring pixels (4.3.6): each pixel is corrected by a fit to the other pixels' samples.
//!
//! The estimate is mean f_p - b' mean phi_p with b from all samples of a window but the pixel's own. It needs no more
//! than one sample in each pixel, and keeps whatever stratification the samples have, within a pixel and across pixels,
//! as far as b changes slowly.
//!
//! Three estimators decide which b:
//!
//! - [`Estimator::LeaveOneOut`], or any with a fixed ridge: one ridge fit with every column. Exactly unbiased, as b never
//!   saw the pixel's own samples.
//! - [`Estimator::Robust`]: fits of rising degree and the plain mean, weighted by the variance across the pixels of their
//!   estimates. That choice is made from the same samples: unbiased as the window grows.
//! - [`Estimator::KFold`]: the same with two halves of the pixels, each weighted by what the other half's fits to itself
//!   say. Exactly unbiased, at twice the time.
//!
//! "Exactly" is for pixels whose samples are independent of each other. A tile's are not; how little that does is
//! measured in the tests.

mod choice;
mod fit;
mod image;
mod members;
mod terms;

pub use image::Image;

use super::config::{Color, Config, Estimate, Estimator, NonFinite, Ridge};
use super::per_channel::get;
use super::result::saturate;
use super::samples::{Reader, Samples};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::real::Real;
use crate::rows::{rows, rows_mut};
use choice::Weights;
use fit::{Group, Problem};
use heapless::Vec;
use members::{Area, Members};

/// Numbers of workspace that [`estimate_block`] needs for `pixels` pixels of `n` samples.
///
/// # Errors
/// As for [`estimate_block`].
pub fn block_workspace_len<R: Real>(config: &Config, pixels: usize, n: usize) -> Result<usize, Error> {
    workspace_len(config, 0, pixels, pixels, n)
}

/// Numbers of workspace that [`estimate_image`] needs for `n` samples in each pixel.
///
/// # Errors
/// As for [`estimate_image`].
pub fn image_workspace_len<R: Real>(config: &Config, image: &Image<'_>, n: usize) -> Result<usize, Error> {
    let windows = image.windows()?;
    workspace_len(config, windows.first().axes(), windows.pixels(), image.pixels()?, n)
}

fn workspace_len(config: &Config, axes: usize, window: usize, pixels: usize, n: usize) -> Result<usize, Error> {
    check_supported(config)?;
    let mut basis = Basis::empty();
    basis.set(config.basis, config.checked_shape()?)?;
    let fit = Problem::size(config, &basis, axes, window, n).ok_or(Error::Memory)?;
    pixels.checked_mul(sums_len(config.channels)).and_then(|sums| sums.checked_add(fit)).ok_or(Error::Memory)
}

/// Which samples count must not depend on the pixel, the fit is of the channels, and other estimators share no fits.
fn check_supported(config: &Config) -> Result<(), Error> {
    let estimator = matches!(config.estimator, Estimator::Robust | Estimator::LeaveOneOut | Estimator::KFold);
    let supported = estimator && config.color == Color::PerChannel && config.non_finite == NonFinite::Error;
    if supported { Ok(()) } else { Err(Error::Unsupported) }
}

/// Estimates the integral of each of `pixels` pixels that are alike, in no order, all with
/// `samples.f.len() / (pixels channels)` samples, pixel after pixel. `out` is called once for each pixel in order, and
/// only if all succeed.
///
/// # Errors
/// As for [`estimate`](super::estimate); [`Error::Unsupported`] for a luminance ratio, for skipping samples, and for
/// estimators other than the robust, leave-one-out and K-fold ones.
#[inline(always)]
pub fn estimate_block<R: Real>(
    config: &Config,
    samples: Samples<'_>,
    pixels: usize,
    workspace: &mut [R],
    out: impl FnMut(usize, Estimate),
) -> Result<(), Error> {
    let len = |n| block_workspace_len::<R>(config, pixels, n);
    let shared = |call: &mut Call<'_, '_, R>| {
        let members = Members { area: None, list: None, first: 0, step: 1, len: pixels };
        call.group(&members, |_| R::ONE)
    };
    let request = Request { config, samples, pixels, factors: &[] };
    request.run(workspace, len, shared, out)
}

/// Estimates every pixel of an image from `samples.f.len() / (pixels channels)` samples in each, pixel after pixel. `out`
/// is called once for each pixel in order, and only if all succeed.
///
/// # Errors
/// As for [`estimate_block`]; [`Error::Range`] also for an image without pixels, for windows that [`Image`] does not
/// allow, and for negative factors or arrays of the wrong length, [`Error::NotFinite`] for factors that are not finite.
#[inline(always)]
pub fn estimate_image<R: Real>(
    config: &Config,
    image: &Image<'_>,
    samples: Samples<'_>,
    workspace: &mut [R],
    out: impl FnMut(usize, Estimate),
) -> Result<(), Error> {
    let windows = image.windows()?;
    image.check(config)?;
    let len = |n| image_workspace_len::<R>(config, image, n);
    let shared = |call: &mut Call<'_, '_, R>| windows.each().try_for_each(|area| call.window(area, image.surfaces));
    let request = Request { config, samples, pixels: image.pixels()?, factors: image.factors };
    request.run(workspace, len, shared, out)
}

/// What a caller asks for.
struct Request<'c> {
    config: &'c Config,
    samples: Samples<'c>,
    pixels: usize,
    factors: &'c [f32],
}

impl Request<'_> {
    /// Checks everything, lets `shared` add up corrections, and reports each pixel.
    #[inline(always)]
    fn run<'a, R: Real>(
        &self,
        workspace: &'a mut [R],
        len: impl FnOnce(usize) -> Result<usize, Error>,
        shared: impl FnOnce(&mut Call<'_, 'a, R>) -> Result<(), Error>,
        mut out: impl FnMut(usize, Estimate),
    ) -> Result<(), Error> {
        let Self { config, samples, pixels, factors } = *self;
        let mut basis = Basis::empty();
        basis.set(config.basis, config.checked_shape()?)?;
        check_supported(config)?;
        let reader = Reader::new(config, samples)?;
        let n = reader.len().checked_div(pixels).ok_or(Error::NoSamples)?;
        if n * pixels != reader.len() {
            return Err(Error::Range);
        }
        reader.check()?;
        if workspace.len() < len(n)? {
            return Err(Error::Memory);
        }
        let mut arena = Arena::new(workspace);
        let width = sums_len(config.channels);
        let sums = arena.take(pixels * width)?;
        for value in sums.iter_mut() {
            *value = R::ZERO;
        }
        let problem = Problem { config, basis: &basis, reader, n, factors };
        let mut call = Call { problem, sums, arena };
        shared(&mut call)?;
        for (pixel, sums) in rows(call.sums, width).enumerate() {
            out(pixel, call.problem.pixel(pixel, sums));
        }
        Ok(())
    }
}

/// Numbers that are summed for each pixel: over the groups that it was in, their weight and gain, and for each channel its
/// correction and what its standard error comes from.
fn sums_len(channels: usize) -> usize {
    2 + 2 * channels
}

/// A call under way.
struct Call<'c, 'a, R> {
    problem: Problem<'c>,
    sums: &'a mut [R],
    arena: Arena<'a, R>,
}

impl<R: Real> Call<'_, '_, R> {
    /// All groups of a window.
    #[inline(always)]
    fn window(&mut self, area: Area, surfaces: &[u32]) -> Result<(), Error> {
        let pixels = area.pixels();
        let near = |index: usize| area.nearness(index);
        if surfaces.is_empty() {
            return self.group(&Members { area: Some(area), list: None, first: 0, step: 1, len: pixels }, near);
        }
        let surface = |index: &u16| surfaces.get(area.pixel(usize::from(*index))).copied().unwrap_or(0);
        let mut left: Vec<u16, { Image::MAX_WINDOW }> = (0..pixels as u16).collect();
        let mut list: Vec<u16, { Image::MAX_WINDOW }> = Vec::new();
        while let Some(first) = left.first().map(surface) {
            list.clear();
            list.extend(left.iter().copied().filter(|index| surface(index) == first));
            left.retain(|index| surface(index) != first);
            let members = Members { area: Some(area), list: Some(&list), first: 0, step: 1, len: list.len() };
            self.group(&members, near)?;
        }
        Ok(())
    }

    /// Fits a group and adds its pixels' corrections, times their weight.
    #[inline(always)]
    fn group(&mut self, members: &Members<'_>, near: impl Fn(usize) -> R) -> Result<(), Error> {
        let terms = self.problem.terms(members);
        if members.len < 2 || terms.ends.is_empty() {
            return Ok(());
        }
        if self.problem.config.estimator == Estimator::KFold && !matches!(self.problem.config.ridge, Ridge::Fixed(_)) {
            let [even, odd] = [0, 1].map(|first| members.half(first));
            if odd.len < 2 {
                return Ok(());
            }
            let mut weights = [Weights::default(); 2];
            for (half, weights) in [odd, even].iter().zip(&mut weights) {
                let group = self.problem.fit(half, &terms, &mut self.arena.scratch())?;
                *weights = self.problem.weights(&group);
            }
            let group = self.problem.fit(members, &terms, &mut self.arena.scratch())?;
            let [for_even, for_odd] = &weights;
            self.problem.add(members, &group, |index| if index % 2 == 0 { for_even } else { for_odd }, near, self.sums);
            return Ok(());
        }
        let group = self.problem.fit(members, &terms, &mut self.arena.scratch())?;
        let weights = self.problem.weights(&group);
        self.problem.add(members, &group, |_| &weights, near, self.sums);
        Ok(())
    }
}

impl Problem<'_> {
    /// Adds a group's corrections to its pixels' sums.
    #[inline(always)]
    fn add<'w, R: Real>(
        &self,
        members: &Members<'_>,
        group: &Group<'_, R>,
        weights: impl Fn(usize) -> &'w Weights<R>,
        near: impl Fn(usize) -> R,
        sums: &mut [R],
    ) {
        let channels = self.config.channels;
        let width = sums_len(channels);
        let from_block = self.error_is_the_blocks();
        for index in 0..members.len {
            let (pixel, weights) = (members.pixel(index), weights(index));
            let Some(sums) = sums.get_mut(pixel * width..(pixel + 1) * width) else { continue };
            let near = near(members.local(index));
            let (common, each) = sums.split_at_mut_checked(2).unwrap_or((&mut [], &mut []));
            let mut gain = R::ZERO;
            for (channel, each) in rows_mut(each, 2).enumerate() {
                let Some(unit) = group.units.get(channel) else { continue };
                let factor = R::from_f64(self.factor(pixel, channel));
                // Values of an `f32` over a small factor may be beyond any `f32`, and two infinities cancel to NaN.
                let most = f64::from(f32::MAX);
                let correction = libm::scalbn(group.correction(index, weights, channel).to_f64(), unit.exponent);
                let correction = R::from_f64((correction * self.factor(pixel, channel)).clamp(-most, most));
                let ratio = group.spreads.gain(weights, channel);
                let error = if from_block {
                    let variance = group.spreads.variance(weights, channel).unwrap_or(R::INFINITY);
                    variance.sqrt().scale(unit.exponent) * factor
                } else {
                    ratio.sqrt()
                };
                gain += ratio;
                for (sum, value) in each.iter_mut().zip([correction, error]) {
                    *sum += near * value;
                }
            }
            for (sum, value) in common.iter_mut().zip([R::ONE, gain / R::from_usize(channels)]) {
                *sum += near * value;
            }
        }
    }

    /// Whether the standard error is that of the block's estimates, instead of the pixel's plain mean times the root of
    /// the gain: one sample has none, and stratified samples a smaller one than they seem to.
    fn error_is_the_blocks(&self) -> bool {
        self.n == 1 || self.config.stratified
    }

    /// The estimate of a pixel.
    fn pixel<R: Real>(&self, pixel: usize, sums: &[R]) -> Estimate {
        let n = self.n as f64;
        let (mut total, mut squares) = ([0.0f64; Config::MAX_CHANNELS], [0.0f64; Config::MAX_CHANNELS]);
        let first = self.reader.values::<f64>(&self.reader.get(pixel * self.n));
        for sample in 0..self.n {
            let values = self.reader.values::<f64>(&self.reader.get(pixel * self.n + sample));
            for (((total, square), value), first) in total.iter_mut().zip(&mut squares).zip(values).zip(first) {
                *total += value - first;
                *square += (value - first) * (value - first);
            }
        }
        let (common, each) = sums.split_at_checked(2).unwrap_or((&[], &[]));
        let [weight, gain] = [0, 1].map(|index| common.get(index).map_or(0.0, |value| value.to_f64()));
        let mean_of = |sum: f64, otherwise: f64| if weight > 0.0 { sum / weight } else { otherwise };
        let mut estimate = Estimate {
            mean: [0.0; 4],
            std_error: [0.0; 4],
            samples: u32::try_from(self.n).unwrap_or(u32::MAX),
            gain: mean_of(gain, 1.0) as f32,
        };
        let outputs = estimate.mean.iter_mut().zip(&mut estimate.std_error);
        for (channel, (mean, error)) in outputs.enumerate().take(self.config.channels) {
            let each = [2 * channel, 2 * channel + 1].map(|index| each.get(index).map_or(0.0, |value| value.to_f64()));
            let [correction, spread] = each;
            let (total, square) = (get(&total, channel), get(&squares, channel));
            *mean = saturate(get(&first, channel) + total / n + mean_of(correction, 0.0));
            let plain = ((square - total * total / n).max(0.0) / (n * (n - 1.0))).max(0.0);
            let plain = if self.n > 1 { libm::sqrt(plain) } else { f64::INFINITY };
            let spread = mean_of(spread, 1.0);
            *error = (if weight > 0.0 && self.error_is_the_blocks() { spread } else { plain * spread }) as f32;
        }
        estimate
    }
}
