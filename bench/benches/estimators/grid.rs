//! Every estimator x basis x order x integrand x n.

use crate::functions::{Function, sines};
use crate::race::{Effort, Result, Setting, measure};
use noisefloor::basis::Family;
use noisefloor_bench::Method;
use noisefloor_bench::method::{GRADIENT_DESCENT, INCREMENTAL, K_FOLD, LEAST_SQUARES, LEAVE_ONE_OUT, ROBUST};
use noisefloor_tests::integrands;

pub(crate) const COUNTS: [usize; 3] = [16, 64, 256];
const ESTIMATORS: [Method; 6] = [ROBUST, LEAST_SQUARES, LEAVE_ONE_OUT, K_FOLD, GRADIENT_DESCENT, INCREMENTAL];
const ORDERS: [usize; 5] = [1, 2, 3, 5, 7];
/// Order 7 of three coordinates has 120 terms.
const DIMS_OF_ORDER_7: usize = 2;

/// A row of the table.
pub(crate) struct Row {
    pub(crate) integrand: String,
    pub(crate) dims: usize,
    pub(crate) n: usize,
    pub(crate) result: Result,
}

pub(crate) fn functions() -> Vec<Function> {
    let sets = [integrands::nine(), integrands::held_out(), integrands::adversarial()];
    sets.into_iter().flatten().map(Function::from).chain([sines(15)]).collect()
}

fn settings(dims: usize) -> Vec<Setting> {
    let mut settings = Vec::new();
    for estimator in ESTIMATORS {
        for basis in Family::ALL {
            let orders = ORDERS.into_iter().filter(|&order| order < 7 || dims <= DIMS_OF_ORDER_7);
            settings.extend(orders.map(|order| Setting { method: Method { basis, ..estimator }, order }));
        }
    }
    settings
}

/// One function at one sample count, every setting.
pub(crate) fn rows(function: &Function, seed: u64, n: usize, effort: Effort) -> Vec<Row> {
    let (integrand, dims) = (&function.name, function.dims);
    let results = measure(function, &settings(dims), n, seed, effort);
    results.into_iter().map(|result| Row { integrand: integrand.clone(), dims, n, result }).collect()
}
