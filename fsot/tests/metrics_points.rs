//! Neighbours, discrepancy, sliced Wasserstein distance against slow definitions.

use crate::metrics_common::{assert_mean, assert_near, coarse, grid, random};
use fsot::metrics::discrepancy::discrepancy;
use fsot::metrics::neighbours::{lattice_distance, neighbours};
use fsot::metrics::projection::Projection;
use fsot::metrics::transport::{slice_distance, transport};
use fsot::points::Points;

/// What [`fsot::metrics::check`] refuses.
fn no_points() -> [Points; 4] {
    let of = |x| Points::new(2, vec![0.5, 0.25, x, 0.5]);
    [of(f32::NAN), of(1.5), of(-0.5), Points::new(9, vec![0.5; 18])]
}

/// Mean and smallest distance to the nearest other point, over all pairs.
fn slow_neighbours(points: &Points, toroidal: bool) -> [f64; 2] {
    let all: Vec<&[f32]> = points.iter().collect();
    let along = |a: f32, b: f32| {
        let gap = (f64::from(a) - f64::from(b)).abs();
        if toroidal { gap.min(1.0 - gap) } else { gap }
    };
    let distance = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(&a, &b)| along(a, b) * along(a, b)).sum::<f64>().sqrt();
    let nearest = |i: usize| {
        let others = (0..all.len()).filter(|&j| j != i);
        others.map(|j| distance(all[i], all[j])).fold(f64::INFINITY, f64::min)
    };
    let distances: Vec<f64> = (0..all.len()).map(nearest).collect();
    [distances.iter().sum::<f64>() / all.len() as f64, distances.iter().copied().fold(f64::INFINITY, f64::min)]
}

#[test]
fn neighbours_are_those_of_all_pairs() {
    for dims in 1..=8 {
        for points in [random(200, dims, 1), coarse(150, dims, 2), random(2, dims, 3)] {
            let unit = lattice_distance(points.len(), dims);
            let found = neighbours(&points).unwrap();
            let (bounded, toroidal) = (slow_neighbours(&points, false), slow_neighbours(&points, true));
            let what = format!("{} points in {dims} dimensions", points.len());
            assert_near(found.mean * unit, bounded[0], 1e-12, &what);
            assert_near(found.min * unit, bounded[1], 1e-12, &what);
            assert_near(found.mean_toroidal * unit, toroidal[0], 1e-12, &what);
            assert_near(found.min_toroidal * unit, toroidal[1], 1e-12, &what);
        }
    }
}

/// The densest lattices, scaled to the shortest vector sqrt(2), are the root lattices A1, A2, A3, D4, D5, E6, E7, E8:
/// the squares of their cells' volumes are the determinants of their Cartan matrices.
#[test]
fn lattice_distances_are_those_of_root_lattices() {
    for (dims, determinant) in (1..).zip([2.0f64, 3.0, 4.0, 4.0, 4.0, 3.0, 2.0, 1.0]) {
        for points in [1, 1000] {
            let cells = determinant.sqrt() * f64::from(points);
            let distance = 2.0f64.sqrt() / cells.powf(1.0 / dims as f64);
            assert_near(lattice_distance(points as usize, dims), distance, 1e-12, &format!("{dims} dimensions"));
        }
    }
}

#[test]
fn neighbours_of_lattices_and_of_degenerate_sets() {
    // A square grid's spacing over the hexagonal one: sqrt(sqrt(3) / 2).
    let square = neighbours(&grid(16)).unwrap();
    assert_near(square.mean_toroidal, (3.0_f64.sqrt() / 2.0).sqrt(), 1e-6, "square grid");
    assert_near(square.min, square.mean, 1e-6, "square grid");
    let line = Points::new(1, (0..10).map(|i| i as f32 / 10.0).collect());
    assert_near(neighbours(&line).unwrap().mean_toroidal, 1.0, 1e-6, "equidistant points on a line");
    // Densest lattices in the unit torus: face-centred cubic (4 points), D4 (2^3 / 2 * 2 = 8 points on the
    // half-integers of even sum), E8.
    let even = |dims: usize| -> Vec<f32> {
        let corners = (0..1_usize << dims).filter(|c| c.count_ones() % 2 == 0);
        corners.flat_map(|c| (0..dims).map(move |i| (c >> i & 1) as f32 * 0.5)).collect()
    };
    for dims in [3, 4, 5] {
        assert_near(neighbours(&Points::new(dims, even(dims))).unwrap().min_toroidal, 1.0, 1e-6, "D lattice");
    }
    let mut e8 = even(8);
    e8.extend(even(8).iter().map(|x| x + 0.25));
    assert_near(neighbours(&Points::new(8, e8)).unwrap().min_toroidal, 1.0, 1e-6, "E8");
    assert!(neighbours(&random(1, 2, 1)).is_none());
    assert!(no_points().iter().all(|points| neighbours(points).is_none()));
    for dims in [1, 2, 5, 8] {
        let equal = neighbours(&Points::new(dims, vec![0.5; 3000 * dims])).unwrap();
        assert_eq!([equal.mean, equal.min_toroidal], [0.0, 0.0], "equal points");
    }
    // 0 and 1 are the same place on the torus only.
    let ends = neighbours(&Points::new(1, vec![0.0, 1.0])).unwrap();
    assert_eq!([ends.min * lattice_distance(2, 1), ends.min_toroidal], [1.0, 0.0]);
}

/// The integral of the squared local discrepancy, cell by cell between the coordinates of the points, where the count
/// is constant.
fn slow_discrepancy(points: &Points) -> f64 {
    let d = points.dims();
    let all: Vec<Vec<f64>> = points.iter().map(|p| p.iter().map(|&x| f64::from(x)).collect()).collect();
    let cuts: Vec<Vec<f64>> = (0..d)
        .map(|axis| {
            let mut cuts: Vec<f64> = all.iter().map(|p| p[axis]).chain([0.0, 1.0]).collect();
            cuts.sort_by(f64::total_cmp);
            cuts
        })
        .collect();
    let cells = cuts[0].len() - 1;
    let mut sum = 0.0;
    for cell in 0..cells.pow(d as u32) {
        let index: Vec<usize> = (0..d as u32).map(|axis| cell / cells.pow(axis) % cells).collect();
        let (low, high): (Vec<f64>, Vec<f64>) = (0..d).map(|k| (cuts[k][index[k]], cuts[k][index[k] + 1])).unzip();
        let inside = all.iter().filter(|p| p.iter().zip(&low).all(|(x, l)| x <= l)).count();
        let share = inside as f64 / all.len() as f64;
        let moment = |power: i32| -> f64 {
            (0..d).map(|k| (high[k].powi(power + 1) - low[k].powi(power + 1)) / f64::from(power + 1)).product()
        };
        sum += share * share * moment(0) - 2.0 * share * moment(1) + moment(2);
    }
    sum.sqrt()
}

/// Warnock's formula term by term.
fn warnock(points: &Points) -> f64 {
    let (n, d) = (points.len() as f64, points.dims());
    let all: Vec<Vec<f64>> = points.iter().map(|p| p.iter().map(|&x| f64::from(x)).collect()).collect();
    let single: f64 = all.iter().map(|p| p.iter().map(|x| (1.0 - x * x) / 2.0).product::<f64>()).sum();
    let pair = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| 1.0 - x.max(*y)).product::<f64>();
    let double: f64 = all.iter().map(|a| all.iter().map(|b| pair(a, b)).sum::<f64>()).sum();
    (3.0_f64.powi(-(d as i32)) - 2.0 / n * single + double / n / n).max(0.0).sqrt()
}

#[test]
fn discrepancy_is_the_integral_of_its_definition() {
    for (n, dims) in [(1, 1), (7, 1), (1, 2), (6, 2), (9, 2), (5, 3), (3, 4)] {
        for points in [random(n, dims, 5), coarse(n, dims, 6)] {
            let fast = discrepancy(&points).unwrap().l2_star;
            assert_near(fast, slow_discrepancy(&points), 1e-12, &format!("{n} points in {dims} dimensions"));
        }
    }
}

#[test]
fn dividing_the_sum_changes_nothing() {
    for dims in 1..=8 {
        for points in [random(1500, dims, 1), coarse(1500, dims, 2), Points::new(dims, vec![0.25; 1500 * dims])] {
            let fast = discrepancy(&points).unwrap().l2_star;
            let slow = warnock(&points);
            // The squares have rounding errors of about 1e-15.
            assert_near(fast * fast, slow * slow, 1e-13, &format!("{dims} dimensions"));
        }
    }
    let many = random(12_000, 2, 3);
    assert_near(discrepancy(&many).unwrap().l2_star, warnock(&many), 1e-12, "many");
}

#[test]
fn known_discrepancies() {
    // The midpoints of n equal intervals: 1 / (n sqrt 12).
    let midpoints = Points::new(1, (0..100).map(|i| (i as f32 + 0.5) / 100.0).collect());
    assert_near(discrepancy(&midpoints).unwrap().l2_star, 0.01 / 12.0_f64.sqrt(), 1e-8, "midpoints");
    let squares: Vec<f64> = (0..200).map(|s| discrepancy(&random(50, 3, s)).unwrap().relative.powi(2)).collect();
    assert_mean(&squares, 1.0, "random points");
    assert!(discrepancy(&Points::new(4, vec![0.5; 4 * 65_537])).is_none());
    assert!(no_points().iter().all(|points| discrepancy(points).is_none()));
}

/// The projections of the centres of a fine grid of cells, sorted.
fn dense(direction: &[f64], cells: usize) -> Vec<f64> {
    let d = direction.len() as u32;
    let place = |cell: usize, axis: u32| ((cell / cells.pow(axis) % cells) as f64 + 0.5) / cells as f64 - 0.5;
    let along = |cell: usize| (0..d).map(|axis| direction[axis as usize] * place(cell, axis)).sum();
    let mut values: Vec<f64> = (0..cells.pow(d)).map(along).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn unit(direction: &[f64]) -> Vec<f64> {
    let length = direction.iter().map(|a| a * a).sum::<f64>().sqrt();
    direction.iter().map(|a| a / length).collect()
}

#[test]
fn projected_cubes_are_those_of_dense_sampling() {
    let directions: [(&[f64], usize); 8] = [
        (&[-1.0], 20_000),
        (&[1.0, 0.0], 600),
        (&[1.0, 1.0], 600),
        (&[0.3, -0.8], 600),
        (&[1.0, 1e-4], 600),
        (&[0.5, 0.2, -0.8], 90),
        (&[1.0, 0.0, 0.02], 90),
        (&[0.5, -0.5, 0.1, 0.7], 32),
    ];
    for (direction, cells) in directions {
        let direction = unit(direction);
        let samples = dense(&direction, cells);
        let law = Projection::new(&direction);
        // A cell's projection is as long as this, and so is the error of where its mass is.
        let blur = 2.0 * law.half_width() / cells as f64;
        for bins in [1, 2, 7, 50] {
            let mut means = vec![0.0; bins];
            law.bins(&mut means);
            for (i, mean) in means.iter().enumerate() {
                let part = &samples[i * samples.len() / bins..(i + 1) * samples.len() / bins];
                let expected = part.iter().sum::<f64>() / part.len() as f64;
                assert_near(*mean, expected, 2.0 * blur, &format!("{direction:?}, bin {i} of {bins}"));
            }
            assert_near(means.iter().sum(), 0.0, 1e-9, "the mean of all");
        }
        for t in [-0.6, -0.3, -0.01, 0.0, 0.2, 0.45] {
            let below = samples.partition_point(|&s| s < t) as f64 / samples.len() as f64;
            let slack = law.density(t).max(law.density(t - blur)).max(law.density(t + blur)) * blur + 1e-3;
            assert_near(law.cdf(t), below, slack, &format!("{direction:?}, mass below {t}"));
            let slope = (law.cdf(t + 1e-6) - law.cdf(t - 1e-6)) / 2e-6;
            if t != 0.0 {
                assert_near(law.density(t), slope, 1e-3, &format!("{direction:?}, density at {t}"));
            }
        }
    }
}

#[test]
fn bins_by_table_are_those_in_closed_form() {
    // A third component far below the others, but not neglected, changes the quantiles by its square at most.
    let flat = unit(&[0.6, 0.8]);
    let thick = unit(&[0.6, 0.8, 1.5e-5]);
    let (mut closed, mut table) = (vec![0.0; 1000], vec![0.0; 1000]);
    Projection::new(&flat).bins(&mut closed);
    Projection::new(&thick).bins(&mut table);
    closed.iter().zip(&table).for_each(|(a, b)| assert_near(*a, *b, 1e-6, "bins"));
}

#[test]
fn bin_means_are_in_their_bins() {
    let directions: [&[f64]; 5] = [
        &[0.3, 0.1, -0.5],
        &[1.0, 0.01, 0.02, 0.03],
        &[1.0, 0.05, -0.04, 0.03, 0.1],
        &[0.2, -0.3, 0.4, 0.1, 0.9, 0.5],
        &[0.5, 0.1, -0.3, 0.7, 0.2, 0.2, 0.02, 0.4],
    ];
    for direction in directions.map(unit) {
        let law = Projection::new(&direction);
        let mut means = vec![0.0; 3001];
        law.bins(&mut means);
        for (i, mean) in means.iter().enumerate() {
            let place = law.cdf(*mean) * 3001.0 - i as f64;
            assert!(place > 0.05 && place < 0.95, "{direction:?}: the mean of bin {i} is at {place} of it");
        }
    }
}

#[test]
fn slices_are_those_of_dense_transport() {
    for (dims, cells, tolerance) in [(1, 40_000, 1e-6), (2, 800, 5e-4), (3, 80, 2e-3)] {
        let points = random(16, dims, 7);
        let centred: Vec<f64> = points.coordinates().iter().map(|&x| f64::from(x) - 0.5).collect();
        let direction = unit(&[0.7, -0.5, 0.3][..dims]);
        let samples = dense(&direction, cells);
        let mut projected: Vec<f64> =
            centred.chunks(dims).map(|p| p.iter().zip(&direction).map(|(x, a)| x * a).sum()).collect();
        projected.sort_by(f64::total_cmp);
        let cost = |(i, s): (usize, &f64)| (s - projected[i * 16 / samples.len()]).powi(2);
        let expected = samples.iter().enumerate().map(cost).sum::<f64>() / samples.len() as f64;
        let (distance, bound) = slice_distance(&centred, &direction);
        assert_near(distance, expected, tolerance * expected, &format!("{dims} dimensions"));
        let spread = |bin: &[f64]| {
            let mean = bin.iter().sum::<f64>() / bin.len() as f64;
            bin.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>()
        };
        let within = samples.chunks(samples.len() / 16).map(spread).sum::<f64>() / samples.len() as f64;
        assert_near(bound, within, tolerance * distance, &format!("{dims} dimensions, the bound"));
    }
}

#[test]
fn known_distances() {
    // One point in the centre: the projected cube's variance, 1/12, along every direction.
    for dims in [1, 2, 3, 8] {
        let centre = transport(&Points::new(dims, vec![0.5; dims]));
        assert_near(centre.sliced_w2, (1.0_f64 / 12.0).sqrt(), 1e-9, "centre");
        assert_near(centre.lower_bound, centre.sliced_w2, 1e-9, "centre");
    }
    // The midpoints of n equal intervals are optimal: each interval's own spread is left.
    let midpoints = transport(&Points::new(1, (0..64).map(|i| (i as f32 + 0.5) / 64.0).collect()));
    assert_near(midpoints.sliced_w2, 1.0 / 64.0 / 12.0_f64.sqrt(), 1e-9, "midpoints");
    assert_near(midpoints.lower_bound, midpoints.sliced_w2, 1e-9, "midpoints");
    for dims in 1..=8 {
        let t = transport(&random(100, dims, 2));
        assert!(t.lower_bound < t.sliced_w2 && t.sliced_w2 < 0.2 && t.shifted < 0.2, "{dims} dimensions: {t:?}");
        let equal = transport(&Points::new(dims, vec![0.0; 50 * dims]));
        assert!(equal.sliced_w2.is_finite() && equal.sliced_w2 > 0.28, "equal points in a corner: {equal:?}");
    }
}
