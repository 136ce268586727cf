//! Eight groups side by side, a lane each: their samples, and the sums of products that fits are made from.
//!
//! Slot after slot holds one pixel of each group. Every fourth slot is of one colour: with several samples in each, the
//! pixels of a colour are corrected by fits to the other three.

use super::super::config::Config;
use super::fit::Colours;
use super::groups::{Group, Groups};
use super::known::RELATIVE;
use super::pixels::Rectangle;
use super::terms::{MAX_AXES, Terms};
use super::{Call, Layout};
use crate::arena::Arena;
use crate::basis::MAX_DIMS;
use crate::error::Error;
use crate::lanes::{self, LANES, Lanes};
use crate::linalg::packed_len;
use crate::real::Real;
use crate::rows::{row_at, row_at_mut, rows, rows_mut};

/// A number for each of eight groups.
pub(super) type Eight = Lanes<f32>;
/// Nothing in any lane.
pub(super) const NONE: Eight = [0.0; LANES];
/// How many colours there are.
pub(super) const COLOURS: usize = 4;
/// Samples whose products are added, or pixels that are corrected, at a time.
pub(super) const AT_ONCE: usize = 4;
/// The most numbers of a place.
pub(super) const MAX_FIXED: usize = 1 + MAX_AXES;
/// Uniform coordinates from -1 to 1 times this have unit variance.
const SQRT_3: f64 = 1.732_050_807_568_877_2;
/// The largest value of a pixel that no fit is made to, in units of the largest that one is made to, is 2 to the power
/// of this.
const MOST: i32 = 56;

/// What the lanes' values of a channel are divided by, and what is subtracted then.
#[derive(Clone, Copy)]
pub(super) struct Units {
    /// Powers of two.
    pub(super) exponents: [i32; LANES],
    scales: Eight,
    offsets: Eight,
    /// The largest values, not yet divided.
    limits: Eight,
}

/// Eight groups, or eight parts of one.
pub(super) struct Batch<'a> {
    pub(super) lanes: [Group; LANES],
    /// The image's numbers of their windows' first pixels.
    corners: [usize; LANES],
    pub(super) is_joined: bool,
    /// Pixels of the largest group.
    pub(super) slots: usize,
    pub(super) units: [Units; Config::MAX_CHANNELS],
    /// Whether some pixels are in no fit.
    pub(super) leaves_out: bool,
    /// For each slot, 1 and the pixel's place along each axis, of unit variance; 0 where there is no pixel.
    pub(super) places: &'a mut [Eight],
    /// For each slot 1 where a pixel is that fits are made to, else 0.
    pub(super) inside: &'a mut [Eight],
    /// For each slot and channel, the lowest and the highest value.
    pub(super) ranges: &'a mut [Eight],
    /// For each slot and channel, the coefficient of what is known, and its integral.
    pub(super) coefficients: &'a mut [Eight],
    pub(super) integrals: &'a mut [Eight],
    /// Values of a sample.
    pub(super) values: usize,
    /// For each slot and value, its mean in units.
    pub(super) means: &'a mut [Eight],
    /// For each slot the columns of its sample; of several, their means, without the fixed columns.
    pub(super) columns: &'a mut [Eight],
    pub(super) sums: Sums<'a>,
}

/// The sums of products of each part of the pixels.
pub(super) struct Sums<'a> {
    /// How many parts there are: colours, halves, or one where nothing is left out but in closed form.
    parts: usize,
    /// Of samples. Of several in each pixel, the values are differences from the pixel's first.
    pub(super) samples: Products<'a>,
    /// Of pixels with several samples: their means, times the root of their number. The values are those of the samples
    /// above, then whole.
    pub(super) pixels: Products<'a>,
}

/// Sums of products, part after part.
pub(super) struct Products<'a> {
    parts: usize,
    /// Of columns with columns, packed.
    grams: &'a mut [Eight],
    /// Of each value with columns.
    sides: &'a mut [Eight],
    /// Of each value with itself.
    squares: &'a mut [Eight],
}

/// Those of one part.
pub(super) struct Part<'a> {
    pub(super) grams: &'a [Eight],
    pub(super) sides: &'a [Eight],
    pub(super) squares: &'a [Eight],
}

/// Sums of products of some parts.
pub(super) struct Total<'a> {
    pub(super) gram: &'a mut [Eight],
    pub(super) sides: &'a mut [Eight],
    pub(super) squares: &'a mut [Eight],
}

impl<'a> Total<'a> {
    pub(super) fn new(columns: usize, values: usize, arena: &mut Arena<'a, f32>) -> Result<Self, Error> {
        Ok(Self {
            gram: arena.take_lanes(packed_len(columns))?,
            sides: arena.take_lanes(values * columns)?,
            squares: arena.take_lanes(values)?,
        })
    }
}

/// Lanes of sums of products of so many columns and values.
pub(super) fn products_len(columns: usize, values: usize) -> usize {
    packed_len(columns) + values * columns + values
}

/// Numbers that a batch of so many slots takes.
pub(super) fn batch_len(layout: &Layout<'_>, terms: &Terms, slots: usize) -> Option<usize> {
    let (columns, fixed) = (terms.columns(), terms.fixed());
    let (channels, values) = (layout.config.channels, layout.values());
    let known = if layout.image.has_known() { 2 * channels + RELATIVE } else { 0 };
    let each = fixed + 1 + 2 * channels + values + columns + known;
    let products = products_len(columns, values) + products_len(columns, 2 * values);
    let sums = COLOURS * products + AT_ONCE * (2 * columns + 3 * values) + values;
    slots.checked_mul(each)?.checked_add(sums)?.checked_mul(LANES)
}

/// The lanes where `mask` is not 0; 0 elsewhere, whatever is there.
#[inline(always)]
pub(super) fn only(mask: &Eight, value: &Eight) -> Eight {
    lanes::zip(value, mask, |value, mask| if mask > 0.0 { value } else { 0.0 })
}

/// The sum lane by lane.
#[inline(always)]
pub(super) fn plus(a: &Eight, b: &Eight) -> Eight {
    lanes::zip(a, b, |a, b| a + b)
}

/// 2 to the power of an exponent from -126 to 127.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127).clamp(0, 254) as u32) << 23)
}

impl Sums<'_> {
    /// The part that a colour belongs to.
    #[inline(always)]
    fn part(&self, colour: usize) -> usize {
        match self.parts {
            1 => 0,
            2 => usize::from(Colours::HALVES[1].has(colour)),
            _ => colour % COLOURS,
        }
    }

    /// Whether a part is of some colours.
    #[inline(always)]
    fn is_of(&self, part: usize, colours: Colours) -> bool {
        (0..COLOURS).any(|colour| colours.has(colour) && self.part(colour) == part)
    }

    /// Joins the lanes, in all of them.
    fn join(&mut self) {
        let products = [&mut self.samples, &mut self.pixels];
        products.into_iter().flat_map(Products::each).for_each(|sum| *sum = [lanes::sum(sum); LANES]);
    }

    /// The sums of the pixels of some colours.
    #[inline(always)]
    pub(super) fn total(&self, colours: Colours, products: &Products<'_>, total: &mut Total<'_>) {
        let sums = [(&mut *total.gram, &*products.grams), (total.sides, &*products.sides)];
        for (out, sums) in sums.into_iter().chain([(&mut *total.squares, &*products.squares)]) {
            let mut is_first = true;
            for (_, sums) in rows(sums, out.len()).enumerate().filter(|&(part, _)| self.is_of(part, colours)) {
                if is_first {
                    out.iter_mut().zip(sums).for_each(|(out, sum)| *out = *sum);
                } else {
                    out.iter_mut().zip(sums).for_each(|(out, sum)| *out = plus(out, sum));
                }
                is_first = false;
            }
        }
    }
}

impl<'a> Products<'a> {
    fn new(parts: usize, columns: usize, values: usize, arena: &mut Arena<'a, f32>) -> Result<Self, Error> {
        Ok(Self {
            parts,
            grams: arena.take_lanes(parts * packed_len(columns))?,
            sides: arena.take_lanes(parts * values * columns)?,
            squares: arena.take_lanes(parts * values)?,
        })
    }

    /// The sums of a part.
    pub(super) fn part(&self, part: usize) -> Part<'_> {
        let values = self.squares.len().checked_div(self.parts).unwrap_or(0);
        let columns = self.sides.len().checked_div(self.parts * values).unwrap_or(0);
        Part {
            grams: row_at(self.grams, packed_len(columns), part),
            sides: row_at(self.sides, values * columns, part),
            squares: row_at(self.squares, values, part),
        }
    }

    fn each(&mut self) -> impl Iterator<Item = &mut Eight> {
        self.grams.iter_mut().chain(self.sides.iter_mut()).chain(self.squares.iter_mut())
    }

    /// Adds four rows: their columns, and their values.
    #[inline(always)]
    fn add(&mut self, part: usize, columns: [&[Eight]; AT_ONCE], values: [&[Eight]; AT_ONCE]) {
        let [a, b, c, d] = columns;
        let width = a.len();
        let mut gram = row_at_mut(self.grams, packed_len(width), part);
        for (i, (((&ai, &bi), &ci), &di)) in a.iter().zip(b).zip(c).zip(d).enumerate() {
            let Some((row, rest)) = gram.split_at_mut_checked(i + 1) else { return };
            gram = rest;
            for ((((out, a), b), c), d) in row.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *out = plus_four(*out, [(ai, *a), (bi, *b), (ci, *c), (di, *d)]);
            }
        }
        let count = values[0].len();
        let squares = row_at_mut(self.squares, count, part);
        let sides = row_at_mut(self.sides, count * width, part);
        for (value, (sides, square)) in rows_mut(sides, width).zip(squares).enumerate() {
            let [va, vb, vc, vd] = values.map(|values| values.get(value).copied().unwrap_or(NONE));
            for ((((out, a), b), c), d) in sides.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *out = plus_four(*out, [(va, *a), (vb, *b), (vc, *c), (vd, *d)]);
            }
            *square = plus_four(*square, [(va, va), (vb, vb), (vc, vc), (vd, vd)]);
        }
    }
}

/// Rows that are added four at a time.
struct Pending<'a> {
    columns: &'a mut [Eight],
    values: &'a mut [Eight],
    /// Columns and values of a row.
    widths: [usize; 2],
    held: usize,
}

impl<'a> Pending<'a> {
    fn new(columns: usize, values: usize, arena: &mut Arena<'a, f32>) -> Result<Self, Error> {
        let rows = [arena.take_lanes(AT_ONCE * columns)?, arena.take_lanes(AT_ONCE * values)?];
        let [all, each] = rows;
        Ok(Self { columns: all, values: each, widths: [columns, values], held: 0 })
    }

    /// The next row's columns and values.
    #[inline(always)]
    fn row(&mut self) -> (&mut [Eight], &mut [Eight]) {
        let [columns, values] = self.widths;
        (row_at_mut(self.columns, columns, self.held), row_at_mut(self.values, values, self.held))
    }

    /// Counts that row, and adds it with three others.
    #[inline(always)]
    fn push(&mut self, part: usize, products: &mut Products<'_>) {
        self.held += 1;
        if self.held == AT_ONCE {
            let [columns, values] = self.widths;
            let four = |all, width| [0, 1, 2, 3].map(|row| row_at::<Eight>(all, width, row));
            products.add(part, four(self.columns, columns), four(self.values, values));
            self.held = 0;
        }
    }

    /// Adds what is left.
    #[inline(always)]
    fn finish(&mut self, part: usize, products: &mut Products<'_>) {
        while self.held > 0 {
            let (columns, values) = self.row();
            columns.iter_mut().chain(values).for_each(|value| *value = NONE);
            self.push(part, products);
        }
    }
}

/// A sum and four products, one after the other.
#[inline(always)]
fn plus_four(sum: Eight, products: [(Eight, Eight); AT_ONCE]) -> Eight {
    products.into_iter().fold(sum, |sum, (a, b)| lanes::plus_product(sum, a, b))
}

impl<'a> Batch<'a> {
    /// Room for groups of which none is larger than the first.
    pub(super) fn new(
        call: &Call<'_>,
        groups: &Groups<'_>,
        terms: &Terms,
        lanes: [Group; LANES],
        arena: &mut Arena<'a, f32>,
    ) -> Result<Self, Error> {
        let [Group { len, .. }, ..] = lanes;
        let slots = if call.is_joined() { len.div_ceil(LANES) } else { len };
        let (columns, channels, values) = (terms.columns(), call.config.channels, call.values());
        let known = if call.image.has_known() { slots * channels } else { 0 };
        let parts = if call.n > 1 { COLOURS } else { call.turns() };
        Ok(Self {
            lanes,
            corners: lanes.map(|group| call.corner(groups, &group)),
            is_joined: call.is_joined(),
            slots,
            units: [Units { exponents: [0; LANES], scales: NONE, offsets: NONE, limits: NONE }; Config::MAX_CHANNELS],
            leaves_out: false,
            places: arena.take_lanes(slots * terms.fixed())?,
            inside: arena.take_lanes(slots)?,
            ranges: arena.take_lanes(slots * 2 * channels)?,
            coefficients: arena.take_lanes(known)?,
            integrals: arena.take_lanes(known)?,
            values,
            means: arena.take_lanes(slots * values)?,
            columns: arena.take_lanes(slots * columns)?,
            sums: Sums {
                parts,
                samples: Products::new(parts, columns, values, arena)?,
                pixels: Products::new(if call.n > 1 { parts } else { 0 }, columns, 2 * values, arena)?,
            },
        })
    }

    /// Where in a lane's group the pixel of a slot is; None if it has no more.
    #[inline(always)]
    pub(super) fn member(&self, lane: usize, slot: usize) -> Option<usize> {
        let index = if self.is_joined { slot * LANES + lane } else { slot };
        (index < self.lanes[lane % LANES].len).then_some(index)
    }

    /// The image's number of a slot's pixel in a lane, and its column, row and frame in its window.
    #[inline(always)]
    pub(super) fn pixel(
        &self,
        call: &Call<'_>,
        groups: &Groups<'_>,
        lane: usize,
        slot: usize,
    ) -> Option<(usize, [usize; 3])> {
        let index = self.member(lane, slot)?;
        if self.is_joined {
            return Some((index, [0; 3]));
        }
        let [x, y, frame] = groups.place(&self.lanes[lane % LANES], index).split();
        let Rectangle { width, height, .. } = call.windows.given;
        Some((self.corners[lane % LANES] + (frame * height + y) * width + x, [x, y, frame]))
    }

    /// Where the lanes' pixels are, and between what values theirs lie.
    #[inline(always)]
    pub(super) fn survey(&mut self, call: &Call<'_>, groups: &Groups<'_>, terms: &Terms) {
        let (fixed, channels) = (terms.fixed(), call.config.channels);
        let axes = call.windows.used_axes();
        let scales = axes.map(|axis| (SQRT_3 / call.windows.extent[axis % MAX_AXES].max(1) as f64) as f32);
        for slot in 0..self.slots {
            let mut places = [NONE; MAX_FIXED];
            for lane in 0..LANES {
                let Some((pixel, at)) = self.pixel(call, groups, lane, slot) else { continue };
                places[0][lane] = 1.0;
                for axis in 0..MAX_AXES {
                    places[1 + axis][lane] = (2 * at[axes[axis] % MAX_AXES] + 1) as f32 * scales[axis] - SQRT_3 as f32;
                }
                let ranges = row_at_mut(self.ranges, 2 * channels, slot);
                for (channel, range) in rows_mut(ranges, 2).enumerate() {
                    if let [low, high] = range {
                        [low[lane], high[lane]] = call.range(pixel, channel);
                    }
                }
            }
            for (out, place) in row_at_mut(self.places, fixed, slot).iter_mut().zip(&places) {
                *out = *place;
            }
            for range in row_at_mut(self.ranges, 2 * channels, slot) {
                *range = only(&places[0], range);
            }
            if let Some(inside) = self.inside.get_mut(slot) {
                *inside = places[0];
            }
        }
    }

    /// Keeps pixels beyond their group's limits out of all fits.
    pub(super) fn leave_out<'l>(&mut self, channels: usize, limits: impl Fn(&Group) -> &'l [f32]) {
        self.leaves_out = true;
        for channel in 0..channels {
            let (mut lowest, mut highest) = (NONE, NONE);
            for (lane, group) in self.lanes.iter().enumerate() {
                if let &[low, high] = row_at(limits(group), 2, channel) {
                    [lowest[lane % LANES], highest[lane % LANES]] = [low, high];
                }
            }
            for (inside, ranges) in self.inside.iter_mut().zip(rows(self.ranges, 2 * channels)) {
                let &[low, high] = row_at(ranges, 2, channel) else { continue };
                for l in 0..LANES {
                    let is_within = lowest[l] <= low[l] && high[l] <= highest[l];
                    inside[l] = if is_within { inside[l] } else { 0.0 };
                }
            }
        }
    }

    /// As for one pixel's samples: the zero at a value, the unit near the largest.
    #[inline(always)]
    fn set_units(&mut self, channels: usize) {
        for (channel, units) in self.units.iter_mut().enumerate().take(channels) {
            let mut largest = NONE;
            let mut first = [f32::INFINITY; LANES];
            for (inside, ranges) in self.inside.iter().zip(rows(self.ranges, 2 * channels)) {
                let &[low, high] = row_at(ranges, 2, channel) else { continue };
                for l in 0..LANES {
                    let most = Real::max(Real::abs(low[l]), Real::abs(high[l]));
                    largest[l] = if inside[l] > 0.0 { Real::max(most, largest[l]) } else { largest[l] };
                    first[l] = if inside[l] > 0.0 && first[l] == f32::INFINITY { low[l] } else { first[l] };
                }
            }
            if self.is_joined {
                largest = [largest.into_iter().fold(0.0, Real::max); LANES];
                first = [first.into_iter().find(|&first| first < f32::INFINITY).unwrap_or(0.0); LANES];
            }
            for l in 0..LANES {
                units.exponents[l] = Real::exponent(largest[l]).clamp(-126, 126);
                units.scales[l] = power_of_two(-units.exponents[l]);
                units.limits[l] = power_of_two(units.exponents[l] + MOST);
                units.offsets[l] = if first[l] < f32::INFINITY { first[l] * units.scales[l] } else { 0.0 };
            }
        }
    }

    /// Reads all samples and sums their products.
    #[inline(always)]
    pub(super) fn load(
        &mut self,
        call: &Call<'_>,
        groups: &Groups<'_>,
        terms: &Terms,
        arena: &mut Arena<'_, f32>,
    ) -> Result<(), Error> {
        let (width, n, count) = (terms.columns(), call.n, self.values);
        let channels = call.config.channels;
        let mut position = Position { x: [NONE; MAX_DIMS], h: [NONE; Config::MAX_CONTROLS] };
        let mut arena = arena.scratch();
        let mut samples = Pending::new(width, count, &mut arena)?;
        let mut pixels = Pending::new(width, 2 * count, &mut arena)?;
        let first = arena.take_lanes(count)?;
        self.set_units(channels);
        self.sums.samples.each().chain(self.sums.pixels.each()).for_each(|sum| *sum = NONE);
        for part in 0..self.sums.parts {
            for slot in 0..self.slots {
                if self.sums.part(slot) != part {
                    continue;
                }
                let number = |lane| self.pixel(call, groups, lane, slot).map(|(pixel, _)| pixel);
                let numbers = [0, 1, 2, 3, 4, 5, 6, 7].map(number);
                let inside = self.inside.get(slot).copied().unwrap_or(NONE);
                let places = row_at(self.places, terms.fixed(), slot);
                let [coefficients, integrals] =
                    [&*self.coefficients, &*self.integrals].map(|all| row_at(all, channels, slot));
                let pixels_of = Pixels { units: &self.units, terms, numbers, places, coefficients, integrals };
                let columns_of = row_at_mut(self.columns, width, slot);
                let means = row_at_mut(self.means, count, slot);
                for sample in 0..n {
                    let (columns, values) = samples.row();
                    call.read(&pixels_of, sample, &mut position, columns, values);
                    if sample == 0 {
                        columns_of.iter_mut().zip(columns.iter()).for_each(|(sum, column)| *sum = *column);
                        first.iter_mut().zip(values.iter()).for_each(|(first, value)| *first = *value);
                    } else {
                        columns_of.iter_mut().zip(columns.iter()).for_each(|(sum, column)| *sum = plus(sum, column));
                    }
                    if n > 1 {
                        // Differences tell equal values from such as are nearly so.
                        for ((value, first), sum) in values.iter_mut().zip(first.iter()).zip(means.iter_mut()) {
                            *value = lanes::zip(value, first, |value, first| value - first);
                            *sum = if sample == 0 { *value } else { plus(sum, value) };
                        }
                    } else {
                        means.iter_mut().zip(values.iter()).for_each(|(mean, value)| *mean = *value);
                    }
                    if self.leaves_out {
                        columns.iter_mut().chain(values).for_each(|value| *value = only(&inside, value));
                    }
                    samples.push(part, &mut self.sums.samples);
                }
                if n > 1 {
                    let inverse = 1.0 / n as f32;
                    let root = Real::sqrt(n as f32);
                    columns_of.iter_mut().chain(means.iter_mut()).for_each(|sum| *sum = sum.map(|sum| sum * inverse));
                    let (columns, values) = pixels.row();
                    let (differences, whole) = values.split_at_mut_checked(count).unwrap_or_default();
                    let means = means.iter_mut().zip(first.iter());
                    for ((mean, first), (difference, whole)) in means.zip(differences.iter_mut().zip(whole)) {
                        *difference = *mean;
                        *mean = plus(mean, first);
                        *whole = *mean;
                    }
                    columns.iter_mut().zip(columns_of.iter()).for_each(|(out, mean)| *out = *mean);
                    columns.iter_mut().chain(values).for_each(|value| {
                        *value = only(&inside, &value.map(|value| value * root));
                    });
                    pixels.push(part, &mut self.sums.pixels);
                    columns_of.iter_mut().take(terms.fixed()).for_each(|column| *column = NONE);
                }
            }
            samples.finish(part, &mut self.sums.samples);
            if n > 1 {
                pixels.finish(part, &mut self.sums.pixels);
            }
        }
        if self.is_joined {
            self.sums.join();
        }
        Ok(())
    }
}

/// Where eight samples are, and their control functions: what is left of other samples where there is no pixel.
struct Position {
    x: [Eight; MAX_DIMS],
    h: [Eight; Config::MAX_CONTROLS],
}

/// The pixels of a slot.
struct Pixels<'a> {
    units: &'a [Units; Config::MAX_CHANNELS],
    terms: &'a Terms,
    /// The image's numbers of them.
    numbers: [Option<usize>; LANES],
    places: &'a [Eight],
    /// Of each channel, if something is known.
    coefficients: &'a [Eight],
    integrals: &'a [Eight],
}

impl Call<'_> {
    /// A pixel's lowest and highest value, as fits see them.
    #[inline(always)]
    fn range(&self, pixel: usize, channel: usize) -> [f32; 2] {
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for sample in pixel * self.n..(pixel + 1) * self.n {
            let value = self.value(pixel, sample, channel);
            range = [Real::min(value, range[0]), Real::max(value, range[1])];
        }
        range
    }

    /// A channel of a sample, divided by its pixel's factor.
    #[inline(always)]
    pub(super) fn value(&self, pixel: usize, sample: usize, channel: usize) -> f32 {
        self.over_factor(self.reader.input(sample, channel), pixel, channel)
    }

    /// What is known of it, divided likewise.
    #[inline(always)]
    pub(super) fn known(&self, pixel: usize, sample: usize, channel: usize) -> f32 {
        let known = self.image.known.get(sample * self.config.channels + channel).copied().unwrap_or(0.0);
        self.over_factor(known, pixel, channel)
    }

    /// The integral of what is known, divided likewise.
    #[inline(always)]
    pub(super) fn integral(&self, pixel: usize, channel: usize) -> f32 {
        let integral = self.image.known_integrals.get(pixel * self.config.channels + channel).copied().unwrap_or(0.0);
        self.over_factor(integral, pixel, channel)
    }

    /// Divides by a pixel's factor.
    #[inline(always)]
    fn over_factor(&self, value: f32, pixel: usize, channel: usize) -> f32 {
        if self.image.factors.is_empty() {
            return value;
        }
        let most = f64::from(f32::MAX);
        (f64::from(value) / self.factor(pixel, channel)).clamp(-most, most) as f32
    }

    /// What a pixel's values are divided by. Black says nothing about what it multiplies: 1.
    #[inline(always)]
    pub(super) fn factor(&self, pixel: usize, channel: usize) -> f64 {
        let factor = self.image.factors.get(pixel * self.config.channels + channel).copied().unwrap_or(1.0);
        if factor > 0.0 { f64::from(factor) } else { 1.0 }
    }

    /// Writes a sample of eight pixels: its columns, and its values in units. Zero where there is no pixel.
    #[inline(always)]
    fn read(
        &self,
        pixels: &Pixels<'_>,
        sample: usize,
        position: &mut Position,
        columns: &mut [Eight],
        values: &mut [Eight],
    ) {
        let Pixels { units, terms, numbers, places, coefficients, integrals } = pixels;
        let channels = self.config.channels;
        let (inputs, rest) = values.split_at_mut_checked(channels).unwrap_or_default();
        let Position { x, h } = position;
        let mut is_full = true;
        for (lane, pixel) in numbers.iter().enumerate() {
            let &Some(pixel) = pixel else {
                is_full = false;
                continue;
            };
            let index = pixel * self.n + sample;
            self.reader.put_position(index, lane, x);
            if self.config.controls > 0 {
                self.reader.get(index).put(lane, x, h);
            }
            for (channel, value) in inputs.iter_mut().enumerate() {
                value[lane % LANES] = self.value(pixel, index, channel);
            }
            let known = coefficients.iter().zip(*integrals).zip(rest.iter_mut()).zip(inputs.iter());
            for (channel, (((coefficient, integral), out), value)) in known.enumerate() {
                let apart = self.known(pixel, index, channel) - integral[lane % LANES];
                let left = value[lane % LANES] - coefficient[lane % LANES] * apart;
                out[lane % LANES] = left;
            }
        }
        let one = places.first().copied().unwrap_or(NONE);
        for (value, units) in values.iter_mut().zip(units.iter().take(channels).cycle()) {
            // Only what no fit is made to, or is known of it, is far beyond the unit; its square fits too.
            let limited = lanes::zip(value, &units.limits, |value, most| Real::min(Real::max(value, -most), most));
            let scaled = lanes::zip(&only(&one, &limited), &units.scales, |value, scale| value * scale);
            *value = only(&one, &lanes::zip(&scaled, &units.offsets, |value, offset| value - offset));
        }
        let (fixed, rest) = columns.split_at_mut_checked(terms.fixed()).unwrap_or_default();
        for (out, place) in fixed.iter_mut().zip(places.iter()) {
            *out = *place;
        }
        let (functions, products) = rest.split_at_mut_checked(terms.functions).unwrap_or_default();
        self.reader.columns(self.basis, x, h, functions);
        if !is_full {
            functions.iter_mut().for_each(|column| *column = only(&one, column));
        }
        let (first, count) = terms.moving;
        let moving = functions.get(first..first + count).unwrap_or(&[]);
        for (products, axis) in rows_mut(products, count).zip(places.iter().skip(1)) {
            for (out, function) in products.iter_mut().zip(moving) {
                *out = lanes::zip(function, axis, |function, axis| function * axis);
            }
        }
    }
}
