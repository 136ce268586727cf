//! The convergence plots of chapter 4, on functions whose integrals are known.

use crate::functions::{Function, exponential, lights, of_one_dimension, sines};
use crate::race::{Effort, Result, Setting, measure};
use noisefloor::basis::Family;
use noisefloor_bench::Method;
use noisefloor_bench::method::{GRADIENT_DESCENT, INCREMENTAL, LEAST_SQUARES, ROBUST};
use noisefloor_tests::integrands;

/// One point of a plot.
pub(crate) struct Row {
    pub(crate) figure: &'static str,
    pub(crate) panel: String,
    /// Samples, or for figure 4.15 lights.
    pub(crate) x: usize,
    pub(crate) n: usize,
    /// The integrand's standard deviation.
    pub(crate) deviation: f64,
    pub(crate) result: Result,
}

/// A plot of several functions and settings.
struct Figure {
    name: &'static str,
    functions: Vec<Function>,
    settings: Vec<Setting>,
    counts: std::ops::RangeInclusive<u32>,
}

fn with(method: Method, orders: &[usize]) -> Vec<Setting> {
    orders.iter().map(|&order| Setting { method, order }).collect()
}

fn named(name: &str) -> Function {
    let found = integrands::all().into_iter().find(|integrand| integrand.name == name);
    found.unwrap_or_else(|| panic!("there is no integrand `{name}`")).into()
}

/// Counts are powers of two.
fn figures() -> Vec<Figure> {
    let listing = integrands::nine()[0];
    let bases = [Family::Legendre, Family::Step, Family::Sine, Family::Gaussian];
    let basis = |basis| Setting { method: Method { basis, ..ROBUST }, order: 2 };
    let direct_and_descent = [with(LEAST_SQUARES, &[2, 5, 7]), with(GRADIENT_DESCENT, &[2, 5, 7])].concat();
    let incremental = [with(GRADIENT_DESCENT, &[2]), with(INCREMENTAL, &[2]), with(LEAST_SQUARES, &[2])].concat();
    vec![
        Figure {
            name: "4.3",
            functions: of_one_dimension(listing).into(),
            settings: [with(LEAST_SQUARES, &[1, 3, 5]), with(ROBUST, &[5])].concat(),
            counts: 2..=10,
        },
        Figure {
            name: "4.5",
            functions: ["four lights", "step", "exp 2D"].map(named).into(),
            settings: [with(LEAST_SQUARES, &[1, 2, 3]), with(ROBUST, &[1, 2, 3])].concat(),
            counts: 2..=10,
        },
        Figure {
            name: "4.6",
            functions: [1, 5, 15].into_iter().flat_map(|dims| [sines(dims), exponential(dims)]).collect(),
            settings: [with(LEAST_SQUARES, &[1, 2]), with(ROBUST, &[1, 2])].concat(),
            counts: 3..=10,
        },
        Figure {
            name: "4.14",
            functions: ["exp 2D", "sines 2D", "step", "disc"].map(named).into(),
            settings: bases.map(basis).into(),
            counts: 3..=10,
        },
        Figure { name: "4.16", functions: vec![named("four lights")], settings: direct_and_descent, counts: 4..=10 },
        Figure {
            name: "4.17",
            functions: ["four lights", "exp 2D"].map(named).into(),
            settings: incremental,
            counts: 3..=10,
        },
    ]
}

/// All rows; `step` is told of each finished point.
pub(crate) fn rows(effort: Effort, mut step: impl FnMut(&str)) -> Vec<Row> {
    let mut rows = Vec::new();
    for (seed, figure) in figures().iter().enumerate() {
        for function in &figure.functions {
            let deviation = function.deviation();
            for n in figure.counts.clone().map(|power| 1 << power) {
                let results = measure(function, &figure.settings, n, 100 + seed as u64, effort);
                let row =
                    |result| Row { figure: figure.name, panel: function.name.clone(), x: n, n, deviation, result };
                rows.extend(results.into_iter().map(row));
                step(figure.name);
            }
        }
    }
    rows.extend(many_lights(effort, step));
    rows
}

/// How many points [`rows`] has.
pub(crate) fn steps() -> usize {
    figures().iter().map(|figure| figure.functions.len() * figure.counts.clone().count()).sum::<usize>() + LIGHTS.len()
}

const LIGHTS: [usize; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
/// As in the thesis.
const SAMPLES: usize = 1024;

/// Figure 4.15: the ratio against the number of lights.
fn many_lights(effort: Effort, mut step: impl FnMut(&str)) -> Vec<Row> {
    let mut rows = Vec::new();
    for count in LIGHTS {
        let function = lights(count);
        let deviation = function.deviation();
        let mut settings = [with(LEAST_SQUARES, &[1, 2, 3]), with(ROBUST, &[2])].concat();
        if count > 1 {
            settings.push(Setting { method: Method { slices: count, ..ROBUST }, order: 2 });
        }
        let results = measure(&function, &settings, SAMPLES, 200, effort);
        let row = |result| Row { figure: "4.15", panel: "lights".into(), x: count, n: SAMPLES, deviation, result };
        rows.extend(results.into_iter().map(row));
        step("4.15");
    }
    rows
}
