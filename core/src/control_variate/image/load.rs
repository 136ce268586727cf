//! Reading all samples of a batch, and sums of their products.

use super::super::config::Config;
use super::batch::{Batch, MAX_FIXED, kept};
use super::products::*;
use super::sliced::Sliced;
use super::terms::Terms;
use core::array::from_fn;

/// What samples are read to: they, their pixels, and sums.
pub(super) struct Loading<'a> {
    samples: Rows<'a>,
    pixels: Rows<'a>,
    deviations: Deviations<'a>,
    sliced: Sliced<'a>,
}

impl<'a> Loading<'a> {
    pub(super) fn new(batch: &Batch<'_>, arena: &mut Arena<'a, f32>) -> Self {
        let (terms, values, n) = (&batch.terms, batch.values, batch.call.n);
        let (summed, (kept, _)) = (terms.of_slices(values, n), kept(terms, n));
        Self {
            samples: Rows::new(terms.functions, values, arena),
            pixels: Rows::new(terms.columns(), values.max(summed), arena),
            deviations: Deviations::new(kept, values, arena),
            sliced: Sliced::new(terms.slices, terms.columns(), summed, arena),
        }
    }
}

impl Batch<'_> {
    /// Reads all samples and sums their products.
    #[inline(always)]
    pub(super) fn load(&mut self, arena: &mut Arena<'_, f32>) {
        let (call, values, slices) = (self.call, self.values, self.terms.slices);
        let (columns, functions, fixed) = (self.terms.columns(), self.terms.functions, self.terms.fixed());
        let Loading { mut samples, mut pixels, mut deviations, mut sliced } = Loading::new(self, &mut arena.scratch());
        self.set_units();
        for sums in [&mut self.between, &mut self.within, &mut self.sliced] {
            sums.empty();
        }
        let parts = if self.has_colours { COLOURS } else { 1 };
        for part in 0..parts {
            for block in (part..self.len).step_by(parts) {
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
                self.put_pixels(block, true, columns, means);
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
            let (pixels, which) = (self.pixels((block, row)), begin..begin + count);
            call.put_values(self, (block, row), &pixels, &which, 0, samples.values);
            self.put_in_units(samples.values);
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
        empty(deviations.totals);
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

    /// The columns of a block's pixels, and their values; as fits are made to them, where `fits`.
    #[inline(always)]
    pub(super) fn put_pixels(&self, block: usize, fits: bool, columns: &mut [Four], values: &mut [Four]) {
        let (terms, n) = (&self.terms, self.call.n);
        let places = row_at(self.places, terms.fixed(), block);
        let (fixed, rest) = halves_mut(columns, terms.fixed());
        let (functions, products) = halves_mut(rest, terms.functions);
        copy(fixed, places);
        copy(functions, row_at(self.functions, terms.functions, block));
        copy(values, row_at(self.means, self.values, block));
        if fits && (self.leaves_out || n > 1) {
            let (inside, root) = (at(self.inside, block), Real::sqrt(n as f32));
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
                set(self.functions, k * width + j, product);
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
