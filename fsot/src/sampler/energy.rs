//! What all pixels share during a step: the net's points, their groups and what each octave counts.

use super::basis::Basis;
use super::problem::{OCTAVES, SamplerProblem};
use super::table::{leading, net};

/// The most points of a pixel that are looked at.
pub(crate) const POINTS: usize = 1 << (OCTAVES - 1);

/// Points of a pixel as the leading 16 bits of coordinates: `[axis][point]`.
pub(crate) type Places = [[u16; POINTS]; 2];

/// What a step's energy is made of.
#[derive(Debug)]
pub(crate) struct Energy {
    /// The octaves that count.
    pub(crate) octaves: Vec<usize>,
    /// The weight of each octave's squared error.
    pub(crate) weights: [f32; OCTAVES],
    /// Points that are looked at.
    pub(crate) points: usize,
    /// The first octave that counts and has this point, for each point.
    pub(crate) first: [usize; POINTS],
    /// The weight of each pair of points.
    pub(crate) pairs: Vec<[f32; POINTS]>,
}

impl Energy {
    pub(crate) fn new(basis: &Basis, shares: &[f32; OCTAVES]) -> Energy {
        let octaves: Vec<usize> = (0..OCTAVES).filter(|octave| shares[*octave] > 0.0).collect();
        let points = octaves.last().map_or(1, |octave| 1 << octave);
        let weigh = |octave: usize| {
            let count = f64::from(1u32 << octave);
            (f64::from(shares[octave]) * count * libm::sqrt(count) / f64::from(basis.total)) as f32
        };
        let weights: [f32; OCTAVES] = std::array::from_fn(weigh);
        let first = |point: usize| octaves.iter().copied().find(|octave| point < 1 << octave).unwrap_or(OCTAVES - 1);
        let first: [usize; POINTS] = std::array::from_fn(first);
        let pair = |i: usize, j: usize| {
            let from = first[i.max(j)];
            let seen = octaves.iter().filter(|octave| **octave >= from && i != j && i.max(j) < points);
            seen.map(|octave| 2.0 * weights[*octave] / (1u32 << (2 * octave)) as f32).sum()
        };
        let pairs = (0..POINTS).map(|i| std::array::from_fn(|j| pair(i, j))).collect();
        Energy { octaves, weights, points, first, pairs }
    }
}

/// The net's first points, and which of them share an offset's bits.
#[derive(Debug)]
pub(crate) struct Groups {
    /// The points' coordinates before any offset.
    pub(crate) net: [[u32; POINTS]; 2],
    /// The offset of each point.
    pub(crate) offset: [[usize; POINTS]; 2],
    bits: u32,
    /// `[axis][depth][prefix]`
    groups: [Vec<Vec<Vec<u8>>>; 2],
}

impl Groups {
    /// Of the first `points` points.
    pub(crate) fn new(problem: &SamplerProblem, points: usize) -> Groups {
        let bits = problem.bits;
        let net: [[u32; POINTS]; 2] = std::array::from_fn(|axis| std::array::from_fn(|i| net(i as u32)[axis]));
        let offset = net.map(|values| values.map(|value| leading(value, bits)));
        let members = |axis: usize, depth: u32, prefix: usize| -> Vec<u8> {
            let all = 0..points;
            all.filter(|i| offset[axis][*i] >> (bits - depth) == prefix).map(|i| i as u8).collect()
        };
        let depths = |axis: usize| -> Vec<Vec<Vec<u8>>> {
            (0..=bits).map(|depth| (0..1 << depth).map(|prefix| members(axis, depth, prefix)).collect()).collect()
        };
        Groups { net, offset, bits, groups: [depths(0), depths(1)] }
    }

    /// The points whose bit at a depth is one with that of `point`.
    pub(crate) fn members(&self, axis: usize, depth: u32, point: usize) -> &[u8] {
        let depth = depth.min(self.bits);
        &self.groups[axis][depth as usize][self.offset[axis][point] >> (self.bits - depth)]
    }

    /// The offsets whose bit at a depth is one with that of `point`.
    pub(crate) fn offsets(&self, axis: usize, depth: u32, point: usize) -> std::ops::Range<usize> {
        let below = self.bits - depth.min(self.bits);
        let start = self.offset[axis][point] >> below << below;
        start..start + (1 << below)
    }
}
