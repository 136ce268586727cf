//! A visit of a pixel: other arrangements of its points are tried, and kept where the energy falls, or, while it is
//! hot, rises by a little.

use super::basis::{Basis, Spectrum};
use super::border::{BINS, bin};
use super::energy::{Energy, Groups, POINTS, Places};
use super::power::{LANES, sum, terms};
use super::prices::Prices;
use super::problem::OCTAVES;
use super::table::{OFFSET_BITS, fine};
use noisefloor::rng::Rng;

/// The offsets of a pixel: `[axis][offset]`.
pub(crate) type Offsets = [[u16; POINTS]; 2];

/// What the rest of the tile asks of a pixel, for the points whose first octave is the index.
pub(crate) struct Surroundings {
    pub(crate) fields: [Spectrum; OCTAVES],
    pub(crate) prices: Prices,
}

/// Shared by all visits of a step.
pub(crate) struct Rules<'a> {
    pub(crate) basis: &'a Basis,
    pub(crate) energy: &'a Energy,
    pub(crate) groups: &'a Groups,
    pub(crate) bits: u32,
    pub(crate) temperature: f32,
    pub(crate) candidates: usize,
}

/// How much shallower than the deepest the bit of the tree is that is tried.
const DEPTHS: [u32; 16] = [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 3, 3, 4, 5];

/// Digits that are optimised: those that tell a marginal's bins apart. All others stay as random as they start: within
/// a bin nothing keeps points from flocking to one place.
const DIGITS: u32 = BINS.trailing_zeros();
/// Their bits of an offset.
const OPTIMISED: u16 = !(0xffff >> DIGITS);

/// A pixel being visited.
struct Pixel<'a> {
    rules: &'a Rules<'a>,
    around: &'a Surroundings,
    number: u32,
    offsets: Offsets,
    places: Places,
    x: [f32; POINTS],
    y: [f32; POINTS],
    /// What each point costs by itself.
    alone: [f32; POINTS],
    /// What it gains by its distances from the others.
    apart: [f32; POINTS],
    /// The factor of the mean distance for the points of each first octave.
    means: [f32; OCTAVES],
}

/// A coordinate as a number of the unit interval.
fn unit(place: u16) -> f32 {
    (f32::from(place) + 0.5) * (1.0 / 65536.0)
}

/// Where points lie.
pub(crate) fn places(groups: &Groups, offsets: &Offsets, number: u32) -> Places {
    let place = |axis: usize, point: usize| place(groups, offsets, number, axis, point);
    std::array::from_fn(|axis| std::array::from_fn(|point| place(axis, point)))
}

fn place(groups: &Groups, offsets: &Offsets, number: u32, axis: usize, point: usize) -> u16 {
    let offset = u32::from(offsets[axis][groups.offset[axis][point]]);
    (fine(groups.net[axis][point] ^ (offset << OFFSET_BITS), number, axis) >> 16) as u16
}

/// Visits pixel `number`; its offsets and points afterwards, and whether an arrangement was taken.
pub(crate) fn visit(
    rules: &Rules,
    around: &Surroundings,
    number: u32,
    (offsets, places): (Offsets, Places),
    rng: &mut Rng,
) -> (Offsets, Places, bool) {
    let mut pixel = Pixel::new(rules, around, number, (offsets, places));
    let mut changed = false;
    for _ in 0..rules.candidates {
        changed |= pixel.attempt(rng);
    }
    (pixel.offsets, pixel.places, changed)
}

impl<'a> Pixel<'a> {
    fn new(
        rules: &'a Rules<'a>,
        around: &'a Surroundings,
        number: u32,
        (offsets, places): (Offsets, Places),
    ) -> Pixel<'a> {
        let mut means = [0.0; OCTAVES];
        for (first, mean) in means.iter_mut().enumerate() {
            let octaves = rules.energy.octaves.iter().filter(|octave| **octave >= first);
            *mean = octaves.map(|octave| 2.0 * rules.energy.weights[*octave] / (1u32 << octave) as f32).sum();
        }
        let (x, y) = (places[0].map(unit), places[1].map(unit));
        let zero = [0.0; POINTS];
        let mut pixel = Pixel { rules, around, number, offsets, places, x, y, alone: zero, apart: zero, means };
        for point in 0..rules.energy.points {
            pixel.alone[point] = pixel.cost(point, pixel.places[0][point], pixel.places[1][point]);
        }
        pixel.sum_apart();
        pixel
    }

    fn sum_apart(&mut self) {
        let mut into = [0.0; POINTS];
        for point in 0..self.rules.energy.points {
            self.apart[point] = self.terms(point, self.x[point], self.y[point], &self.x, &self.y, &mut into);
        }
    }

    /// What a point at a place costs by itself.
    fn cost(&self, point: usize, x: u16, y: u16) -> f32 {
        let first = self.rules.energy.first[point];
        let [along_x, along_y] = &self.around.prices[first];
        self.rules.basis.at(x, y, &self.around.fields[first])
            + self.means[first] * self.rules.basis.mean_at(unit(x), unit(y))
            + (along_x[bin(x)] + along_y[bin(y)])
    }

    fn terms(&self, point: usize, x: f32, y: f32, xs: &[f32], ys: &[f32], into: &mut [f32; POINTS]) -> f32 {
        let padded = self.rules.energy.points.next_multiple_of(LANES);
        let weights = &self.rules.energy.pairs[point][..padded];
        terms([x, y], [&xs[..padded], &ys[..padded], weights], self.rules.basis.half, &mut into[..padded])
    }

    fn weighed(&self, weights: &[f32; POINTS], x: f32, y: f32, xs: &[f32; POINTS], ys: &[f32; POINTS]) -> f32 {
        let padded = self.rules.energy.points.next_multiple_of(LANES);
        sum([x, y], [&xs[..padded], &ys[..padded], &weights[..padded]], self.rules.basis.half)
    }

    /// Tries one arrangement; whether it was taken.
    fn attempt(&mut self, rng: &mut Rng) -> bool {
        let (rules, groups) = (self.rules, self.rules.groups);
        // Every octave gets the same attention.
        let random = rng.next_u32();
        let octaves = &rules.energy.octaves;
        let octave = octaves[((random & 0xffff) as usize * octaves.len()) >> 16];
        let start = octaves.iter().rev().find(|other| **other < octave).map_or(0, |other| 1usize << other);
        let point = start + ((rng.next_u32() as u64 * ((1 << octave) - start) as u64) >> 32) as usize;
        let axis = (random >> 16 & 1) as usize;
        let bits = rules.bits;
        // A bit of the tree, or finer ones of one offset, or of both axes' offsets.
        let kind = random >> 17 & 7;
        let trees = if rules.energy.points < POINTS { 3 } else { 1 };
        let mut offsets = self.offsets;
        if kind < trees {
            // Shallow ones move many points, which takes long.
            let depth = bits - 1 - DEPTHS[(random >> 24) as usize & 15].min(bits - 1);
            for offset in &mut offsets[axis][groups.offsets(axis, depth, point)] {
                *offset ^= 0x8000 >> depth;
            }
            if random >> 20 & 1 == 0 {
                offsets[axis][groups.offset[axis][point]] ^= rng.next_u32() as u16 & (0xffff >> bits) & OPTIMISED;
            }
            return self.decide(axis, groups.members(axis, depth, point), &offsets, rng);
        }
        let depth = bits + (((random >> 20) * (DIGITS - bits)) >> 12);
        let mask = |random: u32| ((0x8000u32 >> depth) | (random & (0x7fffu32 >> depth))) as u16 & OPTIMISED;
        let random = rng.next_u32();
        offsets[axis][groups.offset[axis][point]] ^= mask(random);
        let members = groups.members(axis, bits, point);
        let both = kind == 7 && members.len() == 1 && groups.members(1 - axis, bits, point).len() == 1;
        if both {
            let finer = random >> 16 & (0xffff >> (depth + (random >> 31)));
            offsets[1 - axis][groups.offset[1 - axis][point]] ^= finer as u16 & OPTIMISED;
        }
        self.decide(axis, members, &offsets, rng)
    }

    /// Takes new offsets that move these points if that is better, or not much worse.
    fn decide(&mut self, axis: usize, members: &[u8], offsets: &Offsets, rng: &mut Rng) -> bool {
        let moved = |point: usize| [0, 1].map(|axis| place(self.rules.groups, offsets, self.number, axis, point));
        let allowed = self.rules.temperature * exponential(rng);
        if let [point] = members {
            let point = usize::from(*point);
            let to = moved(point);
            let alone = self.cost(point, to[0], to[1]);
            let (x, y) = (unit(to[0]), unit(to[1]));
            let mut new = [0.0; POINTS];
            let apart = self.terms(point, x, y, &self.x, &self.y, &mut new);
            let rise = (alone - self.alone[point]) - (apart - self.apart[point]);
            if rise >= allowed {
                return false;
            }
            let mut old = [0.0; POINTS];
            self.terms(point, self.x[point], self.y[point], &self.x, &self.y, &mut old);
            for ((sum, new), old) in self.apart.iter_mut().zip(&new).zip(&old) {
                *sum += new - old;
            }
            self.apart[point] = apart;
            self.alone[point] = alone;
            (self.x[point], self.y[point]) = (x, y);
            (self.places[0][point], self.places[1][point]) = (to[0], to[1]);
            self.offsets = *offsets;
            return true;
        }
        self.decide_many(axis, members, offsets, allowed)
    }

    fn decide_many(&mut self, axis: usize, members: &[u8], offsets: &Offsets, allowed: f32) -> bool {
        let (mut xs, mut ys, mut to) = (self.x, self.y, self.places);
        let mut alone = self.alone;
        let mut rise = 0.0;
        for &point in members {
            let point = usize::from(point);
            to[axis][point] = place(self.rules.groups, offsets, self.number, axis, point);
            (xs[point], ys[point]) = (unit(to[0][point]), unit(to[1][point]));
            alone[point] = self.cost(point, to[0][point], to[1][point]);
            rise += alone[point] - self.alone[point];
        }
        // Pairs of moved points are seen from both sides.
        let mut counted = [1.0; POINTS];
        members.iter().for_each(|point| counted[usize::from(*point)] = 0.5);
        for &point in members {
            let point = usize::from(point);
            let mut weights = self.rules.energy.pairs[point];
            weights.iter_mut().zip(&counted).for_each(|(weight, counted)| *weight *= counted);
            let (new, old) = (self.weighed(&weights, xs[point], ys[point], &xs, &ys), {
                self.weighed(&weights, self.x[point], self.y[point], &self.x, &self.y)
            });
            rise -= new - old;
        }
        if rise >= allowed {
            return false;
        }
        (self.x, self.y, self.places, self.alone, self.offsets) = (xs, ys, to, alone, *offsets);
        self.sum_apart();
        true
    }
}

/// An exponentially distributed number, by the logarithm's bits: exact enough for a temperature.
fn exponential(rng: &mut Rng) -> f32 {
    let uniform = (rng.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0) + 3e-8;
    let bits = uniform.to_bits();
    let mantissa = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000);
    let exponent = (bits >> 23) as f32 - 127.0;
    -std::f32::consts::LN_2 * (exponent + (mantissa - 1.0) * (1.35 - 0.35 * (mantissa - 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;
    use crate::sampler::SamplerProblem;

    /// The energy of a pixel's points by its definition: each octave's squared error, and what the rest of the tile
    /// asks of each point.
    fn energy(rules: &Rules, around: &Surroundings, places: &Places) -> f64 {
        let [xs, ys] = places.map(|places| places.map(|place| f64::from(unit(place))));
        let mut sum = 0.0;
        for &octave in &rules.energy.octaves {
            let count = 1 << octave;
            let share = 1.0 / count as f64;
            let mut own = 0.0;
            for i in 0..count {
                own += 2.0 * share * f64::from(rules.basis.mean_at(xs[i] as f32, ys[i] as f32));
                for j in 0..i {
                    let squared = (xs[i] - xs[j]).powi(2) + (ys[i] - ys[j]).powi(2);
                    own -= 2.0 * share * share * libm::pow(squared + 1e-10, f64::from(rules.basis.half));
                }
            }
            sum += f64::from(rules.energy.weights[octave]) * own;
        }
        for i in 0..rules.energy.points {
            let first = rules.energy.octaves.iter().copied().find(|octave| i < 1 << octave).unwrap();
            let [along_x, along_y] = &around.prices[first];
            let asked = rules.basis.at(places[0][i], places[1][i], &around.fields[first]);
            sum += f64::from(asked + along_x[bin(places[0][i])] + along_y[bin(places[1][i])]);
        }
        sum
    }

    /// Cold, an arrangement is taken exactly if the energy falls; what the visit remembers of each point stays true.
    #[test]
    fn what_lowers_the_energy_is_taken() {
        let basis = Basis::new(0.65);
        let mut rng = stream(4, 0, 0);
        let around = Surroundings {
            fields: std::array::from_fn(|_| std::array::from_fn(|_| 0.02 * (rng.uniform_f32() - 0.5))),
            prices: std::array::from_fn(|_| [0, 1].map(|_| std::array::from_fn(|bin| (0.02 * bin as f32).sin()))),
        };
        for (bits, shares) in [(6, [1.0; OCTAVES]), (3, [1.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0])] {
            let problem = SamplerProblem { bits, ..SamplerProblem::default() };
            let energy_of = Energy::new(&basis, &shares);
            let groups = Groups::new(&problem, energy_of.points);
            let rules = |temperature: f32| Rules {
                basis: &basis,
                energy: &energy_of,
                groups: &groups,
                bits,
                temperature,
                candidates: 1,
            };
            let (cold, hot) = (rules(0.0), rules(1e9));
            let looked_at = energy_of.points;
            let offsets = [[0; POINTS]; 2];
            let start = || (offsets, places(&groups, &offsets, 5));
            let mut pixel = Pixel::new(&cold, &around, 5, start());
            let mut kept = [0; 2];
            for _ in 0..400 {
                let before = energy(&cold, &around, &pixel.places);
                let mut proposal = Pixel::new(&hot, &around, 5, (pixel.offsets, pixel.places));
                assert!(proposal.attempt(&mut rng.clone()), "hot, everything is taken");
                let rise = energy(&hot, &around, &proposal.places) - before;
                let taken = pixel.attempt(&mut rng);
                if rise.abs() > 1e-3 {
                    assert_eq!(taken, rise < 0.0, "{rise}");
                    kept[usize::from(taken)] += 1;
                }
                let expected = if taken { &proposal } else { &pixel };
                assert_eq!((pixel.offsets, pixel.places), (expected.offsets, expected.places));
                assert!(pixel.offsets.as_flattened().iter().all(|offset| offset & !OPTIMISED == 0));
                let anew = places(&groups, &pixel.offsets, 5);
                (0..2).for_each(|axis| assert_eq!(pixel.places[axis][..looked_at], anew[axis][..looked_at]));
                let fresh = Pixel::new(&cold, &around, 5, (pixel.offsets, pixel.places));
                for point in 0..looked_at {
                    assert!((pixel.alone[point] - fresh.alone[point]).abs() < 1e-4);
                    assert!((pixel.apart[point] - fresh.apart[point]).abs() < 1e-3);
                }
            }
            assert!(kept[0] > 50 && kept[1] > 20, "{kept:?}");
        }
    }

    /// The limits are five standard deviations.
    #[test]
    fn exponential_numbers_have_the_mean_1() {
        let mut rng = stream(5, 0, 0);
        let numbers: Vec<f64> = (0..100_000).map(|_| f64::from(exponential(&mut rng))).collect();
        let mean = numbers.iter().sum::<f64>() / 1e5;
        let beyond = numbers.iter().filter(|x| **x > 2.0).count() as f64 / 1e5;
        assert!((mean - 1.0).abs() < 0.016 && (beyond - libm::exp(-2.0)).abs() < 0.0055, "{mean} {beyond}");
        assert!(numbers.iter().all(|x| *x >= -1e-6));
    }
}
