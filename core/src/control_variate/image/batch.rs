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
use crate::matrix::{packed_len, row_at, row_at_mut};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// A number for each of eight groups.
pub(super) type Eight = Lanes<f32>;
/// The same for four samples or pixels of each.
pub(super) type Four = [Eight; AT_ONCE];
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

impl Units {
    /// Two to the powers of the exponents.
    #[inline(always)]
    pub(super) fn powers(&self) -> Eight {
        self.exponents.map(power_of_two)
    }
}

/// 2 to the power of an exponent from -126 to 127.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127).clamp(0, 254) as u32) << 23)
}

/// Which of the parts a slot, or its colour, belongs to.
#[inline(always)]
fn part_of(parts: usize, slot: usize) -> usize {
    match parts {
        1 => 0,
        2 => usize::from(Colours::HALVES[1].has(slot)),
        _ => slot % COLOURS,
    }
}

impl Sums<'_> {
    /// Whether a part is of some colours.
    #[inline(always)]
    fn is_of(&self, part: usize, colours: Colours) -> bool {
        (0..COLOURS).any(|colour| colours.has(colour) && part_of(self.parts, colour) == part)
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
                    for (out, sum) in out.iter_mut().zip(sums) {
                        *out = plus(out, sum);
                        lanes::keep_together();
                    }
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

    /// Adds the rows of a block: its columns, and its values.
    #[inline(always)]
    fn add(&mut self, part: usize, columns: &[Four], values: &[Four]) {
        let (width, count) = (columns.len(), values.len());
        let mut gram = row_at_mut(self.grams, packed_len(width), part);
        for (i, column) in columns.iter().enumerate() {
            let Some((row, rest)) = gram.split_at_mut_checked(i + 1) else { return };
            gram = rest;
            add_products(row, column, columns);
        }
        let squares = row_at_mut(self.squares, count, part);
        let sides = row_at_mut(self.sides, count * width, part);
        for ((value, sides), square) in values.iter().zip(rows_mut(sides, width)).zip(squares) {
            add_products(sides, value, columns);
            *square = plus_four(*square, value, value);
        }
    }
}

/// Adds to each sum the products of a column with one of `columns`.
#[inline(always)]
fn add_products(sums: &mut [Eight], column: &Four, columns: &[Four]) {
    let column = *column;
    for (sum, other) in sums.iter_mut().zip(columns) {
        *sum = plus_four(*sum, &column, other);
        lanes::keep_together();
    }
}

/// A sum and four products, one after the other.
#[inline(always)]
fn plus_four(mut sum: Eight, a: &Four, b: &Four) -> Eight {
    for row in 0..AT_ONCE {
        sum = lanes::plus_product(sum, a[row], b[row]);
    }
    sum
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
            let mut one = NONE;
            // Of each axis twice where they are, and 1.
            let mut halves = [[0_i32; LANES]; MAX_AXES];
            for lane in 0..LANES {
                let Some((pixel, at)) = self.pixel(call, groups, lane, slot) else { continue };
                one[lane] = 1.0;
                for (halves, at) in halves.iter_mut().zip(at) {
                    halves[lane] = 2 * at as i32 + 1;
                }
                let ranges = row_at_mut(self.ranges, 2 * channels, slot);
                for (channel, range) in rows_mut(ranges, 2).enumerate() {
                    if let [low, high] = range {
                        [low[lane], high[lane]] = call.range(pixel, channel);
                    }
                }
            }
            if let Some((first, places)) = row_at_mut(self.places, fixed, slot).split_first_mut() {
                *first = one;
                for (place, (axis, scale)) in places.iter_mut().zip(axes.iter().zip(scales)) {
                    *place = only(&one, &halves[axis % MAX_AXES].map(|at| at as f32 * scale - SQRT_3 as f32));
                    lanes::keep_together();
                }
            }
            for range in row_at_mut(self.ranges, 2 * channels, slot) {
                *range = only(&one, range);
                lanes::keep_together();
            }
            if let Some(inside) = self.inside.get_mut(slot) {
                *inside = one;
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
                lanes::keep_together();
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

    /// The image's numbers of a slot's pixels; where a lane has none, that of another.
    #[inline(always)]
    fn numbers(&self, call: &Call<'_>, groups: &Groups<'_>, slot: usize) -> [usize; LANES] {
        let first = self.pixel(call, groups, 0, 0).map_or(0, |(pixel, _)| pixel);
        let mut numbers = [first; LANES];
        for (lane, number) in numbers.iter_mut().enumerate() {
            if let Some((pixel, _)) = self.pixel(call, groups, lane, slot) {
                *number = pixel;
            }
        }
        numbers
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
        let mut arena = arena.scratch();
        let mut samples = Block::new(terms.columns(), self.values, &mut arena)?;
        let mut pixels = Block::new(terms.columns(), 2 * self.values, &mut arena)?;
        let first = arena.take_lanes(self.values)?;
        self.set_units(call.config.channels);
        self.sums.samples.each().chain(self.sums.pixels.each()).for_each(|sum| *sum = NONE);
        for part in 0..self.sums.parts {
            let slots = self.slots;
            let parts = self.sums.parts;
            let mut slots = (0..slots).filter(move |&slot| part_of(parts, slot) == part);
            if call.n == 1 {
                while let Some(four) = next_four(&mut slots) {
                    self.load_singles(call, groups, terms, &mut samples, &four);
                    self.sums.samples.add(part, samples.columns, samples.values);
                }
                continue;
            }
            let mut held = 0;
            for slot in slots {
                self.load_several(call, groups, terms, &mut samples, (part, slot), first);
                self.put_means(call, terms, &mut pixels, (slot, held), first);
                held += 1;
                if held == AT_ONCE {
                    self.sums.pixels.add(part, pixels.columns, pixels.values);
                    held = 0;
                }
            }
            if held > 0 {
                for four in pixels.columns.iter_mut().chain(pixels.values.iter_mut()) {
                    four.iter_mut().skip(held).for_each(|row| *row = NONE);
                }
                self.sums.pixels.add(part, pixels.columns, pixels.values);
            }
        }
        if self.is_joined {
            self.sums.join();
        }
        Ok(())
    }

    /// Reads the samples of four slots, and keeps their columns and values.
    #[inline(always)]
    fn load_singles(
        &mut self,
        call: &Call<'_>,
        groups: &Groups<'_>,
        terms: &Terms,
        block: &mut Block<'_>,
        slots: &[Option<usize>; AT_ONCE],
    ) {
        let mut rows = [None; AT_ONCE];
        for (row, slot) in rows.iter_mut().zip(slots) {
            *row = slot.map(|slot| Row { slot, sample: 0, pixels: self.numbers(call, groups, slot) });
        }
        call.read(self, terms, &rows, block);
        for (row, slot) in slots.iter().enumerate() {
            let Some(slot) = *slot else { continue };
            keep_row(row_at_mut(self.columns, terms.columns(), slot), block.columns, row);
            keep_row(row_at_mut(self.means, self.values, slot), block.values, row);
        }
        self.mask(block, &rows);
    }

    /// Reads the samples of one slot, adds their products, and keeps the sums of their columns, the values of the first
    /// and how far the others are from them.
    #[inline(always)]
    fn load_several(
        &mut self,
        call: &Call<'_>,
        groups: &Groups<'_>,
        terms: &Terms,
        block: &mut Block<'_>,
        (part, slot): (usize, usize),
        first: &mut [Eight],
    ) {
        let pixels = self.numbers(call, groups, slot);
        for begin in (0..call.n).step_by(AT_ONCE) {
            let mut rows = [None; AT_ONCE];
            for (row, out) in rows.iter_mut().enumerate() {
                *out = (begin + row < call.n).then_some(Row { slot, sample: begin + row, pixels });
            }
            call.read(self, terms, &rows, block);
            if begin == 0 {
                keep_row(first, block.values, 0);
            }
            // Differences tell equal values from such as are nearly so.
            for (values, first) in block.values.iter_mut().zip(first.iter()) {
                for value in values.iter_mut().take(call.n - begin) {
                    *value = lanes::zip(value, first, |value, first| value - first);
                }
            }
            let sums = row_at_mut(self.columns, terms.columns(), slot).iter_mut().zip(block.columns.iter());
            let means = row_at_mut(self.means, self.values, slot).iter_mut().zip(block.values.iter());
            for (sum, [a, b, c, d]) in sums.chain(means) {
                let before = if begin == 0 { *a } else { plus(sum, a) };
                *sum = plus(&plus(&plus(&before, b), c), d);
                lanes::keep_together();
            }
            self.mask(block, &rows);
            self.sums.samples.add(part, block.columns, block.values);
        }
    }

    /// Makes means of a slot's sums, and a row of them.
    #[inline(always)]
    fn put_means(
        &mut self,
        call: &Call<'_>,
        terms: &Terms,
        block: &mut Block<'_>,
        (slot, row): (usize, usize),
        first: &[Eight],
    ) {
        let (inverse, root) = (1.0 / call.n as f32, Real::sqrt(call.n as f32));
        let inside = self.inside.get(slot).copied().unwrap_or(NONE);
        let put = |out: &mut Four, mean: &Eight| {
            out[row % AT_ONCE] = only(&inside, &mean.map(|mean| mean * root));
        };
        let columns = row_at_mut(self.columns, terms.columns(), slot);
        for (out, sum) in block.columns.iter_mut().zip(columns.iter_mut()) {
            *sum = sum.map(|sum| sum * inverse);
            put(out, sum);
            lanes::keep_together();
        }
        let (differences, whole) = block.values.split_at_mut_checked(self.values).unwrap_or_default();
        let means = row_at_mut(self.means, self.values, slot).iter_mut().zip(first);
        for ((mean, first), (difference, whole)) in means.zip(differences.iter_mut().zip(whole)) {
            *mean = mean.map(|sum| sum * inverse);
            put(difference, mean);
            *mean = plus(mean, first);
            put(whole, mean);
        }
        columns.iter_mut().take(terms.fixed()).for_each(|column| *column = NONE);
    }

    /// Empties the lanes of pixels that no fit is made to.
    #[inline(always)]
    fn mask(&self, block: &mut Block<'_>, rows: &[Option<Row>; AT_ONCE]) {
        if !self.leaves_out {
            return;
        }
        for (row, at) in rows.iter().enumerate() {
            let inside = at.and_then(|at| self.inside.get(at.slot)).copied().unwrap_or(NONE);
            for four in block.columns.iter_mut().chain(block.values.iter_mut()) {
                four[row] = only(&inside, &four[row]);
            }
        }
    }
}

/// The next four slots, or fewer.
#[inline(always)]
pub(super) fn next_four(slots: &mut impl Iterator<Item = usize>) -> Option<[Option<usize>; AT_ONCE]> {
    let first = slots.next()?;
    Some([Some(first), slots.next(), slots.next(), slots.next()])
}

/// Copies a row of a block.
#[inline(always)]
fn keep_row(out: &mut [Eight], block: &[Four], row: usize) {
    for (out, four) in out.iter_mut().zip(block) {
        *out = four[row % AT_ONCE];
        lanes::keep_together();
    }
}

/// Samples of a slot: those of its pixels with one number.
#[derive(Clone, Copy)]
struct Row {
    slot: usize,
    sample: usize,
    /// The image's numbers of the pixels; of another where a lane has none.
    pixels: [usize; LANES],
}

/// Columns and values of four rows.
struct Block<'a> {
    /// Where they are, and their control functions: what is left of others where there is no row.
    x: [Lanes<f32, AT_ONCE_LANES>; MAX_DIMS],
    h: [Lanes<f32, AT_ONCE_LANES>; Config::MAX_CONTROLS],
    columns: &'a mut [Four],
    values: &'a mut [Four],
}

/// Numbers of a [`Four`].
const AT_ONCE_LANES: usize = AT_ONCE * LANES;

impl<'a> Block<'a> {
    fn new(columns: usize, values: usize, arena: &mut Arena<'a, f32>) -> Result<Self, Error> {
        Ok(Self {
            x: [[0.0; AT_ONCE_LANES]; MAX_DIMS],
            h: [[0.0; AT_ONCE_LANES]; Config::MAX_CONTROLS],
            columns: arena.take_lanes(AT_ONCE * columns)?.as_chunks_mut().0,
            values: arena.take_lanes(AT_ONCE * values)?.as_chunks_mut().0,
        })
    }
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

    /// Reads four rows of samples: their columns, and their values in units. Zero where there is no pixel.
    #[inline(always)]
    fn read(&self, batch: &Batch<'_>, terms: &Terms, rows: &[Option<Row>; AT_ONCE], block: &mut Block<'_>) {
        let Block { x, h, columns, values } = block;
        let (fixed, functions) = columns.split_at_mut_checked(terms.fixed()).unwrap_or_default();
        let mut is_full = true;
        for (row, at) in rows.iter().enumerate() {
            let places = at.as_ref().map_or(&[][..], |at| row_at(batch.places, terms.fixed(), at.slot));
            for (j, column) in fixed.iter_mut().enumerate() {
                column[row] = places.get(j).copied().unwrap_or(NONE);
                lanes::keep_together();
            }
            let one = places.first().copied().unwrap_or(NONE);
            is_full &= one == [1.0; LANES];
            let Some(at) = at else {
                values.iter_mut().for_each(|value| value[row] = NONE);
                continue;
            };
            for (lane, pixel) in at.pixels.iter().enumerate() {
                self.reader.put_position(pixel * self.n + at.sample, row * LANES + lane, x);
            }
            if self.config.controls > 0 {
                for (lane, pixel) in at.pixels.iter().enumerate() {
                    self.reader.get(pixel * self.n + at.sample).put(row * LANES + lane, x, h);
                }
            }
            self.read_values(batch, at, row, values);
            for (value, units) in values.iter_mut().zip(batch.units.iter().take(self.config.channels).cycle()) {
                // Only what no fit is made to, or is known of it, is far beyond the unit; its square fits too.
                let limited =
                    lanes::zip(&value[row], &units.limits, |value, most| Real::min(Real::max(value, -most), most));
                let scaled = lanes::zip(&only(&one, &limited), &units.scales, |value, scale| value * scale);
                value[row] = only(&one, &lanes::zip(&scaled, &units.offsets, |value, offset| value - offset));
                lanes::keep_together();
            }
        }
        let (functions, products) = functions.split_at_mut_checked(terms.functions).unwrap_or_default();
        let wide = functions.as_flattened_mut().as_flattened_mut().as_chunks_mut::<AT_ONCE_LANES>().0;
        self.reader.columns(self.basis, x, h, wide);
        if let (false, Some(one)) = (is_full, fixed.first()) {
            for column in functions.iter_mut() {
                for row in 0..AT_ONCE {
                    column[row] = only(&one[row], &column[row]);
                }
                lanes::keep_together();
            }
        }
        let (first, count) = terms.moving;
        let moving = functions.get(first..first + count).unwrap_or(&[]);
        for (products, axis) in rows_mut(products, count).zip(fixed.iter().skip(1)) {
            for (out, function) in products.iter_mut().zip(moving) {
                for row in 0..AT_ONCE {
                    out[row] = lanes::zip(&function[row], &axis[row], |function, axis| function * axis);
                }
                lanes::keep_together();
            }
        }
    }

    /// A row's values, as they were given but for factors and what is known of them.
    #[inline(always)]
    fn read_values(&self, batch: &Batch<'_>, at: &Row, row: usize, values: &mut [Four]) {
        let channels = self.config.channels;
        let (inputs, rest) = values.split_at_mut_checked(channels).unwrap_or_default();
        for (channel, value) in inputs.iter_mut().enumerate() {
            for (lane, pixel) in at.pixels.iter().enumerate() {
                value[row][lane] = self.value(*pixel, pixel * self.n + at.sample, channel);
            }
        }
        let [coefficients, integrals] =
            [&*batch.coefficients, &*batch.integrals].map(|all| row_at(all, channels, at.slot));
        let known = coefficients.iter().zip(integrals).zip(rest.iter_mut()).zip(inputs.iter());
        for (channel, (((coefficient, integral), out), value)) in known.enumerate() {
            for (lane, pixel) in at.pixels.iter().enumerate() {
                let apart = self.known(*pixel, pixel * self.n + at.sample, channel) - integral[lane];
                out[row][lane] = value[row][lane] - coefficient[lane] * apart;
            }
        }
    }
}
