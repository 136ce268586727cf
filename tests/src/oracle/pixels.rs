//! A fit to several pixels of several samples each, whose integrals are random about a linear trend (section 4.3.6).

use super::linear::{Matrix, least_squares};
use super::regression::{Design, Regression};

/// What a pixel's mean says of what as many samples about it would: s / (s + n t), with s the variance within pixels of
/// `n` values and t that of the pixels' integrals about the trend along `places`, a row for each pixel. 1 where there
/// are too few pixels to tell, or nothing varies.
pub fn noise_share(places: &Matrix, values: &[f64], n: usize) -> f64 {
    let means: Vec<f64> = values.chunks(n).map(|own| own.iter().sum::<f64>() / n as f64).collect();
    let squares: f64 = values.iter().enumerate().map(|(i, value)| (value - means[i / n]).powi(2)).sum();
    let inside = squares / (means.len() * (n - 1)) as f64;
    let rows: Matrix = places.iter().map(|place| [&[1.0], place.as_slice()].concat()).collect();
    let columns = rows.first().map_or(1, Vec::len);
    if means.len() <= columns {
        return 1.0;
    }
    let trend = least_squares(&rows, &means);
    let rest = |(row, mean): (&Vec<f64>, &f64)| mean - row.iter().zip(&trend).map(|(a, b)| a * b).sum::<f64>();
    let apart: f64 = rows.iter().zip(&means).map(|pair| rest(pair).powi(2)).sum();
    let apart = n as f64 * apart / (means.len() - columns) as f64;
    if apart > inside { inside / apart } else { 1.0 }
}

/// Least squares where a pixel's mean counts `share` of what its samples would: by rows and values less as much of the
/// pixel's mean as leaves the root of that.
pub fn fit(design: &Design, f: &[f64], n: usize, share: f64, ridge: f64) -> Regression {
    let columns = design.weights.len();
    let part = 1.0 - share.sqrt();
    let (mut a, mut b) = (vec![], vec![]);
    for (rows, values) in design.rows.chunks(n).zip(f.chunks(n)) {
        let mean = |j: usize| rows.iter().map(|row| row[j]).sum::<f64>() / n as f64;
        let means: Vec<f64> = (0..columns).map(mean).collect();
        let level = values.iter().sum::<f64>() / n as f64;
        for (row, value) in rows.iter().zip(values) {
            let moved = row.iter().zip(&means).map(|(x, mean)| x - part * mean);
            a.push([1.0 - part].into_iter().chain(moved).collect::<Vec<f64>>());
            b.push(value - part * level);
        }
    }
    for (j, weight) in design.weights.iter().enumerate() {
        let mut row = vec![0.0; columns + 1];
        row[j + 1] = (ridge * weight).sqrt();
        a.push(row);
        b.push(0.0);
    }
    let x = least_squares(&a, &b);
    Regression { intercept: x[0], slopes: x[1..].to_vec() }
}
