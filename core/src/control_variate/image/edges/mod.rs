//! Light that arrives for some u and not for others: a candidate whose boundary in two coordinates is a conic.
//!
//! Polynomials follow no edge. Where a group has lit and dark samples, f is modelled as h = A / (1 + e^-q). q is a
//! logistic regression of whether a sample is lit, of degree 2 in the two coordinates and 1 in the pixel's place, so
//! that the boundary, q = 0, moves across the group. A, of degree 1 in all, is least squares to the lit samples, and
//! kept from 0 to the largest of them. What corrects is h's bilinear interpolant between 17 x 17 points of the two
//! coordinates, whose integral the trapezoid rule gives: the correction's mean is 0 whatever was fitted.

mod functions;
mod interpolant;
mod regression;

use super::batch::{Batch, MAX_FIXED};
use super::call::Call;
use super::fit::Fits;
use super::products::*;
use crate::basis::MAX_DIMS;
use crate::control_variate::Config;
use functions::*;
use interpolant::Interpolant;

/// The fewest samples of a pixel that say whether it is cut by an edge.
const FEWEST_SAMPLES: usize = 4;
/// The fewest pixels of a group.
const FEWEST_PIXELS: usize = 8;
const MAX_COLUMNS: usize = MAX_FIXED + FUNCTIONS;

impl Call<'_> {
    pub(super) fn has_edges(&self) -> bool {
        self.config.edges > 0 && self.n >= FEWEST_SAMPLES && !self.is_single_fit()
    }

    /// Whether an edge is looked for in a group of so many pixels.
    pub(super) fn may_have_edge(&self, len: usize) -> bool {
        self.has_edges() && len >= FEWEST_PIXELS
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
    /// The light that a pixel's fits say, at points.
    interpolant: Interpolant<'a>,
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
            interpolant: Interpolant::new(arena),
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
                call.reader.put_positions(&pixels.map(|pixel| pixel * call.held + sample), 1, row * LANES, &mut x);
                lit[row] = NONE;
                for (channel, (value, units)) in values.iter_mut().zip(&batch.units).enumerate() {
                    let input = call.gather(call.reader.samples.f, &pixels, (call.held, sample), channel);
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
                        let (base, weights) = at_pixel(batch, (block, row), &q);
                        self.interpolant.share_out(&base, &weights);
                    }
                    for channel in 0..channels {
                        let corrections = fits.corrections_mut(block, channel).last_mut();
                        let (Some(out), Some(a), Some(most), Some(within)) =
                            (corrections, a.get(channel), most.get(channel), within.get_mut(channel))
                        else {
                            return present;
                        };
                        let integral = if is_needed {
                            let (base, weights) = at_pixel(batch, (block, row), a);
                            self.interpolant.put_light(&base, &weights, most)
                        } else {
                            NONE
                        };
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
            let light = only(wanted, &self.interpolant.value(&x[row % AT_ONCE], &y[row % AT_ONCE]));
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
}

/// A polynomial where a pixel is: its constant there, and its weights of functions of the coordinates.
#[inline(always)]
fn at_pixel<const N: usize>(
    batch: &Batch<'_>,
    (block, row): (usize, usize),
    coefficients: &[Eight],
) -> (Eight, [Eight; N]) {
    let fixed = batch.terms.fixed();
    let places = row_at(batch.places, fixed, block).iter().zip(coefficients);
    let base =
        places.fold(NONE, |sum, (place, coefficient)| lanes::plus_product(sum, place[row % AT_ONCE], *coefficient));
    (base, core::array::from_fn(|i| at(coefficients, fixed + i)))
}
