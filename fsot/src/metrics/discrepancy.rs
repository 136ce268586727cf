//! The L2 star discrepancy.

use crate::points::Points;
use serde::Serialize;

/// Pairs that are summed one by one rather than divided further.
const FEW: usize = 4096;
/// Above this number of points in more than 3 dimensions the quadratic cost is refused.
const MOST: usize = 1 << 16;

/// The L2 star discrepancy and what random points have.
#[derive(Clone, Debug, Serialize)]
pub struct Discrepancy {
    /// The root of the integral over all t in the unit cube of (share of points in [0, t) - volume of [0, t))^2.
    pub l2_star: f64,
    /// The same, relative to the root mean square of independent uniform points.
    pub relative: f64,
}

/// The L2 star discrepancy by Warnock's formula (1972),
/// `3^-d - 2/n sum_i prod_k (1 - x_ik^2)/2 + 1/n^2 sum_ij prod_k (1 - max(x_ik, x_jk))`; of random points its square is
/// `(2^-d - 3^-d) / n` in the mean.
///
/// The double sum is exact for every number of points, by divide and conquer over the dimensions (Heinrich 1996): about
/// n (log n)^d operations, never more than n^2 d. None above 65,536 points in more than 3 dimensions, or of what
/// [`check`](super::check) refuses.
pub fn discrepancy(points: &Points) -> Option<Discrepancy> {
    let (n, d) = (points.len(), points.dims());
    if super::check(points).is_err() || (d > 3 && n > MOST) {
        return None;
    }
    let x: Vec<f64> = points.coordinates().iter().map(|&x| f64::from(x)).collect();
    let single = x.chunks_exact(d).map(|p| p.iter().map(|x| (1.0 - x * x) / 2.0).product::<f64>()).sum::<f64>();
    let all = (0..n as u32).map(|i| (i, 1.0)).collect();
    let double = Sum { x: &x, dims: d }.with_itself(all, d);
    let count = n as f64;
    let volume = |base: f64| (0..d).fold(1.0, |v, _| v * base);
    let squared = volume(1.0 / 3.0) - 2.0 / count * single + double / count / count;
    let random = (volume(0.5) - volume(1.0 / 3.0)) / count;
    let l2_star = squared.max(0.0).sqrt();
    Some(Discrepancy { l2_star, relative: l2_star / random.sqrt() })
}

/// Points of a part: index and weight.
type Part = Vec<(u32, f64)>;

struct Sum<'a> {
    x: &'a [f64],
    dims: usize,
}

impl Sum<'_> {
    fn coordinate(&self, item: (u32, f64), axis: usize) -> f64 {
        self.x[item.0 as usize * self.dims + axis]
    }

    /// Sum over i, j in `a` of w_i w_j prod over the first `d` axes of (1 - max).
    fn with_itself(&self, a: Part, d: usize) -> f64 {
        if a.len() * a.len() <= FEW {
            return self.one_by_one(&a, &a, d);
        }
        let Some(middle) = self.split(&a, &[], d - 1) else {
            let common = 1.0 - self.coordinate(a[0], d - 1);
            return common * if d == 1 { square_of_weights(&a) } else { self.with_itself(a, d - 1) };
        };
        let large = a.len() > 4096;
        let (low, high) = self.divide(a, d - 1, middle);
        let scaled = self.scale(&high, d - 1);
        let (across, (first, second)) = both(
            large,
            || self.across(low.clone(), scaled, d - 1),
            || both(large, || self.with_itself(low.clone(), d), || self.with_itself(high.clone(), d)),
        );
        first + second + 2.0 * across
    }

    /// Sum over i in `a`, j in `b` of w_i w_j prod over the first `d` axes of (1 - max).
    fn across(&self, a: Part, b: Part, d: usize) -> f64 {
        if a.is_empty() || b.is_empty() {
            return 0.0;
        }
        if d == 0 {
            return weight(&a) * weight(&b);
        }
        if a.len() * b.len() <= FEW {
            return self.one_by_one(&a, &b, d);
        }
        let Some(middle) = self.split(&a, &b, d - 1) else {
            return (1.0 - self.coordinate(a[0], d - 1)) * self.across(a, b, d - 1);
        };
        let large = a.len() + b.len() > 8192;
        let (a_low, a_high) = self.divide(a, d - 1, middle);
        let (b_low, b_high) = self.divide(b, d - 1, middle);
        let (a_scaled, b_scaled) = (self.scale(&a_high, d - 1), self.scale(&b_high, d - 1));
        let (mixed, (low, high)) = both(
            large,
            || self.across(a_low.clone(), b_scaled, d - 1) + self.across(a_scaled, b_low.clone(), d - 1),
            || {
                both(
                    large,
                    || self.across(a_low.clone(), b_low.clone(), d),
                    || self.across(a_high.clone(), b_high.clone(), d),
                )
            },
        );
        low + high + mixed
    }

    fn one_by_one(&self, a: &[(u32, f64)], b: &[(u32, f64)], d: usize) -> f64 {
        let at = |item: &(u32, f64)| &self.x[item.0 as usize * self.dims..][..d];
        let row = |i: &(u32, f64)| {
            let p = at(i);
            let pair =
                |j: &(u32, f64)| p.iter().zip(at(j)).fold(j.1, |w, (&x, &y)| w * (1.0 - if x > y { x } else { y }));
            i.1 * b.iter().map(pair).sum::<f64>()
        };
        a.iter().map(row).sum()
    }

    /// A value that parts the points along an axis (low: at most the value); none if all are equal there.
    fn split(&self, a: &[(u32, f64)], b: &[(u32, f64)], axis: usize) -> Option<f64> {
        let mut values: Vec<f64> = a.iter().chain(b).map(|&i| self.coordinate(i, axis)).collect();
        let half = values.len() / 2;
        let middle = *values.select_nth_unstable_by(half, f64::total_cmp).1;
        let largest = values.iter().fold(middle, |m, &x| m.max(x));
        if middle < largest {
            return Some(middle);
        }
        // More than half of them are the largest.
        values.iter().copied().filter(|&x| x < largest).max_by(f64::total_cmp)
    }

    fn divide(&self, part: Part, axis: usize, middle: f64) -> (Part, Part) {
        part.into_iter().partition(|&i| self.coordinate(i, axis) <= middle)
    }

    fn scale(&self, part: &[(u32, f64)], axis: usize) -> Part {
        part.iter().map(|&i| (i.0, i.1 * (1.0 - self.coordinate(i, axis)))).collect()
    }
}

fn weight(part: &[(u32, f64)]) -> f64 {
    part.iter().map(|i| i.1).sum()
}

fn square_of_weights(part: &[(u32, f64)]) -> f64 {
    weight(part) * weight(part)
}

/// Both results, on two threads if it is worth it: the same bits either way.
fn both<A: Send, B: Send>(large: bool, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    if large { rayon::join(a, b) } else { (a(), b()) }
}
