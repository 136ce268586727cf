//! One slice against slow oracles.

use super::rank::{KEY_BITS, Ranking};
use super::slice::{Bins, Slice, Workspace, transport};
use crate::random::stream;
use crate::target::{Target, Uniform};
use noisefloor::rng::Rng;
use proptest::prelude::*;

fn slice_of(dims: usize, points: usize, rng: &mut Rng) -> Slice {
    let direction = super::direction::direction(dims, rng, 0.1);
    Slice { direction, selected: std::iter::once(0..points as u32).collect(), count: points, ..Slice::default() }
}

/// Bins of the uniform target, for the slice.
fn bins_of(slice: &Slice, count: usize) -> (Vec<f32>, Vec<f32>) {
    let (mut means, mut density) = (vec![0.0; count], vec![0.0; count]);
    Uniform::new(slice.direction.len()).bins(&slice.direction, &mut means, &mut density, &mut Vec::new());
    (means, density)
}

/// The offsets that [`transport`] shall find, and ranks, by a comparison sort in double precision.
fn transported(slice: &Slice, coordinates: &[f32]) -> (Vec<f64>, Vec<usize>) {
    let dims = slice.direction.len();
    let project = |point: &[f32]| -> f64 {
        let shifts = slice.shift.iter().copied().chain(std::iter::repeat(0.0));
        point
            .iter()
            .zip(shifts)
            .zip(&slice.direction)
            .map(|((x, shift), direction)| {
                let x = x + shift;
                f64::from(if x >= 1.0 { x - 1.0 } else { x }) * f64::from(*direction)
            })
            .sum()
    };
    let members: Vec<usize> = slice.selected.iter().cloned().flatten().map(|i| i as usize).collect();
    let mut sorted: Vec<(f64, usize)> =
        members.iter().map(|&i| (project(&coordinates[i * dims..(i + 1) * dims]), i)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (means, _) = bins_of(slice, members.len());
    let mut offsets = vec![0.0; coordinates.len() / dims];
    let mut ranks = vec![usize::MAX; offsets.len()];
    for (rank, ((t, i), mean)) in sorted.into_iter().zip(means).enumerate() {
        offsets[i] = f64::from(mean) - t;
        ranks[i] = rank;
    }
    (offsets, ranks)
}

fn run(slice: &Slice, coordinates: &[f32], uniform: bool) -> (Vec<[f32; 2]>, f64) {
    let dims = slice.direction.len();
    let target = Uniform::new(dims);
    let write = |means: &mut [f32], density: &mut [f32], scratch: &mut Vec<f32>| {
        target.bins(&slice.direction, means, density, scratch);
    };
    let mut offsets = vec![[f32::NAN; 2]; coordinates.len() / dims];
    let bins = Bins { write, uniform };
    let energy = transport(slice, &vec![1.0; dims], coordinates, bins, &mut offsets, &mut Workspace::default());
    (offsets, energy)
}

fn against_brute_force(dims: usize, seed: u64) {
    let rng = &mut stream(seed, 0, dims as u64);
    for points in [1usize, 2, 3, 7, 100, 400, 1000] {
        let coordinates: Vec<f32> = (0..points * dims).map(|_| rng.uniform_f32()).collect();
        let mut slice = slice_of(dims, points, rng);
        if points > 50 {
            slice.selected = vec![3..10, 20..points as u32 - 1];
            slice.count = 7 + points - 21;
            slice.shift = (0..dims).map(|_| rng.uniform_f32()).collect();
        }
        let (expected, ranks) = transported(&slice, &coordinates);
        let (means, _) = bins_of(&slice, slice.count);
        let (offsets, energy) = run(&slice, &coordinates, false);
        let mut sum = 0.0;
        for i in slice.selected.iter().cloned().flatten().map(|i| i as usize) {
            let offset = f64::from(offsets[i][0]) / f64::from(offsets[i][1]);
            // Keys are multiples of the projected length by 2^-23: points nearer than that may have changed places.
            let t = |i: usize| f64::from(means[ranks[i]]) - expected[i];
            let crowded = (0..points).any(|j| j != i && ranks[j] < means.len() && (t(i) - t(j)).abs() < 1e-6);
            assert!(
                (offset - expected[i]).abs() < 4e-6 || crowded,
                "{points} points in {dims}: {offset} for {}",
                expected[i]
            );
            sum += expected[i] * expected[i];
        }
        assert!((energy - sum / slice.count as f64).abs() < 1e-4 * energy + 1e-9);
        let untouched = (0..points).filter(|i| !slice.selected.iter().any(|range| range.contains(&(*i as u32))));
        assert!(untouched.map(|i| offsets[i][0]).all(f32::is_nan));

        // Ranks at once: every point has the bin of another one that is nearer than a bucket.
        let longest = means.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f32::max);
        let width: f32 = slice.direction.iter().map(|x| x.abs()).sum();
        let (rough, rough_energy) = run(&slice, &coordinates, true);
        let mut differing = 0.0;
        for i in slice.selected.iter().cloned().flatten().map(|i| i as usize) {
            let offset = f64::from(rough[i][0]) / f64::from(rough[i][1]);
            differing += (offset - expected[i]) * (offset - expected[i]);
            assert!(slice.count >= 512 || rough[i] == offsets[i], "few points take their own bins: {points} in {dims}");
        }
        let bucket = f64::from(width) / (2 * slice.count) as f64 + f64::from(longest);
        assert!(differing / slice.count as f64 <= bucket * bucket, "{points} points in {dims}");
        assert!((rough_energy.sqrt() - energy.sqrt()).abs() <= bucket);
    }
}

#[test]
fn transport_is_that_of_a_comparison_sort() {
    for seed in 0..8 {
        for dims in 1..=8 {
            against_brute_force(dims, seed);
        }
    }
}

/// W2^2 between points on a line and the target of a slice (5.19), by quadrature of the difference of the inverse
/// distributions.
fn distance(sorted: &[f64], fine: &[f32]) -> f64 {
    let per_point = fine.len() / sorted.len();
    let sum: f64 = fine.iter().enumerate().map(|(k, &q)| (sorted[k / per_point] - f64::from(q)).powi(2)).sum();
    sum / fine.len() as f64
}

#[test]
fn offsets_are_the_gradient_of_the_distance() {
    let points = 12;
    let rng = &mut stream(7, 0, 0);
    for _ in 0..20 {
        let coordinates: Vec<f32> = (0..points * 2).map(|_| rng.uniform_f32()).collect();
        let slice = slice_of(2, points, rng);
        let (offsets, _) = run(&slice, &coordinates, false);
        // A thousand bins for each of the points' bins: their means are the inverse distribution, closely.
        let (fine, _) = bins_of(&slice, points * 1000);
        let project =
            |i: usize| -> f64 { (0..2).map(|k| f64::from(coordinates[2 * i + k] * slice.direction[k])).sum() };
        let at: Vec<f64> = (0..points).map(project).collect();
        let with = |i: usize, change: f64| {
            let mut moved = at.clone();
            moved[i] += change;
            moved.sort_by(f64::total_cmp);
            distance(&moved, &fine)
        };
        for i in 0..points {
            let h = 1e-5;
            let near = (0..points).any(|j| j != i && (at[i] - at[j]).abs() < 2.0 * h);
            if near {
                continue;
            }
            let numerical = (with(i, h) - with(i, -h)) / (2.0 * h);
            // (5.21): the derivative is 2 / n (x_i - mean of its bin).
            let analytic = -2.0 / points as f64 * f64::from(offsets[i][0] / offsets[i][1]);
            assert!((numerical - analytic).abs() < 2e-5, "{numerical} for {analytic}");
        }
    }
}

proptest! {
    #[test]
    fn ranks_are_those_of_a_sort(keys in prop::collection::vec(0u32..1 << KEY_BITS, 1..3000)) {
        let mut sorted = keys.clone();
        sorted.sort_unstable();
        let mut ranking = Ranking::default();
        let exact = ranking.sorted(&keys).to_vec();
        let rough = ranking.at_once(&keys).to_vec();
        // At once: at least two buckets per key, and keys in one bucket in any order.
        for (ranks, bucket) in [(exact, 0), (rough, (1 << KEY_BITS) / (2 * keys.len() as u32) + 1)] {
            let mut all = ranks.clone();
            all.sort_unstable();
            prop_assert!(all.iter().enumerate().all(|(i, &rank)| i == rank as usize));
            for (&key, &rank) in keys.iter().zip(&ranks) {
                prop_assert!(key.abs_diff(sorted[rank as usize]) <= bucket);
            }
        }
    }
}

#[test]
fn directions_are_units_and_isotropic() {
    fn check<const D: usize>() {
        let count = 20_000;
        let rng = &mut stream(3, 1, D as u64);
        let mut second = [[0.0f64; D]; D];
        for _ in 0..count {
            let v = super::direction::direction(D, rng, 0.0);
            assert!((v.iter().map(|x| f64::from(x * x)).sum::<f64>() - 1.0).abs() < 1e-6);
            for i in 0..D {
                for j in 0..D {
                    second[i][j] += f64::from(v[i] * v[j]) / f64::from(count);
                }
            }
        }
        for i in 0..D {
            for j in 0..D {
                let expected = if i == j { 1.0 / D as f64 } else { 0.0 };
                // Five standard deviations of a mean of numbers of at most variance 1/4: .018.
                assert!((second[i][j] - expected).abs() < 0.018, "{D}: {second:?}");
            }
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
    check::<8>();
    let rng = &mut stream(4, 0, 0);
    let axes = (0..10_000).filter(|_| super::direction::direction(3, rng, 0.3).contains(&1.0)).count();
    // Half of .3 point up an axis: 1,500, and 5 standard deviations of 36.
    assert!((1320..1680).contains(&axes), "{axes}");
}

/// A point moves by the mean of what its slices want, each by its weight, in D times as many directions as one.
#[test]
fn points_move_by_weighted_means() {
    let (first, points, step) = (700, 600, 0.7);
    let rng = &mut stream(9, 0, 0);
    let ranges =
        [vec![0..1000, 1000..1300], vec![0..701, 950..1000, 1000..1290], vec![100..650, 1299..1300], Vec::new()];
    let slices: Vec<Slice> = ranges
        .into_iter()
        .map(|selected| Slice { direction: super::direction::direction(3, rng, 0.0), selected, ..Slice::default() })
        .collect();
    let offsets: Vec<Vec<[f32; 2]>> = (0..slices.len())
        .map(|_| (0..1300).map(|_| [rng.uniform_f32() - 0.5, 0.1 + rng.uniform_f32()]).collect())
        .collect();
    let moved: Vec<(&Slice, &[[f32; 2]])> = slices.iter().zip(offsets.iter().map(|o| &o[..])).collect();
    let before: Vec<f32> = (0..points * 3).map(|_| rng.uniform_f32()).collect();
    let mut after = before.clone();
    super::slice::advance(&moved, 3, first, step, &mut after, |from, to, axis| if axis == 2 { from } else { to });
    for i in 0..points {
        let number = (first + i) as u32;
        let (mut sum, mut weight) = ([0.0f32; 3], 0.0);
        for (slice, offsets) in &moved {
            if slice.selected.iter().any(|range| range.contains(&number)) {
                let [offset, counts] = offsets[first + i];
                weight += counts;
                (0..3).for_each(|k| sum[k] += slice.direction[k] * offset);
            }
        }
        for k in 0..3 {
            let way = if k == 2 { 0.0 } else { step * 3.0 * sum[k] / (weight + 2.0) };
            assert!((after[3 * i + k] - before[3 * i + k] - way).abs() < 1e-5, "point {number}, axis {k}");
        }
    }
}
