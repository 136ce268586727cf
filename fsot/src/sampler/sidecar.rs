//! The file `NAME.toml` beside a sampler's table `NAME.bin`: what it is, how it was made and how good it is.

use super::problem::SamplerProblem;
use super::report::SamplerReport;
use super::table::SamplerTable;
use crate::digest::digest;
use crate::error::{Error, Result};
use crate::export::sidecar;
use crate::read;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A sidecar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SamplerSidecar {
    /// The command that makes the same bytes again.
    pub command: String,
    /// The version of fsot that did.
    pub version: String,
    /// The seed.
    pub seed: u64,
    /// The steps of the optimisation.
    pub iterations: u64,
    /// Pixels along each side.
    pub size: usize,
    /// Each pixel has 2^bits offsets for each axis.
    pub bits: u32,
    /// The SHA-256 of the table's file, in hexadecimal.
    pub sha256: String,
    /// For the first 1, 2, 4, ... samples.
    pub octaves: Vec<SamplerOctave>,
}

/// What was measured of the first samples: the energies that were optimised.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SamplerOctave {
    /// Samples of each pixel.
    pub spp: usize,
    /// Filtered, relative to independent samples.
    pub filtered: f64,
    /// Not filtered.
    pub raw: f64,
    /// The least and the greatest density of an axis within 1/64 of a border, relative to a uniform one.
    pub border: [f64; 2],
}

impl SamplerOctave {
    /// All octaves of a report, to 4 digits.
    pub fn all(report: &SamplerReport) -> Vec<SamplerOctave> {
        let rounded = |value: f32| sidecar::rounded(f64::from(value));
        let octaves = report.filtered.iter().zip(&report.raw).zip(&report.border).enumerate();
        let row = |(octave, ((filtered, raw), border)): (usize, ((&f32, &f32), &[f32; 2]))| SamplerOctave {
            spp: 1 << octave,
            filtered: rounded(*filtered),
            raw: rounded(*raw),
            border: border.map(rounded),
        };
        octaves.map(row).collect()
    }
}

impl SamplerSidecar {
    /// Of a table.
    pub fn new(
        command: String,
        problem: &SamplerProblem,
        table: &SamplerTable,
        report: &SamplerReport,
    ) -> SamplerSidecar {
        SamplerSidecar {
            command,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: problem.seed,
            iterations: problem.iterations,
            size: problem.size,
            bits: problem.bits,
            sha256: digest(&table.bytes()),
            octaves: SamplerOctave::all(report),
        }
    }
}

/// Reads a table, whose shape its sidecar says.
///
/// # Errors
/// One of the two cannot be read, or is none, or describes another.
pub fn read(path: &Path) -> Result<SamplerTable> {
    let beside = sidecar::path(path);
    let SamplerSidecar { size, bits, sha256, .. } = sidecar::read(path)?.ok_or_else(|| {
        let (table, missing) = (path.display(), beside.display());
        Error::Input(format!("{table} needs its sidecar {missing}, which `fsot sampler` writes beside it"))
    })?;
    SamplerProblem { size, bits, ..SamplerProblem::default() }
        .validate()
        .map_err(|error| Error::Input(format!("{}: {error}", beside.display())))?;
    let bytes = read::bytes(path)?;
    if digest(&bytes) != sha256 {
        return Err(Error::Input(format!("{} describes another table: its sha256 differs", beside.display())));
    }
    SamplerTable::from_bytes(size, bits, &bytes)
}
