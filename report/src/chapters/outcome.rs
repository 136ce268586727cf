//! What was rendered, and how it compares with the plain mean.

use super::measurement::BASELINE;
use super::statistics::Estimate;
use crate::measure::metric::Reference;
use crate::measure::renderer::Timing;
use crate::measure::score;
use anyhow::{Context, Result};
use image::Rgb32FImage;
use rayon::prelude::*;
use std::rc::Rc;

/// What one estimator made.
pub(crate) struct Renderings {
    pub(crate) estimator: String,
    /// One for each seed.
    pub(crate) images: Vec<Rgb32FImage>,
    pub(crate) timings: Vec<Timing>,
}

/// What an experiment made; all estimators saw the same samples.
#[derive(Clone)]
pub(crate) struct Outcome {
    pub(crate) reference: Rc<Reference>,
    pub(crate) renderings: Rc<[Renderings]>,
}

impl Outcome {
    pub(crate) fn of(&self, estimator: &str) -> Result<&Renderings> {
        let found = self.renderings.iter().find(|renderings| renderings.estimator == estimator);
        found.with_context(|| format!("`{estimator}` was not rendered"))
    }

    /// relMSE of each seed.
    pub(crate) fn errors(&self, estimator: &str) -> Result<Vec<f64>> {
        Ok(self.of(estimator)?.images.iter().map(|image| self.reference.rel_mse(image)).collect())
    }

    /// Raw and filtered errors of each seed, highlights limited: on all threads, since images of samplers are large.
    pub(crate) fn seen(&self, estimator: &str) -> Result<Vec<[f64; 2]>> {
        let reference = &*self.reference;
        Ok(self.of(estimator)?.images.par_iter().map(|image| score::errors(image, reference)).collect())
    }

    /// relMSE over the plain mean's, of the same samples.
    pub(crate) fn ratio(&self, estimator: &str) -> Result<Estimate> {
        Ok(Estimate::ratio(&self.errors(estimator)?, &self.errors(BASELINE)?))
    }

    /// Total time over the plain mean's, seed by seed.
    pub(crate) fn time_ratios(&self, estimator: &str) -> Result<Vec<f64>> {
        let (own, plain) = (self.of(estimator)?, self.of(BASELINE)?);
        let pairs = own.timings.iter().zip(&plain.timings);
        Ok(pairs.map(|(own, plain)| own.total_seconds / plain.total_seconds).collect())
    }

    /// relMSE over that of the plain mean of as many samples as it makes in the same time: its error falls as 1 /
    /// samples. Error and time are of the same seed, so that the interval has the noise of both.
    pub(crate) fn equal_time(&self, estimator: &str) -> Result<Estimate> {
        let pairs = self.errors(estimator)?.into_iter().zip(self.errors(BASELINE)?).zip(self.time_ratios(estimator)?);
        Ok(Estimate::median(&pairs.map(|((own, plain), time)| own / plain * time).collect::<Vec<_>>()))
    }
}

impl Renderings {
    /// The median over the seeds.
    pub(crate) fn nanoseconds(&self, of: impl Fn(&Timing) -> f64) -> Estimate {
        Estimate::median(&self.timings.iter().map(of).collect::<Vec<_>>())
    }
}
