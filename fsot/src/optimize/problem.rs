//! What to optimise.

use crate::class::{Class, ClassCoordinates, single};
use crate::counted::counted;
use crate::points::Points;
use std::fmt;

/// The shape of the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Domain {
    /// The unit cube.
    #[default]
    Bounded,
    /// The unit torus: opposite faces are one. Needs uniform targets.
    Toroidal,
}

/// How long to optimise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// A few iterations: for trying out.
    Draft,
    /// Where further iterations begin to gain little.
    #[default]
    Standard,
    /// Several times as long.
    High,
    /// As many iterations as it says; 0 leaves the initial points.
    Iterations(u64),
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Quality::Draft => f.write_str("draft"),
            Quality::Standard => f.write_str("standard"),
            Quality::High => f.write_str("high"),
            Quality::Iterations(steps) => f.write_str(&counted(*steps, "step")),
        }
    }
}

/// What to optimise.
#[derive(Clone, Debug)]
pub struct Problem {
    /// How many points, 1 to 2^28.
    pub points: usize,
    /// Coordinates per point, 1 to 8.
    pub dims: usize,
    /// The classes, at least one.
    pub classes: Vec<Class>,
    /// Where the points are in the space of the class functions.
    pub class_coordinates: ClassCoordinates,
    /// The shape of the domain.
    pub domain: Domain,
    /// The probability that a slice is along an axis instead of a direction from the whole sphere, in [0, 1] (figure
    /// 5.7: .3).
    pub axis_priority: f32,
    /// Chooses all random numbers.
    pub seed: u64,
    /// How long to optimise.
    pub quality: Quality,
    /// Where the points begin; random places by default. Points at one place are moved apart.
    pub initial: Option<Points>,
}

impl Problem {
    /// One class of uniform points in the unit cube, at standard quality.
    pub fn new(points: usize, dims: usize) -> Problem {
        Problem {
            points,
            dims,
            classes: single(dims),
            class_coordinates: ClassCoordinates::Index,
            domain: Domain::Bounded,
            axis_priority: 0.0,
            seed: 0,
            quality: Quality::Standard,
            initial: None,
        }
    }
}
