//! How good point sets and tiles are: the figures that chapter 5 judges by.
//!
//! Definitions and sources: docs/metrics.md. All points are compared with the uniform distribution on the unit cube.
//! Seeds are fixed: the same points give the same figures on any number of threads, and across targets up to the
//! rounding of the Fourier transforms.

pub(crate) mod border;
pub mod discrepancy;
pub mod exponential_sums;
pub mod figure;
pub mod integrands;
pub mod integration;
pub mod neighbours;
mod plane;
pub mod projection;
pub mod report;
pub mod scenes;
pub mod spectrum;
pub mod text;
pub mod tile;
pub mod transport;

pub use integration::{PrefixError, log_spaced, prefix_errors};
pub use report::{PointReport, measure, quick, select};
pub use spectrum::Spectrum;
pub use tile::{TileOptions, TileReport, TileView, error_spectrum, measure_energies, measure_tile};

use crate::error::{Error, Result};
use crate::points::Points;
use serde::{Serialize, Serializer};

/// Whether points can be measured: 1 to 8 coordinates each, at least one point, every coordinate in [0, 1].
pub fn check(points: &Points) -> Result<()> {
    if points.is_empty() {
        return Err(Error::input("there are no points"));
    }
    if points.dims() > 8 {
        return Err(Error::input(format!("points of {} coordinates: at most 8 are supported", points.dims())));
    }
    if u32::try_from(points.len()).is_err() {
        return Err(Error::input(format!("{} points: at most {} are supported", points.len(), u32::MAX)));
    }
    check_coordinates(points.dims(), points.coordinates())
}

/// Axes as they are counted outside the library.
fn from_one<S: Serializer>(axes: &[usize; 2], serializer: S) -> std::result::Result<S::Ok, S::Error> {
    axes.map(|axis| axis + 1).serialize(serializer)
}

fn check_coordinates(dims: usize, coordinates: &[f32]) -> Result<()> {
    match coordinates.iter().position(|x| !(0.0..=1.0).contains(x)) {
        None => Ok(()),
        Some(i) => Err(Error::input(format!(
            "point {} has {} as coordinate {}: coordinates must be numbers in [0, 1]",
            i / dims + 1,
            coordinates[i],
            i % dims + 1
        ))),
    }
}
