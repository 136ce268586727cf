//! Fits shared by neighbouring pixels (section 4.3.6): each pixel is corrected by a fit to the other pixels' samples.
//!
//! The estimate is mean f_p - b' mean phi_p with b from all samples of a window but the pixel's own. It needs no more
//! than one sample in each pixel, and keeps whatever stratification the samples have, within a pixel and across pixels,
//! as far as b changes slowly. One sample is left out of its fit in closed form. With several in each pixel the pixels
//! have four colours, as 2 x 2 squares do, and each colour is corrected by a fit to the other three, in which a
//! pixel's mean counts as far as noise, and not texture, sets it apart (`Fits::weigh`).
//!
//! Three estimators decide which b:
//!
//! - [`Estimator::LeaveOneOut`], or any with a fixed ridge: one ridge fit with every column. Exactly unbiased, as b
//!   never saw the pixel's own samples. With [`Image::known`] only the first is: it then fits nothing else.
//! - [`Estimator::Robust`]: fits of rising degree and the plain mean, weighted by the variance of their estimates
//!   across the pixels and, with several samples, by what they leave of the variance within pixels that they have not
//!   seen. The choice has seen the pixel's own samples, though they count less: unbiased as the window grows.
//! - [`Estimator::KFold`]: the same with two halves of the pixels, each weighted by what the other half's fits to
//!   itself say. Exactly unbiased, at up to 1.6 times the time.
//!
//! The last two leave bright pixels out of fits that explain little (`bright`). What is left out for a pixel depends on
//! its own samples in the robust estimator alone.
//!
//! "Exactly" is for pixels whose samples are independent of each other. A tile's are not; how little that does is
//! measured in the tests.
//!
//! Groups of pixels, one for each surface of a window, are sorted by size, and eight are worked on side by side in the
//! lanes of vector registers. All is computed in `f32`: sums are of a window's samples, and the ridge keeps condition
//! numbers far from its end.

mod batch;
mod bright;
mod call;
mod choice;
mod edges;
mod fit;
mod groups;
mod known;
mod load;
mod passes;
mod pixels;
mod products;
mod read;
mod seen;
mod several;
mod sliced;
mod slices;
mod steps;
mod sums;
mod terms;

pub use pixels::{Image, Rectangle};

use super::config::{Color, Config, Estimate, Estimator, NonFinite, Solver};
use super::samples::{Reader, Samples};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::{Error, ensure};
use crate::lanes::LANES;
use crate::processor::{Portable, Processor};
use batch::Batch;
use call::Call;
use choice::{Choices, Room, Shares};
use edges::Edges;
use fit::Fits;
use groups::Group;
use load::Loading;
use sums::Band;
use terms::Terms;

/// Numbers of workspace that [`estimate_image`] needs for `n` samples in each pixel, or for `image.samples` of them.
///
/// # Errors
/// As for [`estimate_image`]; [`Error::Range`] also if no memory could be large enough.
pub fn image_workspace_len(config: &Config, image: &Image<'_>, n: usize) -> Result<usize, Error> {
    let basis = Basis::empty();
    let call = Call::new(config, image, &basis)?;
    Call { n: image.used(n)?, held: n, ..call }.workspace_len().ok_or(Error::Range)
}

/// Which samples count must not depend on the pixel, the fit is of the channels, and other estimators share no fits.
fn check_supported(config: &Config, image: &Image<'_>) -> Result<(), Error> {
    let estimator = matches!(config.estimator, Estimator::Robust | Estimator::LeaveOneOut | Estimator::KFold);
    // Halves that choose for each other would have to know nothing of each other's samples.
    let is_halved = config.estimator == Estimator::KFold && image.has_known();
    let solver = matches!(config.solver, Solver::Auto | Solver::NormalEquations);
    let samples = config.color == Color::PerChannel && config.non_finite == NonFinite::Error && config.controls == 0;
    ensure(estimator && !is_halved && solver && samples, Error::Unsupported)
}

/// Estimates every pixel of an image from `samples.f.len() / (pixels channels)` samples in each, pixel after pixel.
/// `out` is called once for each pixel that is wanted, and only if all succeed.
///
/// # Errors
/// As for [`estimate`](super::estimate), of up to `u32::MAX` samples; [`Error::Unsupported`] also for a luminance
/// ratio, for skipping samples, for control functions, for estimators other than the robust, leave-one-out and K-fold
/// ones, for the last if something is known, and for solvers other than `Auto` and the normal equations;
/// [`Error::Range`] also for an image without pixels or with more than [`Image::MAX_PIXELS`], for windows and parts
/// that [`Image`] does not allow, for more samples than there are, for negative factors or integrals, and where only
/// one of `known` and its integrals is there; [`Error::Length`] also for arrays of [`Image`]; [`Error::NotFinite`] for
/// factors, for what is known and for integrals that are not finite. Of pixels that are not needed no number is looked
/// at.
///
/// ```
/// use noisefloor::control_variate::{Config, Image, Samples, estimate_image, image_workspace_len};
///
/// // 8 x 8 pixels, one sample of f = u + x in each.
/// let u: [f32; 64] = core::array::from_fn(|pixel| ((pixel * 29) % 64) as f32 / 64.0);
/// let f: [f32; 64] = core::array::from_fn(|pixel| u[pixel] + (pixel % 8) as f32);
/// let (config, image) = (Config::new(1, 1, 1), Image::new(8, 8));
/// let mut workspace = vec![0.0; image_workspace_len(&config, &image, 1)?];
/// let mut pixels = [0.0; 64];
/// estimate_image(&config, &image, Samples::new(&u, &f), &mut workspace, &mut |pixel, estimate| {
///     pixels[pixel] = estimate.mean[0];
/// })?;
/// assert!((pixels[10] - 2.5).abs() < 0.05);
/// # Ok::<(), noisefloor::Error>(())
/// ```
pub fn estimate_image(
    config: &Config,
    image: &Image<'_>,
    samples: Samples<'_>,
    workspace: &mut [f32],
    out: &mut dyn FnMut(usize, Estimate),
) -> Result<(), Error> {
    estimate_image_by::<Portable>(config, image, samples, workspace, out)
}

/// [`estimate_image`] in steps that are compiled for a processor.
///
/// # Errors
/// As for [`estimate_image`].
pub fn estimate_image_by<P: Processor>(
    config: &Config,
    image: &Image<'_>,
    samples: Samples<'_>,
    workspace: &mut [f32],
    out: &mut dyn FnMut(usize, Estimate),
) -> Result<(), Error> {
    let mut basis = Basis::empty();
    basis.set(config.basis, config.checked_shape()?.apart());
    let call = Call::new(config, image, &basis)?;
    let reader = Reader::new(config, samples)?;
    image.check(config, call.pixels, samples.f.len())?;
    let held = reader.len() / call.pixels.max(1);
    ensure(held * call.pixels == reader.len(), Error::Length)?;
    let n = image.used(held)?;
    for row in call.windows.rows() {
        // Samples that count lie side by side, or only those of a pixel do.
        let step = if n == held { row.len() } else { 1 };
        for first in row.step_by(step.max(1)) {
            let samples = first * held..(first + step - 1) * held + n;
            image.check_values(config.channels, first..first + step, samples.clone())?;
            reader.part(samples).check()?;
        }
    }
    let call = Call { n, held, reader, ..call };
    let mut arena = Arena::new(workspace, call.workspace_len())?;
    call.run::<P>(&mut arena, out);
    Ok(())
}

impl<'a> Call<'a> {
    /// Without samples.
    fn new(config: &'a Config, image: &'a Image<'a>, basis: &'a Basis) -> Result<Self, Error> {
        let shape = config.checked_shape()?.apart();
        check_supported(config, image)?;
        let (windows, pixels) = (image.windows()?, image.pixels()?);
        Ok(Self { config, image, windows, pixels, shape, n: 0, held: 0, basis, reader: Reader::default() })
    }

    /// How many rows of windows are worked on before pixels are written, and how many rows of pixels those touch.
    fn band(&self) -> [usize; 2] {
        let [across, down] = self.windows.counts();
        let rows = (self.windows_at_once() / across.max(1)).min(down).max(1);
        // Later ones touch no more than the first.
        [rows, self.windows.top(rows - 1) - self.windows.top(0) + self.windows.extent[1]]
    }

    /// Counts what a call takes, by making all of it.
    fn workspace_len(&self) -> Option<usize> {
        // More samples than 32 bits count need more memory than there is.
        u32::try_from(self.pixels.checked_mul(self.held)?).ok()?;
        let (arena, len) = (&mut Arena::count(), self.windows.pixels());
        Band::new(self, self.band()[1], arena);
        self.groups(arena);
        let terms = Terms::new(self, len, self.has_edges());
        let batch = Batch::new(self, terms, [Group { len, ..Group::default() }; LANES], arena);
        batch.related(arena);
        Loading::new(&batch, arena);
        Fits::new(&batch, arena);
        Edges::new(&batch, arena);
        let choices = Choices::new(self, &batch.terms);
        Shares::last(choices, arena);
        Room::new(choices, batch.terms.fixed(), arena);
        arena.counted()
    }
}
