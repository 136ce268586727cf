//! Least squares by Householder QR with column pivoting; the minimum-norm solution where the rank is short.

/// A dense matrix as a list of rows.
pub type Matrix = Vec<Vec<f64>>;

/// argmin |A x - b|; of all minimisers the one of smallest norm (Golub and Van Loan, 5.5).
///
/// A column counts as dependent when its pivot falls below 1e-12 of the first one.
pub fn least_squares(a: &Matrix, b: &[f64]) -> Vec<f64> {
    let unknowns = a.first().map_or(0, Vec::len);
    let (mut r, mut c) = (a.clone(), b.to_vec());
    let order = triangularise(&mut r, &mut c);
    let steps = unknowns.min(r.len());
    let rank = (0..steps).take_while(|&k| r[k][k].abs() > 1e-12 * r[0][0].abs()).count();
    let mut permuted = vec![0.0; unknowns];
    if rank == unknowns {
        permuted = back_substitute(&r, &c, rank);
    } else if rank > 0 {
        // [R11 R12] x = c has many solutions; with its transpose Q [S; 0], x = Q [S^-T c; 0] is the shortest. It is
        // found as x = M' z, where M = [R11 R12] and M M' z = c is solved through the triangle S: S' S z = c.
        let m: Matrix = r[..rank].to_vec();
        let mut transposed: Matrix = (0..unknowns).map(|j| m.iter().map(|row| row[j]).collect()).collect();
        let pivots = triangularise(&mut transposed, &mut vec![0.0; unknowns]);
        let s = &transposed;
        let mut half = vec![0.0; rank];
        for i in 0..rank {
            let sum: f64 = (0..i).map(|k| s[k][i] * half[k]).sum();
            half[i] = (c[pivots[i]] - sum) / s[i][i];
        }
        let z = back_substitute(s, &half, rank);
        for (j, x) in permuted.iter_mut().enumerate() {
            *x = (0..rank).map(|k| m[pivots[k]][j] * z[k]).sum();
        }
    }
    let mut x = vec![0.0; unknowns];
    order.iter().zip(permuted).for_each(|(&column, value)| x[column] = value);
    x
}

/// Turns A into R and b into Q'b by Householder reflections, largest remaining column first; returns the column order.
fn triangularise(a: &mut Matrix, b: &mut [f64]) -> Vec<usize> {
    let (rows, columns) = (a.len(), a.first().map_or(0, Vec::len));
    let mut order: Vec<usize> = (0..columns).collect();
    for k in 0..columns.min(rows) {
        let norm = |a: &Matrix, j: usize| a[k..].iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt();
        let largest = (k..columns).max_by(|&i, &j| norm(a, i).total_cmp(&norm(a, j))).unwrap_or(k);
        order.swap(k, largest);
        a.iter_mut().for_each(|row| row.swap(k, largest));
        let length = norm(a, k);
        if length == 0.0 {
            break;
        }
        let mut v: Vec<f64> = a[k..].iter().map(|row| row[k]).collect();
        v[0] += if v[0] < 0.0 { -length } else { length };
        let square: f64 = v.iter().map(|x| x * x).sum();
        for j in k..columns {
            let scale = 2.0 * v.iter().zip(&a[k..]).map(|(v, row)| v * row[j]).sum::<f64>() / square;
            a[k..].iter_mut().zip(&v).for_each(|(row, v)| row[j] -= scale * v);
        }
        let scale = 2.0 * v.iter().zip(&b[k..]).map(|(v, b)| v * b).sum::<f64>() / square;
        b[k..].iter_mut().zip(&v).for_each(|(b, v)| *b -= scale * v);
    }
    order
}

fn back_substitute(r: &Matrix, c: &[f64], size: usize) -> Vec<f64> {
    let mut x = vec![0.0; size];
    for i in (0..size).rev() {
        let sum: f64 = (i + 1..size).map(|j| r[i][j] * x[j]).sum();
        x[i] = (c[i] - sum) / r[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn random(rows: usize, columns: usize, rng: &mut SplitMix64) -> Matrix {
        (0..rows).map(|_| (0..columns).map(|_| rng.normal()).collect()).collect()
    }

    fn times(a: &Matrix, x: &[f64]) -> Vec<f64> {
        a.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
    }

    fn transposed(a: &Matrix) -> Matrix {
        (0..a[0].len()).map(|j| a.iter().map(|row| row[j]).collect()).collect()
    }

    #[test]
    fn residual_is_orthogonal_to_the_columns() {
        let mut rng = SplitMix64::new(1);
        let a = random(12, 5, &mut rng);
        let b: Vec<f64> = (0..12).map(|_| rng.normal()).collect();
        let residual: Vec<f64> = times(&a, &least_squares(&a, &b)).iter().zip(&b).map(|(g, b)| b - g).collect();
        assert!(times(&transposed(&a), &residual).iter().all(|x| x.abs() < 1e-12));
    }

    /// A minimum-norm solution lies in the row space: adding any null vector makes it longer.
    #[test]
    fn short_rank_gives_the_shortest_solution() {
        let mut rng = SplitMix64::new(2);
        let mut a = random(4, 7, &mut rng);
        a[3] = a[0].iter().zip(&a[1]).map(|(x, y)| x - 2.0 * y).collect();
        let truth: Vec<f64> = (0..7).map(|_| rng.normal()).collect();
        let b = times(&a, &truth);
        let x = least_squares(&a, &b);
        assert!(times(&a, &x).iter().zip(&b).all(|(g, b)| (g - b).abs() < 1e-11));
        let in_row_space = least_squares(&transposed(&a), &x);
        let projected = times(&transposed(&a), &in_row_space);
        assert!(projected.iter().zip(&x).all(|(p, x)| (p - x).abs() < 1e-10));
    }
}
