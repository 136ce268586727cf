//! A minibatch drawn from several importance distributions.

use crate::error::{Error, ensure};
use crate::mis::MAX_TECHNIQUES;
use crate::mis::linear::Vector;

/// Which technique drew each item of a minibatch, and how probable the item is to every technique.
#[derive(Clone, Copy, Debug)]
pub struct Batch<'a> {
    pub(super) items: f64,
    techniques: usize,
    /// n_j, counted from `technique`.
    pub(super) counts: Vector,
    pdf: &'a [f32],
    technique: &'a [u32],
}

/// A probability of 1 with room for rounding: what is above is no probability, but a weight or a density.
const LARGEST: f32 = 1.001;

impl<'a> Batch<'a> {
    /// Checks a minibatch of `technique.len()` drawn items.
    ///
    /// - `items`: N, the size of the data set, at least 1.
    /// - `techniques`: J in 1..=16.
    /// - `pdf[s * J + j]`: the probability with which technique j draws the item of sample s; over the N items each
    ///   technique's probabilities sum to 1. Finite, at least 0 and, but for rounding, at most 1; positive for the
    ///   technique that drew it.
    /// - `technique[s]`: the one that drew it, below J. n_j is the number of its samples; one that drew nothing has no
    ///   part in the batch, whatever its probabilities.
    ///
    /// # Errors
    /// [`Error::Range`] for arguments outside these ranges; [`Error::Length`]; [`Error::NoSamples`] for an empty batch;
    /// [`Error::NotFinite`] for a probability that is NaN or infinite.
    pub fn new(items: u32, techniques: usize, pdf: &'a [f32], technique: &'a [u32]) -> Result<Batch<'a>, Error> {
        ensure((1..=MAX_TECHNIQUES).contains(&techniques) && items > 0, Error::Range)?;
        ensure(!technique.is_empty(), Error::NoSamples)?;
        ensure(technique.len().checked_mul(techniques) == Some(pdf.len()), Error::Length)?;
        ensure(pdf.iter().all(|p| p.is_finite()), Error::NotFinite)?;
        let mut counts = Vector::default();
        for (&own, p) in technique.iter().zip(pdf.chunks_exact(techniques)) {
            let drawn = p.get(own as usize).is_some_and(|&p| p > 0.0);
            *counts.get_mut(own as usize).filter(|_| drawn).ok_or(Error::Range)? += 1.0;
        }
        let most = counts.map(|count| if count > 0.0 { LARGEST } else { f32::MAX });
        let mut each = pdf.chunks_exact(techniques).flat_map(|p| p.iter().zip(&most));
        ensure(each.all(|(p, most)| (0.0..=*most).contains(p)), Error::Range)?;
        Ok(Batch { items: items.into(), techniques, counts, pdf, technique })
    }

    /// The number of samples.
    #[allow(clippy::len_without_is_empty, reason = "no batch is empty")]
    pub fn len(&self) -> usize {
        self.technique.len()
    }

    /// The number of techniques J.
    pub fn techniques(&self) -> usize {
        self.techniques
    }

    pub(super) fn samples(&self) -> impl Iterator<Item = Sample> {
        self.pdf.chunks_exact(self.techniques.max(1)).map(|pdf| Sample::new(pdf, &self.counts))
    }
}

/// What all parameters share of one sample.
pub(super) struct Sample {
    /// 1 / S, S = sum_k n_k p_k, which is positive.
    pub(super) balance: f64,
    /// p_j / S, at most 1 / n_j; 0 for a technique that drew nothing, which nothing would bound.
    pub(super) ratio: Vector,
}

impl Sample {
    fn new(pdf: &[f32], counts: &Vector) -> Sample {
        let sum: f64 = pdf.iter().zip(counts).map(|(&p, n)| f64::from(p) * n).sum();
        let mut ratio = Vector::default();
        for (ratio, (&p, &n)) in ratio.iter_mut().zip(pdf.iter().zip(counts)) {
            *ratio = if n > 0.0 { f64::from(p) / sum } else { 0.0 };
        }
        Sample { balance: 1.0 / sum, ratio }
    }
}
