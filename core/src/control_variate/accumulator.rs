//! Streaming estimates: sums of fixed size that samples are added to and that can be merged.
//!
//! Leave-one-out errors need the samples, which are gone, so the robust estimate here trusts held-out errors instead:
//! runs of an accumulator's samples are summed into folds, and each fold judges the fits to the other folds.

use super::config::{Config, Estimate};
use super::samples::Samples;
use super::state::State;
use crate::error::Error;
use crate::real::Real;

/// A fixed-size accumulator over `sums`, a buffer of [`Accumulator::len`] numbers: an array, a slice, a vector.
///
/// ```
/// use noisefloor::control_variate::{Accumulator, Config, Samples};
///
/// let config = Config::new(2, 2, 1);
/// let mut accumulator = Accumulator::<f64, _>::new(&config, [0.0; 112])?;
/// accumulator.add(Samples::new(&[0.1, 0.7, 0.5, 0.2], &[1.0, 3.0]))?;
/// let estimate = accumulator.estimate(&mut [0.0; 256])?;
/// assert_eq!(estimate.samples, 2);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Accumulator<R, S> {
    state: State<R>,
    sums: S,
}

impl<R: Real, S: AsRef<[R]> + AsMut<[R]>> Accumulator<R, S> {
    /// Numbers of `sums` that a configuration needs.
    ///
    /// # Errors
    /// As for [`Accumulator::new`].
    pub fn len(config: &Config) -> Result<usize, Error> {
        Ok(State::<R>::new(config)?.len())
    }

    /// Numbers of workspace that [`Accumulator::estimate`] needs.
    ///
    /// # Errors
    /// As for [`Accumulator::new`].
    pub fn workspace_len(config: &Config) -> Result<usize, Error> {
        Ok(State::<R>::new(config)?.workspace_len())
    }

    /// An empty accumulator; `sums` is cleared.
    ///
    /// # Errors
    /// [`Error::Memory`] if `sums` is too short, [`Error::Range`] or [`Error::Unsupported`] for the configuration.
    pub fn new(config: &Config, mut sums: S) -> Result<Self, Error> {
        let mut state = State::new(config)?;
        state.reset(sums.as_mut())?;
        Ok(Self { state, sums })
    }

    /// Forgets all samples.
    pub fn reset(&mut self) {
        // The length was checked when it was made.
        let _ = self.state.reset(self.sums.as_mut());
    }

    /// Adds samples, all or, on an error, none.
    ///
    /// # Errors
    /// As for [`estimate`](super::estimate); adding no samples is an error too.
    pub fn add(&mut self, samples: Samples<'_>) -> Result<(), Error> {
        self.state.add(self.sums.as_mut(), samples)
    }

    /// Adds all samples of another accumulator ([`State::merge`]).
    ///
    /// # Errors
    /// [`Error::Mismatch`] if the configurations differ.
    ///
    /// ```
    /// use noisefloor::control_variate::{Accumulator, Config, Samples};
    ///
    /// let config = Config::new(1, 1, 1);
    /// let new = || Accumulator::<f64, _>::new(&config, vec![0.0; Accumulator::<f64, Vec<f64>>::len(&config)?]);
    /// let mut all = new()?;
    /// let mut pass = new()?; // of another thread, say
    /// pass.add(Samples::new(&[0.1, 0.3], &[1.1, 1.3]))?;
    /// all.merge(&pass)?;
    /// assert_eq!(all.samples(), 2);
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    pub fn merge<T: AsRef<[R]>>(&mut self, other: &Accumulator<R, T>) -> Result<(), Error> {
        self.state.merge(self.sums.as_mut(), &other.state, other.sums.as_ref())
    }
}

impl<R: Real, S: AsRef<[R]>> Accumulator<R, S> {
    /// The estimate from all samples so far. More may be added afterwards.
    ///
    /// # Errors
    /// [`Error::NoSamples`] if there are none, [`Error::Memory`] if `workspace` is shorter than
    /// [`Accumulator::workspace_len`] says.
    pub fn estimate(&self, workspace: &mut [R]) -> Result<Estimate, Error> {
        self.state.estimate(self.sums.as_ref(), workspace)
    }

    /// All but the buffer.
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// Samples added so far.
    pub fn samples(&self) -> u64 {
        self.state.samples()
    }
}
