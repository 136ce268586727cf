//! Groups: the pixels of one window and one surface, which share fits.

use super::call::Call;
use super::pixels::{Image, Rectangle};
use super::products::*;
use heapless::Vec;

/// Windows that are worked on together hold at most so many pixels, or are eight.
const PIXELS: usize = 1 << 14;
/// Pixels in no order that are so many share one fit by eight parts.
const MANY: usize = 64;

/// Something of each pixel of a window.
type Pixels<T> = Vec<T, { Image::MAX_WINDOW }>;

/// Where a pixel is in its window: its column, row and frame, each below 1024.
///
/// Kept as the bits of a number, as the workspace holds nothing else; so are counts. All are below 2^30: no bits of a
/// NaN, which a processor might change.
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
    fn split(self) -> [usize; 3] {
        [0, Self::BITS, 2 * Self::BITS].map(|shift| (self.0 >> shift & Self::MASK) as usize)
    }

    pub(super) fn split_each(places: &[Self; LANES]) -> [[u32; LANES]; 3] {
        [0, Self::BITS, 2 * Self::BITS].map(|shift| places.map(|place| place.0 >> shift & Self::MASK))
    }

    pub(super) fn read(number: f32) -> Self {
        Self(number.to_bits() & ((1 << (3 * Self::BITS)) - 1))
    }
}

/// What a group's samples are like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Kind {
    /// They have all the same values, and nothing is left to fit. Sky, background, deep shadow.
    Constant,
    #[default]
    Smooth,
    /// Lit and dark ones, where that matters.
    Edges,
}

impl Kind {
    /// Each at the place of its number, which records keep.
    const ALL: [Self; 3] = [Self::Constant, Self::Smooth, Self::Edges];
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Group {
    /// Its number.
    pub(super) index: usize,
    /// Its window's.
    pub(super) window: usize,
    /// Where its pixels begin in the list.
    pub(super) start: usize,
    pub(super) len: usize,
    pub(super) kind: Kind,
}

/// Numbers of a record that are not told of its group: window, start, length and kind, as bits.
const RECORD: usize = 4;

/// The groups of some windows, and what was found for them.
pub(super) struct Groups<'a> {
    pub(super) count: usize,
    channels: usize,
    /// Numbers of a record.
    width: usize,
    /// The pixels' places, group after group.
    list: &'a mut [f32],
    /// Of each group where it is; what is told of it: its gain, whether it has an error, and the error of each channel;
    /// then of each turn the lowest and the highest value of each channel that fits are made to, infinite where all
    /// are.
    records: &'a mut [f32],
    /// The groups' numbers, from the largest to the smallest.
    order: &'a mut [f32],
    /// For each group and channel, what is added to the means of its pixels.
    pub(super) corrections: &'a mut [f32],
}

impl Call<'_> {
    /// How many windows are worked on together.
    pub(super) fn windows_at_once(&self) -> usize {
        let [across, down] = self.windows.counts();
        (PIXELS / self.windows.pixels().max(1)).max(8).min(across.saturating_mul(down))
    }

    /// Whether all pixels are one group, whose eight parts are worked on side by side.
    pub(super) fn is_joined(&self) -> bool {
        !self.windows.is_ordered && self.image.surfaces.is_empty() && self.windows.pixels() >= MANY
    }

    /// The fewest pixels of a group for which a fit can do more than the mean.
    fn least(&self) -> usize {
        if self.is_single_fit() && self.n > 1 { 2 } else { self.with_spread() }
    }

    /// The fewest pixels whose spread about their trend says something. Of one sample in each, fewer would leave no
    /// digits of what is left of them.
    fn with_spread(&self) -> usize {
        self.windows.axes() + 3
    }

    /// Room for those of as many windows as are worked on together.
    pub(super) fn groups<'a>(&self, arena: &mut Arena<'a, f32>) -> Groups<'a> {
        let (windows, each, channels) = (self.windows_at_once(), self.windows.pixels(), self.config.channels);
        let pixels = windows.saturating_mul(each);
        let most = windows.saturating_mul(each / self.least().max(1));
        let (list, count) = if self.is_joined() { (0, 1) } else { (pixels, most) };
        let width = RECORD + 2 + channels + self.turns() * 2 * channels;
        Groups {
            count: 0,
            channels,
            width,
            list: arena.take(list),
            records: arena.take(count.saturating_mul(width)),
            order: arena.take(count),
            // Eight are read at a time, also behind the last.
            corrections: arena.zeros(pixels.saturating_mul(channels)),
        }
    }

    pub(super) fn window(&self, index: usize) -> [usize; 2] {
        let [across, _] = self.windows.counts();
        let row = index / across.max(1);
        self.windows.window(index - row * across, row)
    }

    /// The image's number of pixel `index` of a group, which is at `place` in its window.
    pub(super) fn pixel(&self, [left, top]: [usize; 2], place: Place, index: usize) -> usize {
        let [x, y, frame] = place.split();
        if self.is_joined() { index } else { self.windows.number(left + x, top + y, frame) }
    }

    /// What the samples of a group are like, which are those of `members` of a window.
    fn kind(&self, window: usize, members: &[f32], len: usize) -> Kind {
        let (corner, channels) = (self.window(window), self.config.channels);
        let mut samples = (0..len).flat_map(|member| {
            let pixel = self.pixel(corner, Place::read(at(members, member)), member);
            rows(part(self.reader.samples.f, pixel * self.held * channels, self.n * channels), channels)
        });
        let Some(first) = samples.next() else { return Kind::Smooth };
        // Values that differ in their factors, or in what is known of them, differ in fits. Few pixels have no error.
        let is_alone = self.image.factors.is_empty() && !self.image.has_known();
        let may_be = (is_alone || first.iter().all(|&value| value == 0.0)) && len >= self.with_spread();
        let is_lit = |sample: &[f32]| sample.iter().any(|&value| value > 0.0);
        if may_be && samples.clone().all(|sample| sample == first) {
            Kind::Constant
        } else if self.may_have_edge(len) && samples.any(|sample| is_lit(sample) != is_lit(first)) {
            Kind::Edges
        } else {
            Kind::Smooth
        }
    }

    /// Divides windows `first` to before `end` into groups.
    pub(super) fn divide(&self, first: usize, end: usize, groups: &mut Groups<'_>) {
        groups.count = 0;
        if self.is_joined() {
            groups.push(self, 0, 0, self.windows.pixels());
            return groups.sort();
        }
        // Where the pixels of any window are, and how far their numbers are from its first pixel's.
        let (mut places, mut numbers) = (Pixels::<f32>::new(), Pixels::<u32>::new());
        let Rectangle { x: left, y: top, .. } = self.windows.given;
        let [width, height, frames] = self.windows.extent;
        for frame in 0..frames {
            // By squares of 2 x 2, so that every fourth place is not next to another.
            for (y, x) in (0..height).step_by(2).flat_map(|y| (0..width).step_by(2).map(move |x| (y, x))) {
                for (x, y) in [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)] {
                    if x < width && y < height {
                        // A window has no more pixels than that.
                        let _ = places.push(f32::from_bits(Place::new(x, y, frame).0));
                        let _ = numbers.push(self.windows.number(left + x, top + y, frame) as u32);
                    }
                }
            }
        }
        let mut filled = 0;
        // The pixels of a window that are in no group yet, and their surfaces.
        let mut left = Pixels::<(f32, u32)>::new();
        for index in first..end {
            let [column, line] = self.window(index);
            let surfaces = from(self.image.surfaces, self.windows.number(column, line, 0));
            let each = numbers.iter().map(|&number| at(surfaces, number as usize));
            // Mostly one.
            if each.clone().all(|surface| surface == at(surfaces, 0)) {
                copy(from_mut(groups.list, filled), &places);
                filled = groups.push(self, index, filled, places.len());
                continue;
            }
            for pixel in places.iter().copied().zip(each) {
                // No more than there are places; `extend` would panic of more.
                let _ = left.push(pixel);
            }
            while let Some(&(_, surface)) = left.first() {
                let mut len = 0;
                left.retain(|&(place, other)| {
                    if other == surface
                        && let Some(out) = groups.list.get_mut(filled + len)
                    {
                        *out = place;
                        len += 1;
                    }
                    other != surface
                });
                filled = groups.push(self, index, filled, len);
            }
        }
        groups.sort();
    }
}

impl Groups<'_> {
    /// Adds a group, unless its pixels are too few, and says where the list goes on.
    fn push(&mut self, call: &Call<'_>, window: usize, start: usize, len: usize) -> usize {
        if len < call.least() {
            return start;
        }
        let kind = call.kind(window, part(self.list, start, len), len);
        let record = row_at_mut(self.records, self.width, self.count);
        let Some((record, told)) = record.split_first_chunk_mut::<RECORD>() else { return start };
        *record = [window, start, len, kind as usize].map(|number| f32::from_bits(number as u32));
        if kind == Kind::Constant {
            // No gain; the group's error, or by how much the pixels' are multiplied; and limits that are numbers, as
            // lanes without a group read those of the first.
            told.fill(1.0);
            let error = if call.error_is_the_groups() { 0.0 } else { 1.0 };
            part_mut(told, 2, self.channels).fill(error);
            part_mut(self.corrections, start * self.channels, len * self.channels).fill(0.0);
        }
        self.count += 1;
        start + len
    }

    /// Group `index` in the order of their windows.
    pub(super) fn numbered(&self, index: usize) -> Group {
        let record = row_at(self.records, self.width, index).first_chunk::<RECORD>();
        let [window, start, len, kind] = record.map_or([0; RECORD], |record| record.map(bits));
        Group { index, window, start, len, kind: at(&Kind::ALL, kind) }
    }

    /// Orders the groups by size: eight that are worked on side by side then have about as many pixels.
    fn sort(&mut self) {
        // Where the groups of each size begin, those of the largest first.
        let mut begins = [0u32; Image::MAX_WINDOW + 1];
        // All pixels in one are as many as they may be.
        let size = |groups: &Self, index: usize| groups.numbered(index).len.min(Image::MAX_WINDOW);
        for index in 0..self.count {
            if let Some(begin) = begins.get_mut(size(self, index)) {
                *begin += 1;
            }
        }
        let mut total = 0;
        for begin in begins.iter_mut().rev() {
            (*begin, total) = (total, total + *begin);
        }
        for index in 0..self.count {
            let Some(begin) = begins.get_mut(size(self, index)) else { continue };
            if let Some(out) = self.order.get_mut(*begin as usize) {
                *out = f32::from_bits(index as u32);
                *begin += 1;
            }
        }
    }

    /// The groups from the largest to the smallest.
    pub(super) fn by_size(&self, place: usize) -> Option<Group> {
        let &index = first(self.order, self.count).get(place)?;
        Some(self.numbered(bits(index)))
    }

    /// What is told of a group, and of each turn for each channel the lowest and the highest value.
    pub(super) fn found(&self, group: &Group) -> (&[f32], &[f32]) {
        halves(from(row_at(self.records, self.width, group.index), RECORD), 2 + self.channels)
    }

    pub(super) fn found_mut(&mut self, group: &Group) -> (&mut [f32], &mut [f32]) {
        halves_mut(from_mut(row_at_mut(self.records, self.width, group.index), RECORD), 2 + self.channels)
    }

    /// The places of a group's pixels, to be read; none where all pixels are one group.
    pub(super) fn members(&self, group: &Group) -> &[f32] {
        part(self.list, group.start, group.len)
    }
}

/// A count that was kept as bits.
fn bits(number: f32) -> usize {
    number.to_bits() as usize
}
