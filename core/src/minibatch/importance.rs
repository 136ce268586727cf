//! How important an item is: the norm of the loss's derivative by the network's outputs (section 6.1.4).
//!
//! By the chain rule the norm of an item's parameter gradient is at most a constant times it, and it needs no backward
//! pass. Everything is in `f64` inside: finite inputs of any size give finite results, one beyond the range of `f32`
//! becoming the largest finite `f32`. Wrong input is an error, but for [`squared_error`], of which it is NaN.

use crate::error::{Error, ensure};
use crate::mis::MAX_TECHNIQUES;
use crate::real::{Real, saturate};

/// What the cross-entropy loss of one item is made of: sums of e_k = exp(logit_k - largest), which lie in 0..=1
/// whatever the logits are.
///
/// ```
/// use noisefloor::minibatch::importance::Softmax;
/// assert_eq!(Softmax::new(&[0.0, 0.0], 0)?.norm(), 0.5_f32.sqrt());
/// assert!(Softmax::new(&[9.0, 0.0], 0)?.norm() < 0.001); // already learnt
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Softmax<'a> {
    logits: &'a [f32],
    label: usize,
    /// The logit of the label.
    own: f64,
    largest: f64,
    /// Of all e.
    sum: f64,
    /// Of all e but that of the first largest logit, whose e is 1.
    not_largest: f64,
    /// Of all e but the label's.
    others: f64,
    /// Of the squares of those.
    others_squared: f64,
}

impl<'a> Softmax<'a> {
    /// Of the logits of an item whose class is `label`.
    ///
    /// # Errors
    /// [`Error::Range`] for a label that does not exist, as where there are no logits; [`Error::NotFinite`] for
    /// a logit that is NaN or infinite.
    pub fn new(logits: &'a [f32], label: usize) -> Result<Self, Error> {
        let own = f64::from(*logits.get(label).ok_or(Error::Range)?);
        let (mut at, mut largest) = (0, f32::NEG_INFINITY);
        for (k, &z) in logits.iter().enumerate() {
            ensure(z.is_finite(), Error::NotFinite)?;
            if z > largest {
                (at, largest) = (k, z);
            }
        }
        let largest = f64::from(largest);
        let mut s =
            Softmax { logits, label, own, largest, sum: 0.0, not_largest: 0.0, others: 0.0, others_squared: 0.0 };
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
        Ok(s)
    }

    /// `|| softmax(logits) - onehot(label) ||`, the norm of (6.10): from 0 to the square root of 2.
    ///
    /// Near 0 it keeps its relative accuracy: 1 - softmax(label) is formed from the other classes.
    pub fn norm(&self) -> f32 {
        saturate(Real::sqrt(self.others_squared + self.others * self.others) / self.sum)
    }

    /// The cross-entropy loss `-ln softmax(logits)[label]`, at least 0.
    pub fn loss(&self) -> f32 {
        // ln sum exp(z) - z_label, where the largest exp is 1: log1p of the others keeps a loss near 0 accurate.
        saturate(libm::log1p(self.not_largest) - (self.own - self.largest))
    }

    /// The derivative of the loss by each logit, `softmax(logits) - onehot(label)` (6.10).
    pub fn gradient(&self) -> impl Iterator<Item = f32> {
        self.logits.iter().enumerate().map(|(k, &z)| {
            let value = if k == self.label { -self.others } else { libm::exp(f64::from(z) - self.largest) };
            (value / self.sum) as f32
        })
    }
}

/// `|| 2 (output - target) ||`, for the loss `sum (output - target)^2`: NaN for nothing, NaN or infinity among them, or
/// different lengths.
pub fn squared_error(output: &[f32], target: &[f32]) -> f32 {
    let differences = output.iter().zip(target).map(|(&o, &t)| f64::from(o) - f64::from(t));
    let square = differences.fold(0.0, |sum, difference| sum + difference * difference);
    if output.is_empty() || output.len() != target.len() || !square.is_finite() {
        return f32::NAN;
    }
    saturate(2.0 * Real::sqrt(square))
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
/// half of it with [`Split::Sign`]. Section 6.2.3 proposes a subset of the nodes, which leaves gradients to the other
/// nodes without an importance, or norms of groups; it does not split by sign, which is our own.
///
/// Errors, which leave `importance` as it was: [`Error::Range`] unless there are 1..=16 importances, an even number
/// with [`Split::Sign`], and at least one node per group; [`Error::NotFinite`] for NaN or infinity in `gradient`.
pub fn nodes(gradient: &[f32], split: Split, importance: &mut [f32]) -> Result<(), Error> {
    let techniques = importance.len();
    let signs = if split == Split::Sign { 2 } else { 1 };
    ensure((1..=MAX_TECHNIQUES).contains(&techniques) && techniques.is_multiple_of(signs), Error::Range)?;
    let groups = (techniques / signs).max(1);
    ensure(gradient.len() >= groups, Error::Range)?;
    ensure(gradient.iter().all(|g| g.is_finite()), Error::NotFinite)?;
    importance.chunks_mut(signs).enumerate().for_each(|(group, out)| {
        let mut squares = [0.0_f64; 2];
        for g in gradient.iter().skip(group).step_by(groups).map(|&g| f64::from(g)) {
            squares[usize::from(split == Split::Sign && g < 0.0)] += g * g;
        }
        out.iter_mut().zip(squares).for_each(|(out, square)| *out = saturate(Real::sqrt(square)));
    });
    Ok(())
}
