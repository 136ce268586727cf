//! How many points lie at the borders of the unit cube, which the energies of a tile hardly show.

/// A border is one of so many parts of an axis.
pub(crate) const PARTS: usize = 64;

/// The least and the greatest density of an axis within 1/64 of a border, relative to a uniform one.
pub(super) fn density(dims: usize, coordinates: &[f32]) -> [f32; 2] {
    let part = 1.0 / PARTS as f32;
    let mut counts = [0_usize; 16];
    for point in coordinates.chunks_exact(dims) {
        for (ends, x) in counts.as_chunks_mut::<2>().0.iter_mut().zip(point) {
            ends[0] += usize::from(*x < part);
            ends[1] += usize::from(*x >= 1.0 - part);
        }
    }
    extremes(counts.into_iter().take(2 * dims), coordinates.len() / dims)
}

/// The same of `counts` at each end of each axis, of so many points.
pub(crate) fn extremes(counts: impl IntoIterator<Item = usize>, points: usize) -> [f32; 2] {
    let uniform = points as f32 / PARTS as f32;
    let densities = counts.into_iter().map(|count| count as f32 / uniform);
    densities.fold([f32::MAX, 0.0], |[least, most], density| [least.min(density), most.max(density)])
}
