//! The fits of a group of pixels: which of them choose, and what they add to the pixels' sums.

use super::super::config::{Config, Estimator};
use super::bright::Limits;
use super::choice::Weights;
use super::fit::{Group, Problem};
use super::members::Members;
use super::{COMMON, Call, sums_len};
use crate::error::Error;
use crate::real::Real;
use crate::rows::rows_mut;

/// The largest correction that the windows of a pixel may add up in a narrow type, 2^120.
const MOST: f64 = (1_u128 << 120) as f64;

/// What fits to some pixels say of those that correct a pixel.
#[derive(Clone, Copy)]
struct Choice<R> {
    /// How far the mean and the fits to all are trusted, which tells the error.
    first: Weights<R>,
    /// How far those are that are used.
    weights: Weights<R>,
    /// What values are left out of these.
    limits: Option<Limits>,
    told: Told<R>,
}

/// What is told of a group's error.
#[derive(Clone, Copy)]
struct Told<R> {
    gain: R,
    /// Of each channel the root of the gain, or the error itself.
    errors: [f64; Config::MAX_CHANNELS],
    has_error: bool,
}

/// A fit of a group.
struct Pass {
    /// Which choice it makes, or follows.
    turn: usize,
    /// Whether pixels are corrected by it; otherwise it chooses for them.
    corrects: bool,
    /// Whether it is one without bright pixels, if there are any.
    leaves_out: bool,
}

impl Pass {
    /// All pixels choose for themselves.
    const ALL: [Self; 2] = [Self::new(0, true, false), Self::new(0, true, true)];
    /// Halves choose for each other.
    const HALVES: [Self; 7] = [
        Self::new(0, false, false),
        Self::new(0, false, true),
        Self::new(1, false, false),
        Self::new(1, false, true),
        Self::new(0, true, false),
        Self::new(0, true, true),
        Self::new(1, true, true),
    ];

    const fn new(turn: usize, corrects: bool, leaves_out: bool) -> Self {
        Self { turn, corrects, leaves_out }
    }
}

impl<R: Real> Call<'_, '_, R> {
    /// Fits a group and adds its pixels' corrections, times their weight.
    #[inline(always)]
    pub(super) fn group(&mut self, members: &Members<'_>) -> Result<(), Error> {
        let problem = &self.problem;
        let terms = problem.terms(members);
        if members.len < 2 || terms.ends.is_empty() {
            return Ok(());
        }
        let has_halves = problem.config.estimator == Estimator::KFold && !problem.is_single_fit();
        let [even, odd] = [0, 1].map(|first| members.half(first));
        if has_halves && odd.len < 2 {
            return Ok(());
        }
        let (passes, turns) = if has_halves { (&Pass::HALVES[..], 2) } else { (&Pass::ALL[..], 1) };
        let told = Told { gain: R::ZERO, errors: [0.0; Config::MAX_CHANNELS], has_error: false };
        let choice = Choice { first: Weights::default(), weights: Weights::default(), limits: None, told };
        let mut choices = [choice; 2];
        // One loop, as each call of `fit` is a copy of it.
        for pass in passes {
            let limits = choices.get(pass.turn).and_then(|choice| choice.limits).filter(|_| pass.leaves_out);
            if pass.leaves_out && limits.is_none() {
                continue;
            }
            // Even members take what the odd ones chose: how far fits are trusted, and what is left out of them.
            let sharing = match pass {
                Pass { corrects: true, .. } => members,
                Pass { turn: 0, .. } => &odd,
                _ => &even,
            };
            let group = problem.fit(sharing, &terms, limits.as_ref(), &mut self.arena.scratch())?;
            let choice = choices.get_mut(pass.turn).filter(|_| !pass.corrects || !has_halves);
            if let Some(choice) = choice {
                choice.weights = problem.weights(&group);
                if !pass.leaves_out {
                    choice.first = choice.weights;
                    choice.limits = problem.limits(sharing, members, &choice.weights);
                }
            }
            if !pass.corrects {
                continue;
            }
            for (turn, choice) in choices.iter_mut().enumerate().take(turns) {
                if !pass.leaves_out {
                    choice.told = problem.told(&group, &choice.first);
                }
                let follows = if pass.leaves_out { turn == pass.turn } else { choice.limits.is_none() };
                if follows {
                    problem.add(members, &group, choice, (turn, turns), self.sums);
                }
            }
        }
        Ok(())
    }
}

impl Problem<'_> {
    /// Bright pixels count: without them the error would be told too small where every pixel has rare bright samples.
    #[inline(always)]
    fn told<R: Real>(&self, group: &Group<'_, R>, weights: &Weights<R>) -> Told<R> {
        // Without freedom there is no spread to tell the error from.
        let has_error = !self.error_is_the_blocks() || group.spreads.freedom > R::ZERO;
        let mut told = Told { gain: R::ZERO, errors: [0.0; Config::MAX_CHANNELS], has_error };
        let outputs = told.errors.iter_mut().zip(&group.units).enumerate();
        for (channel, (error, units)) in outputs.take(self.config.channels) {
            let ratio = group.spreads.gain(weights, channel);
            told.gain += ratio;
            if !self.error_is_the_blocks() {
                *error = ratio.sqrt().to_f64();
            } else if has_error {
                *error = group.spreads.variance(weights, channel).sqrt().to_f64() * libm::scalbn(1.0, units.exponent);
            }
        }
        told.gain = told.gain / R::from_usize(self.config.channels);
        told
    }

    /// Adds a group's corrections to the sums of its pixels, or of every second one.
    #[inline(always)]
    fn add<R: Real>(
        &self,
        members: &Members<'_>,
        group: &Group<'_, R>,
        choice: &Choice<R>,
        (first, step): (usize, usize),
        sums: &mut [R],
    ) {
        let width = sums_len(self.config.channels);
        let Told { gain, errors, has_error } = choice.told;
        let units = group.units.map(|units| libm::scalbn(1.0, units.exponent));
        for index in (first..members.len).step_by(step) {
            let pixel = members.pixel(index);
            let Some(sums) = sums.get_mut(pixel * width..(pixel + 1) * width) else { continue };
            let near = members.area.nearness::<R>(members.local(index));
            let (common, each) = sums.split_at_mut_checked(COMMON).unwrap_or((&mut [], &mut []));
            for (sum, value) in common.iter_mut().zip([R::ONE, if has_error { R::ONE } else { R::ZERO }, gain]) {
                *sum += near * value;
            }
            let per_channel = rows_mut(each, 2).zip(units).zip(errors).enumerate();
            for (channel, ((each, unit), error)) in per_channel {
                let factor = if self.factors.is_empty() { 1.0 } else { self.factor(pixel, channel) };
                let correction = group.correction(index, &choice.weights, channel).to_f64() * unit * factor;
                let error = if self.error_is_the_blocks() { error * factor } else { error };
                for (sum, value) in each.iter_mut().zip([correction, error]) {
                    // What a narrow type cannot add up is no number, and found at the end.
                    let fits = !R::NARROW || libm::fabs(value) < MOST;
                    *sum += near * R::from_f64(if fits { value } else { f64::NAN });
                }
            }
        }
    }
}
