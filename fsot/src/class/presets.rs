//! The class configurations of the chapter's figures.

use super::function::{ClassFunction, Step};
use super::weighted::Class;
use crate::target::{Target, Uniform};
use std::sync::Arc;

fn class(name: &str, function: ClassFunction, weight: f32, target: &Arc<dyn Target>) -> Class {
    Class { function, target: Arc::clone(target), weight, name: name.into() }
}

fn uniform(dims: usize) -> Arc<dyn Target> {
    Arc::new(Uniform::new(dims))
}

/// All points in one class.
pub fn single(dims: usize) -> Vec<Class> {
    vec![class("all", ClassFunction::Constant, 1.0, &uniform(dims))]
}

/// Figure 5.8: the first half of the points is red, the second blue; red, blue and their union are uniform.
///
/// A deviation: figure 5.5 gives each half and the union equal priority, here the union counts twice. Then neither it
/// nor the colors are much worse than they could be alone.
pub fn two_colors(dims: usize) -> Vec<Class> {
    let target = uniform(dims);
    vec![
        class("red", ClassFunction::Box { from: 0.0, to: 0.5 }, 1.0, &target),
        class("blue", ClassFunction::Box { from: 0.5, to: 1.0 }, 1.0, &target),
        class("all", ClassFunction::Constant, 2.0, &target),
    ]
}

/// Figure 5.9: thirds of the points are red, green and blue; each, each pair and all are uniform.
pub fn three_colors(dims: usize) -> Vec<Class> {
    let target = uniform(dims);
    let (a, b) = (1.0 / 3.0, 2.0 / 3.0);
    let split = vec![Step { to: a, value: 1.0 }, Step { to: b, value: 0.0 }, Step { to: 1.0, value: 1.0 }];
    vec![
        class("red", ClassFunction::Box { from: 0.0, to: a }, 1.0, &target),
        class("green", ClassFunction::Box { from: a, to: b }, 1.0, &target),
        class("blue", ClassFunction::Box { from: b, to: 1.0 }, 1.0, &target),
        class("red+green", ClassFunction::Box { from: 0.0, to: b }, 1.0, &target),
        class("green+blue", ClassFunction::Box { from: a, to: 1.0 }, 1.0, &target),
        class("red+blue", ClassFunction::Staircase(split), 1.0, &target),
        class("all", ClassFunction::Constant, 1.0, &target),
    ]
}

/// Figure 5.14: a falling and a rising ramp, so that the points before and behind any index are uniform, and all of
/// them.
pub fn ramp(dims: usize) -> Vec<Class> {
    let target = uniform(dims);
    vec![
        class("first", ClassFunction::Ramp { rising: false }, 1.0, &target),
        class("last", ClassFunction::Ramp { rising: true }, 1.0, &target),
    ]
}

/// Figure 5.17: one staircase whose `levels` prefixes are uniform; they end at `points^(k / levels)`, k = 1 to
/// `levels`. As many levels as points, or more, make a ramp: every prefix.
pub fn progressive(dims: usize, levels: usize, points: usize) -> Vec<Class> {
    let target = uniform(dims);
    if levels >= points.max(2) {
        return vec![class("prefixes", ClassFunction::Ramp { rising: false }, 1.0, &target)];
    }
    let ends = progressive_prefixes(levels, points);
    let steps = ends.iter().enumerate().map(|(k, &end)| Step {
        to: (end as f64 / points as f64) as f32,
        value: ((ends.len() - k) as f64 / ends.len() as f64) as f32,
    });
    vec![class("prefixes", ClassFunction::Staircase(steps.collect()), 1.0, &target)]
}

/// The lengths of the prefixes that [`progressive`] makes uniform, ascending; lengths that coincide count once.
pub fn progressive_prefixes(levels: usize, points: usize) -> Vec<usize> {
    let levels = levels.max(1);
    let mut ends: Vec<usize> = (1..=levels)
        .map(|k| libm::round(libm::pow(points as f64, k as f64 / levels as f64)) as usize)
        .map(|end| end.clamp(1, points.max(1)))
        .collect();
    ends.dedup();
    ends
}
