//! Fits shared by neighbouring pixels (4.3.6): each pixel is corrected by a fit to the other pixels' samples.
//!
//! The estimate is mean f_p - b' mean phi_p with b from all samples of a window but the pixel's own. It needs no more
//! than one sample in each pixel, and keeps whatever stratification the samples have, within a pixel and across pixels,
//! as far as b changes slowly.
//!
//! Three estimators decide which b:
//!
//! - [`Estimator::LeaveOneOut`], or any with a fixed ridge: one ridge fit with every column. Exactly unbiased, as b
//!   never saw the pixel's own samples.
//! - [`Estimator::Robust`]: fits of rising degree and the plain mean, weighted by the variance across the pixels of
//!   their estimates. That choice is made from the same samples: unbiased as the window grows.
//! - [`Estimator::KFold`]: the same with two halves of the pixels, each weighted by what the other half's fits to
//!   itself say. Exactly unbiased, at twice the time.
//!
//! The last two leave bright pixels out of fits that explain little (`bright`). What is left out for a pixel depends on
//! its own samples in the robust estimator alone.
//!
//! "Exactly" is for pixels whose samples are independent of each other. A tile's are not; how little that does is
//! measured in the tests.

mod bright;
mod choice;
mod factor_each;
mod fit;
mod group;
mod image;
mod members;
mod one_factor;
mod panel;
mod terms;

pub use image::Image;

use super::config::{Color, Config, Estimate, Estimator, NonFinite};
use super::result::{saturate, standard_error};
use super::samples::{Reader, Samples};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::lanes::LANES;
use crate::real::Real;
use crate::rows::rows;
use fit::Problem;
use heapless::Vec;
use members::{Area, Members};

/// Numbers of workspace that [`estimate_block`] needs for `pixels` pixels of `n` samples.
///
/// # Errors
/// As for [`estimate_block`].
pub fn block_workspace_len<R: Real>(config: &Config, pixels: usize, n: usize) -> Result<usize, Error> {
    // More pixels than 32 bits count need more memory than there is.
    u32::try_from(pixels).map_err(|_| Error::Memory)?;
    image_workspace_len::<R>(config, &Image::unordered(pixels), n)
}

/// Numbers of workspace that [`estimate_image`] needs for `n` samples in each pixel.
///
/// # Errors
/// As for [`estimate_image`]; [`Error::Memory`] if no memory could be large enough.
pub fn image_workspace_len<R: Real>(config: &Config, image: &Image<'_>, n: usize) -> Result<usize, Error> {
    check_supported(config)?;
    let (shape, windows, pixels) = (config.checked_shape()?, image.windows()?, image.pixels()?);
    let fit = Problem::size(config, &shape, windows.first().axes(), windows.pixels(), n).ok_or(Error::Memory)?;
    pixels.checked_mul(sums_len(config.channels)).and_then(|sums| sums.checked_add(fit)).ok_or(Error::Memory)
}

/// Which samples count must not depend on the pixel, the fit is of the channels, and other estimators share no fits.
fn check_supported(config: &Config) -> Result<(), Error> {
    let estimator = matches!(config.estimator, Estimator::Robust | Estimator::LeaveOneOut | Estimator::KFold);
    let supported = estimator && config.color == Color::PerChannel && config.non_finite == NonFinite::Error;
    if supported { Ok(()) } else { Err(Error::Unsupported) }
}

/// Estimates the integral of each of `pixels` pixels that are alike, in no order: [`estimate_image`] for
/// [`Image::unordered`].
///
/// # Errors
/// As for [`estimate_image`].
///
/// ```
/// use noisefloor::control_variate::{Config, Samples, block_workspace_len, estimate_block};
///
/// // 32 pixels, one sample of f = u in each: the others' samples say how f varies.
/// let u: [f32; 32] = core::array::from_fn(|pixel| ((pixel * 13) % 32) as f32 / 32.0);
/// let config = Config::new(1, 1, 1);
/// let mut workspace = vec![0.0; block_workspace_len::<f64>(&config, 32, 1)?];
/// estimate_block(&config, Samples::new(&u, &u), 32, &mut workspace, |pixel, estimate| {
///     assert!((estimate.mean[0] - 0.5).abs() < 0.05, "pixel {pixel}");
/// })?;
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[inline(always)]
pub fn estimate_block<R: Real>(
    config: &Config,
    samples: Samples<'_>,
    pixels: usize,
    workspace: &mut [R],
    out: impl FnMut(usize, Estimate),
) -> Result<(), Error> {
    if pixels == 0 {
        return Err(Error::NoSamples);
    }
    estimate_image(config, &Image::unordered(pixels), samples, workspace, out)
}

/// Estimates every pixel of an image from `samples.f.len() / (pixels channels)` samples in each, pixel after pixel.
/// `out` is called once for each pixel in order, and only if all succeed.
///
/// # Errors
/// As for [`estimate`](super::estimate); [`Error::Unsupported`] also for a luminance ratio, for skipping samples and
/// for estimators other than the robust, leave-one-out and K-fold ones; [`Error::Range`] also for an image without
/// pixels, for windows that [`Image`] does not allow, for negative factors and for arrays of the wrong length;
/// [`Error::NotFinite`] for factors that are not finite.
///
/// ```
/// use noisefloor::control_variate::{Config, Image, Samples, estimate_image, image_workspace_len};
///
/// // 8 x 8 pixels, one sample of f = u + x in each.
/// let u: [f32; 64] = core::array::from_fn(|pixel| ((pixel * 29) % 64) as f32 / 64.0);
/// let f: [f32; 64] = core::array::from_fn(|pixel| u[pixel] + (pixel % 8) as f32);
/// let (config, image) = (Config::new(1, 1, 1), Image::new(8, 8));
/// let mut workspace = vec![0.0; image_workspace_len::<f64>(&config, &image, 1)?];
/// let mut pixels = [0.0; 64];
/// estimate_image(&config, &image, Samples::new(&u, &f), &mut workspace, |pixel, estimate| {
///     pixels[pixel] = estimate.mean[0];
/// })?;
/// assert!((pixels[10] - 2.5).abs() < 0.05);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[inline(always)]
pub fn estimate_image<R: Real>(
    config: &Config,
    image: &Image<'_>,
    samples: Samples<'_>,
    workspace: &mut [R],
    mut out: impl FnMut(usize, Estimate),
) -> Result<(), Error> {
    let shape = config.checked_shape()?;
    let mut basis = Basis::empty();
    basis.set(config.basis, shape)?;
    check_supported(config)?;
    let reader = Reader::new(config, samples)?;
    let (windows, pixels) = (image.windows()?, image.pixels()?);
    image.check(config)?;
    let n = reader.len() / pixels.max(1);
    if n == 0 || n * pixels != reader.len() {
        return Err(Error::Range);
    }
    reader.check()?;
    if workspace.len() < image_workspace_len::<R>(config, image, n)? {
        return Err(Error::Memory);
    }
    let mut arena = Arena::new(workspace);
    let width = sums_len(config.channels);
    let sums = arena.take(pixels * width)?;
    for value in sums.iter_mut() {
        *value = R::ZERO;
    }
    let problem = Problem { config, shape, basis: &basis, reader, n, factors: image.factors };
    let mut call = Call { problem, sums, arena };
    windows.each().try_for_each(|area| call.window(area, image.surfaces))?;
    // Eight at a time: what was just written number by number is slow to read as a whole.
    let samples = u32::try_from(n).unwrap_or(u32::MAX);
    let mut batch = [Estimate { mean: [0.0; 4], std_error: [0.0; 4], samples, gain: 1.0 }; LANES];
    let mut rest = rows(call.sums, width);
    for start in (0..pixels).step_by(LANES) {
        let mut pixel = start;
        for (estimate, sums) in batch.iter_mut().zip(rest.by_ref()) {
            call.problem.finish(pixel, sums, estimate);
            pixel += 1;
        }
        for (pixel, estimate) in (start..pixel).zip(&batch) {
            out(pixel, *estimate);
        }
    }
    Ok(())
}

/// Numbers that are summed for each pixel over the groups that it was in: their weight, that of those with an error,
/// their gain, and for each channel the correction and what the standard error comes from.
fn sums_len(channels: usize) -> usize {
    COMMON + 2 * channels
}

/// Sums that are not a channel's.
const COMMON: usize = 3;

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
        let surface = |index: &u16| surfaces.get(area.pixel(usize::from(*index))).copied().unwrap_or(0);
        let mut left: Vec<u16, { Image::MAX_WINDOW }> = Vec::new();
        if !surfaces.is_empty() {
            // A window with surfaces has no more pixels than that.
            (0..pixels as u16).for_each(|index| left.push(index).unwrap_or(()));
        }
        let mut list: Vec<u16, { Image::MAX_WINDOW }> = Vec::new();
        // One loop, with surfaces or without, as each call of `group` is a copy of it.
        loop {
            let first = left.first().map(surface);
            if let Some(first) = first {
                list.clear();
                let same = left.iter().copied().filter(|index| surface(index) == first);
                same.for_each(|index| list.push(index).unwrap_or(()));
                left.retain(|index| surface(index) != first);
            }
            let (list, len) = if first.is_some() { (Some(list.as_slice()), list.len()) } else { (None, pixels) };
            self.group(&Members { area, list, first: 0, step: 1, len })?;
            if left.is_empty() {
                return Ok(());
            }
        }
    }
}

impl Problem<'_> {
    /// Whether the standard error is that of the block's estimates, instead of the pixel's plain mean times the root of
    /// the gain: one sample has none, and stratified samples a smaller one than they seem to.
    fn error_is_the_blocks(&self) -> bool {
        self.n == 1 || self.config.stratified
    }

    /// The estimate of a pixel.
    #[inline(always)]
    fn finish<R: Real>(&self, pixel: usize, sums: &[R], estimate: &mut Estimate) {
        let (common, each) = sums.split_at_checked(COMMON).unwrap_or((&[], &[]));
        let at = |sums: &[R], index: usize| sums.get(index).map_or(0.0, |value| value.to_f64());
        let [weight, error_weight, gain] = [0, 1, 2].map(|index| at(common, index));
        // Without a weight all sums are zero.
        let (inverse, error_inverse) = (1.0 / weight.or_one(), 1.0 / error_weight.or_one());
        estimate.gain = if weight > 0.0 { (gain * inverse) as f32 } else { 1.0 };
        let outputs = estimate.mean.iter_mut().zip(&mut estimate.std_error);
        for (channel, (mean, error)) in outputs.enumerate().take(self.config.channels) {
            let correction = at(each, 2 * channel) * inverse;
            let spread = at(each, 2 * channel + 1) * error_inverse;
            let value = |sample: usize| self.reader.value(pixel * self.n + sample, channel);
            let first = value(0);
            let (mut total, mut square) = (0.0, 0.0);
            for sample in 1..self.n {
                let value = value(sample) - first;
                total += value;
                square += value * value;
            }
            let n = self.n as f64;
            let plain = if self.n > 1 { first + total / n } else { first };
            // In no group there is no correction; nor is one that left the type's range.
            *mean = saturate(if correction.is_finite() { plain + correction } else { plain });
            let told = if error_weight > 0.0 && self.error_is_the_blocks() {
                spread
            } else if self.n > 1 {
                let plain = libm::sqrt((square - total * total / n).max(0.0) / (n * (n - 1.0)));
                if error_weight > 0.0 { plain * spread } else { plain }
            } else {
                f64::INFINITY
            };
            *error = standard_error(told);
        }
    }
}
