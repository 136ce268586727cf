//! What a problem must fulfil.

use super::problem::{Domain, Problem};
use crate::Error;
use crate::class::{ClassCoordinates, check_weight};
use crate::counted::counted;
use crate::error::Result;
use crate::target::MAX_DIMS;

/// The most points: their numbers and those of their coordinates fit 32 bits.
const MAX_POINTS: usize = 1 << 28;

pub(super) fn check(problem: &Problem) -> Result<()> {
    let fail = |what: String| Err(Error::Input(what));
    let (points, dims) = (problem.points, problem.dims);
    if points == 0 || points > MAX_POINTS {
        return fail(format!("{points} points: give 1 to {MAX_POINTS}"));
    }
    if dims == 0 || dims > MAX_DIMS {
        return fail(format!("{dims} dimensions: give 1 to {MAX_DIMS}"));
    }
    if !(0.0..=1.0).contains(&problem.axis_priority) {
        return fail(format!("axis priority {}: give a probability, 0 to 1", problem.axis_priority));
    }
    check_classes(problem)?;
    if let ClassCoordinates::Plane(places) = &problem.class_coordinates {
        if places.len() != points {
            return fail(format!(
                "{} for {}: give one per point",
                counted(places.len(), "class coordinate"),
                counted(points, "point")
            ));
        }
        if let Some(place) = places.iter().flatten().find(|c| !(0.0..=1.0).contains(*c)) {
            return fail(format!("a class coordinate is {place}: give numbers in [0, 1]"));
        }
    }
    if let Some(initial) = &problem.initial {
        if initial.dims() != dims || initial.len() != points {
            let (given, given_dims) = (initial.len(), initial.dims());
            return fail(format!(
                "{} of {}, for {points} of {dims}",
                counted(given, "initial point"),
                counted(given_dims, "dimension")
            ));
        }
        if let Some(x) = initial.coordinates().iter().find(|x| !(0.0..1.0).contains(*x)) {
            return fail(format!("an initial coordinate is {x}: give numbers in [0, 1)"));
        }
    }
    Ok(())
}

fn check_classes(problem: &Problem) -> Result<()> {
    let fail = |what: String| Err(Error::Input(what));
    if problem.classes.is_empty() {
        return fail("no class: give at least one".into());
    }
    for class in &problem.classes {
        let name = &class.name;
        class.function.check(name)?;
        check_weight(class.weight, name)?;
        if class.target.dims() != problem.dims {
            let dims = class.target.dims();
            return fail(format!(
                "class {name:?}: a target of {} for points of {}",
                counted(dims, "dimension"),
                problem.dims
            ));
        }
        if class.function.coordinates() > 1 && problem.class_coordinates == ClassCoordinates::Index {
            return fail(format!(
                "class {name:?}: its function is one of the image plane, but points have only an index"
            ));
        }
        if problem.domain == Domain::Toroidal && !class.target.is_uniform() {
            return fail(format!("class {name:?}: only uniform targets can be on a torus: use the bounded domain"));
        }
    }
    if problem.classes.iter().all(|class| class.weight == 0.0) {
        return fail("all classes have weight 0: give at least one that counts".into());
    }
    Ok(())
}
