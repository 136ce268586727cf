//! Point sets.

/// The largest coordinate: the number before 1.
pub(crate) const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Points of `dims` coordinates each, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    dims: usize,
    coordinates: Vec<f32>,
}

impl Points {
    /// Points from their coordinates; a last point that is not complete is dropped.
    pub fn new(dims: usize, mut coordinates: Vec<f32>) -> Points {
        let dims = dims.max(1);
        coordinates.truncate(coordinates.len() / dims * dims);
        Points { dims, coordinates }
    }

    /// Coordinates per point, at least 1.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.coordinates.len() / self.dims
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// All coordinates, point after point.
    pub fn coordinates(&self) -> &[f32] {
        &self.coordinates
    }

    /// One point.
    pub(crate) fn point(&self, number: usize) -> &[f32] {
        &self.coordinates[number * self.dims..][..self.dims]
    }

    /// The points, to be changed.
    pub(crate) fn iter_mut(&mut self) -> std::slice::ChunksExactMut<'_, f32> {
        self.coordinates.chunks_exact_mut(self.dims)
    }

    /// The points, each a slice of `dims` coordinates.
    pub fn iter(&self) -> std::slice::ChunksExact<'_, f32> {
        self.coordinates.chunks_exact(self.dims)
    }
}
