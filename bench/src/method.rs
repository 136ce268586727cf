//! An estimator with its configuration, ready to be timed through the C functions.

use crate::c_abi;
use noisefloor::basis::Family;
use noisefloor::control_variate::{Accumulator, Config, Estimator, Samples};
use noisefloor::real::Real;

/// An estimator as it is compared.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Short and unique: it labels tables.
    pub name: &'static str,
    /// The plain mean if there is none.
    pub estimator: Option<Estimator>,
    /// Folds; 0 is the default.
    pub folds: usize,
    /// Whether `f32` is the accumulator instead of `f64`.
    pub narrow: bool,
    /// Whether samples are added one at a time to an accumulator.
    pub streaming: bool,
    /// The functions that are combined.
    pub basis: Family,
    /// Alternatives that the last coordinate picks from; 0 if it is a number.
    pub slices: usize,
}

const fn method(name: &'static str, estimator: Estimator) -> Method {
    Method {
        name,
        estimator: Some(estimator),
        folds: 0,
        narrow: false,
        streaming: false,
        basis: Family::Legendre,
        slices: 0,
    }
}

/// The plain mean, through the same functions: total degree 0.
pub const MEAN: Method = Method { estimator: None, ..method("mean", Estimator::Robust) };
/// The default.
pub const ROBUST: Method = method("robust", Estimator::Robust);
/// Least squares on its own samples.
pub const LEAST_SQUARES: Method = method("least squares", Estimator::LeastSquares);
/// One ridge fit, each sample corrected by the fit to all others.
pub const LEAVE_ONE_OUT: Method = method("leave-one-out", Estimator::LeaveOneOut);
/// Each of four folds corrected by a robust fit to the others.
pub const K_FOLD: Method = method("4-fold", Estimator::KFold);
/// The fit by gradient descent.
pub const GRADIENT_DESCENT: Method = method("gradient descent", Estimator::GradientDescent);
/// Each sample corrected by a fit to those before it.
pub const INCREMENTAL: Method = method("incremental", Estimator::Incremental);

/// Every estimator, the plain mean first and the default second, least squares third.
pub const METHODS: [Method; 12] = [
    MEAN,
    ROBUST,
    LEAST_SQUARES,
    LEAVE_ONE_OUT,
    K_FOLD,
    Method { folds: 2, ..method("2-fold", Estimator::KFold) },
    GRADIENT_DESCENT,
    INCREMENTAL,
    Method { streaming: true, ..method("robust streaming", Estimator::Robust) },
    Method { streaming: true, ..method("least squares streaming", Estimator::LeastSquares) },
    Method { narrow: true, ..method("robust f32", Estimator::Robust) },
    Method { narrow: true, ..method("least squares f32", Estimator::LeastSquares) },
];

impl Method {
    fn order(&self, order: usize) -> usize {
        if self.estimator.is_some() { order } else { 0 }
    }

    /// The Rust configuration for one channel.
    pub fn config(&self, dims: usize, order: usize) -> Config {
        let mut config = Config::new(dims, self.order(order), 1);
        config.estimator = self.estimator.unwrap_or_default();
        config.folds = self.folds;
        config.basis = self.basis;
        config.slices = self.slices;
        config
    }

    /// The C configuration for one channel.
    pub fn c_config(&self, dims: usize, order: usize) -> c_abi::Config {
        // Estimators and bases are in the order of their numbers in C.
        c_abi::Config {
            dims: dims as u32,
            order: self.order(order) as u32,
            channels: 1,
            estimator: self.estimator.unwrap_or_default() as u32,
            precision: self.narrow.into(),
            basis: self.basis as u32,
            slices: self.slices as u32,
            folds: self.folds as u32,
            ..c_abi::Config::default()
        }
    }

    /// Allocates what estimates from `n` samples need.
    pub fn prepare(&self, dims: usize, order: usize, n: usize) -> Prepared {
        let config = self.c_config(dims, order);
        match self.streaming {
            false => Prepared::Batch(c_abi::Batch::new(config, n)),
            true => Prepared::Stream(c_abi::Accumulator::new(config), dims),
        }
    }
}

/// A Rust accumulator with its workspace.
pub struct Stream<R> {
    accumulator: Accumulator<R>,
    sums: Vec<R>,
    workspace: Vec<R>,
}

impl<R: Real> Stream<R> {
    /// An empty accumulator.
    pub fn new(config: &Config) -> Self {
        let accumulator = Accumulator::new(config).expect("a streaming configuration");
        let [sums, workspace] = [accumulator.len(), accumulator.workspace_len()].map(|len| vec![R::ZERO; len]);
        Self { accumulator, sums, workspace }
    }

    /// Adds one sample for each value.
    pub fn add(&mut self, u: &[f32], f: &[f32]) {
        self.accumulator.add(&mut self.sums, Samples::new(u, f)).expect("valid samples");
    }

    /// The estimate so far.
    pub fn estimate(&mut self) -> f32 {
        self.accumulator.estimate(&self.sums, &mut self.workspace).expect("samples were added").mean[0]
    }
}

/// A method with its memory: estimating allocates nothing.
pub enum Prepared {
    /// All samples in a call.
    Batch(c_abi::Batch),
    /// One sample a call, of so many dims.
    Stream(c_abi::Accumulator, usize),
}

impl Prepared {
    /// One estimate from the samples this was prepared for; streaming methods add them one call at a time.
    #[inline]
    pub fn estimate(&mut self, u: &[f32], f: &[f32]) -> f32 {
        match self {
            Self::Batch(batch) => batch.estimate(u, f),
            Self::Stream(accumulator, dims) => {
                accumulator.reset();
                for (u, f) in u.chunks_exact(*dims).zip(f.chunks_exact(1)) {
                    accumulator.add(u, f);
                }
                accumulator.estimate()
            }
        }
    }
}
