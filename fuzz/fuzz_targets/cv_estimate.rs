//! Any configuration and any samples through every control-variate call: an error or finite numbers, never a panic.
#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use libfuzzer_sys::fuzz_target;
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{
    self, Accumulator, Color, Config, Estimate, Image, NonFinite, Optimizer, Ridge, Samples, Solver, estimate_image,
    image_workspace_len, workspace_len,
};
use noisefloor::real::Real;
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::stream::Stream;

/// Workspaces beyond this many numbers are not allocated.
const MOST: usize = 1 << 18;

#[derive(Debug)]
struct Input {
    config: Config,
    u: Vec<f32>,
    f: Vec<f32>,
    controls: Vec<f32>,
    control_integrals: Vec<f32>,
    start: Vec<f32>,
    pixels: usize,
    split: usize,
}

fn small(bytes: &mut Unstructured<'_>, most: u8) -> arbitrary::Result<usize> {
    // Now and then far out of range.
    Ok(match u8::arbitrary(bytes)? {
        255 => usize::arbitrary(bytes)?,
        byte => usize::from(byte % (most + 1)),
    })
}

fn number(bytes: &mut Unstructured<'_>) -> arbitrary::Result<f32> {
    Ok(match u8::arbitrary(bytes)? {
        0..=127 => 0.0,
        128..=223 => f32::from(u8::arbitrary(bytes)?) / 255.0,
        _ => f32::arbitrary(bytes)?,
    })
}

impl<'a> Arbitrary<'a> for Input {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let config = Config {
            dims: small(bytes, 16)?,
            order: small(bytes, 7)?,
            channels: small(bytes, 4)?,
            estimator: *bytes.choose(&ESTIMATORS)?,
            basis: *bytes.choose(&Family::ALL)?,
            stratified: u8::arbitrary(bytes)? < 16,
            slices: small(bytes, 8)?.saturating_sub(3),
            edges: 0,
            controls: small(bytes, 6)?.saturating_sub(2),
            stride: small(bytes, 18)?.saturating_sub(10),
            solver: *bytes.choose(&[Solver::Auto, Solver::NormalEquations, Solver::SquareRoot, Solver::Dual])?,
            non_finite: *bytes.choose(&[NonFinite::Error, NonFinite::Skip])?,
            color: if u8::arbitrary(bytes)? < 32 { Color::LuminanceRatio } else { Color::PerChannel },
            // Nested folds cost the square of their number.
            folds: small(bytes, 5)?,
            // At most 40 steps, which take their time, or too many, which is an error.
            iterations: Some(small(bytes, 40)?).filter(|&steps| steps <= 40 || steps > 1 << 20).unwrap_or(7),
            optimizer: *bytes.choose(&[Optimizer::Momentum, Optimizer::Adam, Optimizer::Plain])?,
            ridge: match u8::arbitrary(bytes)? % 4 {
                0 => Ridge::Auto,
                1 => Ridge::Fixed(number(bytes)?),
                _ => Ridge::Default,
            },
            learning_rate: number(bytes)?,
            momentum: number(bytes)?,
        };
        let n = usize::from(u8::arbitrary(bytes)? % 40);
        let slack = usize::from(u8::arbitrary(bytes)? / 250);
        let len = |width: usize| n.saturating_mul(width).min(4096) + slack;
        let step = if config.stride == 0 { config.dims } else { config.stride };
        let positions = |bytes: &mut Unstructured<'a>| {
            Ok(match u8::arbitrary(bytes)? {
                0..=249 => f32::from(u16::arbitrary(bytes)?) / 65535.0,
                _ => f32::arbitrary(bytes)?,
            })
        };
        let numbers = |bytes: &mut Unstructured<'a>, len: usize| (0..len).map(|_| f32::arbitrary(bytes)).collect();
        let finite = bool::arbitrary(bytes)?;
        let value = |bytes: &mut Unstructured<'a>| {
            let value = f32::arbitrary(bytes)?;
            Ok(if finite && !value.is_finite() { 1.0 } else { value })
        };
        let u: arbitrary::Result<_> = (0..len(step)).map(|_| positions(bytes)).collect();
        let f: arbitrary::Result<_> = (0..len(config.channels)).map(|_| value(bytes)).collect();
        let controls: arbitrary::Result<_> = (0..len(config.controls)).map(|_| value(bytes)).collect();
        let integrals: arbitrary::Result<_> = (0..config.controls.min(8)).map(|_| value(bytes)).collect();
        let columns = config.terms().map_or(0, |terms| terms - 1);
        let start: arbitrary::Result<Vec<f32>> = numbers(bytes, (columns * config.channels.min(4)).min(64));
        let mut start = start?;
        start.resize(columns.saturating_mul(config.channels.min(4)), 0.0);
        Ok(Self {
            config,
            u: u?,
            f: f?,
            controls: controls?,
            control_integrals: integrals?,
            start,
            pixels: usize::from(u8::arbitrary(bytes)? % 10),
            split: usize::from(u8::arbitrary(bytes)?),
        })
    }
}

fn check(result: Result<Estimate, Error>) -> Result<Estimate, Error> {
    if let Ok(estimate) = result {
        assert!(estimate.mean.iter().all(|mean| mean.is_finite()), "{estimate:?}");
        assert!(estimate.std_error.iter().all(|&error| error >= 0.0), "{estimate:?}");
        assert!(!estimate.gain.is_nan(), "{estimate:?}");
    }
    result
}

fn run<R: Real>(input: &Input) {
    let config = &input.config;
    let nan = R::from_f64(f64::NAN);
    let samples =
        Samples { u: &input.u, f: &input.f, controls: &input.controls, control_integrals: &input.control_integrals };
    let n = input.f.len().checked_div(config.channels).unwrap_or(0);
    match workspace_len::<R>(config, n) {
        Ok(len) if len <= MOST => {
            let mut workspace = vec![nan; len];
            let whole = check(control_variate::estimate(config, samples, &mut workspace));
            assert_ne!(whole, Err(Error::Memory));
            let short = check(control_variate::estimate(config, samples, &mut workspace[..len / 2]));
            assert!(short.is_err() || short == whole);
            let mut start = input.start.clone();
            if check(control_variate::gradient_descent(config, samples, &mut start, &mut workspace)).is_ok() {
                assert!(start.iter().all(|value| value.is_finite()));
            }
        }
        Ok(_) => {}
        Err(_) => assert!(control_variate::estimate(config, samples, &mut [nan; 256]).is_err()),
    }
    let image = Image::unordered(input.pixels);
    if let Ok(len) = image_workspace_len(config, &image, n.checked_div(input.pixels).unwrap_or(0))
        && len <= MOST
    {
        let mut count = 0;
        let result = estimate_image(config, &image, samples, &mut vec![f32::NAN; len], &mut |_, estimate| {
            count += 1;
            check(Ok(estimate)).ok();
        });
        assert_eq!(count, if result.is_ok() { input.pixels } else { 0 });
    }
    if let Ok(len) = Accumulator::<R>::new(config).map(|accumulator| accumulator.len())
        && len <= MOST
    {
        let mut accumulator = Stream::<R>::new(config).unwrap();
        let mut other = accumulator.clone();
        let mut workspace = accumulator.workspace();
        let step = if config.stride == 0 { config.dims } else { config.stride };
        let at = input.split.min(n);
        let cut = |array: &[f32], width: usize| at.saturating_mul(width).min(array.len());
        let (u, f, h) = (cut(&input.u, step), cut(&input.f, config.channels), cut(&input.controls, config.controls));
        let first = Samples { u: &input.u[..u], f: &input.f[..f], controls: &input.controls[..h], ..samples };
        let second = Samples { u: &input.u[u..], f: &input.f[f..], controls: &input.controls[h..], ..samples };
        for (accumulator, samples) in [(&mut accumulator, first), (&mut other, second)] {
            let before = accumulator.samples();
            if accumulator.add(samples).is_err() {
                assert_eq!(accumulator.samples(), before);
            }
            check(accumulator.estimate(&mut workspace)).ok();
        }
        accumulator.merge(&other).unwrap();
        let merged = check(accumulator.estimate(&mut workspace));
        assert_eq!(merged.is_ok(), accumulator.samples() > 0);
        accumulator.add(samples).ok();
        check(accumulator.estimate(&mut workspace)).ok();
        accumulator.reset();
        assert_eq!(accumulator.estimate(&mut workspace), Err(Error::NoSamples));
    }
}

fuzz_target!(|input: Input| {
    run::<f64>(&input);
    run::<f32>(&input);
});
