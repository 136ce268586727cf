//! The uniform distribution on the unit cube, projected on a direction through the cube's centre.

/// Below this share of the largest component, a direction's component is left out: it would move no quantile by 1e-8,
/// and the inclusion-exclusion sums divide by it.
const NEGLIGIBLE: f64 = 1e-5;
/// Cells of the table of the cumulative distribution, over its lower half, in up to 4 dimensions; in more the law is
/// smoother, and has more corners to sum.
const CELLS: usize = 512;
const FEWER_CELLS: usize = 160;

/// The law of `sum a_i (U_i - 1/2)` for U uniform on the unit cube: symmetric about 0.
///
/// It depends on the absolute values of the components only. In two dimensions its density is a trapezoid; in general a
/// spline of degree d - 1, here by inclusion and exclusion over the cube's corners (P. Hall 1927; Barrow and Smith
/// 1979).
#[derive(Clone, Debug)]
pub struct Projection {
    /// The components that count, absolute.
    components: Vec<f64>,
    /// Distance from 0 to the end of the support.
    half: f64,
    /// Corner sums and their signs, ascending.
    corners: Vec<(f64, f64)>,
}

impl Projection {
    /// The law for a direction of 1 to 8 components, not all 0 and not necessarily of length 1.
    pub fn new(direction: &[f64]) -> Projection {
        let largest = direction.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let components: Vec<f64> = direction.iter().map(|a| a.abs()).filter(|&a| a > NEGLIGIBLE * largest).collect();
        let mut corners = vec![(0.0, 1.0)];
        for &a in &components {
            let with: Vec<_> = corners.iter().map(|&(sum, sign)| (sum + a, -sign)).collect();
            corners.extend(with);
        }
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        Projection { half: components.iter().sum::<f64>() / 2.0, components, corners }
    }

    /// Distance from 0 to the end of the support.
    pub fn half_width(&self) -> f64 {
        self.half
    }

    /// P(projection < t).
    pub fn cdf(&self, t: f64) -> f64 {
        if t <= 0.0 { self.antiderivative(t, 0) } else { 1.0 - self.antiderivative(-t, 0) }
    }

    /// The density at t.
    pub fn density(&self, t: f64) -> f64 {
        let u = self.half - t.abs();
        let d = self.components.len();
        if u < 0.0 {
            return 0.0;
        }
        let scale = (1..d).map(|i| i as f64).product::<f64>() * self.components.iter().product::<f64>();
        self.sum(u, d as i32 - 1) / scale
    }

    /// For t <= 0: the cumulative distribution (order 0) or its antiderivative from minus infinity (order 1).
    fn antiderivative(&self, t: f64, order: usize) -> f64 {
        let degree = self.components.len() + order;
        let u = t + self.half;
        if u <= 0.0 {
            return 0.0;
        }
        let scale = (1..=degree).map(|i| i as f64).product::<f64>() * self.components.iter().product::<f64>();
        self.sum(u, degree as i32) / scale
    }

    fn sum(&self, u: f64, degree: i32) -> f64 {
        let power = |x: f64| (0..degree).fold(1.0, |p, _| p * x);
        self.corners.iter().take_while(|c| c.0 <= u).map(|&(s, sign)| sign * power(u - s)).sum()
    }

    /// Cuts the law into `means.len()` parts of equal mass, ascending: the mean of each.
    pub fn bins(&self, means: &mut [f64]) {
        match self.components[..] {
            [a] => {
                let n = means.len() as f64;
                means.iter_mut().enumerate().for_each(|(i, m)| *m = a * ((i as f64 + 0.5) / n - 0.5));
            }
            [a, b] => trapezoid_bins(a.max(b), a.min(b), means),
            _ => self.spline_bins(means),
        }
    }

    /// Bins for three dimensions and more: quantiles from a table with cubic Hermite interpolation of the cumulative
    /// distribution, whose error is below 1e-8.
    fn spline_bins(&self, means: &mut [f64]) {
        let cells = if self.components.len() > 4 { FEWER_CELLS } else { CELLS };
        let step = self.half / cells as f64;
        let node = |j: usize| j as f64 * step - self.half;
        let table: Vec<[f64; 3]> = (0..=cells)
            .map(|j| [self.antiderivative(node(j), 0), self.density(node(j)), self.antiderivative(node(j), 1)])
            .collect();
        let n = means.len();
        // The first moment below the quantile of mass u: u q(u) minus the integral of the cumulative distribution.
        let mut moments = vec![0.0; n / 2 + 2];
        let mut cell = 0;
        for (i, moment) in moments.iter_mut().enumerate().skip(1) {
            let mass = (i as f64 / n as f64).min(0.5);
            while cell + 1 < cells && table[cell + 1][0] < mass {
                cell += 1;
            }
            let (x, integral) = solve(table[cell], table[cell + 1], step, mass);
            *moment = mass * (node(cell) + x * step) - (table[cell][2] + integral);
        }
        // The moment is an even function of u - 1/2.
        let moment = |i: usize| moments[i.min(n - i)];
        means.iter_mut().enumerate().for_each(|(i, m)| *m = n as f64 * (moment(i + 1) - moment(i)));
    }
}

/// Where in a cell, 0 to 1, the cubic that has the values and slopes of its ends reaches `value`, and its integral up
/// to there.
fn solve(left: [f64; 3], right: [f64; 3], step: f64, value: f64) -> (f64, f64) {
    let (f0, s0, s1) = (left[0], left[1] * step, right[1] * step);
    let rise = right[0] - f0;
    let (c2, c3) = (3.0 * rise - 2.0 * s0 - s1, s0 + s1 - 2.0 * rise);
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    let mut x = if rise > 0.0 { ((value - f0) / rise).clamp(0.0, 1.0) } else { 0.5 };
    for _ in 0..60 {
        let error = f0 + x * (s0 + x * (c2 + x * c3)) - value;
        if error > 0.0 {
            high = x
        } else {
            low = x
        }
        let next = x - error / (s0 + x * (2.0 * c2 + x * 3.0 * c3));
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - x).abs() < 1e-15 {
            break;
        }
        x = next;
    }
    (x, step * x * (f0 + x * (s0 / 2.0 + x * (c2 / 3.0 + x * c3 / 4.0))))
}

/// Bins of the trapezoid with components `c >= s`, in closed form.
fn trapezoid_bins(c: f64, s: f64, means: &mut [f64]) {
    let (flat, half, area) = ((c - s) / 2.0, (c + s) / 2.0, c * s);
    let n = means.len();
    let quantile = |u: f64| {
        let v = (u - 0.5).abs();
        let t = if v * c <= flat { v * c } else { half - (2.0 * area * (0.5 - v)).max(0.0).sqrt() };
        t.copysign(u - 0.5)
    };
    // The first moment beyond x, where the density falls linearly to its end.
    let tail = |x: f64| {
        let h = half - x;
        h * h * (half / 2.0 - h / 3.0) / area
    };
    let moment = |t: f64| {
        let t = t.abs().min(half);
        if t >= flat { -tail(t) } else { -(tail(flat) + (flat - t) * (flat + t) / (2.0 * c)) }
    };
    let mut before = 0.0;
    for (i, mean) in means.iter_mut().enumerate() {
        let after = if i + 1 == n { 0.0 } else { moment(quantile((i + 1) as f64 / n as f64)) };
        *mean = n as f64 * (after - before);
        before = after;
    }
}
