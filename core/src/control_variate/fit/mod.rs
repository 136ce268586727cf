//! Least squares, one file for each way to solve it.
//!
//! | file | the system | for |
//! |---|---|---|
//! | [`normal`] | P'P + L, as large as there are functions (4.27) | samples and sums |
//! | [`dual`] | P L^-1 P' + I, as large as there are samples | fewer samples than functions |
//! | [`givens`] | a triangular factor of the rows, P'P is never formed | badly placed samples |
//! | [`descent`] | none: steps along the gradient (4.29) | samples and sums |
//!
//! The first two also say what each sample's residual is under the fit to the others: a [`Fit`].

pub(crate) mod descent;
pub(crate) mod dual;
pub(crate) mod givens;
pub(crate) mod normal;

use super::per_channel::PerChannel;

/// What one ridge fit says, in the design's units.
///
/// With the intercept free, columns centred (P), values centred (f), A = P'P + L and b = A^-1 P'f, the residual of
/// sample i under the fit to all others is
///
/// r_i = (f_i - b'p_i) / (1 - h_i),   h_i = 1/n + p_i' A^-1 p_i,
///
/// and the estimate that corrects each sample by the fit to the others is the mean of
///
/// y_i = f_i - b'q_i + (q_i' A^-1 p_i) r_i
///
/// where q_i = p_i + m is the column before centring, whose integral is zero. For a fixed L that mean is exactly
/// unbiased although every sample serves both the fit and the estimate.
///
/// The estimate of the fit to all, mean f - b'm, has the weight 1/n - m'A^-1 p_i on sample i. The sum of (1 - n m'A^-1
/// p_i)^2 r_i^2 is therefore n^2 times its variance whatever the noise depends on (White 1980; HC3 of MacKinnon and
/// White 1985).
#[derive(Clone, Copy, Default)]
pub(crate) struct Fit<R> {
    /// The sum of squared leave-one-out residuals.
    pub(crate) press: PerChannel<R>,
    /// The sum of squares of those residuals times n times the weight of their sample in the estimate.
    pub(crate) influence: PerChannel<R>,
    /// The mean of y_i minus the mean of f_i: what leaving one out adds to the plain mean.
    pub(crate) leave_one_out: PerChannel<R>,
    /// -b'm: what the fit to all samples adds to the plain mean (Alg. 1).
    pub(crate) in_sample: PerChannel<R>,
    /// n sum_i (m'A^-1 p_i)^2: how far the columns' means are from their integrals, as the fit measures distance.
    pub(crate) eccentricity: R,
    /// The effective number of coefficients, tr(P A^-1 P').
    pub(crate) freedom: R,
}

/// L, as a strength per sample times a relative penalty of each column.
#[derive(Clone, Copy)]
pub(crate) struct Penalty<'a, R> {
    pub(crate) strength: R,
    pub(crate) relative: &'a [R],
}
