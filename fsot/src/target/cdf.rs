//! Bins of equal mass of a distribution on a line, from its cumulative distribution at equidistant nodes.

/// Cuts the distribution whose cumulative mass at `start + k * step` is `cdf[k]` (not decreasing, any total above 0,
/// linear between nodes) into `means.len()` bins of equal mass, as [`Target::bins`](super::Target::bins) wants them.
///
/// Densities are relative to the mass spread over `range`.
///
/// A distribution without mass, or fewer than two nodes, gives bins at `start`.
pub fn bins_of_cdf(start: f64, step: f64, range: f64, cdf: &[f64], means: &mut [f32], density: &mut [f32]) {
    let bins = means.len();
    let (bottom, top) = (cdf.first().copied().unwrap_or(0.0), cdf.last().copied().unwrap_or(0.0));
    let total = top - bottom;
    if !total.is_finite() || total <= 0.0 {
        means.fill(start as f32);
        density.fill(1.0);
        return;
    }
    let first = cdf.iter().take_while(|&&f| f <= bottom).count() - 1;
    let last = cdf.len() - cdf.iter().rev().take_while(|&&f| f >= top).count();
    let average = range / bins as f64;
    // A bin without length has a point of all of its mass: as much density as the others can make up for.
    let shortest = average * 1e-3;
    let share = total / bins as f64;

    let mut cell = first;
    // The moment (integral of position over mass) up to the cell, and up to the bin.
    let (mut moment_of_cell, mut begin_moment) = (0.0, 0.0);
    let mut begin = start + first as f64 * step;
    for (i, (mean, density)) in means.iter_mut().zip(density).enumerate() {
        let mass = if i + 1 == bins { top } else { bottom + share * (i + 1) as f64 };
        while cell + 1 < last && cdf[cell + 1] < mass {
            moment_of_cell += (cdf[cell + 1] - cdf[cell]) * (start + (cell as f64 + 0.5) * step);
            cell += 1;
        }
        let (low, high) = (cdf[cell], cdf[cell + 1]);
        let within = if high > low { ((mass - low) / (high - low)).min(1.0) } else { 0.0 };
        let end = start + (cell as f64 + within) * step;
        let end_moment = moment_of_cell + (mass - low) * (start + (cell as f64 + 0.5 * within) * step);
        *mean = ((end_moment - begin_moment) / share) as f32;
        *density = (average / (end - begin).max(shortest)) as f32;
        (begin, begin_moment) = (end, end_moment);
    }
}
