//! Everything about one scene.

use super::ORDER;
use crate::measure::metric::Reference;
use crate::measure::renderer::Sampler;
use crate::measure::score;
use crate::povray::oracle::{Model, Oracle, Request, View};
use crate::povray::scenes::Scene;
use anyhow::{Context, Result};
use image::Rgb32FImage;
use indicatif::ProgressBar;

/// Samples per pixel.
pub(super) const SPP: [u32; 4] = [1, 4, 16, 64];

/// What is compared.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Points {
    Random,
    Sobol,
    /// The tile of two dimensions.
    Tile,
    /// The tile of four.
    Joint,
}

impl Points {
    /// Those that suit a scene: a tile of four dimensions is of no use to two.
    pub(super) fn of(scene: &Scene) -> Vec<Self> {
        let joint = (scene.axes.len() > 2).then_some(Self::Joint);
        [Self::Random, Self::Sobol, Self::Tile].into_iter().chain(joint).collect()
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Sobol => "Sobol",
            Self::Tile => "tile",
            Self::Joint => "tile, joint",
        }
    }

    fn sampler(self, spp: u32) -> Sampler<'static> {
        match self {
            Self::Random => Sampler::Random,
            Self::Sobol => Sampler::Sobol,
            Self::Tile => Sampler::Tile(""),
            Self::Joint => Sampler::Tile(if spp < 4 { "128_1SPP_4D" } else { "128_4SPP_4D" }),
        }
    }
}

/// One way to render a scene: its errors, seed by seed.
pub(super) struct Way {
    pub(super) spp: u32,
    pub(super) points: Points,
    pub(super) estimator: &'static str,
    pub(super) rel_mse: Vec<f64>,
    pub(super) filtered: Vec<f64>,
    /// Of the estimator alone, per sample and thread.
    pub(super) nanoseconds: Vec<f64>,
    /// The first seed's.
    pub(super) image: Rgb32FImage,
}

/// A scene rendered in every way.
pub(super) struct Measured {
    pub(super) scene: &'static Scene,
    pub(super) reference: Reference,
    pub(super) all: Vec<Way>,
    /// The plain mean and the default where values between cells are interpolated.
    pub(super) linear: Vec<Way>,
}

pub(super) fn find<'a>(all: &'a [Way], spp: u32, points: Points, estimator: &str) -> Result<&'a Way> {
    let found = all.iter().find(|way| (way.spp, way.points, way.estimator) == (spp, points, estimator));
    found.with_context(|| format!("{estimator} was not measured with {spp} samples, {}", points.name()))
}

/// Of the progress bar, for one scene.
pub(super) fn work(scene: &Scene, seeds: u32) -> u64 {
    let spp = u64::from(SPP.iter().sum::<u32>());
    u64::from(seeds) * spp * (Points::of(scene).len() as u64 + 1)
}

/// What measuring needs.
pub(super) struct Measurement<'a> {
    pub(super) oracle: &'a Oracle,
    pub(super) scene: &'static Scene,
    pub(super) view: &'a View,
    pub(super) seeds: u32,
    pub(super) bar: &'a ProgressBar,
}

impl Measurement<'_> {
    pub(super) fn everything(&self, model: Model) -> Result<Vec<Way>> {
        let mut all = Vec::new();
        for spp in SPP {
            for points in Points::of(self.scene) {
                all.extend(self.ways(model, spp, points, &self.scene.estimators())?);
            }
        }
        Ok(all)
    }

    /// The default beside the plain mean, random samples.
    pub(super) fn default(&self, model: Model) -> Result<Vec<Way>> {
        let ways = SPP.map(|spp| self.ways(model, spp, Points::Random, &["mc", "robust"]));
        Ok(ways.into_iter().collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
    }

    fn ways(&self, model: Model, spp: u32, points: Points, estimators: &[&'static str]) -> Result<Vec<Way>> {
        let sampler = points.sampler(spp);
        let request = Request { model, spp, order: ORDER, sampler, estimators, seeds: self.seeds };
        let renderings = self.oracle.render(self.view, &request)?;
        self.bar.inc(u64::from(self.seeds) * u64::from(spp));
        let reference = &self.view.reference;
        let ways = estimators.iter().zip(renderings).map(|(&estimator, one)| {
            Ok(Way {
                spp,
                points,
                estimator,
                rel_mse: one.images.iter().map(|image| reference.rel_mse(image)).collect(),
                filtered: one.images.iter().map(|image| score::errors(image, reference)[1]).collect(),
                nanoseconds: one.timings.iter().map(|timing| timing.estimating_ns_per_sample).collect(),
                image: one.images.into_iter().next().context("no seed was rendered")?,
            })
        });
        ways.collect()
    }
}
