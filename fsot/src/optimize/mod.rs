//! The optimiser: stochastic descent on the sliced multi-class barycenter (section 5.4).

mod check;
mod contested;
mod cut;
mod direction;
mod group;
mod initial;
mod optimizer;
mod problem;
mod rank;
mod schedule;
mod slice;
#[cfg(test)]
mod tests;
mod window;

pub use optimizer::Optimizer;
pub use problem::{Domain, Problem, Quality};

use crate::error::Result;
use crate::points::Points;
use crate::run::Optimization;

/// Takes all steps of an optimisation, on the threads of the current rayon pool.
pub fn optimize(problem: Problem) -> Result<Points> {
    let mut optimizer = Optimizer::new(problem)?;
    optimizer.run();
    Ok(optimizer.points())
}
