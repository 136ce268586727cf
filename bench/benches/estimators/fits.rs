//! The fits of figure 4.3, point by point, so that they can be drawn beside their functions.

use crate::functions::of_one_dimension;
use noisefloor::control_variate::{self as cv, Config, Estimator, Samples};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::{integrands, legendre};

/// As many samples are fitted.
pub(crate) const SAMPLES: usize = 64;
pub(crate) const ORDERS: [usize; 3] = [1, 3, 5];
const POINTS: usize = 61;

/// A point of a function: its value and the fits'.
pub(crate) struct Row {
    pub(crate) function: String,
    pub(crate) x: f64,
    pub(crate) value: f64,
    pub(crate) fits: [f64; ORDERS.len()],
    /// The plain mean, a fit of order 0.
    pub(crate) mean: f64,
}

pub(crate) fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for function in of_one_dimension(integrands::nine()[0]) {
        let mut rng = SplitMix64::new(43);
        let u: Vec<f32> = (0..SAMPLES).map(|_| rng.uniform_f32()).collect();
        let mut f = vec![0.0; SAMPLES];
        function.values(&u, &mut f);
        let mean = f.iter().map(|&f| f64::from(f)).sum::<f64>() / SAMPLES as f64;
        let fits = ORDERS.map(|order| coefficients(order, &u, &f));
        for i in 0..POINTS {
            let x = i as f64 / (POINTS - 1) as f64;
            let fit = |fit: &Vec<f64>| fit.iter().enumerate().map(|(k, c)| c * legendre::legendre(k, x)).sum();
            let (value, fits) = (function.at(&[x]), fits.each_ref().map(fit));
            rows.push(Row { function: function.name.clone(), x, value, fits, mean });
        }
    }
    rows
}

/// Legendre coefficients of the fit: the library's gradient descent, which hands them out, taken to its end. The
/// constant makes the residuals' mean zero, as least squares does.
fn coefficients(order: usize, u: &[f32], f: &[f32]) -> Vec<f64> {
    let config = Config { estimator: Estimator::GradientDescent, iterations: 4000, ..Config::new(1, order, 1) };
    let mut slopes = vec![0.0; order];
    let mut workspace = vec![0.0_f64; cv::workspace_len::<f64>(&config, f.len()).expect("a valid configuration")];
    cv::gradient_descent(&config, Samples::new(u, f), &mut slopes, &mut workspace).expect("valid samples");
    let slopes: Vec<f64> = slopes.into_iter().map(f64::from).collect();
    let rest = u.iter().zip(f).map(|(&u, &f)| {
        let fit = slopes.iter().enumerate().map(|(k, c)| c * legendre::legendre(k + 1, u.into())).sum::<f64>();
        f64::from(f) - fit
    });
    let constant = rest.sum::<f64>() / f.len() as f64;
    [&[constant], &slopes[..]].concat()
}
