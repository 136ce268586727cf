//! Properties of the estimators under random configurations and samples, and of accumulators under random operations.

use crate::cv_support::*;
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{
    self, Color, Config, Estimate, Estimator, Image, NonFinite, Optimizer, Regressor, Ridge, Samples, Solver,
    estimate_image, image_workspace_len, workspace_len,
};
use noisefloor::real::Real;
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::oracle::{Regression, stream_folds};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::stream::Stream;
use proptest::prelude::*;

fn estimators() -> impl Strategy<Value = Estimator> {
    prop::sample::select(ESTIMATORS.to_vec())
}

/// Estimators that stream.
fn streaming() -> impl Strategy<Value = Estimator> {
    estimators().prop_filter("needs all samples at once", |&estimator| estimator != Estimator::LeaveOneOut)
}

/// Valid configurations of one channel with a basis of at most 136 terms.
fn valid() -> impl Strategy<Value = Config> {
    let shape = (1_usize..=5, 0_usize..=4, prop::sample::select(Family::ALL.to_vec()), 0_usize..=6);
    (shape, estimators(), 0_usize..=7).prop_filter_map(
        "too many terms",
        |((dims, order, basis, slices), estimator, folds)| {
            let folds = if folds == 1 { 0 } else { folds };
            let config = Config { basis, slices, folds, ..config(dims, order, estimator) };
            config.terms().is_ok().then_some(config)
        },
    )
}

/// Any configuration, mostly invalid ones.
fn any_config() -> impl Strategy<Value = Config> {
    let size = || prop_oneof![6 => 0_usize..=4, 1 => 5_usize..=20, 1 => any::<usize>()];
    let some = || prop_oneof![3 => Just(0), 1 => size()];
    let number = || {
        prop_oneof![
            4 => Just(0.0_f32),
            2 => 0.0_f32..1.0,
            1 => any::<f32>(),
            1 => Just(f32::MAX),
            1 => Just(1e-30_f32),
        ]
    };
    let ridge = prop_oneof![3 => Just(Ridge::Default), 1 => Just(Ridge::Auto), 2 => number().prop_map(Ridge::Fixed)];
    let solvers = vec![Solver::Auto, Solver::NormalEquations, Solver::SquareRoot, Solver::Dual];
    let optimizers = vec![Optimizer::Momentum, Optimizer::Adam, Optimizer::Plain];
    (
        (
            size(),
            size(),
            prop_oneof![6 => 1_usize..=4, 1 => size()],
            estimators(),
            prop::sample::select(Family::ALL.to_vec()),
        ),
        (any::<bool>(), size(), some(), some(), some()),
        (
            prop::sample::select(solvers),
            any::<bool>(),
            prop::bool::weighted(0.2),
            size(),
            prop_oneof![0_usize..20, Just(1 << 21)],
        ),
        (prop::sample::select(optimizers), ridge, number(), number()),
    )
        .prop_map(|((dims, order, channels, estimator, basis), second, third, fourth)| {
            let (stratified, slices, edges, controls, stride) = second;
            let (solver, skip, luminance, folds, iterations) = third;
            let (optimizer, ridge, learning_rate, momentum) = fourth;
            Config {
                dims,
                order,
                channels,
                estimator,
                basis,
                stratified,
                slices,
                edges,
                controls,
                stride,
                solver,
                non_finite: if skip { NonFinite::Skip } else { NonFinite::Error },
                color: if luminance { Color::LuminanceRatio } else { Color::PerChannel },
                folds,
                iterations,
                optimizer,
                ridge,
                learning_rate,
                momentum,
            }
        })
}

/// A value of any kind: ordinary, huge, tiny, denormal, zero, no number.
fn wild(rng: &mut SplitMix64, nasty: bool) -> f32 {
    match rng.below(if nasty { 14 } else { 8 }) {
        0..=4 => rng.normal() as f32,
        5 => 0.0,
        6 => 1e20 * rng.normal() as f32,
        7 => 1e-20,
        8 => f32::MAX,
        9 => f32::MIN,
        10 => f32::from_bits(rng.below(1 << 23) as u32),
        11 => f32::NAN,
        12 => f32::NEG_INFINITY,
        _ => f32::from_bits(rng.next_u64() as u32),
    }
}

/// `len` numbers of any kind for values.
fn wild_values(len: usize, rng: &mut SplitMix64, nasty: bool) -> Vec<f32> {
    let one_kind = rng.below(3) == 0;
    let first = wild(rng, nasty);
    (0..len).map(|_| if one_kind { first } else { wild(rng, nasty) }).collect()
}

/// `len` coordinates, now and then out of range.
fn wild_points(len: usize, rng: &mut SplitMix64, nasty: bool) -> Vec<f32> {
    let coarse = rng.below(3) == 0;
    let coordinate = |rng: &mut SplitMix64| match rng.below(if nasty { 40 } else { 20 }) {
        0 => 0.0,
        1 => 1.0,
        20 => wild(rng, true),
        _ if coarse => (rng.uniform_f32() * 2.0).round() / 2.0,
        _ => rng.uniform_f32(),
    };
    (0..len).map(|_| coordinate(rng)).collect()
}

/// Every door of the library with the same arguments: none panics, and what is returned is sound.
fn knock<R: Real>(config: &Config, samples: Samples<'_>, rng: &mut SplitMix64) {
    let check = |result: Result<Estimate, Error>| {
        if let Ok(estimate) = result {
            assert!(is_sound(&estimate), "{config:?} {samples:?}: {estimate:?}");
        }
        result
    };
    let n = samples.f.len().checked_div(config.channels).unwrap_or(0);
    let nan = R::from_f64(f64::NAN);
    match workspace_len::<R>(config, n) {
        Ok(len) if len < 1 << 20 => {
            let mut workspace = vec![nan; len];
            let whole = check(control_variate::estimate(config, samples, &mut workspace));
            assert_ne!(whole, Err(Error::Memory), "{config:?} {n}");
            let short = check(control_variate::estimate(config, samples, &mut workspace[..len / 2]));
            assert!(short.is_err() || short == whole);
            let columns = config.terms().unwrap() - 1;
            let mut start = wild_values(columns * config.channels.min(4), rng, false);
            let before = start.clone();
            if check(control_variate::gradient_descent(config, samples, &mut start, &mut workspace)).is_err() {
                let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&start), bits(&before));
            } else {
                assert!(start.iter().all(|value| value.is_finite()), "{config:?} {before:?} {start:?}");
            }
        }
        Ok(_) => {}
        Err(error) => {
            // What cannot be measured cannot be run.
            let result = control_variate::estimate(config, samples, &mut [nan; 4096]);
            assert!(result.is_err(), "{config:?} {n}: {error}");
        }
    }
    let pixels = 1 + rng.below(4);
    let image = Image::unordered(pixels);
    if let Ok(len) = image_workspace_len(config, &image, n / pixels)
        && len < 1 << 20
    {
        let mut count = 0;
        let result = estimate_image(config, &image, samples, &mut vec![f32::NAN; len], &mut |_, estimate| {
            count += 1;
            check(Ok(estimate)).unwrap();
        });
        assert_eq!(count, if result.is_ok() { pixels } else { 0 });
        assert_ne!(result, Err(Error::Memory));
    }
    if let Ok(mut accumulator) = Stream::<R>::new(config) {
        let added = accumulator.add(samples);
        let mut workspace = accumulator.workspace();
        let estimate = check(accumulator.estimate(&mut workspace));
        assert_eq!(estimate.is_ok(), accumulator.samples() > 0, "{config:?}: {estimate:?}");
        assert!(added.is_ok() || accumulator.samples() == 0);
        let copy = accumulator.clone();
        accumulator.merge(&copy).unwrap();
        assert_eq!(accumulator.samples(), 2 * copy.samples());
        check(accumulator.estimate(&mut workspace)).ok();
    }
}

/// Points, and dyadic values there: sums and products with integers are exact, and only an estimate's own roundings are
/// left.
fn dyadic(dims: usize, n: usize, seed: u64) -> (Vec<f32>, Vec<f32>) {
    let u = points(n, dims, &mut SplitMix64::new(seed));
    let f = values(&u, dims, smooth).iter().map(|f| (f * 1024.0).round() / 1024.0).collect();
    (u, f)
}

proptest! {
    #![proptest_config(crate::cases(1500, 1))]

    /// Any configuration, any arrays: an error or finite numbers, and never a panic.
    #[test]
    fn anything_goes(
        config in any_config(),
        n in 0_usize..30,
        seed in any::<u64>(),
        nasty in any::<bool>(),
        fit in prop::bool::weighted(0.8),
    ) {
        let mut rng = SplitMix64::new(seed);
        let small = |len: usize| if len < 10_000 { len } else { 7 };
        let dims = if config.stride == 0 { config.dims } else { config.stride };
        let slack = |rng: &mut SplitMix64| if fit { 0 } else { rng.below(3) };
        let u = wild_points(small(n.saturating_mul(dims)) + slack(&mut rng), &mut rng, nasty);
        let f = wild_values(small(n.saturating_mul(config.channels)) + slack(&mut rng), &mut rng, nasty);
        let controls = wild_values(small(n.saturating_mul(config.controls)) + slack(&mut rng), &mut rng, nasty);
        let control_integrals = wild_values(small(config.controls) + slack(&mut rng), &mut rng, nasty);
        let samples = Samples { u: &u, f: &f, controls: &controls, control_integrals: &control_integrals };
        knock::<f64>(&config, samples, &mut rng);
        knock::<f32>(&config, samples, &mut rng);
    }

    /// Valid configurations and finite values in range: always an estimate.
    #[test]
    fn what_is_valid_succeeds(config in valid(), channels in 1_usize..=4, n in 1_usize..40, seed in any::<u64>()) {
        let mut rng = SplitMix64::new(seed);
        let config = Config { channels, ..config };
        let u = wild_points(n * config.dims, &mut rng, false);
        let f = wild_values(n * channels, &mut rng, false);
        prop_assert!(is_sound(&batch::<f64>(&config, &u, &f).unwrap()));
        prop_assert!(is_sound(&batch::<f32>(&config, &u, &f).unwrap()));
        knock::<f64>(&config, Samples::new(&u, &f), &mut rng);
        knock::<f32>(&config, Samples::new(&u, &f), &mut rng);
    }

    /// Workspace for some samples is enough for fewer, whatever solves their systems.
    #[test]
    fn workspace_grows_with_samples(
        config in valid(), channels in 1_usize..=4, controls in 0_usize..=2,
        solver in prop::sample::select(vec![Solver::Auto, Solver::NormalEquations, Solver::SquareRoot, Solver::Dual]),
    ) {
        let config = Config { channels, controls, solver, ..config };
        prop_assert!((0..300).map_while(|n| workspace_len::<f64>(&config, n).ok()).is_sorted());
    }

    /// Powers of two times f, of either sign: the same times the estimate, to the bit.
    #[test]
    fn powers_of_two_are_exact(
        config in valid(), n in 1_usize..40, exponent in -90_i32..90, sign in any::<bool>(), seed in any::<u64>(),
    ) {
        let mut rng = SplitMix64::new(seed);
        let u = points(n, config.dims, &mut rng);
        let f = values(&u, config.dims, smooth);
        let size = 2.0_f32.powi(exponent);
        let factor = if sign { size } else { -size };
        let scaled: Vec<f32> = f.iter().map(|f| f * factor).collect();
        let same = |base: Estimate, scaled: Estimate| {
            prop_assert_eq!(scaled.mean[0], base.mean[0] * factor);
            prop_assert_eq!(scaled.std_error[0], base.std_error[0] * size);
            prop_assert_eq!(scaled.gain, base.gain);
            Ok(())
        };
        same(batch::<f64>(&config, &u, &f).unwrap(), batch::<f64>(&config, &u, &scaled).unwrap())?;
        same(batch::<f32>(&config, &u, &f).unwrap(), batch::<f32>(&config, &u, &scaled).unwrap())?;
        if config.estimator != Estimator::LeaveOneOut {
            same(streamed::<f64>(&config, &u, &f).unwrap(), streamed::<f64>(&config, &u, &scaled).unwrap())?;
            same(streamed::<f32>(&config, &u, &f).unwrap(), streamed::<f32>(&config, &u, &scaled).unwrap())?;
        }
    }

    /// A constant more: that much more, within 1e-5 of the constant and the values (a fit to fewer samples than terms
    /// magnifies the roundings of what is added, `f32`s).
    #[test]
    fn constants_shift(config in valid(), n in 12_usize..40, shift in -100_i32..100, seed in any::<u64>()) {
        let (u, f) = dyadic(config.dims, n, seed);
        let shift = shift as f32;
        let shifted: Vec<f32> = f.iter().map(|f| f + shift).collect();
        let error = |base: Estimate, shifted: Estimate| f64::from(shifted.mean[0] - base.mean[0] - shift).abs();
        let size = f64::from(shift.abs()) + largest(&f);
        let wide = error(batch::<f64>(&config, &u, &f).unwrap(), batch::<f64>(&config, &u, &shifted).unwrap());
        let mean = f64::from(batch::<f64>(&config, &u, &f).unwrap().mean[0]);
        prop_assert!(wide < 1e-5 * size.max(mean.abs()), "{}", wide);
    }

    /// Whole numbers times f: as many times the estimate, within 1e-5.
    #[test]
    fn factors_scale(config in valid(), n in 12_usize..60, factor in -100_i32..100, seed in any::<u64>()) {
        let (u, f) = dyadic(config.dims, n, seed);
        let factor = factor as f32;
        let scaled: Vec<f32> = f.iter().map(|f| f * factor).collect();
        let close = |base: Estimate, scaled: Estimate| {
            let error = (scaled.mean[0] - factor * base.mean[0]).abs();
            let size = factor.abs() * (base.mean[0].abs() + largest(&f) as f32);
            prop_assert!(error <= 1e-5 * size, "{:?} {:?}", base, scaled);
            Ok(())
        };
        close(batch::<f64>(&config, &u, &f).unwrap(), batch::<f64>(&config, &u, &scaled).unwrap())?;
        if config.estimator != Estimator::LeaveOneOut {
            close(streamed::<f64>(&config, &u, &f).unwrap(), streamed::<f64>(&config, &u, &scaled).unwrap())?;
        }
    }

    /// The order of samples: no matter for estimators without folds and without a first and a next, within 1e-6.
    #[test]
    fn order_does_not_matter(config in valid(), n in 2_usize..60, seed in any::<u64>()) {
        prop_assume!(!matches!(config.estimator, Estimator::KFold | Estimator::Incremental));
        // A ridge keeps least squares on few samples from magnifying the roundings.
        let config = match config.estimator {
            Estimator::LeastSquares => Config { ridge: Ridge::Fixed(1e-3), ..config },
            _ => config,
        };
        let mut rng = SplitMix64::new(seed);
        let u = points(n, config.dims, &mut rng);
        let f = values(&u, config.dims, smooth);
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by_cached_key(|_| rng.next_u64());
        let point = |&i: &usize| u[i * config.dims..(i + 1) * config.dims].to_vec();
        let shuffled_u: Vec<f32> = order.iter().flat_map(point).collect();
        let shuffled_f: Vec<f32> = order.iter().map(|&i| f[i]).collect();
        let (a, b) = (batch::<f64>(&config, &u, &f).unwrap(), batch::<f64>(&config, &shuffled_u, &shuffled_f).unwrap());
        let size = 1.0 + largest(&f) as f32 + a.mean[0].abs();
        prop_assert!((a.mean[0] - b.mean[0]).abs() < 1e-6 * size, "{:?} {:?}", a, b);
    }

    /// Merging in any grouping and order: within 1e-6 of each other, and of one accumulator for everything, where there
    /// is one fold. Folds fill in the order of merging: there the samples are counted, and merging the same parts in
    /// the same order is the same.
    #[test]
    fn merging(
        estimator in streaming(),
        dims in 1_usize..4,
        sizes in prop::collection::vec(0_usize..20, 3),
        seed in any::<u64>(),
    ) {
        let config = Config { ridge: Ridge::Fixed(0.01), ..config(dims, 2, estimator) };
        let mut rng = SplitMix64::new(seed);
        let mut parts = vec![];
        let (mut all_u, mut all_f) = (vec![], vec![]);
        for (index, &n) in sizes.iter().enumerate() {
            let u = points(n, dims, &mut rng);
            // Parts of very different size: units have to be brought together.
            let f: Vec<f32> = values(&u, dims, smooth).iter().map(|f| f * [1.0, 1e3, 0.1][index] + 5.0).collect();
            let mut part = accumulator::<f64>(&config);
            if n > 0 {
                part.add(Samples::new(&u, &f)).unwrap();
            }
            all_u.extend(u);
            all_f.extend(f);
            parts.push(part);
        }
        prop_assume!(!all_f.is_empty());
        let join = |parts: &[&Stream<f64>]| {
            let mut joined = accumulator::<f64>(&config);
            parts.iter().for_each(|part| joined.merge(part).unwrap());
            joined
        };
        let [a, b, c] = [&parts[0], &parts[1], &parts[2]];
        let left = join(&[&join(&[a, b]), c]);
        let right = join(&[a, &join(&[b, c])]);
        let swapped = join(&[c, b, a]);
        let estimate = |accumulator: &Stream<f64>| finish(accumulator).unwrap();
        let base = estimate(&left);
        let tolerance = 1e-6 * (largest(&all_f) as f32 + base.mean[0].abs());
        if matches!(estimator, Estimator::Robust | Estimator::KFold) {
            prop_assert_eq!(base.samples, estimate(&right).samples);
            prop_assert_eq!(base.samples, estimate(&swapped).samples);
            prop_assert_eq!(&base, &estimate(&join(&[&join(&[a, b]), c])));
            let part = parts.iter().find(|part| part.samples() > 0).unwrap();
            prop_assert_eq!(estimate(part), estimate(&join(&[part])));
            return Ok(());
        }
        for other in [estimate(&right), estimate(&swapped)] {
            prop_assert_eq!(base.samples, other.samples);
            prop_assert!((base.mean[0] - other.mean[0]).abs() <= tolerance, "{:?} {:?}", base, other);
            let same = base.std_error == other.std_error;
            prop_assert!(same || (base.std_error[0] - other.std_error[0]).abs() <= tolerance);
        }
        if matches!(estimator, Estimator::LeastSquares | Estimator::GradientDescent) {
            let whole = streamed::<f64>(&config, &all_u, &all_f).unwrap();
            prop_assert!((base.mean[0] - whole.mean[0]).abs() <= tolerance, "{:?} {:?}", base, whole);
        }
    }

    /// `workspace_len` is enough, more changes nothing, one number less is refused or was to spare, none is refused.
    #[test]
    fn workspace_is_sufficient(
        config in valid(),
        channels in 1_usize..=4,
        n in 1_usize..40,
        extra in 0_usize..100,
        seed in any::<u64>(),
    ) {
        let config = Config { channels, ..config };
        let mut rng = SplitMix64::new(seed);
        let u = points(n, config.dims, &mut rng);
        let f = wild_values(n * channels, &mut rng, false);
        let len = workspace_len::<f64>(&config, n).unwrap();
        let run = |len: usize| control_variate::estimate(&config, Samples::new(&u, &f), &mut vec![f64::NAN; len]);
        prop_assert_eq!(run(len), run(len + extra));
        if len > 0 {
            let short = run(len - 1);
            prop_assert!(short == Err(Error::Memory) || short == run(len));
            prop_assert_eq!(run(0), Err(Error::Memory));
        }
    }
}

/// One step in the life of an accumulator.
#[derive(Clone, Debug)]
enum Step {
    Add(usize),
    AddBad(usize),
    Merge(usize),
    MergeEmpty,
    MergeOther,
    Reset,
    Estimate,
    Clone,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        5 => (1_usize..12).prop_map(Step::Add),
        1 => (1_usize..6).prop_map(Step::AddBad),
        2 => (1_usize..12).prop_map(Step::Merge),
        1 => Just(Step::MergeEmpty),
        1 => Just(Step::MergeOther),
        1 => Just(Step::Reset),
        3 => Just(Step::Estimate),
        1 => Just(Step::Clone),
    ];
    prop::collection::vec(step, 1..14)
}

/// An accumulator's samples, kept by fold as it sums them.
#[derive(Clone, Default)]
struct Model {
    folds: Vec<Vec<(Vec<f32>, f32)>>,
    count: usize,
}

impl Model {
    fn new(folds: usize) -> Self {
        Self { folds: vec![vec![]; folds], count: 0 }
    }

    fn add(&mut self, u: &[f32], dims: usize, f: &[f32]) {
        let folds = stream_folds(self.count + f.len(), self.folds.len());
        for (u, &f) in u.chunks(dims).zip(f) {
            self.folds[folds[self.count]].push((u.to_vec(), f));
            self.count += 1;
        }
    }

    fn merge(&mut self, other: &Self) {
        let folds = self.folds.len();
        // The first of the rotations that leave the sizes' squares least.
        let squares = |rotation: usize| -> usize {
            let size = |fold: usize| self.folds[(fold + rotation) % folds].len() + other.folds[fold].len();
            (0..folds).map(|fold| size(fold).pow(2)).sum()
        };
        let rotation = (0..folds).min_by_key(|&rotation| squares(rotation)).unwrap_or(0);
        for (fold, theirs) in other.folds.iter().enumerate() {
            self.folds[(rotation + fold) % folds].extend(theirs.iter().cloned());
        }
        self.count += other.count;
    }
}

/// The estimate that a model stands for, slowly, for a fixed ridge: each fold corrected by a fit to the others, or,
/// with one fold, a fit to all.
fn expected(config: &Config, model: &Model, ridge: f64) -> f64 {
    let fit = |samples: &[(Vec<f32>, f32)]| {
        let u: Vec<f64> = samples.iter().flat_map(|(u, _)| wide(u)).collect();
        let f: Vec<f64> = samples.iter().map(|&(_, f)| f64::from(f)).collect();
        Regression::fit(&design(config, &u), &f, ridge * f.len() as f64)
    };
    if let [all] = &model.folds[..] {
        return fit(all).intercept;
    }
    let mut sum = 0.0;
    for (fold, own) in model.folds.iter().enumerate() {
        let others: Vec<_> =
            (0..model.folds.len()).filter(|&k| k != fold).flat_map(|k| model.folds[k].clone()).collect();
        let fit = (!others.is_empty()).then(|| fit(&others));
        for (u, f) in own {
            let row = design(config, &wide(u)).rows.remove(0);
            sum += f64::from(*f) - fit.as_ref().map_or(0.0, |fit| fit.control(&row));
        }
    }
    sum / model.count as f64
}

proptest! {
    #![proptest_config(crate::cases(400, 1))]

    /// Any sequence of operations: the estimate is that of the samples which went in, within 1e-6 of the largest; what
    /// is refused changes nothing.
    #[test]
    fn accumulators_hold_their_samples(
        steps in steps(),
        estimator in prop::sample::select(vec![Estimator::LeastSquares, Estimator::KFold]),
        root in any::<bool>(),
        dims in 1_usize..3,
        scale in -20_i32..20,
        seed in any::<u64>(),
    ) {
        let strength = 0.02_f32;
        let is_folded = estimator != Estimator::LeastSquares;
        let solver = if root && !is_folded { Solver::SquareRoot } else { Solver::Auto };
        let config = Config { ridge: Ridge::Fixed(strength), solver, ..config(dims, 2, estimator) };
        let mut rng = SplitMix64::new(seed);
        let scale = 2.0_f32.powi(scale);
        let mut draw = |n: usize| {
            let u = points(n, dims, &mut rng);
            let f: Vec<f32> = values(&u, dims, smooth).iter().map(|f| f * scale).collect();
            (u, f)
        };
        let folds = if is_folded { 4 } else { 1 };
        let (mut subject, mut model) = (accumulator::<f64>(&config), Model::new(folds));
        let mut narrow = accumulator::<f32>(&config);
        for step in steps.into_iter().chain([Step::Estimate]) {
            let before = finish(&subject);
            match step {
                Step::Add(n) => {
                    let (u, f) = draw(n);
                    subject.add(Samples::new(&u, &f)).unwrap();
                    narrow.add(Samples::new(&u, &f)).unwrap();
                    model.add(&u, dims, &f);
                }
                Step::AddBad(n) => {
                    let (mut u, mut f) = draw(n);
                    f[n - 1] = f32::NAN;
                    prop_assert_eq!(subject.add(Samples::new(&u, &f)), Err(Error::NotFinite));
                    f[n - 1] = 1.0;
                    u[n * dims - 1] = 1.5;
                    prop_assert_eq!(subject.add(Samples::new(&u, &f)), Err(Error::Range));
                    prop_assert_eq!(subject.add(Samples::new(&u[..n * dims - 1], &f)), Err(Error::Length));
                    prop_assert_eq!(subject.add(Samples::new(&[], &[])), Err(Error::NoSamples));
                    prop_assert_eq!(finish(&subject), before);
                }
                Step::Merge(n) => {
                    let (u, f) = draw(n);
                    let (mut other, mut others) = (accumulator::<f64>(&config), Model::new(folds));
                    let mut narrow_other = accumulator::<f32>(&config);
                    other.add(Samples::new(&u, &f)).unwrap();
                    narrow_other.add(Samples::new(&u, &f)).unwrap();
                    others.add(&u, dims, &f);
                    subject.merge(&other).unwrap();
                    narrow.merge(&narrow_other).unwrap();
                    model.merge(&others);
                }
                Step::MergeEmpty => {
                    subject.merge(&accumulator::<f64>(&config)).unwrap();
                    prop_assert_eq!(finish(&subject), before);
                }
                Step::MergeOther => {
                    let mut other = accumulator::<f64>(&Config { order: 1, ..config });
                    other.add(Samples::new(&vec![0.5; dims], &[1.0])).unwrap();
                    prop_assert_eq!(subject.merge(&other), Err(Error::Mismatch));
                    prop_assert_eq!(finish(&subject), before);
                }
                Step::Reset => {
                    subject.reset();
                    narrow.reset();
                    model = Model::new(folds);
                }
                Step::Clone => subject = subject.clone(),
                Step::Estimate => {
                    if model.count == 0 {
                        prop_assert_eq!(before, Err(Error::NoSamples));
                        continue;
                    }
                    let (wide, narrow) = (before.unwrap(), finish(&narrow).unwrap());
                    prop_assert_eq!(wide.samples as usize, model.count);
                    let expected = expected(&config, &model, f64::from(strength)) / f64::from(scale);
                    let error = |estimate: Estimate| (f64::from(estimate.mean[0]) / f64::from(scale) - expected).abs();
                    prop_assert!(error(wide) < 1e-6 * (2.0 + expected.abs()), "{:?} {}", wide, expected);
                    prop_assert!(error(narrow) < 1e-3 * (2.0 + expected.abs()), "{:?} {}", narrow, expected);
                }
            }
        }
    }

    /// A regressor of fixed size is an accumulator of the same configuration.
    #[test]
    fn regressors_are_accumulators(n in 1_usize..40, split in 0_usize..40, seed in any::<u64>()) {
        let mut rng = SplitMix64::new(seed);
        let (u, f) = (points(n, 2, &mut rng), points(n, 2, &mut rng));
        let mut parts = [Regressor::<2, 6, 2>::new(Family::Sine, 2).unwrap(), Regressor::new(Family::Sine, 2).unwrap()];
        for (index, (u, f)) in u.as_chunks::<2>().0.iter().zip(f.as_chunks::<2>().0).enumerate() {
            parts[usize::from(index >= split)].add(u, f).unwrap();
        }
        let [mut merged, rest] = parts;
        merged.merge(&rest).unwrap();
        let base = config(2, 2, Estimator::LeastSquares);
        let config = Config { basis: Family::Sine, channels: 2, ridge: Ridge::Fixed(0.01), ..base };
        let streamed = streamed::<f64>(&config, &u, &f).unwrap();
        let regressed = merged.estimate(0.01).unwrap();
        for channel in 0..2 {
            prop_assert!((streamed.mean[channel] - regressed.mean[channel]).abs() < 1e-6);
            let (a, b) = (streamed.std_error[channel], regressed.std_error[channel]);
            prop_assert!((a - b).abs() < 1e-6 || a == b, "{} {}", a, b);
        }
    }
}
