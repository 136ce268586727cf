//! One slice: the points of a subclass, projected on a direction and transported to their target (5.22-5.24).

use std::ops::Range;

/// What a slice did to a point: its offset along the direction times its weight, and the weight, the factor of (5.24).
pub(crate) type Offset = [f32; 2];

/// Which points a slice takes, and how it projects them.
#[derive(Clone, Debug)]
pub(crate) struct Slice<const D: usize> {
    /// A unit vector.
    pub(crate) direction: [f32; D],
    /// Added to every coordinate, modulo the lengths of the region, before projection; 0 unless the domain is a torus.
    pub(crate) shift: [f32; D],
    /// The points' ranges, ascending.
    pub(crate) selected: Vec<Range<u32>>,
    /// The number of points in them.
    pub(crate) count: usize,
}

impl<const D: usize> Slice<D> {
    pub(crate) fn new() -> Slice<D> {
        Slice { direction: [0.0; D], shift: [0.0; D], selected: Vec::new(), count: 0 }
    }
}

/// Memory that slices use one after the other; about 32 bytes per point.
#[derive(Default)]
pub(crate) struct Workspace {
    elements: Vec<u64>,
    sorted: Vec<u64>,
    means: Vec<f32>,
    density: Vec<f32>,
    scratch: Vec<f32>,
    counts: Vec<u32>,
}

/// Projected coordinates are sorted as integers of this many bits: all that a single-precision sum of coordinates carries.
const KEY_BITS: u32 = 23;
/// Adding this to a number in [0, 2^23) leaves the number, rounded, in the low bits of its representation.
const ROUNDING: f32 = (1u32 << KEY_BITS) as f32;

/// Transports the selected points of `coordinates`, in the region [0, lengths], to the bins that `bins` writes (means, relative densities,
/// scratch) and leaves what happened to point i in `offsets[i]`; those of other points are not touched. Returns the mean squared
/// distance that the points have to their bins' means.
pub(crate) fn transport<const D: usize>(
    slice: &Slice<D>,
    lengths: &[f32; D],
    coordinates: &[f32],
    bins: impl FnOnce(&mut [f32], &mut [f32], &mut Vec<f32>),
    offsets: &mut [Offset],
    workspace: &mut Workspace,
) -> f64 {
    let count = slice.count;
    if count == 0 {
        return 0.0;
    }
    let Workspace { elements, sorted, means, density, scratch, counts } = workspace;
    for buffer in [&mut *elements, &mut *sorted] {
        if buffer.len() < count {
            buffer.resize(count, 0);
        }
    }
    for buffer in [&mut *means, &mut *density] {
        if buffer.len() < count {
            buffer.resize(count, 0.0);
        }
    }
    let (elements, sorted) = (&mut elements[..count], &mut sorted[..count]);
    let (means, density) = (&mut means[..count], &mut density[..count]);
    bins(means, density, scratch);

    // Position = low + key * quantum.
    let (mut low, mut width) = (0.0f32, 0.0f32);
    for k in 0..D {
        low += (slice.direction[k] * lengths[k]).min(0.0);
        width += (slice.direction[k] * lengths[k]).abs();
    }
    let top = ROUNDING - 1.0;
    let scale = top / width.max(f32::MIN_POSITIVE);
    let quantum = width / top;

    // Two passes by `digit` bits each, the lowest bits left out: ranks are exact but for points nearer than a small part of a bin.
    let digit = ((count.max(2).ilog2() + 10) / 2).clamp(7, 12);
    let (drop, mask) = (KEY_BITS.saturating_sub(2 * digit), (1usize << digit) - 1);
    counts.clear();
    counts.resize(2 << digit, 0);
    let (low_counts, high_counts) = counts.split_at_mut(1 << digit);

    let wraps = slice.shift != [0.0; D];
    let mut filled = 0;
    for range in &slice.selected {
        let (begin, end) = (range.start as usize, range.end as usize);
        let points = coordinates[begin * D..end * D].chunks_exact(D);
        for ((i, point), element) in (range.start..range.end).zip(points).zip(&mut elements[filled..]) {
            let mut t = 0.0;
            for k in 0..D {
                let mut x = point[k];
                if wraps {
                    x += slice.shift[k];
                    x = if x >= lengths[k] { x - lengths[k] } else { x };
                }
                t += x * slice.direction[k];
            }
            let key = (((t - low) * scale).max(0.0).min(top) + ROUNDING).to_bits() & ((1 << KEY_BITS) - 1);
            *element = u64::from(key) << 32 | u64::from(i);
            low_counts[(key >> drop) as usize & mask] += 1;
            high_counts[(key >> (drop + digit)) as usize & mask] += 1;
        }
        filled += end - begin;
    }
    for counts in [&mut *low_counts, &mut *high_counts] {
        let mut sum = 0;
        for count in counts {
            (*count, sum) = (sum, sum + *count);
        }
    }
    for &element in &*elements {
        let place = &mut low_counts[(element >> (32 + drop)) as usize & mask];
        sorted[*place as usize] = element;
        *place += 1;
    }
    let mean_density = 1.0 / width;
    let mut energy = 0.0;
    for &element in &*sorted {
        let key = (element >> 32) as u32;
        let place = &mut high_counts[(key >> (drop + digit)) as usize & mask];
        let rank = *place as usize;
        *place += 1;
        let offset = means[rank] - (low + key as i32 as f32 * quantum);
        let weight = density[rank] * mean_density;
        offsets[element as u32 as usize] = [offset * weight, weight];
        energy += f64::from(offset) * f64::from(offset);
    }
    energy / count as f64
}

/// Moves the points `first..first + coordinates.len() / D`, whose coordinates are given, by the offsets that slices left for them:
/// by the weighted mean of the offsets, times D because each shows one direction of D only, times `step`.
pub(crate) fn advance<const D: usize>(
    slices: &[(&Slice<D>, &[Offset])],
    first: usize,
    step: f32,
    coordinates: &mut [f32],
    settle: impl Fn(f32, usize) -> f32,
) {
    const BLOCK: usize = 256;
    for (block, coordinates) in coordinates.chunks_mut(BLOCK * D).enumerate() {
        let begin = first + block * BLOCK;
        let end = begin + coordinates.len() / D;
        let mut sums = [[0.0f32; BLOCK]; D];
        let mut weights = [0.0f32; BLOCK];
        for (slice, offsets) in slices {
            let after = slice.selected.partition_point(|range| range.end as usize <= begin);
            for range in slice.selected[after..].iter().take_while(|range| (range.start as usize) < end) {
                let (from, to) = (begin.max(range.start as usize), end.min(range.end as usize));
                let offsets = &offsets[from..to];
                let here = from - begin..to - begin;
                for (weight, offset) in weights[here.clone()].iter_mut().zip(offsets) {
                    *weight += offset[1];
                }
                for (sums, &direction) in sums.iter_mut().zip(&slice.direction) {
                    for (sum, offset) in sums[here.clone()].iter_mut().zip(offsets) {
                        *sum += direction * offset[0];
                    }
                }
            }
        }
        for (i, point) in coordinates.chunks_exact_mut(D).enumerate() {
            let factor = step * D as f32 / (weights[i] + super::schedule::P[3] as f32 * (D - 1) as f32);
            if weights[i] > 0.0 {
                for (k, x) in point.iter_mut().enumerate() {
                    *x = settle(*x + factor * sums[k][i], k);
                }
            }
        }
    }
}
