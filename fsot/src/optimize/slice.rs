//! One slice: the points of a subclass, projected on a direction and transported to their target (5.22-5.24).

use super::rank::{KEY_BITS, Ranking};
use crate::target::MAX_DIMS;
use std::ops::Range;

/// What a slice did to a point: its offset along the direction times its weight, and the weight, the factor of (5.24).
pub(crate) type Offset = [f32; 2];

/// Which points a slice takes, and how it projects them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slice {
    /// A unit vector.
    pub(crate) direction: Vec<f32>,
    /// Added to every coordinate, modulo the lengths of the region, before projection; none unless the domain is a
    /// torus.
    pub(crate) shift: Vec<f32>,
    /// The points' ranges, ascending.
    pub(crate) selected: Vec<Range<u32>>,
    /// The number of points in them.
    pub(crate) count: usize,
}

/// Memory that slices use one after the other; about 32 bytes per point.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    keys: Vec<u32>,
    means: Vec<f32>,
    density: Vec<f32>,
    scratch: Vec<f32>,
    ranking: Ranking,
}

/// Adding this to a number in [0, 2^23) leaves the number, rounded, in the low bits of its representation.
const ROUNDING: f32 = (1u32 << KEY_BITS) as f32;

/// The target of a slice.
pub(crate) struct Bins<F> {
    /// Writes means, relative densities; may use the third.
    pub(crate) write: F,
    /// Whether the target is uniform, so that no part of the projection is crowded.
    pub(crate) uniform: bool,
}

/// Transports the selected points of `coordinates`, in the region [0, lengths], to their target's bins and leaves what
/// happened to point i in `offsets[i]`; those of other points are not touched. Returns the mean squared distance that
/// the points have to their bins' means.
pub(crate) fn transport(
    slice: &Slice,
    lengths: &[f32],
    coordinates: &[f32],
    bins: Bins<impl FnOnce(&mut [f32], &mut [f32], &mut Vec<f32>)>,
    offsets: &mut [Offset],
    workspace: &mut Workspace,
) -> f64 {
    let count = slice.count;
    if count == 0 {
        return 0.0;
    }
    let Workspace { keys, means, density, scratch, ranking } = workspace;
    if keys.len() < count {
        keys.resize(count, 0);
        means.resize(count, 0.0);
        density.resize(count, 0.0);
    }
    let (keys, means, density) = (&mut keys[..count], &mut means[..count], &mut density[..count]);
    (bins.write)(means, density, scratch);

    // Position = low + key * quantum.
    let (mut low, mut width) = (0.0f32, 0.0f32);
    for (direction, length) in slice.direction.iter().zip(lengths) {
        low += (direction * length).min(0.0);
        width += (direction * length).abs();
    }
    let top = ROUNDING - 1.0;
    let quantum = width / top;
    let project = match lengths.len() {
        1 => project::<1>,
        2 => project::<2>,
        3 => project::<3>,
        4 => project::<4>,
        5 => project::<5>,
        6 => project::<6>,
        7 => project::<7>,
        _ => project::<MAX_DIMS>,
    };
    project(slice, lengths, coordinates, low, top / width.max(f32::MIN_POSITIVE), keys);

    let ranks =
        if bins.uniform && Ranking::AT_ONCE.contains(&count) { ranking.at_once(keys) } else { ranking.sorted(keys) };
    let mut energy = 0.0;
    let mut before = 0;
    for range in &slice.selected {
        let here = before..before + range.len();
        before = here.end;
        let places = &mut offsets[range.start as usize..range.end as usize];
        let (keys, ranks) = (&keys[here.clone()], &ranks[here]);
        // Four at a time, for the sake of vector units and because a sum waits for the one before.
        let (quads, places_left) = places.as_chunks_mut::<4>();
        let ((key_quads, keys_left), (rank_quads, ranks_left)) = (keys.as_chunks::<4>(), ranks.as_chunks::<4>());
        let one = |key: u32, rank: u32| {
            let offset = means[rank as usize] - (low + key as i32 as f32 * quantum);
            (offset, density[rank as usize])
        };
        for ((place, keys), ranks) in quads.iter_mut().zip(key_quads).zip(rank_quads) {
            let mut squares = [0.0; 4];
            for i in 0..4 {
                let (offset, weight) = one(keys[i], ranks[i]);
                place[i] = [offset * weight, weight];
                squares[i] = offset * offset;
            }
            energy += f64::from((squares[0] + squares[1]) + (squares[2] + squares[3]));
        }
        for ((place, &key), &rank) in places_left.iter_mut().zip(keys_left).zip(ranks_left) {
            let (offset, weight) = one(key, rank);
            *place = [offset * weight, weight];
            energy += f64::from(offset * offset);
        }
    }
    energy / count as f64
}

/// The keys of the selected points: projected coordinates as integers.
fn project<const D: usize>(
    slice: &Slice,
    lengths: &[f32],
    coordinates: &[f32],
    low: f32,
    scale: f32,
    keys: &mut [u32],
) {
    let key = |t: f32| (((t - low) * scale).clamp(0.0, ROUNDING - 1.0) + ROUNDING).to_bits() & ((1 << KEY_BITS) - 1);
    let array = |of: &[f32]| std::array::from_fn::<f32, D, _>(|k| of[k]);
    let direction = array(&slice.direction);
    let mut keys = keys;
    for range in &slice.selected {
        let (here, rest) = keys.split_at_mut(range.len());
        keys = rest;
        let (points, _) = coordinates[range.start as usize * D..range.end as usize * D].as_chunks::<D>();
        if slice.shift.is_empty() {
            for (point, place) in points.iter().zip(here) {
                let mut t = 0.0;
                for (x, direction) in point.iter().zip(&direction) {
                    t += x * direction;
                }
                *place = key(t);
            }
        } else {
            let (lengths, shift) = (array(lengths), array(&slice.shift));
            for (point, place) in points.iter().zip(here) {
                let mut t = 0.0;
                for k in 0..D {
                    let x = point[k] + shift[k];
                    t += (if x >= lengths[k] { x - lengths[k] } else { x }) * direction[k];
                }
                *place = key(t);
            }
        }
    }
}

/// Moves points of `dims` coordinates from number `first` on, as many as are given, by the offsets that slices left for
/// them: by the weighted mean of the offsets, times `dims` because each shows one direction of so many, times `step`.
/// `settle(from, to, axis)` says where a coordinate goes that would go from one place to the other.
pub(crate) fn advance(
    slices: &[(&Slice, &[Offset])],
    dims: usize,
    first: usize,
    step: f32,
    coordinates: &mut [f32],
    settle: impl Fn(f32, f32, usize) -> f32,
) {
    const BLOCK: usize = 256;
    for (block, coordinates) in coordinates.chunks_mut(BLOCK * dims).enumerate() {
        let begin = first + block * BLOCK;
        let end = begin + coordinates.len() / dims;
        let mut sums = [[0.0f32; BLOCK]; MAX_DIMS];
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
        for (i, point) in coordinates.chunks_exact_mut(dims).enumerate() {
            let factor = step * dims as f32 / (weights[i] + (dims - 1) as f32);
            if weights[i] > 0.0 {
                for (k, x) in point.iter_mut().enumerate() {
                    *x = settle(*x, *x + factor * sums[k][i], k);
                }
            }
        }
    }
}
