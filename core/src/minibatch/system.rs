//! The linear system of optimal MIS, which all parameters share.
//!
//! With S = sum_k n_k p_k and s over a batch's samples, `sum_s h / S` estimates the sum of h over all items without
//! bias, for any h. So do `q = sum_s p / S` the ones to which probabilities sum, `A = sum_s p p' / S^2` the matrix of
//! (6.17), and `b = sum_s g p / S^2` its right-hand side for a gradient g. The estimate of the sum of all gradients is
//!
//! `sum_s g / S - (q - 1)' alpha`, alpha = (A + L)^-1 b:
//!
//! the balance heuristic's, less what the batch got wrong about sums that are known. A and q belong to no parameter, so
//! with `c = (A + L)^-1 (q - 1)` it is `sum_s g / S - c' b`, linear in the gradients: one solve serves every parameter.
//!
//! Algorithm 5 prints W = n_j p_j / S where this has p_j / S. Its matrix is N A N and its right-hand side N b, for N
//! the counts, so that its sum of alpha is that of N^-1 A^-1 b: too small by n_j.

use super::Batch;
use crate::error::{Error, check_part, ensure};
use crate::matrix::{first, packed_len};
use crate::mis::linear::{self, Cells, Vector};
use crate::mis::{MAX_TECHNIQUES, Solver};

/// The most that the weights of all batches add up to: rounding a gradient's averages to `f32` moves them by a part in
/// 2^25 at each step, in the end by this times as much. Of a power of two, what is kept of them is exact.
const MOST: f64 = 65536.0;

/// Averages of A, q - 1 and the counts over the batches so far, newer ones counting for more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct System {
    pub(super) techniques: usize,
    /// The sum of the weights that the batches have: 1 for the newest, beta times as much for each one before.
    weight: f64,
    counts: Vector,
    /// q_j - 1, which is 0 in a batch where technique j drew nothing.
    error: Vector,
    /// A, its lower triangle by rows.
    cells: Cells,
}

impl System {
    /// No batches yet. A number of techniques outside 1..=16 fits no batch.
    pub const fn new(techniques: usize) -> System {
        System {
            techniques,
            weight: 0.0,
            counts: [0.0; MAX_TECHNIQUES],
            error: [0.0; MAX_TECHNIQUES],
            cells: [0.0; packed_len(MAX_TECHNIQUES)],
        }
    }

    /// Multiplies the weights of the earlier batches by `beta` in 0..=1 and adds `batch`. Returned are the parts that
    /// the old averages and the batch have in the new ones, which sum to 1.
    pub(super) fn add(&mut self, batch: &Batch<'_>, beta: f32) -> Result<(f64, f64), Error> {
        check_part(beta)?;
        ensure(batch.techniques() == self.techniques, Error::Range)?;
        let earlier = (f64::from(beta) * self.weight).min(MOST - 1.0);
        self.weight = earlier + 1.0;
        let (keep, part) = (earlier / self.weight, 1.0 / self.weight);
        self.error.iter_mut().chain(&mut self.counts).chain(&mut self.cells).for_each(|average| *average *= keep);
        for (j, &count) in batch.counts.iter().enumerate() {
            self.counts[j] += part * count;
            if count > 0.0 {
                self.error[j] -= part;
            }
        }
        for sample in batch.samples() {
            self.error.iter_mut().zip(&sample.ratio).for_each(|(error, ratio)| *error += part * ratio);
            linear::add_products(&mut self.cells, first(&sample.ratio, self.techniques), part);
        }
        Ok((keep, part))
    }

    /// c: zeros for [`Solver::Balance`].
    ///
    /// A technique that never drew has a row of zeros there, and gets a c of 0.
    pub(super) fn correction(&self, solver: Solver) -> Result<Vector, Error> {
        solver.check()?;
        ensure(solver != Solver::Progressive, Error::Unsupported)?;
        let samples = self.weight * self.counts.iter().sum::<f64>();
        let scale = self.counts.map(libm::sqrt);
        let system = linear::System::new(solver, &self.cells, 1.0, scale, self.techniques, samples);
        Ok(system.solve(&self.error))
    }
}
