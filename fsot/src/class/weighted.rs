//! A class and how much it counts.

use super::function::ClassFunction;
use crate::Error;
use crate::error::Result;
use crate::points::BELOW_ONE;
use crate::target::Target;
use std::sync::Arc;

/// A class (w, mu) and its weight kappa (5.17).
#[derive(Clone, Debug)]
pub struct Class {
    /// Which points it takes, and which subsets of them. Thresholds go up to its largest value at a point, not to 1.
    pub function: ClassFunction,
    /// What they shall be distributed like, at every threshold.
    pub target: Arc<dyn Target>,
    /// How much it counts beside the other classes; not negative, and not all 0. Weights are normalised to sum to 1.
    pub weight: f32,
    /// What a person calls it.
    pub name: String,
}

/// Where the points are in the space of the class functions.
#[derive(Clone, Debug, PartialEq)]
pub enum ClassCoordinates {
    /// Point i of n is at (i + 1/2) / n, below 1. As an `f32`: beyond 2^23 points neighbours share places.
    Index,
    /// Every point's place in the image plane, in [0, 1]^2.
    Plane(Vec<[f32; 2]>),
}

impl ClassCoordinates {
    /// A class function at point `i` of `points`.
    pub fn value(&self, function: &ClassFunction, i: usize, points: usize) -> f32 {
        match self {
            ClassCoordinates::Index => function.value(&[middle(i, points)]),
            ClassCoordinates::Plane(places) => places.get(i).map_or(0.0, |place| function.value(place)),
        }
    }
}

/// The middle of the `i`th of `count` parts of [0, 1): the last of 2^24 would be rounded to 1.
pub(crate) fn middle(i: usize, count: usize) -> f32 {
    (((i as f64 + 0.5) / count as f64) as f32).min(BELOW_ONE)
}

/// The weights of classes, normalised to sum to 1; empty classes (no members) have 0. `None` if nothing is left.
pub(crate) fn normalised(weights: impl Iterator<Item = (f32, bool)>) -> Option<Vec<f64>> {
    let mut weights: Vec<f64> = weights.map(|(weight, empty)| if empty { 0.0 } else { f64::from(weight) }).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    (sum > 0.0).then_some(weights)
}

pub(crate) fn check_weight(weight: f32, name: &str) -> Result<()> {
    if weight >= 0.0 && weight.is_finite() {
        Ok(())
    } else {
        Err(Error::Input(format!("class {name:?}: the weight is {weight}: give a finite number, 0 or more")))
    }
}
