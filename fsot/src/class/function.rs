//! Class functions.

use crate::Error;
use crate::error::Result;
use serde::Deserialize;

/// The least standard deviation of a Gaussian: the squares of much smaller ones are 0.
pub(crate) const MIN_SIGMA: f32 = 1e-18;

/// A piece of a staircase.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Where it ends (it begins where the one before ends, the first at 0), in (0, 1].
    pub to: f32,
    /// The function's value on it, in [0, 1].
    pub value: f32,
}

/// A class function w (section 5.3.1): how much the point at a class coordinate takes part in the class, in [0, 1].
///
/// The points with `w > z` make the subclass of threshold z. A coordinate is a number in [0, 1) (the index space of the
/// points), or two (the image plane); a function of one number uses the first.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ClassFunction {
    /// 1 everywhere.
    Constant,
    /// 1 on [from, to), else 0.
    Box {
        /// Where it begins.
        from: f32,
        /// Where it ends.
        to: f32,
    },
    /// 1 on a rectangle of the image plane, else 0.
    Rectangle {
        /// The lower corner, included.
        from: [f32; 2],
        /// The upper corner, excluded.
        to: [f32; 2],
    },
    /// Constant on pieces, 0 behind the last one.
    Staircase(Vec<Step>),
    /// The coordinate (rising), or one minus the coordinate.
    Ramp {
        /// Whether it rises.
        rising: bool,
    },
    /// exp(-|c - center|^2 / (2 sigma^2)), with a center of one or two numbers.
    Gaussian {
        /// Where it is 1.
        center: Vec<f32>,
        /// Its standard deviation, at least 1e-18.
        sigma: f32,
    },
    /// Values at equidistant coordinates from 0 to 1, linear between them; one value is a constant.
    Tabulated(Vec<f32>),
}

impl ClassFunction {
    /// The function at a class coordinate of one or two numbers; 0 for none.
    pub fn value(&self, c: &[f32]) -> f32 {
        let Some(&x) = c.first() else { return 0.0 };
        match self {
            ClassFunction::Constant => 1.0,
            ClassFunction::Box { from, to } => indicator(x >= *from && x < *to),
            ClassFunction::Rectangle { from, to } => {
                indicator(c.iter().zip(from.iter().zip(to)).all(|(c, (from, to))| c >= from && c < to))
            }
            ClassFunction::Staircase(steps) => {
                steps.get(steps.partition_point(|step| step.to <= x)).map_or(0.0, |step| step.value)
            }
            ClassFunction::Ramp { rising } => (if *rising { x } else { 1.0 - x }).clamp(0.0, 1.0),
            ClassFunction::Gaussian { center, sigma } => {
                let squared: f32 = c.iter().zip(center).map(|(c, center)| (c - center) * (c - center)).sum();
                libm::expf(-squared / (2.0 * sigma * sigma))
            }
            ClassFunction::Tabulated(values) => {
                let last = values.len().saturating_sub(1);
                let position = x.clamp(0.0, 1.0) * last as f32;
                let left = (position as usize).min(last);
                match values.get(left..) {
                    Some([a, b, ..]) => a + (b - a) * (position - left as f32),
                    Some([a]) => *a,
                    _ => 0.0,
                }
            }
        }
    }

    /// Checks what the variants promise. `name` is the class's, for the message.
    pub fn check(&self, name: &str) -> Result<()> {
        let unit = |value: f32| (0.0..=1.0).contains(&value);
        let fail = |what: String| Err(Error::Input(format!("class {name:?}: {what}")));
        match self {
            ClassFunction::Constant | ClassFunction::Ramp { .. } => Ok(()),
            ClassFunction::Box { from, to } if unit(*from) && unit(*to) && from < to => Ok(()),
            ClassFunction::Box { from, to } => {
                fail(format!("a box from {from} to {to}: give two numbers in [0, 1], the smaller first"))
            }
            ClassFunction::Rectangle { from, to } => {
                if (0..2).all(|k| unit(from[k]) && unit(to[k]) && from[k] < to[k]) {
                    Ok(())
                } else {
                    fail(format!("a rectangle from {from:?} to {to:?}: give corners in [0, 1], the lower one first"))
                }
            }
            ClassFunction::Staircase(steps) => {
                let mut before = 0.0;
                for step in steps {
                    if !(step.to > before && step.to <= 1.0) {
                        return fail(format!(
                            "a step ends at {} behind one that ends at {before}: steps must rise to at most 1",
                            step.to
                        ));
                    }
                    if !unit(step.value) {
                        return fail(format!("a step has the value {}: values are in [0, 1]", step.value));
                    }
                    before = step.to;
                }
                if steps.is_empty() { fail("a staircase without steps: give at least one".into()) } else { Ok(()) }
            }
            ClassFunction::Gaussian { center, sigma } => {
                if center.is_empty() || center.len() > 2 || !center.iter().all(|c| c.is_finite()) {
                    fail(format!("a Gaussian around {center:?}: give one or two finite numbers"))
                } else if !(*sigma >= MIN_SIGMA && sigma.is_finite()) {
                    fail(format!("a Gaussian with sigma {sigma}: give a finite number of at least {MIN_SIGMA:e}"))
                } else {
                    Ok(())
                }
            }
            ClassFunction::Tabulated(values) => match values.iter().find(|&&value| !unit(value)) {
                Some(value) => fail(format!("the table holds {value}: values are in [0, 1]")),
                None if values.is_empty() => fail("the table is empty: give at least one value".into()),
                None => Ok(()),
            },
        }
    }

    /// How many numbers its class coordinate has at most: 1, or 2 for functions of the image plane.
    pub fn coordinates(&self) -> usize {
        match self {
            ClassFunction::Rectangle { .. } => 2,
            ClassFunction::Gaussian { center, .. } => center.len().clamp(1, 2),
            _ => 1,
        }
    }
}

fn indicator(inside: bool) -> f32 {
    if inside { 1.0 } else { 0.0 }
}
