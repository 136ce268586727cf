//! How important an item is: the norm of the loss's derivative by the network's outputs (6.1.4).
//!
//! By the chain rule the norm of an item's parameter gradient is at most a constant times it, and it needs no backward
//! pass. Everything is in `f64` inside: finite inputs of any size give finite results, one beyond the range of `f32`
//! becoming the largest finite `f32`. Functions that return a number return NaN for wrong input: nothing given, a NaN
//! or infinity among it, slices of different lengths, or a label that does not exist.

use crate::Error;
use crate::mis::MAX_TECHNIQUES;
use crate::real::saturate;

/// `|| softmax(logits) - onehot(label) ||`, the norm of (6.10): from 0 to the square root of 2.
///
/// Near 0 it keeps its relative accuracy: 1 - softmax(label) is formed from the other classes.
///
/// ```
/// use noisefloor::minibatch::importance::cross_entropy;
/// assert_eq!(cross_entropy(&[0.0, 0.0], 0), 0.5_f32.sqrt());
/// assert!(cross_entropy(&[9.0, 0.0], 0) < 0.001); // already learnt
/// ```
pub fn cross_entropy(logits: &[f32], label: usize) -> f32 {
    Softmax::new(logits, label)
        .map_or(f32::NAN, |s| saturate(libm::sqrt(s.others_squared + s.others * s.others) / s.sum))
}

/// The cross-entropy loss `-ln softmax(logits)[label]`, at least 0.
pub fn cross_entropy_loss(logits: &[f32], label: usize) -> f32 {
    // ln sum exp(z) - z_label, where the largest exp is 1: log1p of the others keeps a loss near 0 accurate.
    Softmax::new(logits, label).map_or(f32::NAN, |s| saturate(libm::log1p(s.not_largest) - s.label))
}

/// The derivative of the cross-entropy loss by the logits, `softmax(logits) - onehot(label)` (6.10).
///
/// `gradient` has one element per logit. Errors: [`Error::Range`] for no logits, a label that does not exist or a wrong
/// length; [`Error::NotFinite`] for a logit that is NaN or infinite.
pub fn cross_entropy_gradient(logits: &[f32], label: usize, gradient: &mut [f32]) -> Result<(), Error> {
    if gradient.len() != logits.len() || label >= logits.len() {
        return Err(Error::Range);
    }
    let s = Softmax::new(logits, label).ok_or(Error::NotFinite)?;
    for (k, (out, &z)) in gradient.iter_mut().zip(logits).enumerate() {
        let value = if k == label { -s.others } else { libm::exp(f64::from(z) - s.largest) };
        *out = (value / s.sum) as f32;
    }
    Ok(())
}

/// `|| 2 (output - target) ||`, for the loss `sum (output - target)^2`.
pub fn squared_error(output: &[f32], target: &[f32]) -> f32 {
    if output.len() != target.len() {
        return f32::NAN;
    }
    2.0 * norm(output.iter().zip(target).map(|(&o, &t)| f64::from(o) - f64::from(t)), 0.5 * f64::from(f32::MAX))
}

/// The norm of any derivative of the loss by the outputs.
pub fn gradient(gradient: &[f32]) -> f32 {
    norm(gradient.iter().map(|&g| f64::from(g)), f64::from(f32::MAX))
}

/// How [`nodes`] makes several importances of one derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// One importance per group of output nodes: the norm over the group.
    Norm,
    /// Two per group: the norm of the positive parts at 2 g, of the negative parts at 2 g + 1.
    ///
    /// Importances of which each belongs to one sign can combine linearly to the derivative itself, which norms cannot:
    /// that is what optimal MIS needs for a gain.
    Sign,
}

/// Importances for several distributions, from the derivative of the loss by each output node.
///
/// Node k belongs to group k mod G, so that every node is covered; G is `importance.len()` with [`Split::Norm`] and
/// half of it with [`Split::Sign`]. (6.2.3) proposes a subset of the nodes, which leaves gradients to the other nodes
/// without an importance.
///
/// Errors, which leave `importance` as it was: [`Error::Range`] unless there are 1..=16 importances, an even number
/// with [`Split::Sign`], and at least one node per group; [`Error::NotFinite`] for NaN or infinity in `gradient`.
pub fn nodes(gradient: &[f32], split: Split, importance: &mut [f32]) -> Result<(), Error> {
    let techniques = importance.len();
    let signs = if split == Split::Sign { 2 } else { 1 };
    if !(1..=MAX_TECHNIQUES).contains(&techniques) || !techniques.is_multiple_of(signs) {
        return Err(Error::Range);
    }
    let groups = (techniques / signs).max(1);
    if gradient.len() < groups {
        return Err(Error::Range);
    }
    if !gradient.iter().all(|g| g.is_finite()) {
        return Err(Error::NotFinite);
    }
    importance.chunks_mut(signs).enumerate().for_each(|(group, out)| {
        let mut squares = [0.0_f64; 2];
        for g in gradient.iter().skip(group).step_by(groups).map(|&g| f64::from(g)) {
            squares[usize::from(split == Split::Sign && g < 0.0)] += g * g;
        }
        out.iter_mut().zip(squares).for_each(|(out, square)| *out = saturate(libm::sqrt(square)));
    });
    Ok(())
}

/// The L2 norm, at most `largest`; NaN for no values or one that is not finite.
fn norm(values: impl Iterator<Item = f64>, largest: f64) -> f32 {
    let (count, square) = values.fold((0_usize, 0.0), |(count, square), value| (count + 1, square + value * value));
    if count == 0 || !square.is_finite() { f32::NAN } else { libm::sqrt(square).min(largest) as f32 }
}

/// Sums of e_k = exp(logit_k - largest), which lie in 0..=1 whatever the logits are.
struct Softmax {
    largest: f64,
    /// The label's logit less the largest.
    label: f64,
    /// Of all e.
    sum: f64,
    /// Of all e but that of the first largest logit, whose e is 1.
    not_largest: f64,
    /// Of all e but the label's.
    others: f64,
    /// Of the squares of those.
    others_squared: f64,
}

impl Softmax {
    /// None for a label that does not exist or a logit that is not finite.
    fn new(logits: &[f32], label: usize) -> Option<Softmax> {
        let own = f64::from(*logits.get(label)?);
        let (mut at, mut largest) = (0, f32::NEG_INFINITY);
        for (k, &z) in logits.iter().enumerate() {
            if !z.is_finite() {
                return None;
            }
            if z > largest {
                (at, largest) = (k, z);
            }
        }
        let largest = f64::from(largest);
        let mut s =
            Softmax { largest, label: own - largest, sum: 0.0, not_largest: 0.0, others: 0.0, others_squared: 0.0 };
        for (k, &z) in logits.iter().enumerate() {
            let e = libm::exp(f64::from(z) - largest);
            s.sum += e;
            if k != at {
                s.not_largest += e;
            }
            if k != label {
                s.others += e;
                s.others_squared += e * e;
            }
        }
        Some(s)
    }
}
