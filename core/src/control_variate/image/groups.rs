//! Groups: the pixels of one window and one surface, which share fits.

use super::call::Layout;
use super::pixels::{Image, Window};
use crate::arena::Arena;
use crate::error::Error;
use crate::lanes::LANES;
use crate::matrix::{at, row_at, row_at_mut};
use crate::rows::part;
use heapless::Vec;

/// Windows that are worked on together hold at most so many pixels, or are eight.
const PIXELS: usize = 1 << 14;
/// Pixels in no order that are so many share one fit by eight parts.
const MANY: usize = 64;

/// Where a pixel is in its window: its column, row and frame, each below 1024.
///
/// Kept as the bits of a number, as the workspace holds nothing else. All are below 2^30: no bits of a NaN, which a
/// processor might change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place(u32);

impl Place {
    const BITS: u32 = 10;
    const MASK: u32 = (1 << Self::BITS) - 1;

    fn new(x: usize, y: usize, frame: usize) -> Self {
        let part = |value: usize| value as u32 & Self::MASK;
        Self(part(x) | part(y) << Self::BITS | part(frame) << (2 * Self::BITS))
    }

    /// Column, row and frame.
    #[inline]
    pub(super) fn split(self) -> [usize; 3] {
        [0, Self::BITS, 2 * Self::BITS].map(|shift| (self.0 >> shift & Self::MASK) as usize)
    }

    #[inline]
    pub(super) fn split_each(places: &[Self; LANES]) -> [[u32; LANES]; 3] {
        [0, Self::BITS, 2 * Self::BITS].map(|shift| places.map(|place| place.0 >> shift & Self::MASK))
    }

    #[inline]
    pub(super) fn read(number: f32) -> Self {
        Self(number.to_bits() & ((1 << (3 * Self::BITS)) - 1))
    }
}

/// A count below 2^24, which is exact in `f32`.
#[inline]
fn count(number: f32) -> usize {
    number as usize
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Group {
    /// Its number.
    pub(super) index: usize,
    /// Its window's, among those that are worked on.
    pub(super) window: usize,
    /// Where its pixels begin in the list.
    pub(super) start: usize,
    /// How many pixels it has.
    pub(super) len: usize,
    /// Whether it has lit and dark samples, if that matters.
    pub(super) has_edges: bool,
}

/// Numbers of a group: window, start, length.
const RECORD: usize = 3;

/// The groups of some windows, and what was found for them.
pub(super) struct Groups<'a> {
    /// The number of the first of the windows.
    pub(super) first: usize,
    /// How many groups there are.
    count: usize,
    /// The pixels' places, group after group.
    list: &'a mut [f32],
    records: &'a mut [f32],
    /// The groups' numbers, from the largest to the smallest.
    order: &'a mut [f32],
    /// What is told of each group: its gain, whether it has an error, and the error of each channel.
    told: &'a mut [f32],
    /// For each group and turn, the lowest and the highest value of each channel that fits are made to; infinite where
    /// all are.
    limits: &'a mut [f32],
    /// For each group 1 if it has lit and dark samples; none unless edges are looked for.
    pub(super) edges: &'a mut [f32],
    /// For each pixel of the list and each channel, what is added to the mean.
    pub(super) corrections: &'a mut [f32],
}

impl Layout<'_> {
    /// How many windows are worked on together.
    pub(super) fn windows_at_once(&self) -> usize {
        let [across, down] = self.windows.counts();
        (PIXELS / self.windows.pixels().max(1)).max(8).min(across.saturating_mul(down))
    }

    /// Whether all pixels are one group, whose eight parts are worked on side by side.
    pub(super) fn is_joined(&self) -> bool {
        !self.windows.is_ordered && self.image.surfaces.is_empty() && self.windows.pixels() >= MANY
    }

    fn whole(&self) -> Group {
        Group { len: self.windows.pixels(), ..Group::default() }
    }

    /// The fewest pixels of a group for which a fit can do more than the mean. Of one sample in each, fewer would leave
    /// no digits of what is left of them beside their trend.
    fn least(&self) -> usize {
        if self.is_single_fit() && self.n > 1 { 2 } else { self.windows.axes() + 3 }
    }

    fn most_groups(&self) -> usize {
        if self.is_joined() { 1 } else { self.windows_at_once() * (self.windows.pixels() / self.least().max(1)) }
    }

    /// Numbers that the groups of all turns take.
    pub(super) fn groups_len(&self) -> Option<usize> {
        let channels = self.config.channels;
        let pixels = self.windows_at_once().checked_mul(self.windows.pixels())?;
        let listed = if self.is_joined() { 0 } else { pixels };
        let each = RECORD + 1 + self.told_len() + self.limits_len() + usize::from(self.has_edges());
        pixels.checked_mul(channels)?.checked_add(listed)?.checked_add(self.most_groups().checked_mul(each)?)
    }

    /// Numbers that are told of a group.
    pub(super) fn told_len(&self) -> usize {
        2 + self.config.channels
    }

    pub(super) fn limits_len(&self) -> usize {
        self.turns() * 2 * self.config.channels
    }

    /// Room for the groups of as many windows as are worked on together.
    pub(super) fn groups<'a>(&self, arena: &mut Arena<'a, f32>) -> Result<Groups<'a>, Error> {
        let pixels = self.windows_at_once() * self.windows.pixels();
        let most = self.most_groups();
        Ok(Groups {
            first: 0,
            count: 0,
            list: arena.take(if self.is_joined() { 0 } else { pixels })?,
            records: arena.take(most * RECORD)?,
            order: arena.take(most)?,
            told: arena.take(most * self.told_len())?,
            limits: arena.take(most * self.limits_len())?,
            edges: arena.take(if self.has_edges() { most } else { 0 })?,
            corrections: arena.take(pixels * self.config.channels)?,
        })
    }

    pub(super) fn window(&self, index: usize) -> Window {
        let [across, _] = self.windows.counts();
        let row = index / across.max(1);
        self.windows.window(index - row * across, row)
    }

    /// The image's number of the first pixel of a group's window.
    pub(super) fn corner(&self, groups: &Groups<'_>, group: &Group) -> usize {
        let Window { x, y } = self.window(groups.first + group.window);
        if self.is_joined() { 0 } else { self.windows.number(x, y, 0) }
    }

    /// The image's number of pixel `index` of a group, which is at `place` in its window.
    #[inline]
    pub(super) fn pixel(&self, window: Window, place: Place, index: usize) -> usize {
        let [x, y, frame] = place.split();
        if self.is_joined() { index } else { self.windows.number(window.x + x, window.y + y, frame) }
    }

    /// Divides windows `first` to before `end` into groups.
    #[inline]
    pub(super) fn divide(&self, first: usize, end: usize, groups: &mut Groups<'_>) {
        groups.first = first;
        groups.count = 0;
        if self.is_joined() {
            return;
        }
        let mut filled = 0;
        // Of each pixel of a window its place, and its number less that of the window's first.
        let mut places: Vec<(Place, u32), { Image::MAX_WINDOW }> = Vec::new();
        let corner = self.window(first);
        self.each_place(|place| {
            let apart = self.pixel(corner, place, 0) - self.pixel(corner, Place::default(), 0);
            // A window has no more pixels than that.
            let _ = places.push((place, apart as u32));
        });
        let mut left: Vec<(Place, u32), { Image::MAX_WINDOW }> = Vec::new();
        for index in first..end {
            let corner = self.pixel(self.window(index), Place::default(), 0);
            for &(place, apart) in &places {
                let _ = left.push((place, at(self.image.surfaces, corner + apart as usize)));
            }
            while let Some(&(_, surface)) = left.first() {
                let start = filled;
                left.retain(|&(place, other)| {
                    if other == surface
                        && let Some(out) = groups.list.get_mut(filled)
                    {
                        *out = f32::from_bits(place.0);
                        filled += 1;
                    }
                    other != surface
                });
                if filled - start < self.least() {
                    filled = start;
                } else {
                    groups.push(index - first, start, filled - start);
                }
            }
        }
        groups.sort();
    }

    /// The places of a window by squares of 2 x 2, so that every fourth of them is not next to another.
    fn each_place(&self, mut visit: impl FnMut(Place)) {
        let [width, height, frames] = self.windows.extent;
        for frame in 0..frames {
            for (y, x) in (0..height).step_by(2).flat_map(|y| (0..width).step_by(2).map(move |x| (y, x))) {
                for (x, y) in [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)] {
                    if x < width && y < height {
                        visit(Place::new(x, y, frame));
                    }
                }
            }
        }
    }
}

impl Groups<'_> {
    fn push(&mut self, window: usize, start: usize, len: usize) {
        let record = self.records.get_mut(self.count * RECORD..);
        if let Some([a, b, c, ..]) = record {
            [*a, *b, *c] = [window, start, len].map(|number| number as f32);
            self.count += 1;
        }
    }

    fn record(&self, index: usize) -> Group {
        match self.records.get(index * RECORD..) {
            Some(&[window, start, len, ..]) => {
                let [window, start, len] = [window, start, len].map(count);
                let has_edges = at(self.edges, index) > 0.0;
                Group { index, window, start, len, has_edges }
            }
            _ => Group::default(),
        }
    }

    /// Orders the groups by size: eight that are worked on side by side then have about as many pixels.
    fn sort(&mut self) {
        // Where the groups of each size begin, those of the largest first.
        let mut begins = [0u32; Image::MAX_WINDOW + 1];
        for index in 0..self.count {
            if let Some(begin) = begins.get_mut(self.record(index).len) {
                *begin += 1;
            }
        }
        let mut total = 0;
        for begin in begins.iter_mut().rev() {
            (*begin, total) = (total, total + *begin);
        }
        for index in 0..self.count {
            let Some(begin) = begins.get_mut(self.record(index).len) else { continue };
            if let Some(out) = self.order.get_mut(*begin as usize) {
                *out = index as f32;
                *begin += 1;
            }
        }
    }

    /// The groups from the largest to the smallest.
    #[inline]
    pub(super) fn by_size(&self, layout: &Layout<'_>, place: usize) -> Option<Group> {
        if layout.is_joined() {
            return self.numbered(layout, place);
        }
        let &index = self.order.get(..self.count)?.get(place)?;
        Some(self.record(count(index)))
    }

    pub(super) fn numbered(&self, layout: &Layout<'_>, index: usize) -> Option<Group> {
        if layout.is_joined() {
            let has_edges = at(self.edges, 0) > 0.0;
            return (index == 0).then(|| Group { has_edges, ..layout.whole() });
        }
        (index < self.count).then(|| self.record(index))
    }

    /// The groups in the order of their windows.
    pub(super) fn in_order(&self, layout: &Layout<'_>) -> impl Iterator<Item = Group> {
        (0..).map_while(|index| self.numbered(layout, index))
    }

    /// What is told of a group: its gain, whether it has an error, and the error of each channel.
    pub(super) fn told(&self, layout: &Layout<'_>, group: &Group) -> &[f32] {
        row_at(self.told, layout.told_len(), group.index)
    }

    pub(super) fn told_mut(&mut self, layout: &Layout<'_>, group: &Group) -> &mut [f32] {
        row_at_mut(self.told, layout.told_len(), group.index)
    }

    /// For each channel the lowest and the highest value that fits are made to in a turn.
    #[inline]
    pub(super) fn limits(&self, layout: &Layout<'_>, group: &Group, turn: usize) -> &[f32] {
        row_at(self.limits, 2 * layout.config.channels, group.index * layout.turns() + turn)
    }

    /// The same, to be written.
    #[inline]
    pub(super) fn limits_mut(&mut self, layout: &Layout<'_>, group: &Group, turn: usize) -> &mut [f32] {
        row_at_mut(self.limits, 2 * layout.config.channels, group.index * layout.turns() + turn)
    }

    /// Whether a group has pixels beyond its limits.
    pub(super) fn has_limits(&self, layout: &Layout<'_>, group: &Group, turn: usize) -> bool {
        self.limits(layout, group, turn).iter().any(|limit| limit.is_finite())
    }

    /// The places of a group's pixels, to be read; none where all pixels are one group.
    #[inline]
    pub(super) fn members(&self, group: &Group) -> &[f32] {
        part(self.list, group.start, group.len)
    }
}
