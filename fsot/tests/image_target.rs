//! Densities from pictures: projections against an oracle, resolution, mixtures, samples, bad input.

use fsot::Error;
use fsot::random::stream;
use fsot::target::Target;
use fsot::target::image::{ImageTarget, spread};

/// Cells cut into points, projected, sorted and cut one after the other: (5.23) and (5.24) by definition.
fn oracle(width: usize, height: usize, weights: &[f32], direction: [f64; 2], count: usize) -> (Vec<f64>, Vec<f64>) {
    // The more cells, the smaller the part of one: about half a million points, but at least 6 * 6 in a cell.
    let fine = ((5e5 / (width * height) as f64).sqrt() as usize).clamp(6, 64);
    let longer = width.max(height) as f64;
    let mut atoms = Vec::new();
    for (cell, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
        for part in 0..fine * fine {
            let x = ((cell % width) as f64 + ((part % fine) as f64 + 0.5) / fine as f64) / longer;
            let y = ((cell / width) as f64 + ((part / fine) as f64 + 0.5) / fine as f64) / longer;
            atoms.push((x * direction[0] + y * direction[1], f64::from(*weight)));
        }
    }
    atoms.sort_by(|a, b| a.0.total_cmp(&b.0));
    let unit = atoms.iter().map(|atom| atom.1).sum::<f64>() / count as f64;
    let mut means = Vec::new();
    let mut edges = vec![atoms[0].0];
    let (mut mass, mut moment) = (0.0, 0.0);
    for (at, mut weight) in atoms {
        while mass + weight >= unit * (1.0 - 1e-9) && means.len() < count {
            let part = unit - mass;
            means.push((moment + part * at) / unit);
            edges.push(at);
            weight -= part;
            (mass, moment) = (0.0, 0.0);
        }
        mass += weight.max(0.0);
        moment += weight.max(0.0) * at;
    }
    // The mean projected length of the rectangle.
    let average = 2.0 / std::f64::consts::PI * (width + height) as f64 / longer / count as f64;
    let density = edges.windows(2).map(|edge| average / (edge[1] - edge[0]).max(1e-9)).collect();
    (means, density)
}

fn directions() -> Vec<[f64; 2]> {
    let mut all: Vec<[f64; 2]> = (0..8)
        .map(|k| {
            let angle = (f64::from(k) + 0.3) * std::f64::consts::TAU / 8.0;
            [angle.cos(), angle.sin()]
        })
        .collect();
    let half = 0.5_f64.sqrt();
    all.extend([[1.0, 0.0], [0.0, -1.0], [half, half], [-half, half]]);
    all
}

/// The largest distance between the means of the target's bins and the oracle's, over the cell's length.
fn worst_mean(width: usize, height: usize, weights: &[f32], count: usize) -> f64 {
    let target = ImageTarget::new(width, height, weights, count).unwrap();
    let mut worst: f64 = 0.0;
    for direction in directions() {
        let (expected, _) = oracle(width, height, weights, direction, count);
        let (mut means, mut density) = (vec![0.0; count], vec![0.0; count]);
        let direction = direction.map(|d| d as f32);
        target.bins(&direction, &mut means, &mut density, &mut Vec::new());
        assert!(means.windows(2).all(|pair| pair[0] <= pair[1]), "{direction:?}: means do not ascend");
        assert!(density.iter().all(|d| d.is_finite() && *d > 0.0));
        for (mean, expected) in means.iter().zip(&expected) {
            worst = worst.max((f64::from(*mean) - expected).abs());
        }
    }
    worst * width.max(height) as f64
}

fn picture(width: usize, height: usize) -> Vec<f32> {
    let mut rng = stream(1, 2, 3);
    (0..width * height)
        .map(|i| {
            let (x, y) = ((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
            let disc = (x - 0.4).powi(2) + (y - 0.6).powi(2) < 0.07;
            if disc { 1.0 } else { 0.2 * x * y + 0.1 * rng.uniform_f32() }
        })
        .collect()
}

#[test]
fn projections_are_those_of_the_oracle() {
    // Pictures of at least 128 * 128 pixels stay as they are, or their cells would not be the oracle's.
    let worst = worst_mean(160, 112, &picture(160, 112), 2300);
    assert!(worst < 0.1, "{worst} of a cell");
    let worst = worst_mean(100, 170, &picture(100, 170), 2331);
    assert!(worst < 0.1, "{worst} of a cell");
}

#[test]
fn magnified_grids_are_the_same_density() {
    // The oracle's own grain is 1/64 of a cell.
    let weights = [0.0, 1.0, 3.0, 0.0, 0.5, 0.0, 2.0, 1.0, 0.0, 0.0, 4.0, 1.0];
    for count in [1, 2, 7, 1000] {
        let worst = worst_mean(4, 3, &weights, count);
        assert!(worst < 0.06, "{worst} of a cell at {count} bins");
    }
    let worst = worst_mean(1, 1, &[7.0], 64);
    assert!(worst < 0.06, "{worst}");
}

#[test]
fn densities_are_those_of_the_oracle() {
    let (width, height, count) = (160, 112, 200);
    let weights: Vec<f32> = (0..width * height).map(|i| 1.0 + (i % width) as f32 / 40.0).collect();
    let target = ImageTarget::new(width, height, &weights, 2300).unwrap();
    // Along an axis or a diagonal the oracle's points coincide, and give no lengths.
    for direction in directions().into_iter().take(8) {
        let (_, expected) = oracle(width, height, &weights, direction, count);
        let (mut means, mut density) = (vec![0.0; count], vec![0.0; count]);
        target.bins(&direction.map(|d| d as f32), &mut means, &mut density, &mut Vec::new());
        // The oracle's atoms quantise the lengths of its bins; the outermost ones are mostly empty corners.
        for (bin, (density, expected)) in density.iter().zip(&expected).enumerate().skip(1).take(count - 2) {
            assert!(
                (f64::from(*density) / expected - 1.0).abs() < 0.08,
                "bin {bin} of {direction:?}: {density} {expected}"
            );
        }
    }
}

#[test]
fn gaps_hold_no_means() {
    let mut weights = vec![0.0; 128 * 128];
    for row in weights.chunks_exact_mut(128) {
        row[..16].fill(1.0);
        row[112..].fill(1.0);
    }
    let target = ImageTarget::new(128, 128, &weights, 10).unwrap();
    let (mut means, mut density) = ([0.0; 10], [0.0; 10]);
    target.bins(&[1.0, 0.0], &mut means, &mut density, &mut Vec::new());
    for (bin, mean) in means.iter().enumerate() {
        let inside = if bin < 5 { *mean < 0.125 } else { *mean > 0.875 };
        assert!(inside, "{means:?}");
    }
    assert!((means[0] - 0.0125).abs() < 1e-4 && (means[9] - 0.9875).abs() < 1e-4, "{means:?}");
}

#[test]
fn weights_of_any_scale() {
    let base: Vec<f32> = picture(130, 130);
    let expected = ImageTarget::new(130, 130, &base, 3000).unwrap();
    for scale in [1e-30, 1e37] {
        let scaled: Vec<f32> = base.iter().map(|w| w * scale).collect();
        let target = ImageTarget::new(130, 130, &scaled, 3000).unwrap();
        assert!((target.cell(50, 70) / expected.cell(50, 70) - 1.0).abs() < 1e-5);
    }
    // A single positive weight, the smallest there is.
    let target = ImageTarget::new(2, 1, &[0.0, f32::from_bits(1)], 5).unwrap();
    assert_eq!(target.extent(), [1.0, 0.5]);
    let mut point = [0.0; 2];
    for k in 0..100 {
        target.sample(&mut stream(5, k, 0), &mut point);
        assert!(point[0] >= 0.5 && point[0] <= 1.0 && point[1] <= 0.5, "{point:?}");
    }
}

#[test]
fn mixtures_weigh_normalised_densities() {
    let left = ImageTarget::new(2, 1, &[100.0, 0.0], 10).unwrap();
    let right = ImageTarget::new(2, 1, &[0.0, 0.01], 10).unwrap();
    let both = ImageTarget::mixture(&[(3.0, &left), (1.0, &right)]).unwrap();
    let [width, height] = both.size();
    assert!((both.cell(0, 0) - 1.5).abs() < 1e-6 && (both.cell(width - 1, height - 1) - 0.5).abs() < 1e-6);
    let other = ImageTarget::new(1, 1, &[1.0], 10).unwrap();
    assert!(matches!(ImageTarget::mixture(&[(1.0, &left), (1.0, &other)]), Err(Error::Input(_))));
    assert!(matches!(ImageTarget::mixture(&[]), Err(Error::Input(_))));
    assert!(matches!(ImageTarget::mixture(&[(f32::NAN, &left)]), Err(Error::Input(_))));
    assert!(matches!(ImageTarget::mixture(&[(0.0, &left)]), Err(Error::Input(_))));
}

#[test]
fn what_is_no_density_is_refused() {
    let refused = |width, height, weights: &[f32]| {
        let error = ImageTarget::new(width, height, weights, 10).unwrap_err();
        assert!(matches!(error, Error::Input(_)));
        error.to_string()
    };
    assert!(refused(2, 2, &[0.0; 4]).contains("0 everywhere"));
    assert!(refused(2, 2, &[0.0, 1.0, f32::NAN, 0.0]).contains("column 0, row 1 is NaN"));
    assert!(refused(2, 2, &[0.0, -1.0, 0.0, 0.0]).contains("column 1, row 0 is -1"));
    assert!(refused(2, 2, &[0.0, f32::INFINITY, 0.0, 0.0]).contains("inf"));
    assert!(refused(2, 3, &[1.0; 4]).contains("2 x 3"));
    assert!(refused(0, 0, &[]).contains("0 x 0"));
    assert!(refused(usize::MAX, 2, &[1.0]).contains("as many weights"));
}

#[test]
fn resolution_follows_the_number_of_points() {
    let weights = vec![1.0; 900 * 600];
    let cells = |points| ImageTarget::new(900, 600, &weights, points).unwrap().size();
    assert_eq!(cells(1_000_000), [900, 600]);
    assert_eq!(cells(10), [157, 105]);
    let [width, height] = cells(20_000);
    assert!((width * height).abs_diff(160_000) < 2000, "{width} x {height}");
    assert_eq!(ImageTarget::new(3, 1, &[1.0; 3], 10).unwrap().size(), [222, 74]);
    let line = ImageTarget::new(100_000, 1, &vec![1.0; 100_000], 10).unwrap();
    assert!(line.size()[0] <= 4096);
}

/// Counts in the four quarters of the picture, against their masses: a chi-squared test at 1e-6 (3 degrees of
/// freedom: 30.7).
#[test]
fn samples_follow_the_density() {
    let target = ImageTarget::new(2, 2, &[1.0, 2.0, 3.0, 10.0], 100).unwrap();
    let mut counts = [0.0_f64; 4];
    let mut rng = stream(11, 0, 0);
    for _ in 0..20_000 {
        let mut point = [0.0; 2];
        target.sample(&mut rng, &mut point);
        counts[usize::from(point[0] >= 0.5) + 2 * usize::from(point[1] >= 0.5)] += 1.0;
    }
    let statistic: f64 = counts
        .iter()
        .zip([1250.0, 2500.0, 3750.0, 12500.0])
        .map(|(n, expected)| (n - expected).powi(2) / expected)
        .sum();
    assert!(statistic < 30.7, "{statistic}");
}

#[test]
fn spread_points_are_stratified_in_every_set_and_in_their_union() {
    let one = ImageTarget::new(2, 1, &[1.0, 3.0], 1000).unwrap();
    let two = ImageTarget::new(2, 1, &[1.0, 0.0], 1000).unwrap();
    let points = spread(&[&one, &two], &[800, 200], &mut stream(3, 0, 0));
    assert_eq!(points.len(), 2000);
    let left = |from: usize, to: usize| points[2 * from..2 * to].chunks_exact(2).filter(|p| p[0] < 0.5).count();
    assert!(left(0, 800).abs_diff(200) <= 3, "{}", left(0, 800));
    assert_eq!(left(800, 1000), 200);
    // Sixteen squares of the left half, 400 points in all of it: 25 +- a few in each, where chance would give a
    // deviation of 4.8.
    for square in 0..16 {
        let (x, y) = ((square % 4) as f32 * 0.125, (square / 4) as f32 * 0.125);
        let inside = points.chunks_exact(2).filter(|p| p[0] >= x && p[0] < x + 0.125 && p[1] >= y && p[1] < y + 0.125);
        assert!(inside.count().abs_diff(25) <= 4);
    }
}
