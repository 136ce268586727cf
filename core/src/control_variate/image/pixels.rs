//! The pixels of an image, and which of them share fits.

use crate::control_variate::Config;
use crate::error::{Error, Invalid, ensure, rule};
use crate::matrix::part;
use core::ops::Range;

/// The pixels' axes: x, y and frames.
pub(super) const MAX_AXES: usize = 3;
/// What is said of too many pixels.
const MOST: Invalid = Invalid::range(c"pixels must be at most 2^30 - 1, all frames together");

/// The pixels of an image, or of a part of one, and what is known of them. `Image::new(width, height)` knows nothing.
///
/// Pixel (x, y) of frame t has the number (t height + y) width + x.
///
/// Parts of a picture can be estimated on their own, one on each thread: see `wanted`. Together they have the same bits
/// as the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image<'a> {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Images of the same pixels, at other times; they share fits. 0 means 1.
    pub frames: usize,
    /// How many of a pixel's samples count, its first; 0 means all. No others are read: arrays may have room for those
    /// that are still to come. The workspace depends on it.
    pub samples: usize,
    /// Whether the pixels have no places: all of the same surface, in all frames, then share one fit, whatever `window`
    /// and `stride` say. With `surfaces` they are at most [`Image::MAX_WINDOW`]. Which of them correct which, and
    /// choose for which, goes by their order: shuffle them where that follows a picture.
    pub unordered: bool,
    /// Width and height of the square windows that pixels share a fit in; 0 means 8. A window has at most
    /// [`Image::MAX_WINDOW`] pixels in all frames together.
    pub window: usize,
    /// Pixels from one window to the next, at most `window`; 0 means half of it. Where windows overlap a pixel's
    /// corrections are averaged, those of windows that have it near their centre counting more.
    pub stride: usize,
    /// A number for each pixel, or empty: only pixels with the same number share a fit. What shows the same material
    /// under a similar normal and depth, for example. Must not depend on the pixel's own samples, or no estimator is
    /// unbiased.
    pub surfaces: &'a [u32],
    /// `channels` numbers for each pixel, or empty: what its values are divided by before a fit and multiplied by
    /// after it, such as its albedo. Finite and not negative; 0 counts as 1. Must not depend on the pixel's own samples
    /// either. Pixels near 0 beside others are better kept apart by `surfaces`: their values would decide the fit. For
    /// textures where all samples of a pixel see one albedo: with defocus or motion blur they can raise the error.
    pub factors: &'a [f32],
    /// For each sample, as `f`: what it would be with nothing in the way, its unshadowed contribution. Or empty.
    /// Finite, and 0 where no light arrives anyway. Each pixel's estimate is then also corrected by how far these are
    /// from `known_integrals`, as far as its neighbours' values follow theirs.
    pub known: &'a [f32],
    /// With `known`: for each pixel `channels` numbers, the exact integrals of that over u. Finite and not negative; a
    /// pixel with 0 is not corrected by it. Where a pixel's samples see several points, the mean of their integrals.
    pub known_integrals: &'a [f32],
    /// The pixels that the arrays hold, in all frames; all, if all four numbers are 0. Only these have numbers there;
    /// results are numbered among those wanted.
    pub given: Rectangle,
    /// The pixels that are estimated; all that are given, if all four numbers are 0. Every window that has one of them
    /// must be given whole: [`Image::needed`]. No others are read.
    pub wanted: Rectangle,
}

/// Pixels of a picture: those from column `x` on and from row `y` on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rectangle {
    /// The first column.
    pub x: usize,
    /// The first row.
    pub y: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Rectangle {
    /// From the first column and row, of so many.
    #[inline]
    pub const fn new(x: usize, y: usize, width: usize, height: usize) -> Self {
        Self { x, y, width, height }
    }

    fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Whether it has pixels, all of them within another.
    fn is_within(&self, other: &Self) -> bool {
        let along = |[at, extent]: [usize; 2], [start, all]: [usize; 2]| {
            extent > 0 && at.checked_sub(start).is_some_and(|before| before <= all && extent <= all - before)
        };
        along([self.x, self.width], [other.x, other.width]) && along([self.y, self.height], [other.y, other.height])
    }

    /// Pixels, if they can be counted.
    fn pixels(&self) -> Option<usize> {
        self.width.checked_mul(self.height)
    }
}

impl Image<'_> {
    /// The most pixels of a window, all frames counted.
    pub const MAX_WINDOW: usize = 1024;

    /// The most pixels of a picture, or of the part of it that is given, all frames counted.
    pub const MAX_PIXELS: u32 = (1 << 30) - 1;

    /// An image of which nothing is known but its size.
    #[inline]
    pub const fn new(width: usize, height: usize) -> Self {
        let all = Rectangle::new(0, 0, 0, 0);
        Self {
            width,
            height,
            frames: 1,
            samples: 0,
            unordered: false,
            window: 0,
            stride: 0,
            surfaces: &[],
            factors: &[],
            known: &[],
            known_integrals: &[],
            given: all,
            wanted: all,
        }
    }

    /// Pixels in no order.
    #[inline]
    pub const fn unordered(pixels: usize) -> Self {
        Self { unordered: true, ..Self::new(pixels, 1) }
    }

    /// Checks its size, its windows and its parts; of arrays only whether there are any.
    ///
    /// # Errors
    /// The rule that is broken.
    pub fn check_windows(&self) -> Result<(), Invalid> {
        self.windows()?;
        self.pixels().map(|_| ())
    }

    /// How many pixels the arrays hold, and how many are estimated, in all frames.
    ///
    /// # Errors
    /// [`Error::Range`] for an image without pixels or with more than [`Image::MAX_PIXELS`], and for windows and parts
    /// that are not allowed.
    pub fn counts(&self) -> Result<[usize; 2], Error> {
        let windows = self.windows()?;
        let estimated = windows.wanted.pixels().and_then(|pixels| pixels.checked_mul(windows.frames()));
        Ok([self.pixels()?, estimated.ok_or(Error::Range)?])
    }

    /// Whether something is known of the samples.
    pub(super) fn has_known(&self) -> bool {
        !self.known.is_empty()
    }

    /// The pixels that must be given for those of `wanted`: whole windows. Empty for pixels without places: all.
    ///
    /// # Errors
    /// [`Error::Range`] for windows that are not allowed, and if `wanted` has no pixels or some beyond the image.
    ///
    /// ```
    /// use noisefloor::control_variate::{Image, Rectangle};
    ///
    /// // The second of four strips. Windows of 8 x 8 pixels begin at every fourth.
    /// let image = Image { wanted: Rectangle::new(0, 16, 64, 16), ..Image::new(64, 64) };
    /// assert_eq!(image.needed()?, Rectangle::new(0, 12, 64, 24));
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    pub fn needed(&self) -> Result<Rectangle, Error> {
        let windows = Self { given: Rectangle::default(), ..*self }.windows()?;
        Ok(if windows.is_ordered { windows.needed } else { Rectangle::default() })
    }

    /// Where its windows lie.
    pub(super) fn windows(&self) -> Result<Windows, Invalid> {
        rule(self.width > 0 && self.height > 0, c"width and height must be at least 1")?;
        let is_whole = self.given.is_empty() && self.wanted.is_empty();
        rule(is_whole || !self.unordered, c"given and wanted must be all zero where pixels are unordered")?;
        // Pixels without places are a row, and its own window.
        let image = match self.unordered {
            true => [self.pixels()?, 1, 1],
            false => [self.width, self.height, self.frames()],
        };
        let [across, down, frames] = image;
        let all = Rectangle::new(0, 0, across, down);
        let given = if self.given.is_empty() { all } else { self.given };
        let wanted = if self.wanted.is_empty() { given } else { self.wanted };
        let or = |number: usize, otherwise: usize| if number == 0 { otherwise } else { number };
        let side = if self.unordered { across } else { or(self.window, 8) };
        let stride = if self.unordered { across } else { or(self.stride, side.div_ceil(2)) };
        let (width, height) = (side.min(across), side.min(down));
        let is_small = width.saturating_mul(height).saturating_mul(frames) <= Self::MAX_WINDOW;
        if self.unordered {
            let is_kept = is_small || self.surfaces.is_empty();
            rule(is_kept, c"pixels with surfaces must be at most 1024 where they are unordered")?;
        } else {
            rule(is_small, c"window must be at most 1024 pixels, all frames together")?;
        }
        rule(stride <= side, c"stride must be at most window")?;
        rule(given.is_within(&all), c"given must lie in the image, and have pixels")?;
        rule(wanted.is_within(&given), c"wanted must lie in what is given, and have pixels")?;
        let (extent, is_ordered) = ([width, height, frames], !self.unordered);
        let (used, needed) = (Rectangle::default(), Rectangle::default());
        let mut windows = Windows { extent, stride, image, is_ordered, given, wanted, used, needed };
        windows.used = windows.with_pixels(&wanted);
        windows.needed = windows.pixels_of_used();
        rule(windows.needed.is_within(&given), c"given must hold the windows of wanted whole: see nf_cv_image_needed()")
            .map(|()| windows)
    }

    pub(super) fn frames(&self) -> usize {
        self.frames.max(1)
    }

    /// How many of a pixel's `held` samples count.
    pub(super) fn used(&self, held: usize) -> Result<usize, Error> {
        ensure(self.samples <= held, Error::Range)?;
        Ok(if self.samples > 0 { self.samples } else { held })
    }

    /// All pixels that are given, of all frames.
    pub(super) fn pixels(&self) -> Result<usize, Invalid> {
        let all = Rectangle::new(0, 0, self.width, self.height);
        let given = if self.given.is_empty() { all } else { self.given };
        let pixels = given.pixels().and_then(|pixels| pixels.checked_mul(self.frames()));
        pixels.filter(|&pixels| pixels <= Self::MAX_PIXELS as usize).ok_or(MOST)
    }

    /// Checks the arrays' lengths, for so many pixels and numbers of samples.
    pub(super) fn check(&self, config: &Config, pixels: usize, values: usize) -> Result<(), Error> {
        let fits = |array: &[f32], len: Option<usize>| array.is_empty() || len == Some(array.len());
        let each = pixels.checked_mul(config.channels);
        let surfaces_fit = self.surfaces.is_empty() || self.surfaces.len() == pixels;
        let known_fits = fits(self.known, Some(values)) && fits(self.known_integrals, each);
        ensure(surfaces_fit && known_fits && fits(self.factors, each), Error::Length)?;
        ensure(self.known.is_empty() == self.known_integrals.is_empty(), Error::Range)
    }

    /// Checks what the arrays say of some pixels, and of some samples.
    pub(super) fn check_values(
        &self,
        channels: usize,
        pixels: Range<usize>,
        samples: Range<usize>,
    ) -> Result<(), Error> {
        let rows = |values, range: &Range<usize>| part(values, range.start * channels, range.len() * channels);
        let [factors, integrals] = [self.factors, self.known_integrals].map(|values| rows(values, &pixels));
        let mut values = [factors, integrals, rows(self.known, &samples)].into_iter().flatten();
        ensure(values.all(|value| value.is_finite()), Error::NotFinite)?;
        ensure(factors.iter().chain(integrals).all(|&value| value >= 0.0), Error::Range)
    }
}

/// Where windows lie: in rows of as many, all of one size.
#[derive(Clone, Copy)]
pub(super) struct Windows {
    /// Width, height and frames of a window; of pixels in no order their number, 1 and 1.
    pub(super) extent: [usize; MAX_AXES],
    stride: usize,
    /// Width, height and frames of the image.
    image: [usize; MAX_AXES],
    pub(super) is_ordered: bool,
    /// Pixels that the arrays hold.
    pub(super) given: Rectangle,
    /// Pixels that are estimated.
    pub(super) wanted: Rectangle,
    /// Columns and rows of windows that have any of those.
    used: Rectangle,
    /// The pixels of all windows that are used: no others are read.
    pub(super) needed: Rectangle,
}

impl Windows {
    /// Pixels of a window, in all frames.
    pub(super) fn pixels(&self) -> usize {
        let [width, height, frames] = self.extent;
        width * height * frames
    }

    pub(super) fn frames(&self) -> usize {
        self.image[2]
    }

    /// The axes along which a window's pixels differ.
    pub(super) fn axes(&self) -> usize {
        if self.is_ordered { self.extent.into_iter().filter(|&extent| extent > 1).count() } else { 0 }
    }

    /// Those axes; what follows the last is no axis.
    pub(super) fn used_axes(&self) -> [usize; MAX_AXES] {
        let mut axes = [0; MAX_AXES];
        let used = self.extent.into_iter().enumerate().filter(|&(_, extent)| extent > 1);
        axes.iter_mut().zip(used).for_each(|(out, (axis, _))| *out = axis);
        axes
    }

    /// Used windows in a row, and rows of them.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.used.width, self.used.height]
    }

    /// Which of the windows along an axis have any of some pixels, as the first and how many; all, if pixels have no
    /// places. Windows begin at every `stride` pixels, and the last ends where the image does.
    fn with_any(&self, axis: usize, first: usize, pixels: usize) -> [usize; 2] {
        let [image, window] = [self.image, self.extent].map(|extents| extents[axis % MAX_AXES]);
        let last = image.saturating_sub(window);
        let stride = self.stride.max(1);
        let windows = 1 + last.div_ceil(stride);
        // The first that ends beyond the first pixel: the image's last may begin less than a stride after the one
        // before.
        let begin = (first + 1).saturating_sub(window).div_ceil(stride).min(windows - 1);
        let end = (first + pixels - 1) / stride + 1;
        // The last begins where the image's end says.
        let end = if first + pixels > last { windows } else { end.min(windows) };
        [begin, end.saturating_sub(begin)]
    }

    fn with_pixels(&self, wanted: &Rectangle) -> Rectangle {
        let [x, width] = self.with_any(0, wanted.x, wanted.width);
        let [y, height] = self.with_any(1, wanted.y, wanted.height);
        Rectangle { x, y, width, height }
    }

    fn pixels_of_used(&self) -> Rectangle {
        let [across, down] = self.counts();
        let [left, top] = self.window(0, 0);
        let [right, bottom] = self.window(across.saturating_sub(1), down.saturating_sub(1));
        let [width, height, _] = self.extent;
        Rectangle::new(left, top, right + width - left, bottom + height - top)
    }

    /// The first row of pixels of a row of used windows.
    pub(super) fn top(&self, row: usize) -> usize {
        let [[_, height, _], [_, down, _]] = [self.image, self.extent];
        ((self.used.y + row) * self.stride).min(height.saturating_sub(down))
    }

    /// The first column and row of pixels of a used window.
    pub(super) fn window(&self, column: usize, row: usize) -> [usize; 2] {
        let [[width, ..], [across, ..]] = [self.image, self.extent];
        [((self.used.x + column) * self.stride).min(width.saturating_sub(across)), self.top(row)]
    }

    /// The rows of pixels that are read, by the pixels' numbers.
    pub(super) fn rows(&self) -> impl Iterator<Item = Range<usize>> {
        let Rectangle { x, y, width, height } = self.needed;
        let row = move |frame, y| self.number(x, y, frame)..self.number(x + width, y, frame);
        (0..self.frames()).flat_map(move |frame| (y..y + height).map(move |y| row(frame, y)))
    }

    pub(super) fn number(&self, x: usize, y: usize, frame: usize) -> usize {
        (frame * self.given.height + y - self.given.y) * self.given.width + x - self.given.x
    }
}
