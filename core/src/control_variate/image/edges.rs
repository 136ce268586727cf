//! Light that arrives for some u and not for others: a candidate whose boundary in two coordinates is a conic.
//!
//! Polynomials follow no edge. Where a group has lit and dark samples, f is modelled as h = A / (1 + e^-q). q is a
//! logistic regression of whether a sample is lit, of degree 2 in the two coordinates and 1 in the pixel's place, so
//! that the boundary, q = 0, moves across the group. A, of degree 1 in all, is least squares to the lit samples, and
//! kept from 0 to the largest of them. What corrects is h's bilinear interpolant between 17 x 17 points of the two
//! coordinates, whose integral the trapezoid rule gives: the correction's mean is 0 whatever was fitted.

use super::batch::{Batch, MAX_FIXED};
use super::call::Call;
use super::fit::Fits;
use super::groups::Place;
use super::products::*;
use crate::basis::MAX_DIMS;
use crate::control_variate::Config;
use core::f32::consts::{LN_2, LOG2_E};

/// The fewest samples of a pixel that say whether it is cut by an edge.
const FEWEST_SAMPLES: usize = 4;
/// The fewest pixels of a group.
const FEWEST_PIXELS: usize = 8;
/// Functions of the coordinates: of degree 1, then of degree 2.
const FUNCTIONS: usize = 5;
/// Those that A has.
const SLOPES: usize = 2;
const MAX_COLUMNS: usize = MAX_FIXED + FUNCTIONS;
/// The most steps of the regression, the longest, and the shortest after which there is another.
const STEPS: usize = 8;
const LONGEST: f32 = 4.0;
const SHORTEST: f32 = 0.02;
/// Penalties of the constant, of places and of functions, in q and in A, where places have unit variance.
const PENALTIES: [f32; 2 + FUNCTIONS] = [1e-4, 0.03, 0.05, 0.05, 0.2, 0.2, 0.2];
const PENALTIES_OF_A: [f32; 2 + SLOPES] = [2e-3, 0.3, 0.5, 0.5];
/// q is no further from 0.
const MOST: f32 = 50.0;
/// The least variance of whether a sample is lit.
const LEAST_VARIANCE: f32 = 1e-3;
/// Points along a coordinate, and cells between them.
const POINTS: usize = CELLS + 1;
const CELLS: usize = 16;
const SQRT_3: f32 = super::batch::SQRT_3 as f32;
const SQRT_5: f32 = 2.236_068;

impl Call<'_> {
    pub(super) fn has_edges(&self) -> bool {
        self.config.edges > 0 && self.n >= FEWEST_SAMPLES && !self.is_single_fit()
    }

    /// Whether a group, `members` of a window, has lit and dark samples, if edges are looked for.
    pub(super) fn has_edge(&self, window: usize, members: &[f32], len: usize) -> bool {
        if !self.has_edges() || len < FEWEST_PIXELS {
            return false;
        }
        let (window, channels) = (self.window(window), self.config.channels);
        let is_lit = |member: usize, sample: usize| {
            let pixel = self.pixel(window, Place::read(at(members, member)), member);
            row_at(self.reader.samples.f, channels, pixel * self.n + sample).iter().any(|&value| value > 0.0)
        };
        let first = is_lit(0, 0);
        (0..len).any(|member| (0..self.n).any(|sample| is_lit(member, sample) != first))
    }
}

/// The fits to a batch whose groups have lit and dark samples.
pub(super) struct Edges<'a> {
    /// For each block and sample: its two coordinates, 1 if it is lit, and its values in units.
    samples: &'a mut [Four],
    /// Of each colour: all samples, with whether they are lit; lit ones, with their values.
    sums: [Sums<'a>; 2],
    /// The same of what a fit is to.
    training: [Sums<'a>; 2],
    /// The largest value of each colour and channel.
    most: [[Eight; Config::MAX_CHANNELS]; COLOURS],
    /// How much of the light arrives, and how much light arrives, at the points.
    shares: &'a mut [Eight],
    points: &'a mut [Eight],
}

/// The orthonormal Legendre polynomial of degree 1 of a coordinate.
const fn linear(u: f32) -> f32 {
    (u + u - 1.0) * SQRT_3
}

/// It at the points of a line.
const LINE: [f32; POINTS] = {
    let mut line = [0.0; POINTS];
    let mut i = 0;
    while i < POINTS {
        line[i] = linear(i as f32 / CELLS as f32);
        i += 1;
    }
    line
};

#[inline(always)]
fn functions(x: &Four, y: &Four) -> [Four; FUNCTIONS] {
    let mut out = [[NONE; AT_ONCE]; FUNCTIONS];
    let place = |u: &Eight| lanes::each(u, linear);
    let square = |x: &Eight| lanes::each(x, |x| (x * x - 1.0) * (0.5 * SQRT_5));
    for row in 0..AT_ONCE {
        let (x, y) = (place(&x[row]), place(&y[row]));
        let xy = product(&x, &y);
        for (out, function) in out.iter_mut().zip([x, y, square(&x), xy, square(&y)]) {
            out[row] = function;
        }
    }
    out
}

/// 1 / (1 + e^-q)
#[inline]
fn logistic(q: &Eight) -> Eight {
    let mut out = *q;
    for value in &mut out {
        *value = Real::max(Real::min(*value, MOST), -MOST) * -LOG2_E;
    }
    out = lanes::exp2(&out);
    for value in &mut out {
        *value = 1.0 / (1.0 + *value);
    }
    out
}

impl<'a> Edges<'a> {
    /// Of a batch with such, if it is one.
    pub(super) fn new(batch: &Batch<'_>, arena: &mut Arena<'a, f32>) -> Option<Self> {
        if !batch.terms.has_edges {
            return None;
        }
        let (n, channels, fixed) = (batch.call.n, batch.call.config.channels, batch.terms.fixed());
        let mut sums = |parts| {
            [(FUNCTIONS, 1), (SLOPES, channels)].map(|(own, values)| Sums::new(parts, fixed + own, values, arena))
        };
        Some(Self {
            sums: sums(COLOURS),
            training: sums(1),
            samples: arena.take_fours(batch.len.saturating_mul(n).saturating_mul(3 + channels)),
            most: [[NONE; Config::MAX_CHANNELS]; COLOURS],
            shares: arena.take_lanes(POINTS * POINTS),
            // Looked up also where nothing was put there.
            points: arena.zeros(POINTS * POINTS * LANES).as_chunks_mut().0,
        })
    }

    /// Reads the samples and sums their products.
    #[inline(always)]
    pub(super) fn load(&mut self, batch: &Batch<'_>) {
        self.sums.iter_mut().for_each(Sums::empty);
        for block in 0..batch.len {
            self.read(batch, block);
            self.add(batch, block);
        }
        if batch.is_joined {
            self.sums.iter_mut().for_each(Sums::join);
            for most in self.most.as_flattened_mut() {
                *most = [most.iter().copied().fold(0.0, Real::max); LANES];
            }
        }
    }

    fn samples(&self, batch: &Batch<'_>, block: usize) -> impl Iterator<Item = (&Four, &Four, &Four, &[Four])> {
        let (n, width) = (batch.call.n, 3 + batch.call.config.channels);
        (block * n..(block + 1) * n).filter_map(move |sample| {
            let [x, y, lit, values @ ..] = row_at(self.samples, width, sample) else { return None };
            Some((x, y, lit, values))
        })
    }

    fn read(&mut self, batch: &Batch<'_>, block: usize) {
        let (call, width) = (batch.call, 3 + batch.call.config.channels);
        let inside = at(batch.inside, block);
        let mut x = [[0.0; AT_ONCE_LANES]; MAX_DIMS];
        for sample in 0..call.n {
            let out = row_at_mut(self.samples, width, block * call.n + sample);
            let [u, v, lit, values @ ..] = out else { return };
            for row in 0..AT_ONCE {
                let pixels = batch.pixels((block, row));
                call.reader.put_positions(&pixels.map(|pixel| pixel * call.n + sample), 1, row * LANES, &mut x);
                lit[row] = NONE;
                for (channel, (value, units)) in values.iter_mut().zip(&batch.units).enumerate() {
                    let input = call.gather(call.reader.samples.f, &pixels, (call.n, sample), channel);
                    lit[row] = lanes::zip(&lit[row], &input, |lit, input| if input > 0.0 { 1.0 } else { lit });
                    value[row] = units.scale(&input);
                }
                lit[row] = only(&inside[row], &lit[row]);
            }
            let place = |axis: usize| -> Four {
                let wide: &Lanes<f32, AT_ONCE_LANES> = x.get(axis).unwrap_or(&[0.0; AT_ONCE_LANES]);
                core::array::from_fn(|row| at(wide.as_chunks().0, row))
            };
            let first = call.config.edges.saturating_sub(1);
            (*u, *v) = (place(first), place(first + 1));
        }
    }

    /// Adds a block's samples to the sums of its colour.
    #[inline(always)]
    fn add(&mut self, batch: &Batch<'_>, block: usize) {
        let (fixed, channels, n, colour) =
            (batch.terms.fixed(), batch.call.config.channels, batch.call.n, block % COLOURS);
        let inside = at(batch.inside, block);
        let mut columns = [[NONE; AT_ONCE]; MAX_COLUMNS];
        let columns = first_mut(&mut columns, fixed + FUNCTIONS);
        for (out, place) in columns.iter_mut().zip(row_at(batch.places, fixed, block)) {
            *out = times(&inside, place);
        }
        for sample in block * n..(block + 1) * n {
            let [x, y, lit, values @ ..] = row_at(self.samples, 3 + channels, sample) else { return };
            for (out, function) in from_mut(columns, fixed).iter_mut().zip(functions(x, y)) {
                *out = times(&inside, &function);
            }
            let mut columns_of_lit = [[NONE; AT_ONCE]; MAX_FIXED + SLOPES];
            let mut values_of_lit = [[NONE; AT_ONCE]; Config::MAX_CHANNELS];
            let columns_of_lit = first_mut(&mut columns_of_lit, fixed + SLOPES);
            let values_of_lit = first_mut(&mut values_of_lit, channels);
            let most = self.most.get_mut(colour).into_iter().flatten();
            for (out, column) in columns_of_lit.iter_mut().zip(columns.iter()) {
                *out = times(lit, column);
            }
            for ((out, value), most) in values_of_lit.iter_mut().zip(values).zip(most) {
                *out = times(lit, value);
                *most = out.iter().fold(*most, |most, value| lanes::zip(value, &most, Real::max));
            }
            let [all, of_lit] = &mut self.sums;
            all.add(colour, columns, &[*lit]);
            of_lit.add(colour, columns_of_lit, values_of_lit);
        }
    }

    /// Corrects every pixel of the colours `taken` by fits to the other of them, as the last candidate. 1 where they
    /// have lit and dark samples, else 0.
    #[inline(always)]
    pub(super) fn correct(&mut self, batch: &Batch<'_>, taken: Colours, fits: &mut Fits<'_>) -> Eight {
        let (fixed, channels) = (batch.terms.fixed(), batch.call.config.channels);
        self.set_training(taken);
        let present = self.has_both();
        for colour in (0..COLOURS).filter(|&colour| taken.has(colour)) {
            let others = taken.without(colour);
            self.set_training(others);
            let has_both = self.has_both();
            let is_needed = has_both != NONE;
            let mut q = [NONE; MAX_COLUMNS];
            let mut a = [[NONE; MAX_FIXED + SLOPES]; Config::MAX_CHANNELS];
            let mut most = [NONE; Config::MAX_CHANNELS];
            if is_needed {
                self.regress(batch, others, &has_both, first_mut(&mut q, fixed + FUNCTIONS));
                self.fit_lit(batch, &mut a);
                for (_, colour) in self.most.iter().enumerate().filter(|&(colour, _)| others.has(colour)) {
                    most.iter_mut().zip(colour).for_each(|(most, value)| *most = lanes::zip(value, most, Real::max));
                }
            }
            let mut within = [NONE; Config::MAX_CHANNELS];
            for block in batch.blocks(Colours(1 << colour)) {
                for row in 0..AT_ONCE {
                    if is_needed {
                        self.share_out(batch, (block, row), &q);
                    }
                    for channel in 0..channels {
                        let corrections = fits.corrections_mut(block, channel).last_mut();
                        let (Some(out), Some(a), Some(most), Some(within)) =
                            (corrections, a.get(channel), most.get(channel), within.get_mut(channel))
                        else {
                            return present;
                        };
                        let integral = if is_needed { self.light(batch, (block, row), a, most) } else { NONE };
                        out[row] = self.compare(batch, (block, row), channel, &integral, &has_both, within);
                    }
                }
            }
            for value in 0..batch.values {
                let left = batch.joined(&at(&within, value));
                let left = if value < channels { left } else { batch.whole(value, colour) };
                fits.set_within(batch, (value, colour), fits.count.saturating_sub(1), &left);
            }
        }
        // Of what is left of values without what is known nothing is dark.
        for (block, value) in batch.blocks(taken).flat_map(|b| (channels..batch.values).map(move |v| (b, v))) {
            fits.corrections_mut(block, value).last_mut().into_iter().for_each(|out| *out = [NONE; AT_ONCE]);
        }
        present
    }

    fn set_training(&mut self, colours: Colours) {
        for (training, sums) in self.training.iter_mut().zip(&self.sums) {
            training.set_total(sums, colours);
        }
    }

    /// Where samples of the training set are lit, and others are not.
    fn has_both(&self) -> Eight {
        let sums = self.training[0].part(0);
        let [count, lit] = [sums.gram, sums.sides].map(|sums| at(sums, 0));
        lanes::zip(&lit, &count, |lit, count| if lit > 0.0 && lit < count { 1.0 } else { 0.0 })
    }

    /// The logistic regression, by Newton's steps, where `wanted`.
    #[inline(always)]
    fn regress(&self, batch: &Batch<'_>, training: Colours, wanted: &Eight, weights: &mut [Eight]) {
        let (width, fixed) = (weights.len(), batch.terms.fixed());
        let sums = self.training[0].part(0);
        let [count, lit] = [sums.gram, sums.sides].map(|sums| at(sums, 0));
        let odds = lanes::zip(&lit, &count, |lit, count| (lit + 0.5) / (count - lit + 0.5));
        let share = odds.map(|odds| odds / (1.0 + odds));
        set(weights, 0, lanes::log2(&odds).map(|logarithm| logarithm * LN_2));
        let mut all = [NONE; packed_len(MAX_COLUMNS)];
        let matrix = first_mut(&mut all, packed_len(width));
        let mut sides = [NONE; MAX_COLUMNS];
        let sides = first_mut(&mut sides, width);
        let mut left = *wanted;
        for step in 0..STEPS {
            if step == 0 {
                // All are as likely to be lit, so that the sums are at hand.
                let variance = share.map(|share| Real::max(share * (1.0 - share), LEAST_VARIANCE));
                for (out, sum) in matrix.iter_mut().zip(sums.gram) {
                    *out = product(sum, &variance);
                }
                for (j, (out, side)) in sides.iter_mut().zip(sums.sides).enumerate() {
                    *out = lanes::minus_product(*side, at(row(sums.gram, j), 0), share);
                }
            } else {
                matrix.iter_mut().chain(sides.iter_mut()).for_each(|sum| *sum = NONE);
                for block in batch.blocks(training) {
                    self.add_slopes(batch, block, weights, matrix, sides);
                }
                matrix.iter_mut().chain(sides.iter_mut()).for_each(|sum| *sum = batch.joined(sum));
            }
            for (j, (side, weight)) in sides.iter_mut().zip(weights.iter()).enumerate() {
                *side = lanes::minus_product(*side, *weight, [penalise(matrix, &PENALTIES, fixed, j); LANES]);
            }
            ldlt::factor_each(matrix, width);
            ldlt::solve_each(matrix, sides);
            let mut longest = NONE;
            for side in sides.iter() {
                longest = lanes::zip(&longest, side, |longest, side| Real::max(Real::abs(side), longest));
            }
            let scale = longest.map(|longest| LONGEST / Real::max(longest, LONGEST));
            let scale = only(&left, &scale);
            for (weight, side) in weights.iter_mut().zip(sides.iter()) {
                *weight = lanes::plus_product(*weight, *side, scale);
            }
            left = lanes::zip(&left, &longest, |left, longest| if longest >= SHORTEST { left } else { 0.0 });
            if left == NONE {
                break;
            }
        }
    }

    /// Adds what a block's samples say of the next step.
    #[inline]
    fn add_slopes(
        &self,
        batch: &Batch<'_>,
        block: usize,
        weights: &[Eight],
        matrix: &mut [Eight],
        sides: &mut [Eight],
    ) {
        let fixed = batch.terms.fixed();
        let places = row_at(batch.places, fixed, block);
        let inside = at(batch.inside, block);
        let base = combine([NONE; AT_ONCE], places, weights);
        // A pixel's place is the same for all of its samples.
        let (mut total, mut totals) = ([NONE; AT_ONCE], [[NONE; AT_ONCE]; FUNCTIONS]);
        let mut rest = [NONE; AT_ONCE];
        for (x, y, lit, _) in self.samples(batch, block) {
            let functions = functions(x, y);
            let q = combine(base, &functions, from(weights, fixed));
            let (mut variance, mut apart) = (q, *lit);
            for row in 0..AT_ONCE {
                let share = logistic(&q[row]);
                for l in 0..LANES {
                    variance[row][l] = Real::max(share[l] * (1.0 - share[l]), LEAST_VARIANCE) * inside[row][l];
                    apart[row][l] = (lit[row][l] - share[l]) * inside[row][l];
                    total[row][l] += variance[row][l];
                    rest[row][l] += apart[row][l];
                }
                lanes::keep_together();
            }
            for (i, (function, total)) in functions.iter().zip(&mut totals).enumerate() {
                let weighted = times(function, &variance);
                for row in 0..AT_ONCE {
                    total[row] = plus(&total[row], &weighted[row]);
                }
                add_products(from_mut(row_mut(matrix, fixed + i), fixed), &weighted, &functions);
                if let Some(side) = sides.get_mut(fixed + i) {
                    *side = plus_four(*side, &apart, function);
                }
            }
        }
        for (j, (place, side)) in places.iter().zip(sides.iter_mut()).enumerate() {
            let weighted = times(place, &total);
            add_products(row_mut(matrix, j), &weighted, places);
            *side = plus_four(*side, &rest, place);
        }
        for (i, total) in totals.iter().enumerate() {
            add_products(first_mut(row_mut(matrix, fixed + i), fixed), total, places);
        }
    }

    /// Least squares to the lit samples of the training set.
    fn fit_lit(&self, batch: &Batch<'_>, a: &mut [[Eight; MAX_FIXED + SLOPES]; Config::MAX_CHANNELS]) {
        let (fixed, width) = (batch.terms.fixed(), batch.terms.fixed() + SLOPES);
        let sums = self.training[1].part(0);
        let count = at(sums.gram, 0);
        let mut matrix = [NONE; packed_len(MAX_FIXED + SLOPES)];
        let matrix = first_mut(&mut matrix, packed_len(width));
        copy(matrix, sums.gram);
        for j in 0..width {
            penalise(matrix, &PENALTIES_OF_A, fixed, j);
        }
        ldlt::factor_each(matrix, width);
        let divisor = lanes::divisor(&count);
        for (channel, out) in a.iter_mut().enumerate().take(batch.call.config.channels) {
            let out = first_mut(out, width);
            copy(out, row_at(sums.sides, width, channel));
            // About their mean, which is not held back.
            let mean = lanes::zip(&at(out, 0), &divisor, |sum, count| sum / count);
            for (j, out) in out.iter_mut().enumerate() {
                *out = lanes::minus_product(*out, at(row(sums.gram, j), 0), mean);
            }
            ldlt::solve_each(matrix, out);
            if let Some(first) = out.first_mut() {
                *first = plus(first, &mean);
            }
        }
    }

    /// How much of the light arrives, at the points.
    ///
    /// Along a line e^-q is multiplied by a factor from point to point, which is multiplied by one that does not
    /// change, as q is of degree 2; and so are the first values of lines. Where q is large all of it is less, and 0
    /// where it was.
    #[inline(always)]
    fn share_out(&mut self, batch: &Batch<'_>, at: (usize, usize), q: &[Eight]) {
        // Between points, the difference of the function of degree 1; of that of degree 2 the first, and its own.
        const STEP: f32 = 2.0 * SQRT_3 / CELLS as f32;
        const CHANGE: f32 = SQRT_5 * STEP * STEP;
        const FIRST: f32 = 0.5 * CHANGE - SQRT_5 * SQRT_3 * STEP;
        let base = self.place_part(batch, at, q);
        let Some(&[x, y, xx, xy, yy]) = q.get(batch.terms.fixed()..).and_then(<[Eight]>::first_chunk) else { return };
        let corner = [(base, 1.0), (x, -SQRT_3), (y, -SQRT_3), (xx, SQRT_5), (xy, 3.0), (yy, SQRT_5)];
        let largest = corner.iter().fold(NONE, |sum, (weight, f)| {
            lanes::zip(&sum, weight, |sum, weight| sum + Real::abs(*f) * Real::abs(weight))
        });
        let scale = largest.map(|largest| -LOG2_E * (MOST / Real::max(largest, MOST)));
        let power = |terms: &[(Eight, f32)]| {
            let sum = terms.iter().fold(NONE, |sum, (weight, f)| lanes::plus_product(sum, *weight, [*f; LANES]));
            lanes::exp2(&product(&sum, &scale))
        };
        let multiply = |a: &mut Eight, b: &Eight| *a = product(a, b);
        let (mut begin, mut down) = (power(&corner), power(&[(y, STEP), (xy, -SQRT_3 * STEP), (yy, FIRST)]));
        let mut along = power(&[(x, STEP), (xy, -SQRT_3 * STEP), (xx, FIRST)]);
        let (down_change, change) = (power(&[(yy, CHANGE)]), power(&[(xx, CHANGE)]));
        let along_down = power(&[(xy, STEP * STEP)]);
        for line in self.shares.as_chunks_mut::<POINTS>().0 {
            let (mut value, mut factor) = (begin, along);
            for out in line {
                *out = value.map(|value| 1.0 / (1.0 + value));
                multiply(&mut value, &factor);
                multiply(&mut factor, &change);
                lanes::keep_together();
            }
            multiply(&mut begin, &down);
            multiply(&mut down, &down_change);
            multiply(&mut along, &along_down);
        }
    }

    /// How much light of a channel arrives at the points, and the interpolant's integral.
    #[inline]
    fn light(&mut self, batch: &Batch<'_>, at: (usize, usize), a: &[Eight], most: &Eight) -> Eight {
        let base = self.place_part(batch, at, a);
        let Some(&[x, y]) = a.get(batch.terms.fixed()..).and_then(<[Eight]>::first_chunk) else { return NONE };
        let mut integral = NONE;
        let lines = self.points.as_chunks_mut::<POINTS>().0.iter_mut();
        for (j, ((line, shares), first)) in lines.zip(self.shares.as_chunks::<POINTS>().0).zip(LINE).enumerate() {
            let constant = lanes::plus_product(base, y, [first; LANES]);
            let mut sum = NONE;
            for ((out, share), first) in line.iter_mut().zip(shares).zip(LINE) {
                let light = lanes::plus_product(constant, x, [first; LANES]);
                let light = lanes::zip(&light, most, |light, most| Real::max(Real::min(light, most), 0.0));
                *out = product(&light, share);
                sum = plus(&sum, out);
                lanes::keep_together();
            }
            // Points at the ends count half.
            let [first, .., last] = line;
            sum = lanes::minus_product(sum, plus(first, last), [0.5; LANES]);
            let weight = if j == 0 || j == CELLS { 0.5 } else { 1.0 };
            integral = lanes::plus_product(integral, sum, [weight / (CELLS * CELLS) as f32; LANES]);
        }
        integral
    }

    /// The part of a polynomial that the pixels' places decide.
    fn place_part(&self, batch: &Batch<'_>, (block, row): (usize, usize), coefficients: &[Eight]) -> Eight {
        let places = row_at(batch.places, batch.terms.fixed(), block).iter().zip(coefficients);
        places.fold(NONE, |sum, (place, coefficient)| lanes::plus_product(sum, place[row % AT_ONCE], *coefficient))
    }

    /// The integral less the mean at the samples; adds to `within` what is left of these about their pixel's mean.
    #[inline(always)]
    fn compare(
        &self,
        batch: &Batch<'_>,
        (block, row): (usize, usize),
        channel: usize,
        integral: &Eight,
        wanted: &Eight,
        within: &mut Eight,
    ) -> Eight {
        let (mut sum, mut square) = (NONE, NONE);
        let (mut total, mut first) = (NONE, None);
        for (x, y, _, values) in self.samples(batch, block) {
            let value = at(values, channel)[row % AT_ONCE];
            let light = only(wanted, &self.interpolate(&x[row % AT_ONCE], &y[row % AT_ONCE]));
            total = plus(&total, &light);
            let apart = minus(&value, &light);
            let first = *first.get_or_insert(apart);
            let apart = minus(&apart, &first);
            sum = plus(&sum, &apart);
            square = lanes::plus_product(square, apart, apart);
        }
        let inverse = 1.0 / batch.call.n as f32;
        let left = lanes::minus_product(square, sum.map(|sum| sum * inverse), sum);
        *within = plus(within, &only(&at(batch.inside, block)[row % AT_ONCE], &left.map(|left| Real::max(left, 0.0))));
        only(wanted, &lanes::zip(integral, &total, |integral, total| integral - total * inverse))
    }

    /// The interpolant between the points.
    fn interpolate(&self, x: &Eight, y: &Eight) -> Eight {
        let mut out = NONE;
        for lane in 0..LANES {
            let [(i, a), (j, b)] = [x[lane], y[lane]].map(|u| {
                let at = u * CELLS as f32;
                let cell = (at as usize).min(CELLS - 1);
                (cell, at - cell as f32)
            });
            // Loops, not closures: these may stay calls, which check `lane` again.
            let mut ends = [0.0; 2];
            for (row, end) in ends.iter_mut().enumerate() {
                if let Some([left, right, ..]) = self.points.get((j + row) * POINTS + i..) {
                    *end = left[lane] + a * (right[lane] - left[lane]);
                }
            }
            let [below, above] = ends;
            out[lane] = below + b * (above - below);
        }
        out
    }
}

/// Adds the penalty of a column to its square, and says it.
fn penalise(matrix: &mut [Eight], penalties: &[f32], fixed: usize, column: usize) -> f32 {
    let penalty = at(penalties, if column < fixed { column.min(1) } else { 2 + column - fixed });
    if let Some(square) = row_mut(matrix, column).last_mut() {
        *square = square.map(|square| square + penalty);
    }
    penalty
}
