//! Orthonormal shifted Legendre polynomials in total degree, written for reading.
//!
//! On the unit cube their Gram matrix is the identity and every term but the constant integrates to zero, so the
//! integral of a fit (eq. 4.23) is its first coefficient.

/// The exponents of every term with total degree at most `order`, constant first, then by total degree; within one
/// degree the first dimension's exponent falls: in 2D `00 | 10 01 | 20 11 02 | ...`.
pub fn terms(dims: usize, order: usize) -> Vec<Vec<usize>> {
    let mut all = Vec::new();
    for degree in 0..=order {
        exponents_of(dims, degree, &mut Vec::new(), &mut all);
    }
    all
}

fn exponents_of(dims: usize, degree: usize, prefix: &mut Vec<usize>, all: &mut Vec<Vec<usize>>) {
    if prefix.len() + 1 == dims {
        all.push(prefix.iter().copied().chain([degree]).collect());
        return;
    }
    for first in (0..=degree).rev() {
        prefix.push(first);
        exponents_of(dims, degree - first, prefix, all);
        prefix.pop();
    }
}

/// sqrt(2k + 1) P_k(2x - 1): orthonormal on [0, 1].
pub fn legendre(k: usize, x: f64) -> f64 {
    let t = 2.0 * x - 1.0;
    let (mut previous, mut current) = (1.0, t);
    if k == 0 {
        return 1.0;
    }
    for j in 1..k {
        let next = ((2 * j + 1) as f64 * t * current - j as f64 * previous) / (j + 1) as f64;
        (previous, current) = (current, next);
    }
    (2.0 * k as f64 + 1.0).sqrt() * current
}

/// One row of the design matrix: every term at the point `u`.
pub fn row(terms: &[Vec<usize>], u: &[f64]) -> Vec<f64> {
    let value = |term: &Vec<usize>| term.iter().zip(u).map(|(&k, &x)| legendre(k, x)).product();
    terms.iter().map(value).collect()
}

/// The total degree of a term.
pub fn degree(term: &[usize]) -> usize {
    term.iter().sum()
}

/// Nodes and weights of the 8-point Gauss-Legendre rule on [0, 1]: exact to degree 15.
pub fn gauss_legendre() -> Vec<(f64, f64)> {
    // On [-1, 1], those above 0.
    let half = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
    ];
    half.iter().flat_map(|&(x, weight)| [0.5 - 0.5 * x, 0.5 + 0.5 * x].map(|x| (x, 0.5 * weight))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_binomial() {
        for (dims, order, expected) in [(1, 3, 4), (2, 2, 6), (3, 3, 20), (5, 3, 56), (15, 2, 136), (2, 7, 36)] {
            assert_eq!(terms(dims, order).len(), expected);
        }
        assert_eq!(terms(2, 2), [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]]);
    }

    /// 16 midpoints per subinterval are not exact; 8-point Gauss-Legendre on [0, 1] is, up to degree 15.
    #[test]
    fn orthonormal_under_gauss_legendre() {
        for a in 0..=7 {
            for b in 0..=7 {
                let sum: f64 = gauss_legendre().iter().map(|(x, w)| w * legendre(a, *x) * legendre(b, *x)).sum();
                assert!((sum - f64::from(u8::from(a == b))).abs() < 1e-12, "{a} {b} {sum}");
            }
        }
    }
}
