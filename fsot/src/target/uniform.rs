//! The uniform distribution, whose projections have closed forms or cheap exact tables.

use super::cdf::bins_of_cdf;
use super::distribution::{MAX_DIMS, MEAN_COMPONENT, Target};
use noisefloor::rng::Rng;
use std::sync::LazyLock;

/// The uniform distribution on `[0, 1)^dims`.
#[derive(Clone, Copy, Debug)]
pub struct Uniform {
    dims: usize,
}

impl Uniform {
    /// For points of `dims` coordinates, 1 to 8 (clamped).
    pub fn new(dims: usize) -> Uniform {
        Uniform { dims: dims.clamp(1, MAX_DIMS) }
    }
}

impl Target for Uniform {
    fn dims(&self) -> usize {
        self.dims
    }

    fn bins(&self, direction: &[f32], means: &mut [f32], density: &mut [f32], _: &mut Vec<f32>) {
        let mut extents = [0.0; MAX_DIMS];
        let dims = direction.len().min(MAX_DIMS);
        for (extent, &component) in extents.iter_mut().zip(direction) {
            *extent = component.abs();
        }
        let range = dims as f32 * MEAN_COMPONENT[dims];
        uniform_bins(0.5 * direction.iter().sum::<f32>(), &mut extents[..dims], range, means, density);
    }

    fn sample(&self, rng: &mut Rng, point: &mut [f32]) {
        point.fill_with(|| rng.uniform_f32());
    }

    fn is_uniform(&self) -> bool {
        true
    }
}

/// [`Target::bins`] for the uniform distribution on a box, by the box's projected centre and the projected lengths of
/// its edges (`|direction[k]|` times the length of edge k; at most 8, not negative). Reorders `extents`. Densities are
/// relative to the mass spread over `range`.
///
/// One or two edges: closed form (a trapezoid). More: the cumulative distribution at 1,024 nodes, relative error about
/// 1e-6.
pub fn uniform_bins(center: f32, extents: &mut [f32], range: f32, means: &mut [f32], density: &mut [f32]) {
    extents.sort_unstable_by(|a, b| b.total_cmp(a));
    let longest = extents.first().copied().unwrap_or(0.0);
    // Without an edge this short the projection is too narrow, by at most 1e-5 of its length.
    let edges = extents.iter().take_while(|&&extent| extent > 1e-5 * longest).count();
    match edges {
        0 => {
            means.fill(center);
            density.fill(1.0);
        }
        1 => trapezoid(center, [longest, 0.0], range, means, density),
        2 => trapezoid(center, [longest, extents[1]], range, means, density),
        _ => tabulated(center, &extents[..edges], range, means, density),
    }
}

/// Entries of [`TABLE`].
const ROOTS: usize = 8192;

/// [`root_bin`], which takes longer than all else here.
static TABLE: LazyLock<Vec<[f32; 2]>> = LazyLock::new(|| (0..ROOTS).map(root_bin).collect());

/// The mean of sqrt(x) over [i, i + 1], and 1 / (sqrt(i + 1) - sqrt(i)), without cancellation.
fn root_bin(i: usize) -> [f32; 2] {
    let (begin, end) = (i as f32, (i + 1) as f32);
    let (a, b) = (begin.sqrt(), end.sqrt());
    [(2.0 / 3.0) * (begin + a * b + end) / (a + b), a + b]
}

/// The projection of a rectangle: a density that is constant over `long - short` and falls linearly over `short` to
/// both sides.
fn trapezoid(center: f32, [long, short]: [f32; 2], range: f32, means: &mut [f32], density: &mut [f32]) {
    let bins = means.len();
    if bins == 0 {
        return;
    }
    let width = long + short;
    let low = center - 0.5 * width;
    let share = 1.0 / bins as f32;
    let half = bins / 2;
    // Mass of one slope, in bins; where a slope's cumulative mass is i bins, its position is low + slope * sqrt(i).
    let tail = 0.5 * short / long * bins as f32;
    let slope = (2.0 * long * short * share).sqrt();
    let sloped = (tail as usize).min(half);
    let average = range * share;
    let per_slope = if sloped > 0 { average / slope } else { 0.0 };

    let known = sloped.min(ROOTS);
    for ((mean, density), [middle, sum]) in means[..known].iter_mut().zip(&mut density[..known]).zip(&*TABLE) {
        *mean = low + slope * middle;
        *density = per_slope * sum;
    }
    for i in known..sloped {
        let [middle, sum] = root_bin(i);
        means[i] = low + slope * middle;
        density[i] = per_slope * sum;
    }
    // Behind the slope, position is linear in mass.
    let flat = |mass: f32| low + short + (mass - tail) * long * share;
    let height = average / (long * share);
    for i in sloped..half {
        let (begin, end) = (i as f32, (i + 1) as f32);
        if begin >= tail {
            means[i] = flat(begin + 0.5);
            density[i] = height;
        } else {
            let (a, b) = (begin.sqrt(), tail.sqrt());
            let slope_mean = low + slope * (2.0 / 3.0) * (begin + a * b + tail) / (a + b);
            means[i] = (tail - begin) * slope_mean + (end - tail) * 0.5 * (low + short + flat(end));
            density[i] = average / (flat(end) - low - slope * a);
        }
    }
    if bins % 2 == 1 {
        let begin = half as f32;
        means[half] = center;
        let edge = if begin >= tail { flat(begin) } else { low + slope * begin.sqrt() };
        density[half] = average / (2.0 * (center - edge)).max(1e-3 * average);
    }
    let (left, right) = means.split_at_mut(bins - half);
    for (right, left) in right.iter_mut().rev().zip(left) {
        *right = 2.0 * center - *left;
    }
    let (left, right) = density.split_at_mut(bins - half);
    for (right, left) in right.iter_mut().rev().zip(left) {
        *right = *left;
    }
}

/// Cells of the table of the cumulative distribution.
const CELLS: usize = 1024;

/// The projection of a box of three or more edges, in descending order: the trapezoid of the longest two, averaged over
/// each further edge in turn.
fn tabulated(center: f32, extents: &[f32], range: f32, means: &mut [f32], density: &mut [f32]) {
    let width: f64 = extents.iter().map(|&extent| f64::from(extent)).sum();
    let step = width / CELLS as f64;
    let position = |k: usize| (k as f64 - 0.5 * CELLS as f64) * step;
    let mut cdf = [0.0; CELLS + 1];
    let mut integral = [0.0; CELLS + 1];
    let (long, short) = (f64::from(extents[0]), f64::from(extents[1]));
    for (k, f) in cdf.iter_mut().enumerate() {
        *f = trapezoid_cdf(position(k), long, short);
    }
    for &extent in &extents[2..] {
        average_over(f64::from(extent), step, &mut cdf, &mut integral);
    }
    // Rounding must not make it fall.
    let mut highest = 0.0f64;
    for f in &mut cdf {
        highest = highest.max(f.min(1.0));
        *f = highest;
    }
    bins_of_cdf(f64::from(center) - 0.5 * width, step, f64::from(range), &cdf, means, density);
}

fn trapezoid_cdf(t: f64, long: f64, short: f64) -> f64 {
    let (flat, end) = (0.5 * (long - short), 0.5 * (long + short));
    let distance = t.abs().min(end);
    if distance <= flat {
        return 0.5 + t / long;
    }
    let tail = (end - distance) * (end - distance) / (2.0 * long * short);
    if t > 0.0 { 1.0 - tail } else { tail }
}

/// Replaces F(t) at the nodes by its mean over [t - extent / 2, t + extent / 2]: the distribution of a sum with one
/// more uniform variable. F is 0 before the first node and 1 behind the last.
fn average_over(extent: f64, step: f64, cdf: &mut [f64; CELLS + 1], integral: &mut [f64; CELLS + 1]) {
    // Fourth-order cumulative integration, then cubic Hermite interpolation, whose slope is F itself.
    integral[0] = 0.0;
    for k in 0..CELLS {
        let before = if k == 0 { 0.0 } else { cdf[k - 1] };
        let behind = if k + 2 > CELLS { 1.0 } else { cdf[k + 2] };
        integral[k + 1] = integral[k] + step / 24.0 * (13.0 * (cdf[k] + cdf[k + 1]) - before - behind);
    }
    let cells = 0.5 * extent / step;
    let whole = cells as usize;
    let r = cells - whole as f64;
    let weights = [
        (1.0 + 2.0 * r) * (1.0 - r) * (1.0 - r),
        r * r * (3.0 - 2.0 * r),
        step * r * (1.0 - r) * (1.0 - r),
        step * r * r * (r - 1.0),
    ];
    let last = CELLS as isize;
    let at = |k: isize| -> (f64, f64) {
        if k < 0 {
            (0.0, 0.0)
        } else if k > last {
            (integral[CELLS] + (k - last) as f64 * step, 1.0)
        } else {
            (integral[k as usize], cdf[k as usize])
        }
    };
    let mut averaged = [0.0; CELLS + 1];
    for (k, averaged) in averaged.iter_mut().enumerate() {
        let right = k as isize + whole as isize;
        let left = k as isize - whole as isize;
        let ((a, fa), (b, fb)) = (at(right), at(right + 1));
        let ((c, fc), (d, fd)) = (at(left), at(left - 1));
        let above = weights[0] * a + weights[1] * b + weights[2] * fa + weights[3] * fb;
        // Mirrored: towards smaller t the slope changes its sign.
        let below = weights[0] * c + weights[1] * d - weights[2] * fc - weights[3] * fd;
        *averaged = (above - below) / extent;
    }
    *cdf = averaged;
}
