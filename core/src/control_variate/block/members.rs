//! The pixels that share a fit: which they are, and where.

use super::terms::MAX_AXES;
use crate::lanes::{LANES, Lanes};
use crate::real::Real;

/// Uniform coordinates from -1 to 1 times this have unit variance.
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// A part of an image, in all of its frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) frames: usize,
    pub(super) image_width: usize,
    pub(super) image_height: usize,
    /// Whether the pixels have places; otherwise they are one row in no order.
    pub(super) is_ordered: bool,
}

impl Area {
    pub(super) fn pixels(&self) -> usize {
        self.width * self.height * self.frames
    }

    /// The coordinates within the area of its pixel `index`.
    #[inline(always)]
    fn split(&self, index: usize) -> [usize; MAX_AXES] {
        // An area has as few pixels as 32 bits count, which divide faster than 64.
        if !self.is_ordered {
            return [index, 0, 0];
        }
        let (index, width, height) = (index as u32, self.width as u32, self.height as u32);
        let row = index.checked_div(width).unwrap_or(0);
        let frame = row.checked_div(height).unwrap_or(0);
        [index - row * width, row - frame * height, frame].map(|value| value as usize)
    }

    /// The image's number for the area's pixel `index`.
    #[inline(always)]
    pub(super) fn pixel(&self, index: usize) -> usize {
        let [x, y, frame] = self.split(index);
        (frame * self.image_height + self.y + y) * self.image_width + self.x + x
    }

    fn extents(&self) -> [usize; MAX_AXES] {
        [self.width, self.height, self.frames]
    }

    /// The axes along which the area's pixels differ.
    pub(super) fn axes(&self) -> usize {
        if self.is_ordered { self.extents().into_iter().filter(|&extent| extent > 1).count() } else { 0 }
    }

    /// How near pixel `index` is to the centre: 1 there, falling linearly along x and y to almost 0.
    pub(super) fn nearness<R: Real>(&self, index: usize) -> R {
        if !self.is_ordered {
            return R::ONE;
        }
        let [x, y, _] = self.split(index);
        let hat = |at: usize, extent: usize| R::ONE - Self::place::<R>(at, extent).abs();
        hat(x, self.width) * hat(y, self.height)
    }

    /// Where a pixel is along an axis, from -1 to 1.
    #[inline(always)]
    fn place<R: Real>(at: usize, extent: usize) -> R {
        // In double precision: two neighbours in single would be divided in one vector, with whatever its other half
        // holds.
        R::from_f64((2 * at + 1) as f64 / extent.max(1) as f64 - 1.0)
    }
}

/// Every `step`-th of some of an area's pixels, from the `first` on.
#[derive(Clone, Copy)]
pub(super) struct Members<'a> {
    pub(super) area: Area,
    /// Numbers within the area; None for all.
    pub(super) list: Option<&'a [u16]>,
    pub(super) first: usize,
    pub(super) step: usize,
    pub(super) len: usize,
}

impl Members<'_> {
    pub(super) fn axes(&self) -> usize {
        self.area.axes()
    }

    /// Every second of these.
    pub(super) fn half(&self, first: usize) -> Self {
        let len = (self.len + 1 - first) / 2;
        Self { first: self.first + first * self.step, step: 2 * self.step, len, ..*self }
    }

    /// The area's number for member `index`.
    #[inline(always)]
    pub(super) fn local(&self, index: usize) -> usize {
        let index = self.first + index * self.step;
        match self.list {
            Some(list) => usize::from(list.get(index).copied().unwrap_or(0)),
            None => index,
        }
    }

    /// The caller's number for member `index`.
    #[inline(always)]
    pub(super) fn pixel(&self, index: usize) -> usize {
        self.area.pixel(self.local(index))
    }

    /// A group of lanes of ones, and one for each axis, of unit variance: members from `start` on, zero after the last.
    #[inline(always)]
    pub(super) fn places<R: Real>(&self, start: usize) -> [Lanes<R>; 1 + MAX_AXES] {
        let mut places = [[R::ZERO; LANES]; 1 + MAX_AXES];
        let scale = R::from_f64(SQRT_3);
        for lane in 0..LANES.min(self.len.saturating_sub(start)) {
            let [ones, axes @ ..] = &mut places;
            ones[lane] = R::ONE;
            if !self.area.is_ordered {
                continue;
            }
            let at = self.area.split(self.local(start + lane));
            let used = at.into_iter().zip(self.area.extents()).filter(|&(_, extent)| extent > 1);
            for (axis, (at, extent)) in axes.iter_mut().zip(used) {
                axis[lane] = scale * Area::place(at, extent);
            }
        }
        places
    }
}
