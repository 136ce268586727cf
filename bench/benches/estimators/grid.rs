//! Every estimator x basis x order x integrand x n.

use crate::functions::{Function, sines};
use crate::race::{Effort, Result, Setting, measure};
use noisefloor::basis::Family;
use noisefloor_bench::Method;
use noisefloor_bench::method::{GRADIENT_DESCENT, INCREMENTAL, K_FOLD, LEAST_SQUARES, LEAVE_ONE_OUT, ROBUST};
use noisefloor_tests::integrands;

pub(crate) const COUNTS: [usize; 3] = [16, 64, 256];
const ESTIMATORS: [Method; 6] = [ROBUST, LEAST_SQUARES, LEAVE_ONE_OUT, K_FOLD, GRADIENT_DESCENT, INCREMENTAL];
const BASES: [Family; 4] = [Family::Legendre, Family::Step, Family::Sine, Family::Gaussian];
const ORDERS: [usize; 5] = [1, 2, 3, 5, 7];
/// Order 7 of three coordinates has 120 terms: figure 4.16 has it, the grid of four bases has not.
const DIMS_OF_ORDER_7: usize = 2;

/// A row of the table.
pub(crate) struct Row {
    pub(crate) set: &'static str,
    pub(crate) integrand: String,
    pub(crate) dims: usize,
    pub(crate) n: usize,
    pub(crate) result: Result,
}

pub(crate) fn functions() -> Vec<(&'static str, Function)> {
    let sets = [
        ("nine", integrands::nine()),
        ("held out", integrands::held_out()),
        ("adversarial", integrands::adversarial()),
    ];
    let all = sets.into_iter().flat_map(|(set, list)| list.into_iter().map(move |one| (set, Function::from(one))));
    all.chain([("figure 4.6", sines(15))]).collect()
}

fn settings(dims: usize) -> Vec<Setting> {
    let mut settings = Vec::new();
    for estimator in ESTIMATORS {
        for basis in BASES {
            let orders = ORDERS.into_iter().filter(|&order| order < 7 || dims <= DIMS_OF_ORDER_7);
            settings.extend(orders.map(|order| Setting { method: Method { basis, ..estimator }, order }));
        }
    }
    settings
}

/// One function at one sample count, every setting.
pub(crate) fn rows(set: &'static str, function: &Function, seed: u64, n: usize, effort: Effort) -> Vec<Row> {
    let (integrand, dims) = (&function.name, function.dims);
    let results = measure(function, &settings(dims), n, seed, effort);
    results.into_iter().map(|result| Row { set, integrand: integrand.clone(), dims, n, result }).collect()
}
