//! One number of dimensions, one number of samples: errors and times of every estimator on every kind of samples.

use crate::integrands::{Family, Moments, Scene, Variant};
use crate::samplers::Source;
use anyhow::{Context, Result};
use noisefloor::control_variate::{
    Config, Estimate, Image, Samples, estimate, estimate_image, image_workspace_len, workspace_len,
};
use noisefloor_bench::Extent;
use noisefloor_tests::random::{SplitMix64, mix};
use rayon::prelude::*;
use std::fs;
use std::time::Instant;

pub(crate) const DIMS: [usize; 6] = [1, 2, 4, 5, 8, 15];
pub(crate) const COUNTS: [usize; 5] = [1, 4, 16, 64, 256];
/// Integrands that are estimated together, as a renderer's colours are.
pub(crate) const CHANNELS: usize = 3;
/// The filter's standard deviation, and where it is cut.
const DEVIATION: f64 = 2.1;
const RADIUS: usize = 5;

/// How samples become an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Mean,
    /// The robust estimator on each pixel's samples, told that they are independent.
    PerPixel,
    /// The robust estimator of windows of 8 x 8 pixels, one beside the other.
    Blocks,
    /// The same with windows that overlap by half.
    Windows,
}

/// An estimator and its basis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Method {
    pub(crate) kind: Kind,
    pub(crate) order: usize,
    /// Coordinates that are regressed.
    pub(crate) regressed: usize,
}

impl Method {
    /// All that are worth a measurement, the plain mean first.
    fn all(source: Source, dims: usize, n: usize, full: bool) -> Vec<Self> {
        let mut methods = vec![Self { kind: Kind::Mean, order: 0, regressed: dims }];
        if !source.is_main(dims, n) {
            return methods;
        }
        for kind in [Kind::PerPixel, Kind::Blocks, Kind::Windows] {
            if kind == Kind::PerPixel && n == 1 {
                continue;
            }
            // Samples whose strata a pixel's own fit spoils do not need higher orders.
            let highest = if kind == Kind::PerPixel && source != Source::Independent { 3 } else { 7 };
            let orders = [1, 2, 3, 5, 7].into_iter().filter(|&order| order <= highest);
            methods.extend(orders.map(|order| Self { kind, order, regressed: dims }));
        }
        if dims > 4 {
            methods.push(Self { kind: Kind::Windows, order: 2, regressed: 4 });
        }
        let terms = |method: &Self| Config::new(method.regressed, method.order, CHANNELS).terms();
        // Most of the time would go there: overlapping windows, where many samples gain nothing by them, and many
        // functions.
        let large = |method: &Self| match method.kind {
            Kind::Windows => n >= 64 || terms(method).is_ok_and(|terms| terms > 30),
            _ => terms(method).is_ok_and(|terms| terms > 100) && n >= 64,
        };
        // Orders above 3 where they have few functions: more cost more than they bring.
        let few = |method: &Self| if method.kind == Kind::PerPixel { 21 } else { 8 };
        let high = |method: &Self| method.order > 3 && terms(method).is_ok_and(|terms| terms > few(method));
        methods.retain(|method| terms(method).is_ok() && !high(method) && (full || !large(method)));
        methods
    }

    pub(crate) fn name(&self, dims: usize) -> String {
        let Self { order, regressed, .. } = *self;
        let of = if regressed < dims { format!(" of the first {regressed} dims") } else { String::new() };
        match self.kind {
            Kind::Mean => "plain mean".to_owned(),
            Kind::PerPixel => format!("per pixel, order {order}{of}"),
            Kind::Blocks => format!("shared, stride 8, order {order}{of}"),
            Kind::Windows => format!("shared, stride 4, order {order}{of}"),
        }
    }

    /// The estimates of all pixels, channel after channel, and the nanoseconds that it took.
    fn estimates(
        &self,
        samples: Samples<'_>,
        dims: usize,
        side: usize,
        n: usize,
    ) -> Result<([Vec<f64>; CHANNELS], f64)> {
        let config = Config { stride: dims, ..Config::new(self.regressed, self.order, CHANNELS) };
        let mut out = [(); CHANNELS].map(|()| Vec::with_capacity(side * side));
        let mut push =
            |estimate: Estimate| out.iter_mut().zip(estimate.mean).for_each(|(out, mean)| out.push(f64::from(mean)));
        let stride = match self.kind {
            Kind::Blocks => 8,
            _ => 4,
        };
        let ns = if matches!(self.kind, Kind::Mean | Kind::PerPixel) {
            let mut workspace = vec![0.0f64; workspace_len::<f64>(&config, n).context("no workspace")?];
            let pixels = samples.u.chunks_exact(n * dims).zip(samples.f.chunks_exact(n * CHANNELS));
            let start = Clock::now();
            for (u, f) in pixels {
                push(estimate(&config, Samples::new(u, f), &mut workspace).context("per pixel")?);
            }
            start.ns()
        } else {
            let image = Image { stride, ..Image::new(side, side) };
            let mut workspace = vec![0.0; image_workspace_len(&config, &image, n).context("no workspace")?];
            let start = Clock::now();
            let mut put = |_, estimate| push(estimate);
            estimate_image(&config, &image, samples, &mut workspace, &mut put).context("shared")?;
            start.ns()
        };
        Ok((out, ns))
    }
}

/// The figures of a method on a kind of samples.
pub(crate) struct Cell {
    pub(crate) dims: usize,
    pub(crate) n: usize,
    pub(crate) source: Source,
    pub(crate) method: Method,
    pub(crate) errors: Vec<Errors>,
    /// Nanoseconds per sample of the estimate, and of drawing the sample, of each image.
    pub(crate) ns: Vec<f64>,
    pub(crate) draw_ns: Vec<f64>,
}

/// Mean squared errors of one integrand, over those of the plain mean of independent samples.
#[derive(Clone, Copy)]
pub(crate) struct Errors {
    pub(crate) family: Family,
    pub(crate) variant: Variant,
    pub(crate) raw: f64,
    pub(crate) filtered: f64,
}

/// Pixels in a row: fewer where samples cost much.
fn side(dims: usize, n: usize) -> usize {
    let samples = match dims {
        ..=2 => 1 << 18,
        3..=4 => 1 << 17,
        5..=8 => 1 << 16,
        _ => 1 << 13,
    };
    [64, 32].into_iter().find(|side| side * side * n <= samples).unwrap_or(24)
}

/// Time that this thread was running, where the system says and it is long enough to be exact; else time that passed.
struct Clock {
    start: Instant,
    running: Option<f64>,
}

impl Clock {
    fn now() -> Self {
        Self { running: Self::running(), start: Instant::now() }
    }

    fn running() -> Option<f64> {
        fs::read_to_string("/proc/thread-self/schedstat").ok()?.split(' ').next()?.parse().ok()
    }

    fn ns(&self) -> f64 {
        let passed = self.start.elapsed().as_nanos() as f64;
        let ran = Self::running().zip(self.running).map(|(now, then)| now - then);
        ran.filter(|_| passed > 4e7).unwrap_or(passed)
    }
}

/// An image: which repetition, and of what.
type Subject = (usize, (Family, Variant));

/// One number of dims and of samples.
#[derive(Clone, Copy)]
struct Place {
    dims: usize,
    n: usize,
    /// Pixels in a row.
    side: usize,
}

impl Place {
    fn samples(self) -> usize {
        self.side * self.side * self.n
    }

    /// The integrands of an image, the same whatever the samples and their number, and a seed for its samples.
    fn scenes(self, (repetition, (family, variant)): Subject) -> ([Scene; CHANNELS], u64) {
        let seed = mix((repetition * 8 + family as usize * 2 + variant as usize) as u64 ^ (self.dims as u64) << 32);
        let mut rng = SplitMix64::new(seed);
        ([(); CHANNELS].map(|()| Scene::new(family, variant, self.dims, &mut rng)), seed)
    }

    fn points(self, source: Source, seed: u64) -> Result<Vec<f32>> {
        source.points(self.dims, self.n, self.side, mix(seed ^ (self.n as u64) << 16 ^ source as u64))
    }

    /// The errors of each method on one image.
    fn errors(self, source: Source, methods: &[Method], subject: Subject) -> Result<Vec<Vec<Errors>>> {
        let Self { dims, n, side } = self;
        let ((_, (family, variant)), (scenes, seed)) = (subject, self.scenes(subject));
        let u = self.points(source, seed)?;
        let f = values(&scenes, &u, dims, n, side);
        let truth = scenes.each_ref().map(|scene| scene.moments(side));
        let errors = methods.iter().map(|method| {
            let (estimates, _) = method.estimates(Samples::new(&u, &f), dims, side, n)?;
            let errors = estimates.iter().zip(&truth).map(|(estimates, truth)| {
                let [raw, filtered] = score(estimates, truth, side, n);
                Errors { family, variant, raw, filtered }
            });
            Ok(errors.collect())
        });
        errors.collect()
    }

    /// Nanoseconds per sample of each method, one image of each family after the other: shared fits take longer where
    /// they leave bright pixels out.
    fn times(self, methods: &[Method], subjects: &[Subject]) -> Result<Vec<Vec<f64>>> {
        let mut all = vec![Vec::new(); methods.len()];
        for &subject in subjects {
            let (scenes, seed) = self.scenes(subject);
            let u = self.points(Source::Independent, seed)?;
            let f = values(&scenes, &u, self.dims, self.n, self.side);
            for (method, times) in methods.iter().zip(&mut all) {
                let (_, ns) = method.estimates(Samples::new(&u, &f), self.dims, self.side, self.n)?;
                times.push(ns / self.samples() as f64);
            }
        }
        Ok(all)
    }

    /// Nanoseconds of a draw, round by round.
    fn draw_times(self, source: Source, seed: u64) -> Result<Vec<f64>> {
        let time = |_| {
            let start = Clock::now();
            self.points(source, seed)?;
            Ok(start.ns() / self.samples() as f64)
        };
        (0..ROUNDS).map(time).collect()
    }
}

/// How often drawing is timed.
const ROUNDS: usize = 3;

/// Adds the cells of all kinds of samples. Errors come from all threads, image by image, and are the same on any number
/// of them; times are taken after that, when nothing else runs.
pub(crate) fn measure(cells: &mut Vec<Cell>, dims: usize, n: usize, extent: Extent) -> Result<()> {
    let (full, place) = (extent == Extent::Full, Place { dims, n, side: side(dims, n) });
    let kinds = Family::ALL.into_iter().flat_map(|family| Variant::ALL.map(|variant| (family, variant)));
    let kinds: Vec<_> = kinds.take(if extent == Extent::Quick { 2 } else { usize::MAX }).collect();
    let subjects: Vec<Subject> = (0..if full { 4 } else { 1 })
        .flat_map(|repetition| kinds.iter().map(move |&kind| (repetition, kind)))
        .collect();
    let sources: Vec<(Source, Vec<Method>)> = Source::ALL
        .into_iter()
        .filter(|source| source.applies(dims, n))
        .map(|source| (source, Method::all(source, dims, n, full)))
        .collect();
    let images: Vec<_> = sources.iter().flat_map(|of| subjects.iter().map(move |&subject| (of, subject))).collect();
    let errors: Vec<Vec<Vec<Errors>>> = images
        .par_iter()
        .with_max_len(1)
        .map(|((source, methods), subject)| place.errors(*source, methods, *subject))
        .collect::<Result<_>>()?;
    // Of independent samples all methods are measured that are measured of any.
    let timed = Method::all(Source::Independent, dims, n, full);
    let each_family: Vec<Subject> = subjects.iter().copied().take(kinds.len()).step_by(Variant::ALL.len()).collect();
    let times = place.times(&timed, &each_family)?;
    for ((source, methods), errors) in sources.iter().zip(errors.chunks(subjects.len())) {
        let draw_ns = place.draw_times(*source, 1)?;
        for (index, &method) in methods.iter().enumerate() {
            let at = timed.iter().position(|of| *of == method).context("an estimator was not timed")?;
            cells.push(Cell {
                dims,
                n,
                source: *source,
                method,
                errors: errors.iter().flat_map(|methods| methods[index].iter().copied()).collect(),
                ns: times[at].clone(),
                draw_ns: draw_ns.clone(),
            });
        }
    }
    Ok(())
}

fn values(scenes: &[Scene; CHANNELS], u: &[f32], dims: usize, n: usize, side: usize) -> Vec<f32> {
    let mut f = Vec::with_capacity(u.len() / dims * CHANNELS);
    for (index, u) in u.chunks_exact(n * dims).enumerate() {
        let pixels = scenes.each_ref().map(|scene| scene.pixel(index % side, index / side));
        for u in u.chunks_exact(dims) {
            f.extend(scenes.iter().zip(pixels).map(|(scene, pixel)| scene.value(pixel, u)));
        }
    }
    f
}

/// The mean squared error of an image, and of the filtered image, over what the plain mean of independent samples has.
fn score(estimates: &[f64], truth: &[Moments], side: usize, n: usize) -> [f64; 2] {
    let errors: Vec<f64> = estimates.iter().zip(truth).map(|(estimate, truth)| estimate - truth.mean).collect();
    let variances: Vec<f64> = truth.iter().map(|truth| truth.variance / n as f64).collect();
    let square = |errors: &[f64]| errors.iter().map(|error| error * error).sum::<f64>();
    let weights: Vec<f64> = (0..=2 * RADIUS)
        .map(|tap| (-(tap as f64 - RADIUS as f64).powi(2) / (2.0 * DEVIATION * DEVIATION)).exp())
        .collect();
    let sum: f64 = weights.iter().sum();
    let weights: Vec<f64> = weights.iter().map(|weight| weight / sum).collect();
    let squares: Vec<f64> = weights.iter().map(|weight| weight * weight).collect();
    let filtered = square(&filter(&errors, &weights, side)) / filter(&variances, &squares, side).iter().sum::<f64>();
    [square(&errors) / variances.iter().sum::<f64>(), filtered]
}

/// A separable filter, of the pixels that have all its taps in the image: parts of a tile have no opposite borders that
/// match.
fn filter(image: &[f64], weights: &[f64], side: usize) -> Vec<f64> {
    let rows: Vec<f64> = image.chunks_exact(side).flat_map(|row| along(row, weights)).collect();
    let narrow = side + 1 - weights.len();
    let column = |x: usize| rows[x..].iter().step_by(narrow).copied().collect::<Vec<f64>>();
    (0..narrow).flat_map(|x| along(&column(x), weights)).collect()
}

fn along(values: &[f64], weights: &[f64]) -> Vec<f64> {
    values
        .windows(weights.len())
        .map(|window| window.iter().zip(weights).map(|(value, weight)| value * weight).sum())
        .collect()
}
