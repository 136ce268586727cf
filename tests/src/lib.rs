//! What the tests share: the oracle, the integrands, the statistics, and what the report measures too.

pub mod continued;
pub mod genz;
pub mod gradients;
pub mod integrands;
pub mod legendre;
pub mod minibatch;
pub mod oracle;
pub mod ordered;
pub mod planar;
pub mod random;
pub mod shared;
pub mod shared_bias;
pub mod shared_hard;
pub mod shared_tiles;
pub mod statistics;
pub mod stream;
pub mod tile;

use noisefloor::control_variate::Estimator;

/// Every estimator.
pub const ESTIMATORS: [Estimator; 6] = [
    Estimator::Robust,
    Estimator::LeastSquares,
    Estimator::LeaveOneOut,
    Estimator::KFold,
    Estimator::GradientDescent,
    Estimator::Incremental,
];
