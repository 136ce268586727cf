//! All figures of a point set at once.

use super::discrepancy::{Discrepancy, discrepancy};
use super::integration::{Integration, integration};
use super::neighbours::{Neighbours, neighbours};
use super::spectrum::{Spectrum, SpectrumSummary};
use super::transport::{Transport, transport};
use crate::error::Result;
use crate::points::Points;
use serde::Serialize;

/// The quality of a point set. What does not apply (a spectrum of points on a line, neighbours of a single point) is
/// absent.
#[derive(Clone, Debug, Serialize)]
pub struct PointReport {
    /// How many points.
    pub points: usize,
    /// Coordinates per point.
    pub dims: usize,
    /// Of every pair of coordinates.
    pub spectra: Vec<PlaneSpectrum>,
    /// Nearest-neighbour distances.
    pub neighbours: Option<Neighbours>,
    /// L2 star discrepancy.
    pub discrepancy: Option<Discrepancy>,
    /// Sliced Wasserstein distances.
    pub transport: Transport,
    /// Integration errors; absent from a quick report.
    pub integration: Option<Integration>,
}

/// The spectrum of two coordinates.
#[derive(Clone, Debug, Serialize)]
pub struct PlaneSpectrum {
    /// Which coordinates, from 0; in JSON from 1.
    #[serde(serialize_with = "super::from_one")]
    pub axes: [usize; 2],
    /// Its summary.
    #[serde(flatten)]
    pub summary: SpectrumSummary,
}

/// Measures everything. Errors: see [`check`](super::check).
pub fn measure(points: &Points) -> Result<PointReport> {
    let quick = quick(points)?;
    Ok(PointReport { integration: Some(integration(points)), ..quick })
}

/// Measures everything but the integration error, which takes most of the time. Errors: see [`check`](super::check).
pub fn quick(points: &Points) -> Result<PointReport> {
    super::check(points)?;
    let dims = points.dims();
    let pairs = (0..dims).flat_map(|b| (0..b).map(move |a| [a, b]));
    let spectra = pairs
        .map(|axes| Ok(PlaneSpectrum { axes, summary: Spectrum::of_points(points, axes)?.summary() }))
        .collect::<Result<_>>()?;
    Ok(PointReport {
        points: points.len(),
        dims,
        spectra,
        neighbours: neighbours(points),
        discrepancy: discrepancy(points),
        transport: transport(points),
        integration: None,
    })
}

/// The points for which `wanted` holds, by index.
pub fn select(points: &Points, mut wanted: impl FnMut(usize) -> bool) -> Points {
    let chosen = points.iter().enumerate().filter(|(i, _)| wanted(*i)).flat_map(|(_, p)| p.iter().copied());
    Points::new(points.dims(), chosen.collect())
}
