//! Fits to slices at several samples in each pixel.
//!
//! A pixel's samples are of several slices. So lanes are not of groups here, but of values and candidates: they share a
//! sample's slice, and the coefficients of one are together.

use super::super::config::Config;
use super::batch::Batch;
use super::products::*;
use super::sliced::panels;
use super::terms::Terms;

/// A panel is eight of the values' candidates.
pub(super) struct Several<'a> {
    /// Columns and functions at four samples of a pixel, and their values.
    columns: &'a mut [Four],
    samples: Rows<'a>,
    /// Of a pixel's samples, for each group and panel: sums of what is fitted, of what that leaves of how far values
    /// are from the first, and of squares of this.
    explained: &'a mut [[Eight; 3]],
    /// How far a sample's values are from the first.
    differences: &'a mut [Eight],
    /// For each group, slice, panel and column.
    coefficients: &'a mut [Eight],
}

impl<'a> Several<'a> {
    pub(super) fn new(terms: &Terms, values: usize, arena: &mut Arena<'a, f32>) -> Self {
        let panels = panels(values * terms.ends.len());
        let coefficients = arena.take_lanes(LANES * terms.slices * panels * terms.columns());
        let differences = arena.take_lanes(panels);
        // What a candidate does not use, and what is none, stays 0.
        empty(coefficients);
        empty(differences);
        Self {
            columns: arena.take_fours(terms.columns()),
            samples: Rows::new(terms.functions, values, arena),
            explained: arena.take_lanes(3 * LANES * panels).as_chunks_mut().0,
            differences,
            coefficients,
        }
    }

    /// Sets the coefficients, which are given for each value, candidate, slice and column.
    #[inline]
    pub(super) fn set(&mut self, terms: &Terms, values: usize, coefficients: &[Eight]) {
        let (columns, count, slices) = (terms.columns(), terms.ends.len().max(1), terms.slices);
        let panels = panels(values * count);
        for which in 0..values * count {
            let end = at(&terms.ends, which % count);
            for (slice, row) in rows(row_at(coefficients, slices * columns, which), columns).enumerate() {
                for lane in 0..LANES {
                    let out = row_at_mut(self.coefficients, columns, (lane * slices + slice) * panels + which / LANES);
                    for (out, coefficient) in out.iter_mut().zip(first(row, end)) {
                        out[which % LANES] = coefficient[lane];
                    }
                }
            }
        }
    }

    /// Corrects a block's pixels of several samples, which the fits have not seen, and adds to `left` for each value
    /// and candidate what the fits leave of the samples about their pixels' means.
    #[inline]
    pub(super) fn correct(&mut self, batch: &Batch<'_>, block: usize, corrections: &mut [Four], left: &mut [Eight]) {
        let (terms, call, count) = (&batch.terms, batch.call, batch.terms.ends.len().max(1));
        let panels = panels(batch.values * count);
        let inverse = 1.0 / call.n as f32;
        for slot in 0..AT_ONCE {
            let one = at(row_at(batch.places, terms.fixed(), block), 0)[slot];
            self.explained.iter_mut().for_each(|sums| *sums = [NONE; 3]);
            let mut firsts = [NONE; 2 * Config::MAX_CHANNELS];
            for begin in (0..call.n).step_by(AT_ONCE) {
                let lines = AT_ONCE.min(call.n - begin);
                call.read(batch, (block, slot..slot + 1), begin..begin + lines, &mut self.samples);
                batch.put_samples((block, slot), &[[1.0; LANES]; AT_ONCE], self.samples.columns, self.columns);
                if begin == 0 {
                    firsts.iter_mut().zip(&*self.samples.values).for_each(|(first, values)| *first = values[0]);
                }
                for (line, slices) in call.slices(&self.samples).iter().enumerate().take(lines) {
                    for lane in (0..LANES).filter(|&lane| one[lane] > 0.0) {
                        let slice = lane * terms.slices + slices[lane] as usize;
                        self.explain((line, lane), slice, &firsts, count);
                    }
                }
            }
            let inside = at(batch.inside, block)[slot];
            for (which, left) in left.iter_mut().enumerate().take(batch.values * count) {
                let row = row_at_mut(corrections, terms.candidates(), block * batch.values + which / count);
                let Some(out) = row.get_mut(which % count) else { return };
                for (lane, explained) in rows(self.explained, panels).enumerate() {
                    let [sum, rest, squares] = at(explained, which / LANES).map(|sums| sums[which % LANES]);
                    out[slot][lane % LANES] = sum * -inverse;
                    if inside[lane % LANES] > 0.0 {
                        left[lane % LANES] += squares - rest * inverse * rest;
                    }
                }
            }
        }
    }

    /// Adds one sample of a group's pixel, by the coefficients of the group's slice.
    #[inline]
    fn explain(&mut self, (line, lane): (usize, usize), slice: usize, firsts: &[Eight], count: usize) {
        let (width, panels) = (self.columns.len(), self.differences.len());
        let values = self.samples.values.iter().zip(firsts);
        for ((value, first), out) in values.zip(rows_mut(self.differences.as_flattened_mut(), count)) {
            out.fill(value[line % AT_ONCE][lane % LANES] - first[lane % LANES]);
        }
        let coefficients = rows(row_at(self.coefficients, width * panels, slice), width);
        let explained = row_at_mut(self.explained, panels, lane).iter_mut();
        for (([sum, rest, squares], difference), coefficients) in explained.zip(&*self.differences).zip(coefficients) {
            let mut fitted = NONE;
            for (column, coefficient) in self.columns.iter().zip(coefficients) {
                let column = [column[line % AT_ONCE][lane % LANES]; LANES];
                fitted = lanes::plus_product(fitted, column, *coefficient);
                lanes::keep_together();
            }
            let residual = minus(difference, &fitted);
            (*sum, *rest) = (plus(sum, &fitted), plus(rest, &residual));
            *squares = lanes::plus_product(*squares, residual, residual);
        }
    }
}
