//! Eight groups side by side, a lane each: their pixels and samples.
//!
//! A slot holds one pixel of each group, and a block four slots. Every fourth slot is of one colour. Where colours are
//! corrected by fits to the others, so are the slots of a block: that of the block's own number.

use super::super::config::Config;
use super::call::Call;
use super::groups::{Group, Groups, Place};
use super::pixels::{Image, MAX_AXES};
use super::products::*;
use super::terms::Terms;
use core::array::from_fn;

/// The most numbers of a place.
pub(super) const MAX_FIXED: usize = 1 + MAX_AXES;
/// Uniform coordinates from -1 to 1 times this have unit variance.
pub(super) const SQRT_3: f64 = 1.732_050_807_568_877_2;
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
    /// How many blocks there are, also where room for them is only counted.
    pub(super) len: usize,
    pub(super) is_joined: bool,
    /// Whether the slots of a block are of one colour.
    pub(super) has_colours: bool,
    pub(super) units: [Units; Config::MAX_CHANNELS],
    /// Whether some pixels are in no fit.
    pub(super) leaves_out: bool,
    /// For each block, the given pixels' numbers, as bits; another's where there is none.
    numbers: &'a mut [Four],
    /// For each block, 1 and the pixels' places along each axis, of unit variance; 0 where there is no pixel.
    pub(super) places: &'a mut [Four],
    /// For each block 1 where a pixel is that fits are made to, else 0.
    pub(super) inside: &'a mut [Four],
    /// For each channel and slot, the lowest and the highest value.
    pub(super) ranges: &'a mut [[Eight; 2]],
    /// For each channel and slot, the coefficient of what is known, and its integral.
    pub(super) coefficients: &'a mut [Eight],
    pub(super) integrals: &'a mut [Eight],
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

/// For each pixel how many functions' means are kept, and how many slices.
pub(super) fn kept(terms: &Terms, n: usize) -> (usize, usize) {
    match (terms.slices > 0, n) {
        (false, _) => (terms.functions, 0),
        (true, 1) => (terms.functions, 1),
        (true, _) => (0, 0),
    }
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

impl<'a> Batch<'a> {
    /// Room for groups of which none is larger than the first.
    pub(super) fn new(call: &'a Call<'a>, terms: Terms, lanes: [Group; LANES], arena: &mut Arena<'a, f32>) -> Self {
        let [Group { len, .. }, ..] = lanes;
        let slots = if call.is_joined() { len.div_ceil(LANES) } else { len };
        // Blocks come by as many as there are colours; sums of each are then apart.
        let (parts, len) = match call.has_colours() {
            true => (COLOURS, COLOURS * slots.div_ceil(COLOURS * AT_ONCE)),
            false => (1, slots.div_ceil(AT_ONCE)),
        };
        let (channels, values, each) = (call.config.channels, call.values(), |count: usize| len.saturating_mul(count));
        let known = if call.image.has_known() { each(channels * AT_ONCE) } else { 0 };
        let ((kept, apart), summed) = (kept(&terms, call.n), terms.of_slices(values, call.n));
        Self {
            call,
            lanes,
            len,
            is_joined: call.is_joined(),
            has_colours: call.has_colours(),
            units: [Units { powers: NONE, scales: NONE, offsets: NONE, limits: NONE }; Config::MAX_CHANNELS],
            leaves_out: false,
            numbers: arena.take_fours(len),
            places: arena.take_fours(each(terms.fixed())),
            inside: arena.take_fours(len),
            ranges: arena.take_lanes(each(2 * channels * AT_ONCE)).as_chunks_mut().0,
            coefficients: arena.take_lanes(known),
            integrals: arena.take_lanes(known),
            slices: arena.take_fours(each(apart)),
            values,
            means: arena.take_fours(each(values)),
            functions: arena.take_fours(each(kept)),
            between: Sums::new(parts, terms.of_means(), values, arena),
            within: Sums::new(if call.n > 1 { parts } else { 0 }, terms.of_deviations(), values, arena),
            sliced: Sums::new(parts * terms.slices, terms.columns(), summed, arena),
            terms,
        }
    }

    /// The blocks that have pixels of some colours.
    pub(super) fn blocks(&self, colours: Colours) -> impl Iterator<Item = usize> + use<> {
        let has_colours = self.has_colours;
        (0..self.len).filter(move |&block| !has_colours || colours.has(block))
    }

    /// A sum over all pixels of a group, by those of its lanes.
    pub(super) fn joined(&self, sum: &Eight) -> Eight {
        if self.is_joined { [lanes::sum(sum); LANES] } else { *sum }
    }

    /// How many pixels of some colours there are, in fits or not: of one sample each, whether a pixel's own value keeps
    /// it out of fits must not change the ridge of those that correct it.
    pub(super) fn present(&self, colours: Colours) -> Eight {
        let ones = self.blocks(colours).filter_map(|block| row_at(self.places, self.terms.fixed(), block).first());
        self.joined(&ones.fold(NONE, |count, ones| plus(&count, &total(ones))))
    }

    /// What there is of the samples of a colour about their pixels' means.
    pub(super) fn whole(&self, value: usize, colour: usize) -> Eight {
        at(self.within.part(colour).squares, value)
    }

    /// Where what there is of each channel and slot has that of one.
    pub(super) fn entry(&self, channel: usize, (block, row): (usize, usize)) -> usize {
        (channel * self.len + block) * AT_ONCE + row
    }

    #[inline]
    pub(super) fn colour(&self, (block, row): (usize, usize)) -> usize {
        (if self.has_colours { block } else { row }) % COLOURS
    }

    /// Where in their groups the pixels of a slot are.
    pub(super) fn members(&self, (block, row): (usize, usize)) -> [u32; LANES] {
        let slot = if self.has_colours {
            COLOURS * AT_ONCE * (block / COLOURS) + block % COLOURS + COLOURS * row
        } else {
            AT_ONCE * block + row
        };
        let (first, step) = if self.is_joined { (slot * LANES, 1) } else { (slot, 0) };
        from_fn(|lane| (first + step * lane) as u32)
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

    /// Where the lanes' pixels are, and between what values theirs lie.
    #[inline(always)]
    pub(super) fn survey(&mut self, groups: &Groups<'_>) {
        let call = self.call;
        let (fixed, channels) = (self.terms.fixed(), call.config.channels);
        let axes = call.windows.used_axes();
        let scales = axes.map(|axis| (SQRT_3 / call.windows.extent[axis % MAX_AXES].max(1) as f64) as f32);
        let [width, height] = [call.windows.given.width, call.windows.given.height].map(|extent| extent as u32);
        let corners = self.lanes.map(|group| call.pixel(call.window(group.window), Place::default(), 0) as u32);
        let (members, lens) =
            (self.lanes.map(|group| groups.members(&group)), self.lanes.map(|group| group.len as u32));
        let mut other = None;
        for block in 0..self.len {
            for row in 0..AT_ONCE {
                let (mut one, mut places) = (NONE, [0.0; LANES].map(Place::read));
                let mut numbers = self.members((block, row));
                for l in 0..LANES {
                    one[l] = if numbers[l] < lens[l] { 1.0 } else { 0.0 };
                }
                for lane in 0..LANES {
                    if let Some(&place) = members[lane].get(numbers[lane] as usize) {
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
                for (channel, range) in call.ranges(&pixels).iter().enumerate().take(channels) {
                    let entry = self.entry(channel, (block, row));
                    set(self.ranges, entry, range.map(|value| only(&one, &value)));
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
    pub(super) fn leave_out(&mut self, groups: &Groups<'_>, turn: usize) {
        let channels = self.call.config.channels;
        self.leaves_out = true;
        for channel in 0..channels {
            let (mut lowest, mut highest) = (NONE, NONE);
            for (lane, group) in self.lanes.iter().enumerate() {
                if let &[low, high] = row_at(groups.found(group).1, 2, turn * channels + channel) {
                    [lowest[lane % LANES], highest[lane % LANES]] = [low, high];
                }
            }
            let inside = self.inside.as_flattened_mut();
            let ranges = row_at(self.ranges, inside.len(), channel);
            for (inside, [low, high]) in inside.iter_mut().zip(ranges) {
                for l in 0..LANES {
                    let is_within = lowest[l] <= low[l] && high[l] <= highest[l];
                    inside[l] = if is_within { inside[l] } else { 0.0 };
                }
            }
        }
    }

    /// As for one pixel's samples: the zero at a value, the unit near the largest.
    #[inline(always)]
    pub(super) fn set_units(&mut self) {
        let inside = self.inside.as_flattened();
        for (units, ranges) in self.units.iter_mut().zip(rows(self.ranges, inside.len())) {
            let mut largest = NONE;
            let mut first = [f32::INFINITY; LANES];
            for (inside, [low, high]) in inside.iter().zip(ranges) {
                for l in 0..LANES {
                    // Both sides of each choice are ready, so that there is nothing to jump over.
                    let most = Real::max(Real::abs(low[l]), Real::abs(high[l]));
                    let (most, low) = if inside[l] > 0.0 { (most, low[l]) } else { (0.0, f32::INFINITY) };
                    largest[l] = Real::max(most, largest[l]);
                    first[l] = if first[l] < f32::INFINITY { first[l] } else { low };
                }
                lanes::keep_together();
            }
            if self.is_joined {
                largest = [largest.into_iter().fold(0.0, Real::max); LANES];
                first = [first.into_iter().find(|&first| first < f32::INFINITY).unwrap_or(0.0); LANES];
            }
            for l in 0..LANES {
                let exponent = Real::exponent(largest[l]).clamp(-126, 126);
                units.powers[l] = Real::scale(1.0, exponent);
                units.scales[l] = Real::scale(1.0, -exponent);
                units.limits[l] = Real::scale(1.0, (exponent + MOST).min(127));
                units.offsets[l] = if first[l] < f32::INFINITY { first[l] * units.scales[l] } else { 0.0 };
            }
        }
    }

    #[inline]
    pub(super) fn put_in_units(&self, values: &mut [Four]) {
        for (value, units) in values.iter_mut().zip(self.units.iter().take(self.call.config.channels).cycle()) {
            *value = value.map(|value| units.apply(&value));
            lanes::keep_together();
        }
    }
}
