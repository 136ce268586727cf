//! One weight per drawn item.

use super::Batch;
use super::system::System;
use crate::error::{Error, ensure};
use crate::mis::Solver;
use crate::real::saturate;

/// The optimal MIS gradient as weights: the gradient of the mean loss is `(1 / batch) sum_s weight[s] gradient_s`, for
/// every parameter at once. One backward pass over the weighted losses computes it; no per-item gradient is needed
/// (section 6.2).
///
/// weight = v batch / N with, for S = sum_k n_k p_k, q = sum_s p_s / S_s and A = sum_s p_s p_s' / S_s^2,
///
/// `v_s = 1 / S_s - (q - 1)' (A + L)^-1 p_s / S_s^2`
///
/// and L the ridge of [`Solver::Ridge`], or the pseudo-inverse G = N^1/2 (N^1/2 A N^1/2)^+ N^1/2 without one, N having
/// the counts ([`Solver::Plain`]: then v_s is also 1' G p_s / S_s^2), or only the first term ([`Solver::Balance`]). The
/// balance weights are positive and unbiased. The others are consistent, not unbiased, as A comes from the samples it
/// is applied to; they may be negative. A gradient that is a linear combination of the p_j at every item is estimated
/// exactly by [`Solver::Plain`], from any batch that tells them apart (A is not singular).
///
/// `weight` has one element per sample; one beyond the range of `f32` becomes the largest finite one.
///
/// Errors, which leave `weight` as it was: [`Error::Length`]; [`Error::Range`] for a ridge outside
/// [`RIDGE_RANGE`](crate::mis::RIDGE_RANGE); [`Error::NotFinite`] for a ridge that is NaN or infinite;
/// [`Error::Unsupported`] for [`Solver::Progressive`].
///
/// ```
/// use noisefloor::minibatch::{Batch, weights};
/// use noisefloor::mis::Solver;
///
/// // Two techniques, three samples of a data set of 100 items.
/// let batch = Batch::new(100, 2, &[0.01, 0.02, 0.01, 0.002, 0.01, 0.03], &[0, 0, 1])?;
/// let mut weight = [0.0; 3];
/// weights(&batch, Solver::default(), &mut weight)?;
/// # Ok::<(), noisefloor::Error>(())
/// ```
pub fn weights(batch: &Batch<'_>, solver: Solver, weight: &mut [f32]) -> Result<(), Error> {
    ensure(weight.len() == batch.len(), Error::Length)?;
    let mut system = System::new(batch.techniques());
    system.add(batch, 0.0)?;
    let correction = system.correction(solver)?;
    let scale = batch.len() as f64 / batch.items;
    for (weight, sample) in weight.iter_mut().zip(batch.samples()) {
        let control: f64 = correction.iter().zip(&sample.ratio).map(|(c, ratio)| c * ratio).sum();
        *weight = saturate((1.0 - control) * sample.balance * scale);
    }
    Ok(())
}
