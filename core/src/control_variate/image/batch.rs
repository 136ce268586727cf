//! Eight groups side by side, a lane each: their pixels and samples.
//!
//! A slot holds one pixel of each group, and a block four slots. Every fourth slot is of one colour. Where colours are
//! corrected by fits to the others, so are the slots of a block: that of the block's own number.

use super::super::config::Config;
use super::call::{Call, Layout};
use super::groups::{Group, Groups, Place};
use super::pixels::Image;
use super::products::{
    AT_ONCE, COLOURS, Colours, Eight, Four, NONE, Part, Rows, Sums, add_products, minus, only, plus, plus_four,
    product, times, total, zip_four,
};
use super::sliced::Sliced;
use super::terms::{MAX_AXES, Terms};
use crate::arena::Arena;
use crate::lanes::{self, LANES};
use crate::matrix::{at, copy, first_mut, from_mut, halves_mut, row, row_at, row_at_mut, row_mut};
use crate::real::Real;
use crate::rows::{first, halves, rows, rows_mut};
use core::array::from_fn;

/// The most numbers of a place.
pub(super) const MAX_FIXED: usize = 1 + MAX_AXES;
/// Sums of each slot from which the coefficients of what is known come.
pub(super) const KNOWN_SUMS: usize = 5;
/// Uniform coordinates from -1 to 1 times this have unit variance.
const SQRT_3: f64 = 1.732_050_807_568_877_2;
/// The largest value of a pixel that no fit is made to, in units of the largest that one is made to, is 2 to the power
/// of this.
const MOST: i32 = 56;

/// What the lanes' values of a channel are divided by, and what is subtracted then.
#[derive(Clone, Copy)]
pub(super) struct Units {
    /// Powers of two, and 1 over them.
    pub(super) powers: Eight,
    scales: Eight,
    offsets: Eight,
    /// The largest values, not yet divided.
    limits: Eight,
}

/// Eight groups, or eight parts of one.
pub(super) struct Batch<'a> {
    pub(super) call: &'a Call<'a>,
    pub(super) terms: Terms,
    pub(super) lanes: [Group; LANES],
    pub(super) is_joined: bool,
    /// Whether the slots of a block are of one colour.
    has_colours: bool,
    pub(super) units: [Units; Config::MAX_CHANNELS],
    /// Whether some pixels are in no fit.
    pub(super) leaves_out: bool,
    /// For each block, the given pixels' numbers, as bits; another's where there is none.
    numbers: &'a mut [Four],
    /// For each block, 1 and the pixels' places along each axis, of unit variance; 0 where there is no pixel.
    pub(super) places: &'a mut [Four],
    /// For each block 1 where a pixel is that fits are made to, else 0.
    pub(super) inside: &'a mut [Four],
    /// For each block and channel, the lowest and the highest value.
    pub(super) ranges: &'a mut [Four],
    /// For each block and channel, the coefficient of what is known, and its integral.
    pub(super) coefficients: &'a mut [Four],
    pub(super) integrals: &'a mut [Four],
    /// For each block, the slices of the pixels' samples, where slices are apart and pixels have one.
    pub(super) slices: &'a mut [Four],
    /// Values of a sample.
    pub(super) values: usize,
    /// For each block and value, its mean in units.
    pub(super) means: &'a mut [Four],
    /// For each block and function, its mean over the pixels' samples.
    pub(super) functions: &'a mut [Four],
    /// Of pixels' means, times the root of the number of samples.
    pub(super) between: Sums<'a>,
    /// Of several samples in each pixel, of how far they are from their pixel's mean.
    pub(super) within: Sums<'a>,
    /// Of samples, by slices where these are apart.
    pub(super) sliced: Sums<'a>,
}

pub(super) fn blocks(layout: &Layout<'_>, slots: usize) -> usize {
    if layout.has_colours() { COLOURS * slots.div_ceil(COLOURS * AT_ONCE) } else { slots.div_ceil(AT_ONCE) }
}

/// How many sums of pixels' means, and how many of what is within pixels, are kept apart.
fn parts(layout: &Layout<'_>) -> [usize; 2] {
    let parts = if layout.has_colours() { COLOURS } else { 1 };
    [parts, if layout.n > 1 { parts } else { 0 }]
}

/// For each pixel how many functions' means are kept, and how many slices.
fn kept(terms: &Terms, n: usize) -> (usize, usize) {
    match (terms.slices > 0, n) {
        (false, _) => (terms.functions, 0),
        (true, 1) => (terms.functions, 1),
        (true, _) => (0, 0),
    }
}

/// Numbers that a batch of so many slots takes.
pub(super) fn batch_len(layout: &Layout<'_>, terms: &Terms, slots: usize) -> Option<usize> {
    let (columns, functions) = (terms.columns(), terms.functions);
    let (channels, values) = (layout.config.channels, layout.values());
    let known = if layout.image.has_known() { 2 * (channels + KNOWN_SUMS) } else { 0 };
    let (kept, apart) = kept(terms, layout.n);
    let each = 2 + apart + terms.fixed() + 2 * channels + values + kept + known;
    let summed = terms.of_slices(values, layout.n);
    let rows = AT_ONCE * (functions + columns + values + values.max(summed));
    let pixel = Sums::len(kept, values) + kept + 2 * values;
    let deviations = AT_ONCE * (kept + values) * kept + AT_ONCE * values;
    let [between, within] = parts(layout);
    let sliced = between * terms.slices * Sums::len(columns, summed) + Sliced::len(terms.slices, columns, summed);
    let sums = between * Sums::len(terms.of_means(), values) + within * Sums::len(terms.of_deviations(), values);
    let sums = sums + sliced + rows + pixel + deviations;
    blocks(layout, slots).checked_mul(AT_ONCE * each)?.checked_add(sums)?.checked_mul(LANES)
}

impl Units {
    /// A value in units. Only what no fit is made to, or is known of it, is far beyond them; its square fits too.
    pub(super) fn apply(&self, value: &Eight) -> Eight {
        minus(&self.scale(value), &self.offsets)
    }

    /// The same with the zero at 0.
    pub(super) fn scale(&self, value: &Eight) -> Eight {
        let limited = lanes::zip(value, &self.limits, |value, most| Real::min(Real::max(value, -most), most));
        product(&limited, &self.scales)
    }
}

/// 2 to the power of an exponent from -126 to 127.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127).clamp(0, 254) as u32) << 23)
}

impl<'a> Batch<'a> {
    /// Room for groups of which none is larger than the first.
    pub(super) fn new(call: &'a Call<'a>, terms: Terms, lanes: [Group; LANES], arena: &mut Arena<'a, f32>) -> Self {
        let [Group { len, .. }, ..] = lanes;
        let slots = if call.is_joined() { len.div_ceil(LANES) } else { len };
        let (columns, channels, values) = (terms.columns(), call.config.channels, call.values());
        let (blocks, [between, within]) = (blocks(call, slots), parts(call));
        let known = if call.image.has_known() { blocks * channels } else { 0 };
        let ((kept, apart), summed) = (kept(&terms, call.n), terms.of_slices(values, call.n));
        Self {
            call,
            lanes,
            is_joined: call.is_joined(),
            has_colours: call.has_colours(),
            units: [Units { powers: NONE, scales: NONE, offsets: NONE, limits: NONE }; Config::MAX_CHANNELS],
            leaves_out: false,
            numbers: arena.take_fours(blocks),
            places: arena.take_fours(blocks * terms.fixed()),
            inside: arena.take_fours(blocks),
            ranges: arena.take_fours(blocks * 2 * channels),
            coefficients: arena.take_fours(known),
            integrals: arena.take_fours(known),
            slices: arena.take_fours(blocks * apart),
            values,
            means: arena.take_fours(blocks * values),
            functions: arena.take_fours(blocks * kept),
            between: Sums::new(between, terms.of_means(), values, arena),
            within: Sums::new(within, terms.of_deviations(), values, arena),
            sliced: Sums::new(between * terms.slices, columns, summed, arena),
            terms,
        }
    }

    /// The blocks that have pixels of some colours.
    pub(super) fn blocks(&self, colours: Colours) -> impl Iterator<Item = usize> + use<> {
        let has_colours = self.has_colours;
        (0..self.inside.len()).filter(move |&block| !has_colours || colours.has(block))
    }

    /// A sum over all pixels of a group, by those of its lanes.
    pub(super) fn joined(&self, sum: &Eight) -> Eight {
        if self.is_joined { [lanes::sum(sum); LANES] } else { *sum }
    }

    /// What there is of the samples of a colour about their pixels' means.
    pub(super) fn whole(&self, value: usize, colour: usize) -> Eight {
        at(self.within.part(colour).squares, value)
    }

    /// Of which colour a slot is.
    #[inline(always)]
    pub(super) fn colour(&self, (block, row): (usize, usize)) -> usize {
        (if self.has_colours { block } else { row }) % COLOURS
    }

    /// Where in its group the pixel of a slot is.
    pub(super) fn member(&self, (block, row): (usize, usize), lane: usize) -> usize {
        let slot = if self.has_colours {
            COLOURS * AT_ONCE * (block / COLOURS) + block % COLOURS + COLOURS * row
        } else {
            AT_ONCE * block + row
        };
        if self.is_joined { slot * LANES + lane } else { slot }
    }

    /// The given pixels of a slot; another's where a lane has none.
    pub(super) fn pixels(&self, (block, row): (usize, usize)) -> [usize; LANES] {
        at(self.numbers, block)[row % AT_ONCE].map(|number| number.to_bits() as usize)
    }

    /// Zero in the lanes of a block's slots without a pixel.
    #[inline(always)]
    pub(super) fn empty_missing<'f>(&self, block: usize, columns: impl Iterator<Item = &'f mut Four>) {
        let Some(one) = row_at(self.places, self.terms.fixed(), block).first() else { return };
        if *one != [[1.0; LANES]; AT_ONCE] {
            for column in columns {
                *column = zip_four(one, column, only);
                lanes::keep_together();
            }
        }
    }

    /// The columns of a block's pixels.
    #[inline(always)]
    pub(super) fn put_columns(&self, block: usize, columns: &mut [Four]) {
        let terms = &self.terms;
        let places = row_at(self.places, terms.fixed(), block);
        let functions = row_at(self.functions, terms.functions, block);
        copy(columns, places);
        let (out, products) = halves_mut(columns, terms.fixed() + terms.functions);
        copy(from_mut(out, terms.fixed()), functions);
        terms.multiply(places, functions, products);
    }

    /// Where the lanes' pixels are, and between what values theirs lie.
    #[inline(always)]
    pub(super) fn survey(&mut self, groups: &Groups<'_>) {
        let call = self.call;
        let (fixed, channels) = (self.terms.fixed(), call.config.channels);
        let axes = call.windows.used_axes();
        let scales = axes.map(|axis| (SQRT_3 / call.windows.extent[axis % MAX_AXES].max(1) as f64) as f32);
        let [width, height] = [call.windows.given.width, call.windows.given.height].map(|extent| extent as u32);
        let corners = self.lanes.map(|group| call.pixel(call.window(group.window), Place::default(), 0) as u32);
        let members = self.lanes.map(|group| groups.members(&group));
        let mut other = None;
        for block in 0..self.inside.len() {
            for row in 0..AT_ONCE {
                let (mut one, mut places) = (NONE, [0.0; LANES].map(Place::read));
                let mut numbers = [0; LANES];
                for lane in 0..LANES {
                    let index = self.member((block, row), lane);
                    numbers[lane] = index as u32;
                    one[lane] = if index < self.lanes[lane].len { 1.0 } else { 0.0 };
                    if let Some(&place) = members[lane].get(index) {
                        places[lane] = Place::read(place);
                    }
                }
                let along = Place::split_each(&places);
                if !self.is_joined {
                    for l in 0..LANES {
                        numbers[l] = corners[l] + (along[2][l] * height + along[1][l]) * width + along[0][l];
                    }
                }
                let other = *other.get_or_insert(numbers[0]);
                for l in 0..LANES {
                    numbers[l] = if one[l] > 0.0 { numbers[l] } else { other };
                }
                let pixels = numbers.map(|number| (number & Image::MAX_PIXELS) as usize);
                for (channel, range) in
                    row_at_mut(self.ranges, 2 * channels, block).as_chunks_mut().0.iter_mut().enumerate()
                {
                    let [low, high]: &mut [Four; 2] = range;
                    [low[row], high[row]] = call.range(&pixels, channel).map(|value| only(&one, &value));
                }
                if let (Some(out), Some(inside)) = (self.numbers.get_mut(block), self.inside.get_mut(block)) {
                    (out[row], inside[row]) = (pixels.map(|pixel| f32::from_bits(pixel as u32)), one);
                }
                let Some((first, places)) = row_at_mut(self.places, fixed, block).split_first_mut() else { continue };
                first[row] = one;
                for (place, (axis, scale)) in places.iter_mut().zip(axes.iter().zip(scales)) {
                    let halves = along[axis % MAX_AXES].map(|at| (2 * at + 1) as i32);
                    place[row] = only(&one, &halves.map(|at| at as f32 * scale - SQRT_3 as f32));
                }
                lanes::keep_together();
            }
        }
    }

    /// Keeps pixels beyond their group's limits out of all fits.
    pub(super) fn leave_out<'l>(&mut self, limits: impl Fn(&Group) -> &'l [f32]) {
        let channels = self.call.config.channels;
        self.leaves_out = true;
        for channel in 0..channels {
            let (mut lowest, mut highest) = (NONE, NONE);
            for (lane, group) in self.lanes.iter().enumerate() {
                if let &[low, high] = row_at(limits(group), 2, channel) {
                    [lowest[lane % LANES], highest[lane % LANES]] = [low, high];
                }
            }
            for (inside, ranges) in self.inside.iter_mut().zip(rows(self.ranges, 2 * channels)) {
                let [low, high] = row_at(ranges, 2, channel) else { continue };
                for (inside, (low, high)) in inside.iter_mut().zip(low.iter().zip(high)) {
                    for l in 0..LANES {
                        let is_within = lowest[l] <= low[l] && high[l] <= highest[l];
                        inside[l] = if is_within { inside[l] } else { 0.0 };
                    }
                }
            }
        }
    }

    /// As for one pixel's samples: the zero at a value, the unit near the largest.
    #[inline(always)]
    fn set_units(&mut self) {
        let channels = self.call.config.channels;
        for (channel, units) in self.units.iter_mut().enumerate().take(channels) {
            let mut largest = NONE;
            let mut first = [f32::INFINITY; LANES];
            for (inside, ranges) in self.inside.iter().zip(rows(self.ranges, 2 * channels)) {
                let [low, high] = row_at(ranges, 2, channel) else { continue };
                for (inside, (low, high)) in inside.iter().zip(low.iter().zip(high)) {
                    for l in 0..LANES {
                        let most = Real::max(Real::abs(low[l]), Real::abs(high[l]));
                        largest[l] = if inside[l] > 0.0 { Real::max(most, largest[l]) } else { largest[l] };
                        first[l] = if inside[l] > 0.0 && first[l] == f32::INFINITY { low[l] } else { first[l] };
                    }
                    lanes::keep_together();
                }
            }
            if self.is_joined {
                largest = [largest.into_iter().fold(0.0, Real::max); LANES];
                first = [first.into_iter().find(|&first| first < f32::INFINITY).unwrap_or(0.0); LANES];
            }
            for l in 0..LANES {
                let exponent = Real::exponent(largest[l]).clamp(-126, 126);
                units.powers[l] = power_of_two(exponent);
                units.scales[l] = power_of_two(-exponent);
                units.limits[l] = power_of_two(exponent + MOST);
                units.offsets[l] = if first[l] < f32::INFINITY { first[l] * units.scales[l] } else { 0.0 };
            }
        }
    }

    /// Values in units.
    #[inline(always)]
    pub(super) fn put_in_units(&self, values: &mut [Four]) {
        for (value, units) in values.iter_mut().zip(self.units.iter().take(self.call.config.channels).cycle()) {
            *value = value.map(|value| units.apply(&value));
            lanes::keep_together();
        }
    }

    /// Reads all samples and sums their products.
    #[inline(always)]
    pub(super) fn load(&mut self, arena: &mut Arena<'_, f32>) {
        let (call, values, slices, mut arena) = (self.call, self.values, self.terms.slices, arena.scratch());
        let (columns, functions, fixed) = (self.terms.columns(), self.terms.functions, self.terms.fixed());
        let (summed, (kept, _)) = (self.terms.of_slices(values, call.n), kept(&self.terms, call.n));
        let mut samples = Rows::new(functions, values, &mut arena);
        let mut pixels = Rows::new(columns, values.max(summed), &mut arena);
        let mut deviations = Deviations::new(kept, values, &mut arena);
        let mut sliced = Sliced::new(slices, columns, summed, &mut arena);
        self.set_units();
        for sums in [&mut self.between, &mut self.within, &mut self.sliced] {
            sums.empty();
        }
        let parts = if self.has_colours { COLOURS } else { 1 };
        for part in 0..parts {
            for block in (part..self.inside.len()).step_by(parts) {
                if call.n == 1 {
                    call.read(self, (block, 0..AT_ONCE), 0..1, &mut samples);
                    copy(row_at_mut(self.functions, functions, block), samples.columns);
                    copy(row_at_mut(self.means, values, block), samples.values);
                } else {
                    for row in 0..AT_ONCE {
                        if slices > 0 {
                            self.load_sliced((block, row), part, &mut samples, &mut pixels, &mut sliced);
                        } else {
                            self.load_several((block, row), &mut samples, &mut deviations);
                        }
                    }
                }
                // Of several samples, slices have sums of their own, and pixels' means those of trends alone.
                let needed = if call.n > 1 { self.terms.of_means() } else { columns };
                let (columns, means) = (first_mut(pixels.columns, needed), first_mut(pixels.values, values));
                self.put_means(block, columns, means);
                if slices > 0 && call.n == 1 {
                    let picked = call.slices(&samples);
                    sliced.add(&picked, columns, means);
                    row_at_mut(self.slices, 1, block).fill(picked);
                } else {
                    self.between.add(part, columns, means);
                }
                if call.n > 1 && slices == 0 {
                    let inside = at(self.inside, block);
                    let mut places = [[NONE; AT_ONCE]; MAX_FIXED];
                    for (out, place) in places.iter_mut().zip(row_at(self.places, fixed, block)) {
                        *out = zip_four(&inside, place, only);
                    }
                    deviations.mirror(functions);
                    self.within.add_apart(part, &self.terms, first(&places, fixed), &deviations);
                }
            }
            sliced.put(part * slices, &mut self.sliced);
        }
        if self.is_joined {
            for sums in [&mut self.between, &mut self.within, &mut self.sliced] {
                sums.join();
            }
        }
    }

    /// Reads the samples of one slot, where slices are apart: their means, then sums of samples by slices.
    #[inline(always)]
    fn load_sliced(
        &mut self,
        (block, row): (usize, usize),
        part: usize,
        samples: &mut Rows<'_>,
        pixels: &mut Rows<'_>,
        sliced: &mut Sliced<'_>,
    ) {
        let (call, values, inverse) = (self.call, self.values, 1.0 / self.call.n as f32);
        let inside = at(self.inside, block)[row % AT_ONCE];
        let one = at(row_at(self.places, self.terms.fixed(), block), 0)[row % AT_ONCE];
        // Of each value the first, and sums of how far others are from it, and of squares of this.
        let mut sums = [[NONE; 3]; 2 * Config::MAX_CHANNELS];
        for begin in (0..call.n).step_by(AT_ONCE) {
            let count = AT_ONCE.min(call.n - begin);
            call.read_values(self, (block, row), begin..begin + count, samples.values);
            for ([first, total, squares], value) in sums.iter_mut().zip(samples.values.iter()) {
                *first = if begin == 0 { value[0] } else { *first };
                for value in value.iter().take(count) {
                    let apart = minus(value, first);
                    *total = plus(total, &apart);
                    *squares = lanes::plus_product(*squares, apart, apart);
                }
            }
        }
        let means = row_at_mut(self.means, values, block).iter_mut().zip(self.within.part_mut(part).squares);
        for ((mean, square), [first, total, squares]) in means.zip(&sums) {
            let average = total.map(|total| total * inverse);
            mean[row % AT_ONCE] = only(&one, &plus(&average, first));
            let left = lanes::minus_product(*squares, average, *total);
            *square = plus(square, &only(&inside, &left.map(|left| Real::max(left, 0.0))));
        }
        for begin in (0..call.n).step_by(AT_ONCE) {
            let count = AT_ONCE.min(call.n - begin);
            call.read(self, (block, row..row + 1), begin..begin + count, samples);
            let lines = from_fn(|line| if line < count { inside } else { NONE });
            self.put_samples((block, row), &lines, samples.columns, pixels.columns);
            let (own, of_pixel) = halves_mut(pixels.values, values);
            for (out, value) in own.iter_mut().zip(samples.values.iter()) {
                *out = zip_four(&lines, value, only);
            }
            for (out, mean) in of_pixel.iter_mut().zip(row_at(self.means, values, block)) {
                *out = lines.map(|line| only(&line, &mean[row % AT_ONCE]));
            }
            sliced.add(&call.slices(samples), pixels.columns, pixels.values);
        }
    }

    /// Reads the samples of one slot: their means, and the products of how far they are from those.
    #[inline(always)]
    fn load_several(&mut self, (block, row): (usize, usize), samples: &mut Rows<'_>, deviations: &mut Deviations<'_>) {
        let (call, fixed, functions) = (self.call, self.terms.fixed(), self.terms.functions);
        let inside = at(self.inside, block)[row % AT_ONCE];
        let is_full = inside == [1.0; LANES];
        deviations.sums.empty();
        deviations.totals.iter_mut().for_each(|sum| *sum = NONE);
        for begin in (0..call.n).step_by(AT_ONCE) {
            let count = AT_ONCE.min(call.n - begin);
            call.read(self, (block, row..row + 1), begin..begin + count, samples);
            if begin == 0 {
                deviations.firsts.iter_mut().zip(samples.values.iter()).for_each(|(first, values)| *first = values[0]);
            }
            // Differences tell equal values from such as are nearly so.
            for (values, first) in samples.values.iter_mut().zip(deviations.firsts.iter()) {
                *values = values.map(|value| minus(&value, first));
            }
            let columns = samples.columns.iter_mut().chain(samples.values.iter_mut());
            for (sum, four) in deviations.totals.iter_mut().zip(columns) {
                four.iter_mut().skip(count).for_each(|row| *row = NONE);
                *sum = plus(sum, &total(four));
                lanes::keep_together();
            }
            if !is_full {
                for values in samples.values.iter_mut() {
                    *values = values.map(|value| only(&inside, &value));
                }
            }
            deviations.sums.add(0, samples.columns, samples.values);
        }
        let inverse = 1.0 / call.n as f32;
        let (sums, values) = halves(deviations.totals, functions);
        let one = at(row_at(self.places, fixed, block), 0)[row % AT_ONCE];
        let mean = |sum: &Eight| only(&one, &sum.map(|sum| sum * inverse));
        for (out, sum) in row_at_mut(self.functions, functions, block).iter_mut().zip(sums.iter()) {
            out[row] = mean(sum);
            lanes::keep_together();
        }
        for (out, (sum, first)) in
            row_at_mut(self.means, self.values, block).iter_mut().zip(values.iter().zip(deviations.firsts.iter()))
        {
            out[row] = only(&one, &plus(&mean(sum), first));
        }
        deviations.put(row, &inside, inverse, functions);
    }

    /// The columns of four samples of a slot's pixels, by the functions at them: only in lanes where `lines`, a row for
    /// each sample, are not 0.
    #[inline(always)]
    pub(super) fn put_samples(
        &self,
        (block, row): (usize, usize),
        lines: &Four,
        functions: &[Four],
        columns: &mut [Four],
    ) {
        let terms = &self.terms;
        let (fixed, rest) = halves_mut(columns, terms.fixed());
        let (own, products) = halves_mut(rest, terms.functions);
        for (out, place) in fixed.iter_mut().zip(row_at(self.places, terms.fixed(), block)) {
            *out = lines.map(|line| only(&line, &place[row % AT_ONCE]));
        }
        for (out, function) in own.iter_mut().zip(functions) {
            *out = zip_four(lines, function, only);
        }
        terms.multiply(fixed, own, products);
    }

    /// The columns and values of a block's pixels that fits are made to.
    #[inline(always)]
    fn put_means(&self, block: usize, columns: &mut [Four], values: &mut [Four]) {
        let (terms, n) = (&self.terms, self.call.n);
        let places = row_at(self.places, terms.fixed(), block);
        let (fixed, rest) = halves_mut(columns, terms.fixed());
        let (functions, products) = halves_mut(rest, terms.functions);
        copy(fixed, places);
        copy(functions, row_at(self.functions, terms.functions, block));
        copy(values, row_at(self.means, self.values, block));
        let inside = at(self.inside, block);
        if self.leaves_out || n > 1 {
            let root = Real::sqrt(n as f32);
            for four in fixed.iter_mut().chain(&mut *functions).chain(values.iter_mut()) {
                *four = zip_four(&inside, four, |inside, value| only(inside, &value.map(|value| value * root)));
                lanes::keep_together();
            }
        }
        terms.multiply(places, functions, products);
    }
}

/// Of four pixels, sums of products of how far samples are from their pixel's mean.
struct Deviations<'a> {
    /// Over the samples of one pixel, of their products, and of functions and values themselves; and the first values.
    sums: Sums<'a>,
    totals: &'a mut [Eight],
    firsts: &'a mut [Eight],
    /// Of each function and value with each function.
    functions: &'a mut [Four],
    values: &'a mut [Four],
    squares: &'a mut [Four],
}

impl<'a> Deviations<'a> {
    fn new(functions: usize, values: usize, arena: &mut Arena<'a, f32>) -> Self {
        Self {
            sums: Sums::new(1, functions, values, arena),
            totals: arena.take_lanes(functions + values),
            firsts: arena.take_lanes(values),
            functions: arena.take_fours(functions * functions),
            values: arena.take_fours(values * functions),
            squares: arena.take_fours(values),
        }
    }

    /// Sets those of one pixel: the sums of products less those of means.
    #[inline(always)]
    fn put(&mut self, slot: usize, inside: &Eight, inverse: f32, width: usize) {
        let (totals, values) = halves(self.totals, width);
        let Part { gram, sides, squares } = self.sums.part(0);
        let put = |out: &mut [Four], sums: &[Eight], total: &Eight| {
            let mean = total.map(|total| total * inverse);
            for (out, (sum, other)) in out.iter_mut().zip(sums.iter().zip(totals)) {
                out[slot % AT_ONCE] = lanes::minus_product(*sum, mean, *other);
                lanes::keep_together();
            }
        };
        for (j, (out, total)) in rows_mut(self.functions, width).zip(totals).enumerate() {
            put(out, row(gram, j), total);
        }
        for (out, (square, total)) in self.squares.iter_mut().zip(squares.iter().zip(values)) {
            let left = lanes::minus_product(*square, total.map(|total| total * inverse), *total);
            out[slot % AT_ONCE] = only(inside, &left.map(|square| Real::max(square, 0.0)));
        }
        for (out, (sides, total)) in rows_mut(self.values, width).zip(rows(sides, width).zip(values)) {
            put(out, sides, total);
        }
    }

    /// Copies what is below the diagonal to above it.
    #[inline(always)]
    fn mirror(&mut self, width: usize) {
        for j in 0..width {
            for k in 0..j {
                let product = at(self.functions, j * width + k);
                if let Some(out) = self.functions.get_mut(k * width + j) {
                    *out = product;
                }
                lanes::keep_together();
            }
        }
    }
}

impl Sums<'_> {
    /// Adds what four pixels' samples say within their pixels. A pixel's place is the same for all of them, so that
    /// products with it are made here. The fixed columns do not change within a pixel.
    #[inline(always)]
    fn add_apart(&mut self, part: usize, terms: &Terms, places: &[Four], deviations: &Deviations<'_>) {
        let (fixed, width, columns) = (terms.fixed(), terms.functions, terms.columns());
        let Part { gram, sides, squares } = self.part_mut(part);
        for (i, (factor, function)) in terms.changing(places).enumerate() {
            let others = row_at(deviations.functions, width, function);
            let (plain, products) = halves_mut(from_mut(row_mut(gram, fixed + i), fixed), width.min(i + 1));
            add_products(plain, factor, others);
            // One by one: zipped, the chunks would be counted, and a division may panic.
            let mut products = products.chunks_mut(terms.moving.max(1));
            for axis in places.iter().skip(1) {
                if let Some(out) = products.next() {
                    add_products(out, &times(factor, axis), others);
                }
            }
        }
        for (out, square) in squares.iter_mut().zip(deviations.squares.iter()) {
            *out = square.iter().fold(*out, |sum, square| plus(&sum, square));
        }
        for (products, sides) in rows(deviations.values, width).zip(rows_mut(sides, columns)) {
            for (side, (factor, function)) in from_mut(sides, fixed).iter_mut().zip(terms.changing(places)) {
                if let Some(product) = products.get(function) {
                    *side = plus_four(*side, factor, product);
                }
            }
        }
    }
}
