//! Pictures: reading photographs, drawing dots to pixels and to vectors, comparing the two.

mod colour;
mod drawing;
mod photo;
mod raster;
mod resample;
mod score;
mod vector;

pub use colour::{decode, encode, luminance};
pub use drawing::{BLACK, Blend, Colour, Drawing, Mark, Shape, WHITE};
pub use photo::Photo;
pub(crate) use photo::is_linear;
pub use raster::{check_size, png, rasterise};
pub(crate) use resample::resample;
pub(crate) use score::blurred;
pub use score::blurred_psnr;
pub use vector::{hex, svg};
