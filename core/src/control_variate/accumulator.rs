//! Streaming estimates: sums of fixed size that samples are added to and that can be merged.

use super::config::{Color, Config, Estimate, Ridge};
use super::cross_fit::{self, Groups};
use super::design::Units;
use super::fit::{Penalty, descent, givens, normal};
use super::folds::{self, Subset};
use super::incremental;
use super::per_channel::PerChannel;
use super::plan::{self, Method, NARROW_CAPACITY};
use super::result::{Outcome, Summary};
use super::ridge;
use super::samples::{Reader, Samples};
use super::sums::{Change, Form, Layout};
use crate::arena::Arena;
use crate::basis::{Basis, MAX_DIMS, MAX_TERMS, Shape};
use crate::error::{Error, ensure};
use crate::lanes::Lanes;
use crate::matrix::{first_mut, from, from_mut, halves_mut};
use crate::real::Real;
use core::num::NonZeroUsize;

/// A streaming estimate of fixed size: everything but the sums themselves, a buffer of [`Accumulator::len`] numbers
/// that every method takes as the last call left it, the first as [`Accumulator::reset`] did. A shorter one is
/// [`Error::Memory`].
///
/// Leave-one-out errors need the samples, which are gone, so the robust estimate trusts held-out errors instead: runs
/// of samples are summed into folds, and each fold judges the fits to the other folds.
///
/// ```
/// use noisefloor::control_variate::{Accumulator, Config, Samples};
///
/// let new = || Accumulator::<f64>::new(&Config::new(1, 1, 1));
/// let (mut all, mut pass) = (new()?, new()?); // one of another thread, say
/// let mut sums = vec![0.0; 2 * all.len()]; // anywhere, such as one buffer for all pixels
/// let (all_sums, pass_sums) = sums.split_at_mut(pass.len());
/// all.reset(all_sums)?;
/// pass.reset(pass_sums)?;
/// pass.add(pass_sums, Samples::new(&[0.1, 0.3], &[1.1, 1.3]))?;
/// all.merge(all_sums, &pass, pass_sums)?;
/// let estimate = all.estimate(all_sums, &mut vec![0.0; all.workspace_len()])?;
/// assert_eq!(estimate.samples, 2);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Accumulator<R> {
    config: Config,
    shape: Shape,
    method: Method,
    layout: Layout,
    samples: u64,
    units: Units<R>,
    /// Sums of red, green, blue and luminance, for a luminance ratio.
    colour: PerChannel<f64>,
    incremental: incremental::Progress<R>,
}

impl<R: Real> Accumulator<R> {
    /// An accumulator without samples. Its memory must be [`reset`](Self::reset) before anything is added.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for what needs all samples at once, which are
    /// [`Estimator::LeaveOneOut`](super::Estimator::LeaveOneOut), [`Solver::Dual`](super::Solver::Dual), and
    /// [`Ridge::Auto`] of least squares; and what [`Config::terms`] finds.
    pub fn new(config: &Config) -> Result<Self, Error> {
        let shape = config.checked_shape()?;
        plan::check_stream(config)?;
        let columns = config.controls + shape.columns();
        let method = Method::of(config, columns);
        let (shape, columns) = if method == Method::Plain { (Shape::default(), 0) } else { (shape, columns) };
        let layout = Layout {
            form: if method == Method::SquareRoot { Form::Factor } else { Form::Products },
            columns,
            channels: config.regressed(),
        };
        Ok(Self {
            config: *config,
            shape,
            method,
            layout,
            samples: 0,
            units: Units::default(),
            colour: PerChannel::default(),
            incremental: incremental::Progress::default(),
        })
    }

    /// Groups of sums: one for each fold, or one.
    fn groups(&self) -> NonZeroUsize {
        match self.method {
            Method::Robust | Method::KFold => self.config.fold_count(),
            _ => NonZeroUsize::MIN,
        }
    }

    /// Numbers of the groups of sums.
    fn sums_len(&self) -> usize {
        self.groups().get() * self.layout.len()
    }

    /// Numbers of the whole buffer.
    #[allow(clippy::len_without_is_empty, reason = "an accumulator has at least the sums of a constant")]
    pub fn len(&self) -> usize {
        self.sums_len() + if self.method == Method::Incremental { incremental::len(self.layout) } else { 0 }
    }

    /// Numbers of workspace that an estimate takes.
    pub fn workspace_len(&self) -> usize {
        // Zero would say that there is no such accumulator.
        self.needed().max(1)
    }

    /// The same, none for estimates that take none.
    pub(crate) fn needed(&self) -> usize {
        let fit = normal::len(self.layout);
        match self.method {
            Method::Plain | Method::Incremental | Method::LeaveOneOut => 0,
            Method::LeastSquares => fit,
            Method::Robust | Method::KFold => cross_fit::len(self.layout) + fit,
            Method::Descent => fit + descent::size(self.layout.columns, self.layout.channels),
            Method::SquareRoot => givens::size(self.layout),
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

    /// What it uses of a buffer.
    fn used<'a>(&self, sums: &'a [R]) -> Result<&'a [R], Error> {
        sums.get(..self.len()).ok_or(Error::Memory)
    }

    fn used_mut<'a>(&self, sums: &'a mut [R]) -> Result<&'a mut [R], Error> {
        sums.get_mut(..self.len()).ok_or(Error::Memory)
    }

    /// Sums of a narrow type stop growing when they are too large for one more sample to show.
    fn check_capacity(&self, more: u64) -> Result<(), Error> {
        let total = self.samples.saturating_add(more);
        ensure(!R::NARROW || total <= NARROW_CAPACITY as u64, Error::Range)
    }

    /// Forgets all samples.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn reset(&mut self, sums: &mut [R]) -> Result<(), Error> {
        let sums = self.used_mut(sums)?;
        *self = Self::new(&self.config)?;
        sums.fill(R::ZERO);
        Ok(())
    }

    /// Adds samples, all or, on an error, none.
    ///
    /// # Errors
    /// As for [`estimate`](super::estimate), but that all samples may be skipped; in `f32` more than 2^22 in all are
    /// [`Error::Range`].
    pub fn add(&mut self, sums: &mut [R], samples: Samples<'_>) -> Result<(), Error> {
        let sums = self.used_mut(sums)?;
        let reader = Reader::new(&self.config, samples)?;
        reader.check()?;
        self.check_capacity(reader.len() as u64)?;
        let mut basis = Basis::empty();
        basis.set(self.config.basis, self.shape);
        let terms = self.layout.terms();
        let mut p = [[R::ZERO]; MAX_TERMS];
        p[0] = [R::ONE];
        let mut x = [[R::ZERO; 1]; MAX_DIMS];
        let mut h = [[R::ZERO; 1]; Config::MAX_CONTROLS];
        reader.each(Subset::ALL, |sample| {
            sample.put(0, &mut x, &mut h);
            reader.columns(&basis, &x, &h, from_mut(first_mut(&mut p, terms), 1));
            if let Some(colour) = reader.colour(sample) {
                self.colour += colour;
            }
            self.add_row(sums, first_mut(&mut p, terms), reader.values(sample));
            self.move_zero(self.samples - 1, sums);
        });
        Ok(())
    }

    /// Adds one evaluated sample.
    fn add_row(&mut self, sums: &mut [R], p: &mut [Lanes<R, 1>], values: PerChannel<R>) {
        // Values of a narrow type stay near one.
        if R::NARROW {
            self.raise_exponents(values.map(|value| if value == R::ZERO { -126 } else { value.exponent() }), sums);
        }
        let scaled = values * self.units.scales();
        if self.samples == 0 {
            self.units.offsets = scaled;
        }
        let mut f = scaled - self.units.offsets;
        let (p, f) = (p.as_flattened_mut(), first_mut(&mut f.0, self.layout.channels));
        let (groups, rest) = halves_mut(sums, self.sums_len());
        if self.method == Method::Incremental {
            self.incremental.correct(self.config.ridge, rest, from(p, 1), f);
        }
        let fold = folds::of_stream(self.samples, self.groups());
        self.layout.group_mut(groups, fold).add(p, f);
        self.samples = self.samples.saturating_add(1);
        if self.method == Method::Incremental {
            self.incremental.refit(self.samples, &self.config, self.shape, self.layout, groups, rest);
        }
    }

    /// Adds all samples of another accumulator, as if they had been added here, up to rounding, where there is
    /// one fold; of [`Estimator::Incremental`](super::Estimator::Incremental) each
    /// side's samples stay corrected by their own past.
    ///
    /// The robust estimate and K-fold put the other's folds where they make theirs most even: the same parts merged in
    /// the same order give the same bits, other splits of the same samples other folds, and estimates as good.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if the configurations differ; in `f32` [`Error::Range`] for more than 2^22 samples together.
    pub fn merge(&mut self, sums: &mut [R], other: &Self, other_sums: &[R]) -> Result<(), Error> {
        ensure(self.config == other.config, Error::Mismatch)?;
        let (sums, other_sums) = (self.used_mut(sums)?, other.used(other_sums)?);
        if other.samples == 0 {
            return Ok(());
        }
        self.check_capacity(other.samples)?;
        if self.samples == 0 {
            self.units = other.units;
        }
        self.raise_exponents(other.units.exponents, sums);
        let factors = other.units.exponents.zip(self.units.exponents, |theirs, ours| R::ONE.scale(theirs - ours));
        let change = Change { factors, shift: other.units.offsets * factors - self.units.offsets };
        let (layout, groups) = (self.layout, self.groups());
        let size = |sums: &[R], fold| layout.group(sums, fold).count().to_f64();
        let rotation = folds::rotation(groups, |fold| size(sums, fold), |fold| size(other_sums, fold));
        for fold in 0..groups.get() {
            let theirs = layout.group(other_sums, (fold + groups.get() - rotation) % groups);
            layout.group_mut(sums, fold).merge(&theirs, &change);
        }
        self.colour += other.colour;
        self.incremental.merge(&other.incremental, &change, other.samples);
        let before = self.samples;
        self.samples = self.samples.saturating_add(other.samples);
        self.move_zero(before, sums);
        if self.method == Method::Incremental {
            let (groups, rest) = halves_mut(sums, self.sums_len());
            self.incremental.refit(self.samples, &self.config, self.shape, layout, groups, rest);
        }
        Ok(())
    }

    /// The estimate from all samples so far. More may be added afterwards.
    ///
    /// # Errors
    /// [`Error::NoSamples`] if there are none, [`Error::Memory`] if `workspace` is shorter than
    /// [`Accumulator::workspace_len`] says.
    pub fn estimate(&self, sums: &[R], workspace: &mut [R]) -> Result<Estimate, Error> {
        let sums = self.used(sums)?;
        ensure(self.samples > 0, Error::NoSamples)?;
        let (summary, arena) = (self.summary(sums), &mut Arena::new(workspace, Some(self.needed()))?);
        // From an estimate in the sums' units.
        let correcting = |of: Outcome<R>| Outcome { correction: of.correction - summary.mean, ..of };
        let outcome = match self.method {
            Method::Robust | Method::KFold => self.cross_fit(sums, &summary, arena),
            Method::Incremental => correcting(incremental::outcome(&self.incremental, self.samples)),
            Method::SquareRoot => {
                let group = self.layout.group(sums, 0);
                correcting(givens::least_squares(&group, &self.config, &self.basis(), arena))
            }
            Method::LeastSquares => {
                let (group, penalties) = (self.layout.group(sums, 0), arena.take(self.layout.columns));
                ridge::penalties(&self.config, &self.basis(), |j| group.mean_square(j), penalties);
                let strength = R::from_f64(ridge::least_squares::<R>(self.config.ridge));
                normal::least_squares(&group, Penalty { strength, relative: penalties }, arena)
            }
            Method::Descent => {
                let centred = normal::Centred::new(&self.layout.group(sums, 0), arena);
                let coefficients = arena.zeros(self.layout.coefficients());
                descent::descend(&centred, &self.config, &self.basis(), coefficients, summary.variance, arena)
            }
            // A stream has no leave-one-out errors.
            Method::Plain | Method::LeaveOneOut => Outcome::default(),
        };
        Ok(summary.finish(outcome))
    }

    #[inline(never)]
    fn basis(&self) -> Basis {
        let mut basis = Basis::empty();
        basis.set(self.config.basis, self.shape);
        basis
    }

    fn cross_fit(&self, sums: &[R], summary: &Summary<R>, arena: &mut Arena<'_, R>) -> Outcome<R> {
        let (config, layout, basis) = (&self.config, self.layout, &self.basis());
        let groups = Groups { sums, folds: self.groups().get(), layout, config, basis };
        let k_fold = self.method == Method::KFold;
        // One fold to fit to and one to judge by, and for K-fold one to correct.
        let needed = if k_fold && !matches!(config.ridge, Ridge::Fixed(_)) { groups.folds.min(3) } else { 2 };
        let Some(variance) = summary.variance.filter(|_| groups.filled() >= needed) else {
            return Outcome::default();
        };
        if k_fold {
            cross_fit::nested(&groups, summary.mean, arena)
        } else {
            cross_fit::pooled(&groups, summary.mean, variance, arena)
        }
    }

    /// Moves the units' zero of a narrow type to the mean so far, each time that the samples, of which there were
    /// `before`, have doubled: of values that all lie to one side of it, as where the first sample is an outlier or in
    /// shadow, the sums would soon be too large for one more to show.
    fn move_zero(&mut self, before: u64, sums: &mut [R]) {
        if R::NARROW && before > 0 && self.samples.leading_zeros() < before.leading_zeros() {
            self.move_zero_to_mean(sums);
        }
    }

    #[inline(never)]
    fn move_zero_to_mean(&mut self, sums: &mut [R]) {
        let units = self.summary(sums).units;
        let change = Change { shift: self.units.offsets - units.offsets, ..Change::none() };
        self.units = units;
        self.change(sums, &change);
    }

    /// What the sums say without a fit.
    fn summary(&self, sums: &[R]) -> Summary<R> {
        let groups = (0..self.groups().get()).map(|fold| self.layout.group(sums, fold));
        let mut summary = Summary::of_sums(groups, self.samples, self.layout.channels, self.units);
        if self.config.color == Color::LuminanceRatio {
            summary.colour = Some(self.colour * (1.0 / self.samples as f64));
        }
        summary
    }

    fn change(&mut self, sums: &mut [R], change: &Change<R>) {
        for fold in 0..self.groups().get() {
            self.layout.group_mut(sums, fold).change(change);
        }
        self.incremental.change(change, self.samples, from_mut(sums, self.sums_len()), self.layout);
    }

    /// Raises the units' exponents to at least those given, and rescales what was summed.
    fn raise_exponents(&mut self, exponents: PerChannel<i32>, sums: &mut [R]) {
        let (before, given) = (self.units.exponents, exponents.map(|exponent| exponent.clamp(-126, 126)));
        if self.samples == 0 && R::NARROW {
            // Of nothing yet there is nothing to rescale.
            self.units.exponents = given;
        } else if before.0.iter().zip(&given.0).any(|(before, given)| before < given) {
            self.units.exponents = before.zip(given, i32::max);
            let factors = before.zip(self.units.exponents, |before, now| R::ONE.scale((before - now).max(-149)));
            self.units.offsets = self.units.offsets * factors;
            self.change(sums, &Change { factors, ..Change::none() });
        }
    }
}
