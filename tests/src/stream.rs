//! An accumulator with a buffer of its own.

use noisefloor::control_variate::{Accumulator, Config, Estimate, Samples};
use noisefloor::error::Error;
use noisefloor::real::Real;

/// An accumulator and its sums.
#[derive(Clone, Debug)]
pub struct Stream<R> {
    accumulator: Accumulator<R>,
    sums: Vec<R>,
}

impl<R: Real> Stream<R> {
    /// An empty one.
    pub fn new(config: &Config) -> Result<Self, Error> {
        let mut accumulator = Accumulator::new(config)?;
        let mut sums = vec![R::from_f64(f64::NAN); accumulator.len()];
        accumulator.reset(&mut sums)?;
        Ok(Self { accumulator, sums })
    }

    /// A workspace for its estimates, of numbers that must not be used.
    pub fn workspace(&self) -> Vec<R> {
        vec![R::from_f64(f64::NAN); self.accumulator.workspace_len()]
    }

    pub fn reset(&mut self) {
        self.accumulator.reset(&mut self.sums).unwrap();
    }

    pub fn add(&mut self, samples: Samples<'_>) -> Result<(), Error> {
        self.accumulator.add(&mut self.sums, samples)
    }

    pub fn merge(&mut self, other: &Self) -> Result<(), Error> {
        self.accumulator.merge(&mut self.sums, &other.accumulator, &other.sums)
    }

    pub fn estimate(&self, workspace: &mut [R]) -> Result<Estimate, Error> {
        self.accumulator.estimate(&self.sums, workspace)
    }

    pub fn samples(&self) -> u64 {
        self.accumulator.samples()
    }
}
