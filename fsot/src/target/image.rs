//! A target density given by a picture: stippling (section 5.5.1, figures 5.10-5.13), and placement by a map, our own.

mod curve;
mod density;
mod grid;
mod projection;

pub use curve::spread;
pub use density::ImageTarget;
