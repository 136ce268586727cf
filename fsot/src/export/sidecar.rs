//! The file `NAME.toml` beside a tile `NAME.nft`: how it was made and how good it is.

use crate::digest::digest;
use crate::error::{Error, Result};
use crate::metrics::TileReport;
use crate::metrics::tile::Energies;
use crate::output::is_stream;
use crate::read;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A sidecar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sidecar {
    /// The command that makes the same bytes again.
    pub command: String,
    /// The version of fsot that did.
    pub version: String,
    /// The seed.
    pub seed: u64,
    /// What the tile was optimised for.
    pub kernel: String,
    /// The steps of the optimisation.
    pub iterations: u64,
    /// The SHA-256 of the tile's file, in hexadecimal.
    pub sha256: String,
    /// What was measured: energies of the error relative to white noise.
    pub quality: Quality,
}

/// Measured quality: what `fsot measure` prints, to 4 digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Random integrands of each family.
    pub integrands: usize,
    /// By number of samples.
    pub energy: Vec<Row>,
    /// By number of samples, of each pair of the dimensions if there are more than two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marginal: Vec<Row>,
    /// All samples, after an exponential moving average over the frames.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub temporal: Vec<Row>,
}

/// Energies of one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Samples per pixel that were used.
    pub spp: usize,
    /// The dimensions, counted from 1; all if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<[usize; 2]>,
    /// The weight of the newest frame; no average if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alpha: Option<f64>,
    /// Half-spaces and Gaussians, filtered by a Gaussian of 2.1 pixels.
    pub filtered: [f64; 2],
    /// The same, filtered by exp(-r^2 / 2.1^2).
    pub perceptual: [f64; 2],
    /// The same, not filtered.
    pub raw: [f64; 2],
}

impl Quality {
    /// From a report.
    pub fn new(report: &TileReport) -> Quality {
        let row = |spp, axes: Option<[usize; 2]>, alpha, half_spaces: &Energies, gaussians: &Energies| Row {
            spp,
            axes: axes.map(|axes| axes.map(|axis| axis + 1)),
            alpha,
            filtered: [half_spaces.wide, gaussians.wide].map(rounded),
            perceptual: [half_spaces.perceptual, gaussians.perceptual].map(rounded),
            raw: [half_spaces.raw, gaussians.raw].map(rounded),
        };
        let prefixes = report.prefixes.iter();
        let marginals = report.marginals.iter().flat_map(|pair| pair.prefixes.iter().map(|prefix| (pair.axes, prefix)));
        Quality {
            integrands: report.integrands,
            energy: prefixes
                .map(|prefix| row(prefix.spp, None, None, &prefix.energies.half_spaces, &prefix.energies.gaussians))
                .collect(),
            marginal: marginals
                .map(|(axes, prefix)| {
                    row(prefix.spp, Some(axes), None, &prefix.energies.half_spaces, &prefix.energies.gaussians)
                })
                .collect(),
            temporal: report
                .temporal
                .iter()
                .map(|t| row(report.spp, None, Some(t.alpha), &t.energies.half_spaces, &t.energies.gaussians))
                .collect(),
        }
    }
}

impl Sidecar {
    /// Whether the bytes of a tile's file are those described.
    pub fn describes(&self, tile: &[u8]) -> bool {
        self.sha256 == digest(tile)
    }
}

/// Reads the sidecar, of the kind `S`, of a tile or a table; none if there is no such file.
///
/// # Errors
/// The file cannot be read or is no such sidecar.
pub fn read<S: DeserializeOwned>(described: &Path) -> Result<Option<S>> {
    let path = path(described);
    let text = match read::text(&path, "a sidecar") {
        Err(Error::Io { source, .. }) if source.kind() == ErrorKind::NotFound => return Ok(None),
        text => text?,
    };
    let sidecar = toml::from_str(&text);
    sidecar.map(Some).map_err(|error| Error::Input(format!("{} is no such sidecar: {error}", path.display())))
}

/// Whether a sidecar of the kind `S` may be written at `path`: nothing is there, or another of them.
///
/// # Errors
/// Something else is there, which would be lost.
pub fn check<S: DeserializeOwned>(path: &Path) -> Result<()> {
    if is_stream(path) || !path.exists() || read::text(path, "").is_ok_and(|text| toml::from_str::<S>(&text).is_ok()) {
        return Ok(());
    }
    Err(Error::Input(format!("{} is no such sidecar, and would be replaced: choose another --out", path.display())))
}

/// `NAME.toml` for `NAME.nft` or `NAME.bin`.
pub fn path(described: &Path) -> PathBuf {
    described.with_extension("toml")
}

/// The content of a sidecar's file.
///
/// # Errors
/// Never, but for a value that TOML has no place for.
pub fn encode(sidecar: &impl Serialize) -> Result<Vec<u8>> {
    toml::to_string(sidecar)
        .map(String::into_bytes)
        .map_err(|error| Error::Input(format!("cannot write the sidecar: {error}")))
}

/// To 4 significant digits, so that the last bits of a measurement do not show.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
