//! A target density given by a picture: stippling and placement (5.5.1, figures 5.10-5.15).

mod curve;
mod density;
mod grid;
mod projection;

pub use curve::spread;
pub use density::ImageTarget;
