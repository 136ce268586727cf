//! What corrects: the light that the fits say, interpolated between the points of a grid.

use super::super::products::*;
use super::functions::*;
use core::f32::consts::LOG2_E;

/// q is no further from 0.
pub(super) const MOST: f32 = 50.0;
/// Points along a coordinate, and cells between them.
const POINTS: usize = CELLS + 1;
const CELLS: usize = 16;

/// The polynomial of degree 1 at the points of a line.
const LINE: [f32; POINTS] = {
    let mut line = [0.0; POINTS];
    let mut i = 0;
    while i < POINTS {
        line[i] = linear(i as f32 / CELLS as f32);
        i += 1;
    }
    line
};

/// A function of two coordinates in the unit square, by its values at points.
pub(super) struct Interpolant<'a> {
    /// How much of the light arrives, and how much light arrives, at the points.
    shares: &'a mut [Eight],
    points: &'a mut [Eight],
}

impl<'a> Interpolant<'a> {
    pub(super) fn new(arena: &mut Arena<'a, f32>) -> Self {
        Self {
            shares: arena.take_lanes(POINTS * POINTS),
            // Looked up also where nothing was put there.
            points: arena.zeros(POINTS * POINTS * LANES).as_chunks_mut().0,
        }
    }

    /// How much of the light arrives, at the points, by q's constant and its weights of the functions.
    ///
    /// Along a line e^-q is multiplied by a factor from point to point, which is multiplied by one that does not
    /// change, as q is of degree 2; and so are the first values of lines. Where q is large all of it is less, and 0
    /// where it was.
    #[inline(always)]
    pub(super) fn share_out(&mut self, base: &Eight, weights: &[Eight; FUNCTIONS]) {
        // Between points, the difference of the function of degree 1; of that of degree 2 the first, and its own.
        const STEP: f32 = 2.0 * SQRT_3 / CELLS as f32;
        const CHANGE: f32 = SQRT_5 * STEP * STEP;
        const FIRST: f32 = 0.5 * CHANGE - SQRT_5 * SQRT_3 * STEP;
        let &[x, y, xx, xy, yy] = weights;
        let corner = [(*base, 1.0), (x, -SQRT_3), (y, -SQRT_3), (xx, SQRT_5), (xy, 3.0), (yy, SQRT_5)];
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

    /// How much light of a channel arrives at the points, by A's constant and its weights; the integral of it.
    #[inline]
    pub(super) fn put_light(&mut self, base: &Eight, weights: &[Eight; SLOPES], most: &Eight) -> Eight {
        let [x, y] = weights;
        let mut integral = NONE;
        let lines = self.points.as_chunks_mut::<POINTS>().0.iter_mut();
        for (j, ((line, shares), first)) in lines.zip(self.shares.as_chunks::<POINTS>().0).zip(LINE).enumerate() {
            let constant = lanes::plus_product(*base, *y, [first; LANES]);
            let mut sum = NONE;
            for ((out, share), first) in line.iter_mut().zip(shares).zip(LINE) {
                let light = lanes::plus_product(constant, *x, [first; LANES]);
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

    /// Its value between the points.
    pub(super) fn value(&self, x: &Eight, y: &Eight) -> Eight {
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
