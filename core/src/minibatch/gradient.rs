//! Optimal MIS gradients from explicit per-item gradients, with momentum.

use super::Batch;
use super::batch::Sample;
use super::system::System;
use crate::error::{Error, ensure};
use crate::mis::linear::Vector;
use crate::mis::{MAX_TECHNIQUES, Solver};
use crate::real::saturate;

/// Parameters that are worked on together: their sums and a few rows of gradients stay in the first-level cache.
const BLOCK: usize = 512;
/// Rows of gradients that are added to a sum at once.
const ROWS: usize = 4;
/// Samples that all blocks of parameters see before the next ones come.
const GROUP: usize = 64;
/// The sums of one parameter, at most.
const SUMS: usize = MAX_TECHNIQUES + 1;

/// The f32 that [`Gradient`] needs: J + 1 per parameter. 0 if `techniques` is not in 1..=16, `parameters` is 0, or no
/// memory could hold them.
pub const fn gradient_len(techniques: usize, parameters: usize) -> usize {
    let most = isize::MAX as usize / size_of::<f32>();
    match parameters.checked_mul(techniques.saturating_add(1)) {
        Some(len) if 0 < techniques && techniques <= MAX_TECHNIQUES && len <= most => len,
        _ => 0,
    }
}

/// Gradients of the mean loss from each drawn item's own, for any number of parameters, with momentum over steps
/// (section 6.2.3).
///
/// Each parameter has the averages of its balance estimate and of its b over the batches so far, in `f32`; what they
/// share is a [`System`]. With beta = 0 the estimate is that of [`weights`](super::weights()), whose one backward pass
/// is much cheaper: this is for momentum. The averages' rounding to `f32` is magnified by [`Solver::Plain`] where
/// techniques are nearly alike: by a part in 50 of the estimate for tables that differ by a part in 100,000. The
/// default ridge does not.
///
/// **Momentum** beta gives a batch that is t steps old the weight beta^t, in A, b, q and the balance estimate alike,
/// and divides by the sum of those weights. So from the first step on the estimate has its right size (Algorithm 5
/// multiplies by 1 - beta and does not divide: its ridge-free quotient does not need it, the ridge would). The older
/// gradients lag: under an optimiser with momentum of its own, such as Adam, use 0.
///
/// ```
/// use noisefloor::minibatch::{Batch, Gradient, gradient_len};
/// use noisefloor::mis::Solver;
///
/// let mut gradient = Gradient::new([0.0; gradient_len(2, 1)], 2, 1)?;
/// let batch = Batch::new(100, 2, &[0.01, 0.02, 0.01, 0.002, 0.01, 0.03], &[0, 0, 1])?;
/// let mut estimate = [0.0];
/// gradient.estimate(&batch, Solver::default(), 0.7, &[0.5, -0.25, 1.0], &mut estimate)?;
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient<M> {
    system: System,
    parameters: usize,
    /// Blocks of `BLOCK` parameters, the last one shorter, each `balance[len] | b_0[len] | .. | b_J-1[len]`.
    memory: M,
}

impl<M: AsRef<[f32]> + AsMut<[f32]>> Gradient<M> {
    /// No batches yet.
    ///
    /// # Errors
    /// [`Error::Range`] for techniques outside 1..=16 or no parameters; [`Error::Memory`] for less than
    /// [`gradient_len`]`(techniques, parameters)` elements of memory.
    pub fn new(memory: M, techniques: usize, parameters: usize) -> Result<Self, Error> {
        let mut gradient = Gradient::resume(memory, System::new(techniques), parameters)?;
        gradient.reset();
        Ok(gradient)
    }

    /// Takes up averages that `memory` already holds, with the [`Gradient::system`] that belongs to them.
    ///
    /// # Errors
    /// As for [`Gradient::new`].
    pub fn resume(memory: M, system: System, parameters: usize) -> Result<Self, Error> {
        match gradient_len(system.techniques, parameters) {
            0 => Err(Error::Range),
            needed if memory.as_ref().len() < needed => Err(Error::Memory),
            _ => Ok(Gradient { system, parameters, memory }),
        }
    }

    /// What the parameters share.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Forgets every batch: all of the memory becomes 0.
    pub fn reset(&mut self) {
        self.system = System::new(self.system.techniques);
        self.memory.as_mut().fill(0.0);
    }

    /// Adds a batch and estimates the gradient of the mean loss: `estimate` has one element per parameter.
    ///
    /// - `beta` in 0..=1: the weight that earlier batches keep; 0 forgets them, 1 averages all. From 2^16 batches on
    ///   more than 1 - 2^-16 does what that does: `f32` averages no more, and these within a part in 500.
    /// - `gradient[s * parameters + p]`: the gradient of sample s by parameter p, finite.
    ///
    /// Sums are in `f32`, added in an order that does not depend on the processor. An estimate beyond the range of
    /// `f32` becomes the largest finite one. The gradients are read twice, once to see that they are finite.
    ///
    /// # Errors
    /// These leave everything as it was: [`Error::Length`]; [`Error::Range`] for a number of techniques, beta or
    /// ridge, or where gradients over probabilities add up beyond a quarter of the range of `f32`; [`Error::NotFinite`]
    /// for NaN or infinity among the gradients, beta or ridge; [`Error::Unsupported`] for [`Solver::Progressive`].
    // Inlined into copies for wider registers.
    #[inline(always)]
    pub fn estimate(
        &mut self,
        batch: &Batch<'_>,
        solver: Solver,
        beta: f32,
        gradient: &[f32],
        estimate: &mut [f32],
    ) -> Result<(), Error> {
        let parameters = self.parameters;
        ensure(estimate.len() == parameters, Error::Length)?;
        ensure(batch.len().checked_mul(parameters) == Some(gradient.len()), Error::Length)?;
        let mut system = self.system;
        let (keep, part) = system.add(batch, beta)?;
        let correction = system.correction(solver)?;
        check(batch, gradient, parameters)?;

        self.system = system;
        let sums = system.techniques + 1;
        let memory = self.memory.as_mut();
        let mut samples = batch.samples();
        // Code for size, too, must see that this is not 0, which would panic.
        for (group, rows) in gradient.chunks(parameters.saturating_mul(GROUP).max(1)).enumerate() {
            let coefficients = coefficients(samples.by_ref().take(GROUP), part / batch.items);
            // The old averages fade once.
            let keep = if group == 0 { keep as f32 } else { 1.0 };
            let mut rest = &mut *memory;
            for (block, estimate) in estimate.chunks(BLOCK).enumerate() {
                let len = estimate.len();
                let Some(averages) = rest.split_off_mut(..len * sums) else { break };
                fade(averages, keep);
                let rows = rows.chunks_exact(parameters.max(1));
                let rows = rows.filter_map(|row| row.get(block * BLOCK..)?.get(..len));
                // Loops of known length are the faster ones.
                if len == BLOCK {
                    add(averages, BLOCK, &coefficients, rows);
                } else {
                    add(averages, len, &coefficients, rows);
                }
            }
        }
        let mut rest = &*memory;
        for estimate in estimate.chunks_mut(BLOCK) {
            let Some(averages) = rest.split_off(..estimate.len() * sums) else { break };
            solve(averages, &correction, estimate);
        }
        Ok(())
    }
}

/// Refuses gradients that are not finite, or whose sums might not be.
#[inline]
fn check(batch: &Batch<'_>, gradient: &[f32], parameters: usize) -> Result<(), Error> {
    let mut bound = 0.0;
    let mut overflow = false;
    for (row, sample) in gradient.chunks_exact(parameters.max(1)).zip(batch.samples()) {
        // Bits of positive floats are in the order of their values, NaN behind infinity.
        let largest = row.iter().fold(0, |largest, g| largest.max((g.to_bits() & 0x7fff_ffff) as i32));
        let largest = f32::from_bits(largest as u32);
        ensure(largest.is_finite(), Error::NotFinite)?;
        // The largest coefficient: p_j / S is at most 1.
        let coefficient = sample.balance / batch.items;
        overflow |= coefficient > f64::from(f32::MAX);
        bound += coefficient * f64::from(largest);
    }
    // A quarter leaves room for rounding.
    ensure(!overflow && bound <= 0.25 * f64::from(f32::MAX), Error::Range)
}

/// What the gradients of a group of samples are multiplied by, for the balance estimate and each b: four samples at a
/// time, those that are missing with zeros.
type Coefficients = [[[f32; ROWS]; SUMS]; GROUP / ROWS];

fn coefficients(samples: impl Iterator<Item = Sample>, part: f64) -> Coefficients {
    let mut all = [[[0.0; ROWS]; SUMS]; GROUP / ROWS];
    for (s, sample) in samples.take(GROUP).enumerate() {
        let balance = part * sample.balance;
        let ratios = core::iter::once(&1.0).chain(&sample.ratio);
        let four = &mut all[s / ROWS % (GROUP / ROWS)];
        four.iter_mut().zip(ratios).for_each(|(c, ratio)| c[s % ROWS] = (balance * ratio) as f32);
    }
    all
}

#[inline]
fn fade(averages: &mut [f32], keep: f32) {
    if keep == 0.0 {
        averages.fill(0.0);
    } else if keep != 1.0 {
        averages.iter_mut().for_each(|average| *average *= keep);
    }
}

/// Adds a group of samples to the averages of one block of `len` parameters.
#[inline]
fn add<'a>(averages: &mut [f32], len: usize, coefficients: &Coefficients, mut rows: impl Iterator<Item = &'a [f32]>) {
    for coefficients in coefficients {
        let Some(first) = rows.next() else { break };
        // A missing row may be any: its coefficients are 0.
        let mut row = || rows.next().unwrap_or(first);
        let [a, b, c, d] = [first, row(), row(), row()];
        let four = (a.get(..len), b.get(..len), c.get(..len), d.get(..len));
        let (Some(a), Some(b), Some(c), Some(d)) = four else { break };
        for (average, [ca, cb, cc, cd]) in averages.chunks_exact_mut(len.max(1)).zip(coefficients) {
            for (sum, ((a, b), (c, d))) in average.iter_mut().zip(a.iter().zip(b).zip(c.iter().zip(d))) {
                // In an order that is the same on every processor.
                *sum += (a * ca + b * cb) + (c * cc + d * cd);
            }
        }
    }
}

/// `balance - c' b` of one block, in f64: with similar techniques the terms can be large and cancel.
#[inline]
fn solve(averages: &[f32], correction: &Vector, estimate: &mut [f32]) {
    let len = estimate.len();
    let mut value = [0.0_f64; BLOCK];
    let coefficients = core::iter::once(-1.0).chain(correction.iter().copied());
    for (average, c) in averages.chunks_exact(len.max(1)).zip(coefficients) {
        value.iter_mut().zip(average).for_each(|(value, &average)| *value -= c * f64::from(average));
    }
    estimate.iter_mut().zip(value).for_each(|(out, value)| *out = saturate(value));
}
