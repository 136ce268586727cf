//! Fits of a polynomial to samples and the estimators made of one fit (sections 4.2.2, 4.2.6, 4.3.6).

use super::linear::{Matrix, least_squares};
use crate::legendre;

/// The design matrix of n samples without its constant column, and how strongly each column is penalised.
#[derive(Clone, Debug)]
pub struct Design {
    /// phi_j(u_i) for every term j of degree 1..=order (eq. 4.22); each integrates to zero.
    pub rows: Matrix,
    /// 4^(degree - 1) times the number of terms of that degree.
    pub weights: Vec<f64>,
}

impl Design {
    /// Legendre terms of total degree at most `order` at each of the points `u`, `dims` coordinates each.
    pub fn legendre(u: &[f64], dims: usize, order: usize) -> Self {
        let terms = legendre::terms(dims, order);
        let rows = u.chunks(dims).map(|u| legendre::row(&terms, u)[1..].to_vec()).collect();
        let alike = |term: &Vec<usize>| terms.iter().filter(|t| legendre::degree(t) == legendre::degree(term)).count();
        let weight = |term: &Vec<usize>| 4.0_f64.powi(legendre::degree(term) as i32 - 1) * alike(term) as f64;
        Self { rows, weights: terms[1..].iter().map(weight).collect() }
    }

    /// The samples `keep` alone.
    pub fn select(&self, keep: &[usize]) -> Self {
        Self { rows: keep.iter().map(|&i| self.rows[i].clone()).collect(), weights: self.weights.clone() }
    }

    /// The mean of every column.
    pub fn means(&self) -> Vec<f64> {
        let n = self.rows.len() as f64;
        (0..self.weights.len()).map(|j| self.rows.iter().map(|row| row[j]).sum::<f64>() / n).collect()
    }
}

/// A fitted model g(u) = intercept + slopes . phi(u); its integral is the intercept (eq. 4.23).
#[derive(Clone, Debug)]
pub struct Regression {
    /// The constant term, never penalised.
    pub intercept: f64,
    /// One coefficient per column of the design.
    pub slopes: Vec<f64>,
}

/// What the model says when sample i had no part in it, for each i.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// r_i = f_i - g_{-i}(u_i).
    pub residuals: Vec<f64>,
    /// y_i = f_i - slopes_{-i} . phi(u_i): an unbiased estimate of the integral (eq. 4.9).
    pub estimates: Vec<f64>,
    /// n times the weight of sample i in the constant of the fit to all.
    pub weights: Vec<f64>,
}

impl LeftOut {
    /// The sum of squared residuals (Allen 1974).
    pub fn press(&self) -> f64 {
        self.residuals.iter().map(|r| r * r).sum()
    }

    /// The variance of the fit's constant whatever the noise depends on (MacKinnon and White 1985, HC3; the factor
    /// makes it exact for a plain mean), for d degrees of freedom that the ridge leaves.
    pub fn variance(&self, freedom: f64) -> f64 {
        let n = self.residuals.len() as f64;
        let left = (n - 1.0 - freedom).max(0.5);
        let sum: f64 = self.residuals.iter().zip(&self.weights).map(|(r, w)| (r * w).powi(2)).sum();
        sum * (n - 1.0) / n.powi(3) * (1.0 + 2.0 / left) / (1.0 + 2.0 / (n - 1.0))
    }

    /// The estimate of the integral: the mean of the y_i.
    pub fn mean(&self) -> f64 {
        self.estimates.iter().sum::<f64>() / self.estimates.len() as f64
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Regression {
    /// Least squares with the penalty `ridge * weights_j * slope_j^2`, as extra rows of the system (eq. 4.24 - 4.28
    /// without forming the normal equations). Ridge 0 with too few samples gives the minimum-norm solution.
    pub fn fit(design: &Design, f: &[f64], ridge: f64) -> Self {
        let columns = design.weights.len();
        let mut a: Matrix = design.rows.iter().map(|row| [&[1.0], row.as_slice()].concat()).collect();
        let mut b = f.to_vec();
        if ridge > 0.0 {
            for (j, weight) in design.weights.iter().enumerate() {
                let mut row = vec![0.0; columns + 1];
                row[j + 1] = (ridge * weight).sqrt();
                a.push(row);
                b.push(0.0);
            }
        }
        let x = least_squares(&a, &b);
        Self { intercept: x[0], slopes: x[1..].to_vec() }
    }

    /// The model without its constant, at one row of a design.
    pub fn control(&self, row: &[f64]) -> f64 {
        dot(&self.slopes, row)
    }

    /// The control variate estimate on the samples given: mean(f - g) + G (eq. 4.8, 4.9; Algorithms 1 and 2, last
    /// line).
    pub fn estimate(&self, design: &Design, f: &[f64]) -> f64 {
        design.rows.iter().zip(f).map(|(row, f)| f - self.control(row)).sum::<f64>() / f.len() as f64
    }

    /// Leave-one-out by refitting n times: the definition.
    pub fn leave_one_out_by_refitting(design: &Design, f: &[f64], ridge: f64) -> LeftOut {
        let n = f.len();
        let mut left_out = LeftOut { residuals: vec![], estimates: vec![], weights: vec![] };
        for i in 0..n {
            let keep: Vec<usize> = (0..n).filter(|&j| j != i).collect();
            let others: Vec<f64> = keep.iter().map(|&j| f[j]).collect();
            let fit = Self::fit(&design.select(&keep), &others, ridge);
            left_out.estimates.push(f[i] - fit.control(&design.rows[i]));
            left_out.residuals.push(f[i] - fit.control(&design.rows[i]) - fit.intercept);
            // The constant is linear in the values.
            let unit: Vec<f64> = (0..n).map(|j| f64::from(u8::from(j == i))).collect();
            left_out.weights.push(n as f64 * Self::fit(design, &unit, ridge).intercept);
        }
        left_out
    }

    /// Leave-one-out in closed form. With the centred rows c_i = phi_i - mean phi and A = C'C + ridge diag(weights):
    /// e_i = f_i - mean f - b . c_i, h_i = 1/n + c_i' A^-1 c_i, r_i = e_i / (1 - h_i),
    /// y_i = f_i - b . phi_i + (phi_i' A^-1 c_i) r_i.
    pub fn leave_one_out(design: &Design, f: &[f64], ridge: f64) -> LeftOut {
        let n = f.len() as f64;
        let means = design.means();
        let fit = Self::fit(design, f, ridge);
        let mut left_out = LeftOut { residuals: vec![], estimates: vec![], weights: vec![] };
        for (i, row) in design.rows.iter().enumerate() {
            let centred: Vec<f64> = row.iter().zip(&means).map(|(p, m)| p - m).collect();
            let solved = solve_centred(design, &means, &centred, ridge);
            let residual = f[i] - fit.intercept - fit.control(row);
            let left = residual / (1.0 - 1.0 / n - dot(&centred, &solved));
            left_out.residuals.push(left);
            left_out.estimates.push(f[i] - fit.control(row) + dot(row, &solved) * left);
            left_out.weights.push(1.0 - n * dot(&means, &solved));
        }
        left_out
    }

    /// How far the samples' centre is from the domain's, where every term has mean zero:
    /// F = q (n - 1 - d) / d, Hotelling's but for its n - d, with a_i = c_i' A^-1 m for the column means m,
    /// q = n sum a_i^2 (the variance of the fit's constant is (1 + q) / n times the residual's) and
    /// d = sum c_i' A^-1 c_i, at most n - 1.5, the degrees of freedom the ridge leaves. About 1 for well spread
    /// samples. Needs ridge > 0. Returns F and d.
    pub fn offset(design: &Design, ridge: f64) -> (f64, f64) {
        let n = design.rows.len() as f64;
        let means = design.means();
        let (mut q, mut freedom) = (0.0, 0.0);
        for row in &design.rows {
            let centred: Vec<f64> = row.iter().zip(&means).map(|(p, m)| p - m).collect();
            let solved = solve_centred(design, &means, &centred, ridge);
            q += n * dot(&means, &solved).powi(2);
            freedom += dot(&centred, &solved);
        }
        let freedom = freedom.min(n - 1.5);
        (if freedom > 0.0 { q * (n - 1.0 - freedom) / freedom } else { 0.0 }, freedom)
    }
}

/// A^-1 v for A = C'C + ridge diag(weights), as the least-squares problem with right-hand side W^-1/2 v on the
/// penalty's rows: its normal equations are A x = v. Needs ridge > 0.
fn solve_centred(design: &Design, means: &[f64], v: &[f64], ridge: f64) -> Vec<f64> {
    assert!(ridge > 0.0);
    let columns = means.len();
    let mut a: Matrix = design.rows.iter().map(|row| row.iter().zip(means).map(|(p, m)| p - m).collect()).collect();
    let mut b = vec![0.0; a.len()];
    for j in 0..columns {
        let root = (ridge * design.weights[j]).sqrt();
        let mut row = vec![0.0; columns];
        row[j] = root;
        a.push(row);
        b.push(v[j] / root);
    }
    least_squares(&a, &b)
}

/// Algorithm 2 with full-batch steps: `iterations` times slopes += `step` of the slope's number and its negative
/// gradient of eq. 4.12 / 2 (eq. 4.29), the constant being fitted exactly (its columns are centred). From `start`.
pub fn gradient_descent(
    design: &Design,
    f: &[f64],
    start: &[f64],
    iterations: usize,
    mut step: impl FnMut(usize, f64) -> f64,
) -> Regression {
    let n = f.len() as f64;
    let means = design.means();
    let mean_f = f.iter().sum::<f64>() / n;
    let mut slopes = start.to_vec();
    for _ in 0..iterations {
        let mut gradient = vec![0.0; slopes.len()];
        for (row, f) in design.rows.iter().zip(f) {
            let centred: Vec<f64> = row.iter().zip(&means).map(|(p, m)| p - m).collect();
            let error = dot(&slopes, &centred) - (f - mean_f);
            gradient.iter_mut().zip(&centred).for_each(|(g, c)| *g += error * c / n);
        }
        slopes.iter_mut().zip(&gradient).enumerate().for_each(|(j, (s, g))| *s += step(j, -g));
    }
    Regression { intercept: mean_f - dot(&slopes, &means), slopes }
}

/// Equation 4.30: the running mean of f(u_N+1) - g_N(u_N+1) + G_N, each g_N fitted to the preceding samples alone with
/// penalty `ridge * N`; no fit yet for the first two samples.
pub fn incremental(design: &Design, f: &[f64], ridge: f64) -> f64 {
    let mut estimate = 0.0;
    for (i, row) in design.rows.iter().enumerate() {
        let control = if i < 2 {
            0.0
        } else {
            let before: Vec<usize> = (0..i).collect();
            Regression::fit(&design.select(&before), &f[..i], ridge * i as f64).control(row)
        };
        estimate += (f[i] - control - estimate) / (i + 1) as f64;
    }
    estimate
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn samples(n: usize, dims: usize, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let mut rng = SplitMix64::new(seed);
        let u: Vec<f64> = (0..n * dims).map(|_| rng.uniform()).collect();
        let f = u.chunks(dims).map(|u| (u.iter().sum::<f64>() * 2.0).sin() + 0.1 * rng.normal()).collect();
        (u, f)
    }

    #[test]
    fn closed_form_equals_refitting() {
        for (n, dims, order, ridge) in [(20, 2, 3, 1e-3), (6, 2, 3, 0.05), (30, 3, 2, 1.0), (5, 1, 2, 1e-4)] {
            let (u, f) = samples(n, dims, 5);
            let design = Design::legendre(&u, dims, order);
            let fast = Regression::leave_one_out(&design, &f, ridge);
            let slow = Regression::leave_one_out_by_refitting(&design, &f, ridge);
            for i in 0..n {
                assert!((fast.residuals[i] - slow.residuals[i]).abs() < 1e-9 * (1.0 + slow.residuals[i].abs()));
                assert!((fast.estimates[i] - slow.estimates[i]).abs() < 1e-9 * (1.0 + slow.estimates[i].abs()));
                assert!((fast.weights[i] - slow.weights[i]).abs() < 1e-9 * (1.0 + slow.weights[i].abs()));
            }
        }
    }

    /// A polynomial within the basis is integrated exactly by least squares: its constant coefficient.
    #[test]
    fn polynomials_are_exact() {
        let (u, _) = samples(30, 2, 6);
        let design = Design::legendre(&u, 2, 3);
        let f: Vec<f64> = design.rows.iter().map(|row| 2.5 + row[0] - 3.0 * row[4] + 0.5 * row[8]).collect();
        let fit = Regression::fit(&design, &f, 0.0);
        assert!((fit.intercept - 2.5).abs() < 1e-12 && (fit.estimate(&design, &f) - 2.5).abs() < 1e-12);
    }

    #[test]
    fn gradient_descent_converges_to_least_squares() {
        let (u, f) = samples(64, 2, 8);
        let design = Design::legendre(&u, 2, 2);
        let exact = Regression::fit(&design, &f, 0.0);
        let descent = gradient_descent(&design, &f, &[0.0; 5], 400, |_, g| 0.4 * g);
        assert!((exact.intercept - descent.intercept).abs() < 1e-9);
    }
}
