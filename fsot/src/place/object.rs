//! What is placed.

/// A thing in its place.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Object {
    /// To the right, in [0, 1].
    pub x: f32,
    /// Downwards, in [0, 1].
    pub y: f32,
    /// The number of its colour, from 0.
    pub color: usize,
    /// Its size, in (0, 1); 1/2 for all if sizes are not asked for.
    pub size: f32,
}
