//! Streaming estimates: sums of fixed size that samples are added to and that can be merged.
//!
//! Leave-one-out errors need the samples, which are gone, so the robust estimate here trusts held-out errors instead:
//! sample i of an accumulator is summed into fold i mod K, and each fold judges the fits to the other folds.

use super::config::{Config, Estimate, Estimator, Ridge, Solver};
use super::cross_fit;
use super::design::Units;
use super::incremental;
use super::moments::{self, Centred, Moments, MomentsMut};
use super::per_channel::{PerChannel, add, get, set};
use super::result::{self, Outcome, Summary};
use super::ridge;
use super::samples::{Reader, Samples, Subset};
use super::{gradient_descent, square_root};
use crate::arena::Arena;
use crate::basis::{Basis, MAX_DIMS, MAX_TERMS};
use crate::error::Error;
use crate::lanes::Lanes;
use crate::linalg::{givens, row};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// A fixed-size accumulator over `sums`, a buffer of [`Accumulator::len`] numbers: an array, a slice, a vector.
///
/// ```
/// use noisefloor::control_variate::{Accumulator, Config, Samples};
///
/// let config = Config::new(2, 2, 1);
/// let mut accumulator = Accumulator::<f64, _>::new(&config, [0.0; 112])?;
/// accumulator.add(Samples::new(&[0.1, 0.7, 0.5, 0.2], &[1.0, 3.0]))?;
/// let estimate = accumulator.estimate(&mut [0.0; 256])?;
/// assert_eq!(estimate.samples, 2);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Accumulator<R, S> {
    state: State<R>,
    sums: S,
}

/// All of an [`Accumulator`] but its buffer: plain data, to be stored beside the buffer and joined with it again.
#[derive(Clone, Copy, Debug)]
pub struct State<R> {
    config: Config,
    columns: usize,
    channels: usize,
    samples: u64,
    units: [Units<R>; Config::MAX_CHANNELS],
    /// Sums of red, green, blue and luminance, for a luminance ratio.
    colour: [f64; 4],
    incremental: incremental::Progress<R>,
}

impl<R: Real> State<R> {
    /// # Errors
    /// [`Error::Unsupported`] for [`Estimator::LeaveOneOut`], which needs all samples at once, and whatever
    /// [`Config::terms`] finds.
    pub fn new(config: &Config) -> Result<Self, Error> {
        let columns = config.controls + config.checked_shape()?.columns();
        let square_root = config.solver == Solver::SquareRoot;
        let supported = match config.estimator {
            Estimator::LeaveOneOut => false,
            Estimator::LeastSquares => config.ridge != Ridge::Auto,
            _ => !square_root,
        };
        if !supported || config.solver == Solver::Dual {
            return Err(Error::Unsupported);
        }
        let luminance = config.color == super::config::Color::LuminanceRatio;
        Ok(Self {
            config: *config,
            columns,
            channels: if luminance { 1 } else { config.channels },
            samples: 0,
            units: [Units::default(); Config::MAX_CHANNELS],
            colour: [0.0; 4],
            incremental: incremental::Progress::default(),
        })
    }

    fn terms(&self) -> usize {
        self.columns + 1
    }

    /// Numbers of one group of sums.
    fn group(&self) -> usize {
        moments::len(self.terms(), self.channels)
    }

    /// Groups of sums: one for each fold, or one.
    fn groups(&self) -> usize {
        match self.config.estimator {
            Estimator::Robust | Estimator::KFold => self.config.fold_count(),
            _ => 1,
        }
    }

    /// Numbers of the whole buffer.
    pub fn len(&self) -> usize {
        let extra = match self.config.estimator {
            Estimator::Incremental => incremental::len(self.columns, self.channels),
            _ => 0,
        };
        self.groups() * self.group() + extra
    }

    /// Never: an accumulator has at least the sums of a constant.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Numbers of workspace that an estimate takes.
    pub fn workspace_len(&self) -> usize {
        let (columns, channels) = (self.columns, self.channels);
        let solve = moments::solve_len(columns);
        let fit = moments::centred_len(columns, channels) + columns * (1 + channels) + solve;
        match self.config.estimator {
            Estimator::Robust | Estimator::KFold => cross_fit::len(columns, channels) + self.group() + fit,
            Estimator::GradientDescent => fit + gradient_descent::size(columns, channels),
            _ if self.config.solver == Solver::SquareRoot => square_root::size(self.terms(), channels) + self.group(),
            _ => fit,
        }
    }

    /// Samples added so far.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// What it was made with.
    pub fn config(&self) -> &Config {
        &self.config
    }
}

impl<R: Real, S: AsRef<[R]> + AsMut<[R]>> Accumulator<R, S> {
    /// Numbers of `sums` that a configuration needs.
    ///
    /// # Errors
    /// As for [`Accumulator::new`].
    pub fn len(config: &Config) -> Result<usize, Error> {
        Ok(State::<R>::new(config)?.len())
    }

    /// Numbers of workspace that [`Accumulator::estimate`] needs.
    ///
    /// # Errors
    /// As for [`Accumulator::new`].
    pub fn workspace_len(config: &Config) -> Result<usize, Error> {
        Ok(State::<R>::new(config)?.workspace_len())
    }

    /// An empty accumulator; `sums` is cleared.
    ///
    /// # Errors
    /// [`Error::Memory`] if `sums` is too short, [`Error::Range`] or [`Error::Unsupported`] for the configuration.
    pub fn new(config: &Config, sums: S) -> Result<Self, Error> {
        let mut accumulator = Self { state: State::new(config)?, sums };
        if accumulator.sums.as_ref().len() < accumulator.state.len() {
            return Err(Error::Memory);
        }
        accumulator.reset();
        Ok(accumulator)
    }

    /// Forgets all samples.
    pub fn reset(&mut self) {
        let state = &mut self.state;
        state.samples = 0;
        state.units = [Units::default(); Config::MAX_CHANNELS];
        state.colour = [0.0; 4];
        state.incremental = incremental::Progress::default();
        for value in self.sums.as_mut() {
            *value = R::ZERO;
        }
    }

    /// Adds samples, all or, on an error, none.
    ///
    /// # Errors
    /// As for [`estimate`](super::estimate); adding no samples is an error too.
    pub fn add(&mut self, samples: Samples<'_>) -> Result<(), Error> {
        let config = self.state.config;
        let reader = Reader::new(&config, samples)?;
        reader.check()?;
        let mut basis = Basis::empty();
        config.set_basis(config.checked_shape()?, &mut basis)?;
        let mut p = [[R::ONE]; MAX_TERMS];
        let terms = self.state.terms();
        let mut x = [[R::ZERO; 1]; MAX_DIMS];
        let mut h = [[R::ZERO; 1]; Config::MAX_CONTROLS];
        reader.each(Subset::All, |sample| {
            sample.put(0, &mut x, &mut h);
            reader.columns(&basis, &x, &h, p.get_mut(1..terms).unwrap_or(&mut []));
            if let Some(colour) = reader.colour(sample) {
                for (sum, value) in self.state.colour.iter_mut().zip(colour) {
                    *sum += value;
                }
            }
            self.add_row(p.get_mut(..terms).unwrap_or(&mut []), reader.values(sample));
        });
        Ok(())
    }

    /// Adds one evaluated sample.
    #[inline(always)]
    fn add_row(&mut self, p: &mut [Lanes<R, 1>], values: PerChannel<R>) {
        let state = &mut self.state;
        let (terms, channels, group) = (state.terms(), state.channels, state.group());
        let groups = state.groups();
        let sums = self.sums.as_mut();
        fit_units(state, &values, sums);
        let mut f = PerChannel::default();
        for ((f, value), unit) in f.iter_mut().zip(values).zip(&state.units) {
            *f = value * R::ONE.scale(-unit.exponent) - unit.offset;
        }
        let f = f.get_mut(..channels).unwrap_or(&mut []);
        let p = p.as_flattened_mut();
        if state.config.estimator == Estimator::Incremental {
            let (group, rest) = sums.split_at_mut_checked(group).unwrap_or((&mut [], &mut []));
            incremental::correct(&mut state.incremental, state.config.ridge, rest, p.get(1..).unwrap_or(&[]), f);
            if let Some(mut moments) = MomentsMut::new(group, terms, channels) {
                moments.add(p, f);
            }
            state.samples += 1;
            incremental::refit(state.samples, &mut state.incremental, &state.config, group, rest, terms - 1, channels);
            return;
        }
        let fold = state.samples.checked_rem(groups as u64).unwrap_or(0) as usize;
        state.samples += 1;
        let sums = sums.get_mut(fold * group..(fold + 1) * group).unwrap_or(&mut []);
        if let Some(mut moments) = MomentsMut::new(sums, terms, channels) {
            if state.config.solver == Solver::SquareRoot {
                givens::add_row(moments.gram, moments.rhs, moments.square, p, f);
            } else {
                moments.add(p, f);
            }
        }
    }

    /// Adds all samples of another accumulator, fold to fold, as if they had been added here.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if the configurations differ.
    pub fn merge<T: AsRef<[R]>>(&mut self, other: &Accumulator<R, T>) -> Result<(), Error> {
        if self.state.config != other.state.config {
            return Err(Error::Mismatch);
        }
        if other.state.samples == 0 {
            return Ok(());
        }
        let state = &mut self.state;
        let (terms, channels, group) = (state.terms(), state.channels, state.group());
        let groups = state.groups();
        let sums = self.sums.as_mut();
        if state.samples == 0 {
            state.units = other.state.units;
        }
        raise_exponents(state, &other.state.units.map(|unit| unit.exponent), sums);
        let mut factors = [R::ONE; Config::MAX_CHANNELS];
        let mut shift = PerChannel::default();
        let units = other.state.units.iter().zip(&state.units);
        for (((theirs, ours), factor), shift) in units.zip(&mut factors).zip(&mut shift) {
            *factor = R::ONE.scale(theirs.exponent - ours.exponent);
            *shift = theirs.offset * *factor - ours.offset;
        }
        for fold in 0..groups {
            let range = fold * group..(fold + 1) * group;
            let ours = sums.get_mut(range.clone()).and_then(|sums| MomentsMut::new(sums, terms, channels));
            let theirs = other.sums.as_ref().get(range).and_then(|sums| Moments::new(sums, terms, channels));
            let (Some(mut ours), Some(theirs)) = (ours, theirs) else { continue };
            if state.config.solver == Solver::SquareRoot {
                merge_factors(&mut ours, &theirs, &factors, &shift, terms, channels);
            } else {
                ours.merge(&theirs, &factors, &shift, channels);
            }
        }
        for (sum, value) in state.colour.iter_mut().zip(other.state.colour) {
            *sum += value;
        }
        state.incremental.merge(&other.state.incremental, &factors, &shift, other.state.samples);
        state.samples += other.state.samples;
        if state.config.estimator == Estimator::Incremental {
            let (group, rest) = sums.split_at_mut_checked(group).unwrap_or((&mut [], &mut []));
            state.incremental.refit_now();
            incremental::refit(state.samples, &mut state.incremental, &state.config, group, rest, terms - 1, channels);
        }
        Ok(())
    }
}

impl<R: Real, S: AsRef<[R]>> Accumulator<R, S> {
    /// Joins a state and the buffer it was used with; both as they were when last taken apart.
    ///
    /// # Errors
    /// [`Error::Memory`] if the buffer is too short.
    pub fn from_parts(state: State<R>, sums: S) -> Result<Self, Error> {
        if sums.as_ref().len() < state.len() {
            return Err(Error::Memory);
        }
        Ok(Self { state, sums })
    }

    /// The state, to be kept beside the buffer.
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// The estimate from all samples so far. More may be added afterwards.
    ///
    /// # Errors
    /// [`Error::NoSamples`] if there are none, [`Error::Memory`] if `workspace` is shorter than
    /// [`Accumulator::workspace_len`] says.
    pub fn estimate(&self, workspace: &mut [R]) -> Result<Estimate, Error> {
        let state = &self.state;
        if state.samples == 0 {
            return Err(Error::NoSamples);
        }
        let mut arena = Arena::new(workspace);
        let total = Totals::new(self)?;
        let outcome = if state.columns == 0 || (state.config.stratified && state.config.estimator == Estimator::Robust)
        {
            total.plain()
        } else {
            match state.config.estimator {
                Estimator::Incremental => incremental::outcome(&state.incremental, state.samples).relative_to(&total),
                Estimator::Robust | Estimator::KFold => self.cross_fit(&total, &mut arena)?,
                Estimator::GradientDescent => {
                    let group = self.group(0).ok_or(Error::Memory)?;
                    self.descend(&group, &total, &mut arena)?
                }
                _ if state.config.solver == Solver::SquareRoot => {
                    let group = self.group(0).ok_or(Error::Memory)?;
                    let basis = self.basis()?;
                    square_root::from_factor(&group, &state.config, &basis, state.terms(), state.channels, &mut arena)?
                        .relative_to(&total)
                }
                _ => {
                    let group = self.group(0).ok_or(Error::Memory)?;
                    self.least_squares(&group, &total, &mut arena)?
                }
            }
        };
        let samples = state.samples;
        Ok(result::finish(
            Summary {
                samples: usize::try_from(samples).unwrap_or(usize::MAX),
                channels: state.channels,
                units: total.units,
                plain_variance: total.variance,
                colour: (state.config.color == super::config::Color::LuminanceRatio).then(|| {
                    let inverse = 1.0 / samples as f64;
                    let [red, green, blue, luminance] = state.colour.map(|sum| sum * inverse);
                    ([red, green, blue], luminance)
                }),
            },
            outcome,
        ))
    }

    #[inline(never)]
    fn basis(&self) -> Result<Basis, Error> {
        let mut basis = Basis::empty();
        self.state.config.set_basis(self.state.config.checked_shape()?, &mut basis)?;
        Ok(basis)
    }

    fn group(&self, fold: usize) -> Option<Moments<'_, R>> {
        let group = self.state.group();
        let sums = self.sums.as_ref().get(fold * group..(fold + 1) * group)?;
        Moments::new(sums, self.state.terms(), self.state.channels)
    }

    fn penalties<'a>(&self, gram: &[R], count: R, arena: &mut Arena<'a, R>) -> Result<&'a [R], Error> {
        let penalties = arena.take(self.state.columns)?;
        ridge::penalties(
            &self.state.config,
            &self.basis()?,
            |j| row(gram, j + 1).last().copied().unwrap_or(R::ZERO) / count,
            penalties,
        );
        Ok(penalties)
    }

    fn cross_fit(&self, total: &Totals<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let state = &self.state;
        let first = self.group(0).ok_or(Error::Memory)?;
        let penalties = self.penalties(first.gram, first.count(), arena)?;
        let groups = cross_fit::Groups {
            sums: self.sums.as_ref(),
            folds: state.groups(),
            columns: state.columns,
            channels: state.channels,
        };
        let nested = state.config.estimator == Estimator::KFold;
        let outcome = cross_fit::estimate(&groups, penalties, state.config.ridge, nested, arena)?;
        Ok(outcome.relative_to(total))
    }

    fn least_squares(
        &self,
        group: &Moments<'_, R>,
        total: &Totals<R>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Outcome<R>, Error> {
        let (columns, channels) = (self.state.columns, self.state.channels);
        let penalties = self.penalties(group.gram, group.count(), arena)?;
        let coefficients = arena.take(columns * channels)?;
        let Some(centred) = Centred::new(group, columns, channels, arena)? else { return Ok(total.plain()) };
        let strength = R::from_f64(ridge::least_squares::<R>(self.state.config.ridge));
        centred.solve(penalties, strength, coefficients, false, arena)?;
        Ok(in_sample(&centred, coefficients, total))
    }

    fn descend(
        &self,
        group: &Moments<'_, R>,
        total: &Totals<R>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Outcome<R>, Error> {
        let (columns, channels) = (self.state.columns, self.state.channels);
        let Some(centred) = Centred::new(group, columns, channels, arena)? else { return Ok(total.plain()) };
        let coefficients = arena.take(columns * channels)?;
        for value in coefficients.iter_mut() {
            *value = R::ZERO;
        }
        gradient_descent::descend(&centred, &self.state.config, &self.basis()?, coefficients, arena)?;
        Ok(in_sample(&centred, coefficients, total))
    }
}

/// The outcome of a fit to all samples: its intercept is the estimate.
fn in_sample<R: Real>(centred: &Centred<'_, R>, coefficients: &[R], total: &Totals<R>) -> Outcome<R> {
    let mut correction = PerChannel::default();
    let mut variance = PerChannel::default();
    let freedom = centred.count - R::from_usize(centred.columns + 1);
    for (channel, b) in rows(coefficients, centred.columns).enumerate() {
        let shift = centred.intercept(channel, b) - get(&centred.value_means, channel);
        set(&mut correction, channel, shift);
        let residual = centred.residual_square(channel, b);
        set(&mut variance, channel, residual / (freedom * centred.count));
    }
    let variance = if freedom > R::ZERO { Some(variance) } else { total.variance };
    Outcome { correction, variance }
}

/// What the sums say about the plain mean.
pub(crate) struct Totals<R> {
    /// The accumulator's units, moved so that zero is the plain mean.
    pub(crate) units: [Units<R>; Config::MAX_CHANNELS],
    /// The plain mean in the accumulator's units.
    pub(crate) mean: PerChannel<R>,
    /// The plain mean's variance.
    pub(crate) variance: Option<PerChannel<R>>,
}

impl<R: Real> Totals<R> {
    fn new<S: AsRef<[R]>>(accumulator: &Accumulator<R, S>) -> Result<Self, Error> {
        let state = &accumulator.state;
        let mut totals = PerChannel::default();
        let mut squares = PerChannel::default();
        for fold in 0..state.groups() {
            let group = accumulator.group(fold).ok_or(Error::Memory)?;
            for channel in 0..state.channels {
                let (total, square) = if state.config.solver == Solver::SquareRoot {
                    givens::first_column(group.gram, group.rhs, group.square, state.channels, channel)
                } else {
                    (group.total(channel), group.square(channel))
                };
                add(&mut totals, channel, total);
                add(&mut squares, channel, square);
            }
        }
        let n = R::from_f64(state.samples as f64);
        let mut result = Self { units: state.units, mean: PerChannel::default(), variance: None };
        let mut variance = PerChannel::default();
        for (channel, unit) in result.units.iter_mut().enumerate().take(state.channels) {
            let total = get(&totals, channel);
            let mean = total / n;
            unit.offset += mean;
            set(&mut result.mean, channel, mean);
            let square = Real::max(get::<R>(&squares, channel) - total * mean, R::ZERO);
            set(&mut variance, channel, square / (n * (n - R::ONE)));
        }
        result.variance = (state.samples > 1).then_some(variance);
        Ok(result)
    }

    fn plain(&self) -> Outcome<R> {
        Outcome { correction: PerChannel::default(), variance: self.variance }
    }
}

impl<R: Real> Outcome<R> {
    /// Turns an estimate in the accumulator's units into a correction of the plain mean.
    fn relative_to(mut self, total: &Totals<R>) -> Self {
        for (correction, &mean) in self.correction.iter_mut().zip(&total.mean) {
            *correction -= mean;
        }
        self
    }
}

/// Sets the units at the first sample, and keeps values of a narrow type near one.
fn fit_units<R: Real>(state: &mut State<R>, values: &PerChannel<R>, sums: &mut [R]) {
    if R::NARROW {
        raise_exponents(state, &values.map(|value| if value == R::ZERO { -126 } else { value.exponent() }), sums);
    }
    if state.samples == 0 {
        for (unit, &value) in state.units.iter_mut().zip(values) {
            unit.offset = value * R::ONE.scale(-unit.exponent);
        }
    }
}

/// Raises the units' exponents to at least those given, and rescales what was summed.
fn raise_exponents<R: Real>(state: &mut State<R>, exponents: &[i32; Config::MAX_CHANNELS], sums: &mut [R]) {
    let mut factors = [R::ONE; Config::MAX_CHANNELS];
    let mut any = false;
    let fresh = state.samples == 0;
    for ((unit, &exponent), factor) in state.units.iter_mut().zip(exponents).zip(&mut factors) {
        let exponent = exponent.clamp(-126, 126);
        if exponent > unit.exponent || (fresh && R::NARROW) {
            *factor = R::ONE.scale((unit.exponent - exponent).clamp(-149, 149));
            unit.offset *= *factor;
            unit.exponent = exponent;
            any = true;
        }
    }
    if !any || fresh {
        return;
    }
    let (terms, channels, group, groups) = (state.terms(), state.channels, state.group(), state.groups());
    let (folds, rest) = sums.split_at_mut_checked(groups * group).unwrap_or((&mut [], &mut []));
    for sums in rows_mut(folds, group) {
        if let Some(mut moments) = MomentsMut::new(sums, terms, channels) {
            moments.rescale(&factors, channels);
        }
    }
    state.incremental.rescale(&factors, rest, state.columns, channels);
}

/// Rotates the rows of another triangular factor into ours.
fn merge_factors<R: Real>(
    ours: &mut MomentsMut<'_, R>,
    theirs: &Moments<'_, R>,
    factors: &PerChannel<R>,
    shift: &PerChannel<R>,
    terms: usize,
    channels: usize,
) {
    let mut x = [R::ZERO; MAX_TERMS];
    let x = x.get_mut(..terms).unwrap_or(&mut []);
    for j in 0..terms {
        for (k, x) in x.iter_mut().enumerate() {
            *x = if k < j { R::ZERO } else { row(theirs.gram, k).get(j).copied().unwrap_or(R::ZERO) };
        }
        // The constant's column is the first, so a shift of the values is that many times column 0 of R.
        let first = if j == 0 { x.first().copied().unwrap_or(R::ZERO) } else { R::ZERO };
        let mut y = PerChannel::default();
        let z = theirs.rhs.get(j * channels..).unwrap_or(&[]);
        for (((y, &z), &factor), &shift) in y.iter_mut().zip(z).zip(factors).zip(shift) {
            *y = factor * z + shift * first;
        }
        givens::add_row(ours.gram, ours.rhs, ours.square, x, y.get_mut(..channels).unwrap_or(&mut []));
    }
    for ((square, &other), &factor) in ours.square.iter_mut().zip(theirs.square).zip(factors) {
        *square += factor * factor * other;
    }
}
