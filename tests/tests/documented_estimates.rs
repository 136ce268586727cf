//! What docs/mis.md, docs/choosing.md, docs/control_variates.md and docs/image_fits.md say in words of any samples,
//! held against random ones. What needs a slow model or statistics is in the other tests of those services.

use crate::cv_support::*;
use crate::mis_support::Sample;
use noisefloor::control_variate::{Config, Estimate, Estimator, Image, Ridge, Samples};
use noisefloor::mis::{self, DEFAULT_RIDGE, OptimalMis, Solver};
use noisefloor::recommend::{Recommendation, Sampling, recommend};
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::{block, image};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(3), failure_persistence: None, ..ProptestConfig::default() }
}

fn omis_of(counts: &[u32], samples: &[Sample]) -> OptimalMis<Vec<f64>> {
    let mut omis = OptimalMis::new(vec![0.0; mis::len(counts.len(), 1)], counts, 1).unwrap();
    for sample in samples {
        omis.add(sample.technique, &sample.pdf, &[sample.value]).unwrap();
    }
    omis
}

proptest! {
    #![proptest_config(cases(500))]

    /// mis.md: merging is associative, the order of samples does not matter, and estimates scale with f, within 1e-5.
    #[test]
    fn optimal_mis_merges_permutes_and_scales(
        techniques in 1..6_usize,
        sizes in prop::collection::vec(1..12_usize, 3),
        factor in -50.0..50.0_f32,
        seed in any::<u64>(),
    ) {
        let mut rng = SplitMix64::new(seed);
        let counts: Vec<u32> = (0..techniques).map(|_| 1 + rng.below(3) as u32).collect();
        let mut samples: Vec<Sample> = (0..sizes.iter().sum()).map(|i: usize| {
            let pdf = (0..techniques).map(|_| 0.1 + rng.uniform_f32()).collect();
            Sample { technique: i % techniques, pdf, value: 2.0 * rng.uniform_f32() - 1.0 }
        }).collect();
        let solve = |omis: &OptimalMis<Vec<f64>>| [Solver::Ridge(DEFAULT_RIDGE), Solver::Balance].map(|solver| {
            let mut out = [f32::NAN];
            omis.solve(solver, &mut out).unwrap();
            out[0]
        });
        let same = |a: [f32; 2], b: [f32; 2], size: f32| {
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-5 * size * (1.0 + a.abs()))
        };
        let whole = solve(&omis_of(&counts, &samples));
        let (first, rest) = samples.split_at(sizes[0]);
        let (second, third) = rest.split_at(sizes[1]);
        let [a, b, c] = [first, second, third].map(|part| omis_of(&counts, part));
        let (mut left, mut right, mut end) = (a.clone(), a, b.clone());
        left.merge(&b).unwrap();
        left.merge(&c).unwrap();
        end.merge(&c).unwrap();
        right.merge(&end).unwrap();
        prop_assert!(same(solve(&left), whole, 1.0) && same(solve(&right), whole, 1.0));
        samples.sort_by_cached_key(|_| rng.next_u64());
        prop_assert!(same(solve(&omis_of(&counts, &samples)), whole, 1.0));
        samples.iter_mut().for_each(|sample| sample.value *= factor);
        prop_assert!(same(solve(&omis_of(&counts, &samples)), whole.map(|x| factor * x), 1.0 + factor.abs()));
    }

    /// recommend(): dims are rounded up, samples down, to what was measured.
    #[test]
    fn recommendations_are_rounded(
        dims in 1..=15_usize,
        samples in prop_oneof![1..20_usize, 1..70_usize, 1..3000_usize],
        stratified in any::<bool>(),
        can_share in any::<bool>(),
    ) {
        let sampling = if stratified { Sampling::Stratified } else { Sampling::Independent };
        let measured = [1, 2, 4, 5, 8, 15].into_iter().find(|&measured| measured >= dims).unwrap();
        let fewer = [256, 64, 16, 4, 1].into_iter().find(|&fewer| fewer <= samples).unwrap();
        let of = |dims, samples| recommend(dims, samples, sampling, can_share, f32::INFINITY).unwrap();
        let (here, there) = (of(dims, samples), of(measured, fewer));
        prop_assert_eq!(here.config.dims, dims);
        let config = Config { dims, stride: here.config.stride, ..there.config };
        prop_assert_eq!(here, Recommendation { config, ..there });
    }

    /// control_variates.md: estimates are in the unit of f, whose sign does not matter, within 1e-5: in batches and
    /// streams.
    #[test]
    fn estimates_scale_with_f(
        estimator in prop::sample::select(ESTIMATORS.to_vec()),
        dims in 1..4_usize,
        n in 12..60_usize,
        factor in -100..100_i32,
        seed in any::<u64>(),
    ) {
        let config = config(dims, 2, estimator);
        let mut rng = SplitMix64::new(seed);
        let u = points(n, dims, &mut rng);
        // Dyadic values and an integer: products are exact, and only the estimate's own roundings are left.
        let f: Vec<f32> = values(&u, dims, smooth).iter().map(|f| (f * 1024.0).round() / 1024.0).collect();
        let scaled: Vec<f32> = f.iter().map(|f| f * factor as f32).collect();
        let close = |base: Estimate, scaled: Estimate| {
            let error = (scaled.mean[0] - factor as f32 * base.mean[0]).abs();
            let size = factor.abs() as f32 * (base.mean[0].abs() + largest(&f) as f32);
            prop_assert!(error <= 1e-5 * size, "{:?} {:?}", base, scaled);
            Ok(())
        };
        close(batch::<f64>(&config, &u, &f).unwrap(), batch::<f64>(&config, &u, &scaled).unwrap())?;
        if estimator != Estimator::LeaveOneOut {
            close(streamed::<f64>(&config, &u, &f).unwrap(), streamed::<f64>(&config, &u, &scaled).unwrap())?;
        }
    }

    /// image_fits.md: but for the robust choice a pixel's own samples never shape its correction, and their order
    /// never matters, within the rounding of a fit in `f32`.
    #[test]
    fn a_pixel_does_not_see_itself(
        estimator in 0..3_usize,
        width in 1..10_usize,
        height in 1..10_usize,
        n in 1..5_usize,
        order in 1..3_usize,
        in_order in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let estimator = [Estimator::LeaveOneOut, Estimator::KFold, Estimator::Robust][estimator];
        let config = config(2, order, estimator);
        let ridge = if estimator == Estimator::Robust { Ridge::Fixed(0.02) } else { config.ridge };
        let config = Config { ridge, ..config };
        let (mut rng, pixels) = (SplitMix64::new(seed), width * height);
        let u = points(pixels * n, 2, &mut rng);
        let f = values(&u, 2, smooth);
        let call = |u: &[f32], f: &[f32]| match in_order {
            true => image(&config, &Image::new(width, height), Samples::new(u, f)).unwrap(),
            false => block(&config, pixels, Samples::new(u, f)).unwrap(),
        };
        let pixel = rng.below(pixels);
        let own = pixel * n..(pixel + 1) * n;
        let correction = |f: &[f32]| call(&u, f)[pixel].mean[0] - f[own.clone()].iter().sum::<f32>() / n as f32;
        let mut other = f.clone();
        other[own.clone()].iter_mut().for_each(|f| *f = 3.0 * rng.uniform_f32() - 1.0);
        let (a, b) = (correction(&f), correction(&other));
        prop_assert!((a - b).abs() < 3e-4, "{a} {b}");

        let (mut turned_u, mut turned_f) = (u.clone(), f.clone());
        turned_f[own.clone()].reverse();
        turned_u[2 * own.start..2 * own.end].as_chunks_mut::<2>().0.reverse();
        for (a, b) in call(&u, &f).iter().zip(call(&turned_u, &turned_f)) {
            prop_assert!((a.mean[0] - b.mean[0]).abs() < 1e-4, "{:?} {:?}", a, b);
        }
    }
}
