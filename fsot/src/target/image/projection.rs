//! A grid projected on a line, and the projection cut into bins of equal mass.

use super::grid::Rows;

/// Pieces of constant density that each bin of the histogram is refined to.
const PIECES: usize = 4;

/// The projection of a grid: masses of bins as wide as a cell's projection along its row.
pub(super) struct Profile<'a> {
    masses: &'a [f32],
    /// The coordinate of the first bin, in bins.
    origin: f64,
}

impl<'a> Profile<'a> {
    /// `slope`, at most 1 in size: by how much of a cell's projected length every row is shifted against the one
    /// before.
    ///
    /// A cell's footprint is a box of length 1 convolved with a box of length |slope|. All cells of a row lie at the
    /// same offset from the bins, so their masses in the three bins that they may touch are one filter of three taps.
    pub(super) fn of(rows: &Rows, slope: f64, scratch: &'a mut Vec<f32>) -> Profile<'a> {
        let slope = slope.clamp(-1.0, 1.0);
        let shift = slope.abs();
        let count = rows.width() + (rows.height() as f64 * shift) as usize + 3;
        scratch.clear();
        scratch.resize(count, 0.0);
        for row in 0..rows.height() {
            let Some((first, cells)) = rows.occupied(row) else { continue };
            // Shifted to lower coordinates: the last row is then the one that begins at the origin.
            let rank = if slope < 0.0 { rows.height() - 1 - row } else { row };
            let begin = rank as f64 * shift;
            let bin = begin as usize;
            let offset = begin - bin as f64;
            let (low, middle) = (footprint(1.0 - offset, shift), footprint(2.0 - offset, shift));
            let taps = [low as f32, (middle - low) as f32, (1.0 - middle) as f32];
            let outputs = cells.len() - 2;
            let (zero, one, two) = (&cells[2..], &cells[1..1 + outputs], &cells[..outputs]);
            for ((sum, zero), (one, two)) in
                scratch[bin + first..bin + first + outputs].iter_mut().zip(zero).zip(one.iter().zip(two))
            {
                *sum += taps[0] * zero + (taps[1] * one + taps[2] * two);
            }
        }
        Profile { masses: scratch, origin: if slope < 0.0 { -(rows.height() as f64) * shift } else { 0.0 } }
    }

    /// Cuts the projection into bins of equal mass: their means, and their densities relative to that of the mass
    /// spread evenly over `range`. `length`: of a bin of the histogram.
    pub(super) fn cut(&self, length: f64, range: f64, means: &mut [f32], density: &mut [f32]) {
        let count = means.len().min(density.len());
        let total: f64 = self.masses.iter().map(|mass| f64::from(*mass)).sum();
        if count == 0 || total <= 0.0 {
            return;
        }
        let mut cutter = Cutter { origin: self.origin, length, range, means, density, done: 0, ..Cutter::default() };
        let scale = count as f64 / total;
        let mass = |bin: usize| self.masses.get(bin).map_or(0.0, |mass| f64::from(*mass) * scale);
        for bin in 0..self.masses.len() {
            let centre = mass(bin);
            if centre <= 0.0 {
                continue;
            }
            let below = if bin == 0 { 0.0 } else { mass(bin - 1) };
            let slope = limited(below, centre, mass(bin + 1));
            for piece in 0..PIECES {
                let at = (piece as f64 + 0.5) / PIECES as f64 - 0.5;
                // The limiter keeps the density of every piece from falling below 0, but for rounding.
                let density = (centre + slope * at).max(0.0);
                cutter.add(bin as f64 + piece as f64 / PIECES as f64, 1.0 / PIECES as f64, density);
            }
        }
        cutter.finish(count);
    }
}

/// The part of a cell's footprint that lies within `x` of its beginning: a box of length 1 convolved with one of
/// length `r <= 1`.
fn footprint(x: f64, r: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if x >= 1.0 + r {
        1.0
    } else if x < r {
        x * x / (2.0 * r)
    } else if x <= 1.0 {
        x - r / 2.0
    } else {
        let rest = 1.0 + r - x;
        1.0 - rest * rest / (2.0 * r)
    }
}

/// The slope of the density in a bin from its mass and its neighbours': the central difference, limited so that no
/// part of the bin is below 0 or beyond a neighbour (van Leer 1977).
fn limited(below: f64, centre: f64, above: f64) -> f64 {
    let (left, right) = (centre - below, above - centre);
    if left * right <= 0.0 {
        return 0.0;
    }
    let size = (0.5 * (left + right)).abs().min(2.0 * left.abs()).min(2.0 * right.abs());
    if left < 0.0 { -size } else { size }
}

/// Takes pieces of constant density in ascending order and gives bins of mass 1. Positions are in bins of the
/// histogram.
#[derive(Default)]
struct Cutter<'a> {
    origin: f64,
    length: f64,
    range: f64,
    means: &'a mut [f32],
    density: &'a mut [f32],
    /// Bins that are complete.
    done: usize,
    /// Of the bin being filled: mass, first moment, where it begins.
    mass: f64,
    moment: f64,
    begin: f64,
    /// Where the last piece ends.
    end: f64,
    started: bool,
}

impl Cutter<'_> {
    fn add(&mut self, from: f64, length: f64, density: f64) {
        if density <= 0.0 {
            return;
        }
        if !self.started {
            self.started = true;
            self.begin = from;
        }
        self.end = from + length;
        let count = self.means.len().min(self.density.len());
        let mut at = from;
        let mut left = density * length;
        // The bin that was begun in another piece.
        let missing = 1.0 - self.mass;
        if left < missing {
            self.take(at, self.end, left);
            return;
        }
        let to = (at + missing / density).min(self.end);
        self.take(at, to, missing);
        self.close(to, count);
        left -= missing;
        at = to;
        // Bins that lie in this piece alone all have the same length.
        let whole = (left as usize).min(count.saturating_sub(self.done));
        let step = 1.0 / density;
        let mean = (self.origin + at + 0.5 * step) * self.length;
        let stride = step * self.length;
        for (index, value) in self.means[self.done..self.done + whole].iter_mut().enumerate() {
            *value = (mean + index as f64 * stride) as f32;
        }
        self.density[self.done..self.done + whole].fill(step as f32);
        self.done += whole;
        if whole > 0 {
            at = (at + whole as f64 * step).min(self.end);
            self.begin = at;
        }
        self.take(at, self.end, (left - whole as f64).max(0.0));
    }

    fn take(&mut self, from: f64, to: f64, mass: f64) {
        self.mass += mass;
        self.moment += mass * 0.5 * (from + to);
    }

    /// Completes the bin being filled; its length stands for its density until the end.
    fn close(&mut self, to: f64, count: usize) {
        if self.done < count && self.mass > 0.0 {
            self.means[self.done] = ((self.origin + self.moment / self.mass) * self.length) as f32;
            self.density[self.done] = (to - self.begin) as f32;
            self.done += 1;
        }
        self.mass = 0.0;
        self.moment = 0.0;
        self.begin = to;
    }

    fn finish(mut self, count: usize) {
        // Rounding may leave the last bin a little short of its mass, or without any.
        self.close(self.end, count);
        let last = ((self.origin + self.end) * self.length) as f32;
        self.means[self.done..count].fill(last);
        self.density[self.done..count].fill(0.0);
        let average = (self.range / self.length / count as f64) as f32;
        // A bin has a positive length except for rounding: no density is infinite.
        let shortest = average * 1e-6;
        self.density[..count].iter_mut().for_each(|value| *value = average / value.max(shortest));
    }
}
