//! The marginals of all pixels' points: what keeps each uniform, up to the borders of the unit square.

use super::problem::OCTAVES;
use crate::metrics::border;

/// Bins of a marginal: eight in each stratum of the longest octave.
pub(crate) const BINS: usize = 512;
/// How many bins beside its own an octave's point counts in, on each side: fewer points are seen less sharply. The
/// finest strata are 8 bins wide: what gathers once in each, a triangle of that side would not see.
const REACH: [usize; OCTAVES] = [5, 5, 5, 5, 5, 3, 1];
/// Something for each distance from a bin, up to the longest reach.
pub(crate) type Shares = [f32; 6];
/// The weights of bins at each distance: triangles whose weights have the sum 1.
const WEIGHTS: [Shares; OCTAVES] = weights();
/// Numbers of a state: `[octave][axis][bin]`.
pub(crate) const STATE: usize = OCTAVES * 2 * BINS;
/// How much of a deviation is added to what is remembered of it, each sweep.
const MEMORY: f32 = 0.01;

/// Counts, and what a point pays for being in a bin: the bin's surplus now, and a sum over the past that removes what
/// the surplus alone would leave.
#[derive(Clone, Debug)]
pub(crate) struct Border {
    counts: Vec<i32>,
    means: [f32; OCTAVES],
    pub(crate) past: Vec<f32>,
}

impl Border {
    pub(crate) fn new(pixels: usize) -> Border {
        let means = std::array::from_fn(|octave| ((pixels << octave) as f32) / BINS as f32);
        Border { counts: vec![0; STATE], means, past: vec![0.0; STATE] }
    }

    pub(crate) fn clear(&mut self) {
        self.counts.fill(0);
    }

    /// Counts a coordinate of a point whose octaves are these and all longer ones; `change` is 1, or -1 to forget it.
    pub(crate) fn count(&mut self, octave: usize, axis: usize, coordinate: u16, change: i32) {
        for octave in octave..OCTAVES {
            self.counts[(octave * 2 + axis) * BINS + bin(coordinate)] += change;
        }
    }

    /// The surplus around a bin of an octave, relative to its mean.
    pub(crate) fn surplus(&self, octave: usize, axis: usize, bin: usize) -> f32 {
        let counts = &self.counts[(octave * 2 + axis) * BINS..][..BINS];
        let near = around(bin, REACH[octave]).map(|(bin, distance)| WEIGHTS[octave][distance] * counts[bin] as f32);
        near.sum::<f32>() / self.means[octave] - 1.0
    }

    /// The least and the greatest density within 1/64 of a border, relative to a uniform one.
    pub(crate) fn extremes(&self, octave: usize) -> [f32; 2] {
        let near = BINS / border::PARTS;
        let axis = |axis: usize| (octave * 2 + axis) * BINS;
        let ends = [axis(0), axis(0) + BINS - near, axis(1), axis(1) + BINS - near];
        let counts = ends.map(|start| self.counts[start..start + near].iter().sum::<i32>() as usize);
        border::extremes(counts, (self.means[octave] * BINS as f32) as usize)
    }

    /// Remembers the surplus.
    pub(crate) fn remember(&mut self, octaves: &[usize]) {
        for &octave in octaves {
            for i in 0..2 * BINS {
                let surplus = self.surplus(octave, i / BINS, i % BINS);
                self.past[octave * 2 * BINS + i] += MEMORY * surplus;
            }
        }
    }

    /// What an octave's points pay in each bin.
    pub(crate) fn price(&self, octave: usize, axis: usize, bin: usize) -> f32 {
        self.surplus(octave, axis, bin) + self.past[(octave * 2 + axis) * BINS + bin]
    }

    /// What a point more in a bin adds to the surplus of bins, for each distance from it.
    pub(crate) fn share(&self, octave: usize) -> Shares {
        WEIGHTS[octave].map(|weight| weight / self.means[octave])
    }
}

const fn weights() -> [Shares; OCTAVES] {
    let mut all = [[0.0; 6]; OCTAVES];
    let mut octave = 0;
    while octave < OCTAVES {
        let side = REACH[octave] + 1;
        let mut distance = 0;
        while distance < side {
            all[octave][distance] = (side - distance) as f32 / (side * side) as f32;
            distance += 1;
        }
        octave += 1;
    }
    all
}

/// Bins around one and their distances from it; those beyond a border are mirrored.
pub(crate) fn around(bin: usize, reach: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=2 * reach).map(move |i| {
        let distance = i.abs_diff(reach);
        let place = if bin + i < reach { reach - bin - i - 1 } else { bin + i - reach };
        (place.min(2 * BINS - 1 - place), distance)
    })
}

/// The bin of a coordinate.
pub(crate) fn bin(coordinate: u16) -> usize {
    (usize::from(coordinate) * BINS) >> 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;

    /// Of points at random, more of them at one border.
    fn border(points: u32) -> Border {
        let mut border = Border::new(1024);
        let mut rng = stream(1, 0, 0);
        for _ in 0..points {
            let coordinate = (rng.uniform_f32() * rng.uniform_f32() * 65536.0) as u16;
            border.count(2, 0, coordinate, 1);
        }
        border
    }

    /// Counts are spread over bins near them, mirrored at the borders: none is lost there, or seen twice.
    #[test]
    fn what_is_spread_is_what_was_counted() {
        let points = 3000;
        let border = border(points);
        for octave in 0..OCTAVES {
            let mean: f32 = (0..BINS).map(|bin| border.surplus(octave, 0, bin)).sum::<f32>() / BINS as f32;
            let density = if octave < 2 { 0.0 } else { points as f32 / (1024 << octave) as f32 };
            assert!((mean - (density - 1.0)).abs() < 1e-4, "octave {octave}: {mean}");
            assert_eq!(border.surplus(octave, 1, 7), -1.0, "the other axis has no points");
        }
    }

    /// Points at the same place of each of the 64 finest strata are seen there.
    #[test]
    fn combs_are_seen() {
        for octave in 0..OCTAVES {
            let mut border = Border::new(1024);
            (0..64).for_each(|stratum| border.count(octave, 0, stratum << 10, 1));
            let [most, least] = [64, 68].map(|bin| border.surplus(octave, 0, bin) + 1.0);
            assert!(most > 1.05 * least, "octave {octave}: {most} and {least}");
        }
    }

    #[test]
    fn a_point_more_adds_its_share() {
        for (octave, coordinate) in [(2, 0), (3, 700), (5, 65_535), (6, 30_000)] {
            let (before, mut after) = (border(3000), border(3000));
            after.count(octave, 0, coordinate, 1);
            let share = after.share(octave);
            let mut change = [0.0; BINS];
            around(bin(coordinate), share.len() - 1).for_each(|(bin, distance)| change[bin] += share[distance]);
            for (bin, change) in change.into_iter().enumerate() {
                let found = after.surplus(octave, 0, bin) - before.surplus(octave, 0, bin);
                assert!((found - change).abs() < 1e-5, "octave {octave}, bin {bin}: {found} for {change}");
            }
            // The weights of a triangle, as many bins wide as the octave's points allow.
            let side = [6.0, 6.0, 6.0, 6.0, 6.0, 4.0, 2.0][octave];
            let unit = BINS as f32 / (1024 << octave) as f32;
            assert!((share[1] - unit * (side - 1.0) / (side * side)).abs() < 1e-7);
            after.count(octave, 0, coordinate, -1);
            assert_eq!(after.counts, before.counts);
        }
    }

    #[test]
    fn the_past_adds_up() {
        let mut border = border(3000);
        border.remember(&[3]);
        border.remember(&[3]);
        for bin in [0, 100, 511] {
            let surplus = border.surplus(3, 0, bin);
            assert!((border.price(3, 0, bin) - 1.02 * surplus).abs() < 1e-5 * surplus.abs());
            assert_eq!(border.price(4, 0, bin), border.surplus(4, 0, bin), "of another octave nothing is remembered");
        }
    }
}
