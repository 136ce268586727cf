//! Settings on the same samples, in turns: errors over the plain mean's and times.

use crate::functions::Function;
use noisefloor_bench::method::{INCREMENTAL, K_FOLD, MEAN};
use noisefloor_bench::{Method, Prepared};
use noisefloor_tests::random::{SplitMix64, mix};
use noisefloor_tests::statistics::{Ratio, median, rmse_ratio};
use std::hint::black_box;
use std::time::Instant;

/// An estimator with its basis, and a total degree.
#[derive(Clone, Copy)]
pub(crate) struct Setting {
    pub(crate) method: Method,
    pub(crate) order: usize,
}

impl Setting {
    pub(crate) fn mean() -> Self {
        Self { method: MEAN, order: 0 }
    }

    pub(crate) fn terms(&self, dims: usize) -> Option<usize> {
        self.method.config(dims, self.order).terms().ok()
    }
}

/// What was measured of a setting.
pub(crate) struct Result {
    pub(crate) setting: Setting,
    pub(crate) repetitions: usize,
    /// RMSE over the plain mean's of the same samples, 95 % interval.
    pub(crate) ratio: Ratio,
    /// Nanoseconds per sample, the integrand not counted: the median over the chunks.
    pub(crate) ns: f64,
    pub(crate) mean_ns: f64,
}

/// Estimates that follow each other without another setting between.
const CHUNK: usize = 8;

/// How long a setting of so many terms may take for one function and sample count, in rough nanoseconds.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    pub(crate) budget: f64,
    /// Bounds of the repetitions.
    pub(crate) repetitions: [usize; 2],
    /// Whether estimators that take several times as long have fewer repetitions.
    pub(crate) by_estimator: bool,
}

impl Effort {
    fn chunks(self, n: usize, terms: usize, method: &Method) -> usize {
        let (n, terms) = (n as f64, terms as f64);
        let rank = terms.min(n);
        // Of what least squares takes.
        let times = match method.name {
            _ if !self.by_estimator => 1.0,
            name if name == INCREMENTAL.name => 6.0,
            name if name == K_FOLD.name => 2.5,
            _ => 1.0,
        };
        let cost = times * n * (20.0 + 2.0 * terms + 0.12 * rank * terms);
        let [low, high] = self.repetitions;
        ((self.budget / cost) as usize).clamp(low, high).div_ceil(CHUNK)
    }
}

struct Track {
    setting: Setting,
    chunks: usize,
    prepared: Prepared,
    errors: Vec<f64>,
    ns: Vec<f64>,
}

/// Measures settings that the function's dims admit; others are left out. The plain mean comes first.
pub(crate) fn measure(function: &Function, settings: &[Setting], n: usize, seed: u64, effort: Effort) -> Vec<Result> {
    let dims = function.dims;
    let mut tracks: Vec<Track> = [Setting::mean()]
        .iter()
        .chain(settings)
        .filter_map(|&setting| {
            let terms = setting.terms(dims)?;
            let prepared = setting.method.prepare(dims, setting.order, n);
            Some(Track {
                setting,
                chunks: effort.chunks(n, terms, &setting.method),
                prepared,
                errors: vec![],
                ns: vec![],
            })
        })
        .collect();
    let chunks = tracks.iter().map(|track| track.chunks).max().unwrap_or(0);
    tracks[0].chunks = chunks;
    let mut rng = SplitMix64::new(mix(seed << 16 | n as u64));
    let (mut u, mut f) = (vec![0.0_f32; CHUNK * n * dims], vec![0.0_f32; CHUNK * n]);
    for chunk in 0..chunks {
        u.iter_mut().for_each(|u| *u = rng.uniform_f32());
        function.values(&u, &mut f);
        for track in tracks.iter_mut().filter(|track| chunk < track.chunks) {
            let mut estimates = [0.0; CHUNK];
            // Not timed: brings code, workspace and samples into the caches, for the first setting as for the others.
            black_box(track.prepared.estimate(&u[..n * dims], &f[..n]));
            let start = Instant::now();
            for ((estimate, u), f) in estimates.iter_mut().zip(u.chunks_exact(n * dims)).zip(f.chunks_exact(n)) {
                *estimate = f64::from(black_box(track.prepared.estimate(black_box(u), black_box(f))));
            }
            track.ns.push(start.elapsed().as_secs_f64() * 1e9 / (CHUNK * n) as f64);
            assert!(estimates.iter().all(|e| e.is_finite()), "{}: {} failed", function.name, track.setting.method.name);
            track.errors.extend(estimates.map(|estimate| estimate - function.integral));
        }
    }
    let mean = &tracks[0];
    let result = |track: &Track| {
        let same = &mean.errors[..track.errors.len()];
        Result {
            setting: track.setting,
            repetitions: track.errors.len(),
            ratio: rmse_ratio(&track.errors, same),
            ns: median(&track.ns),
            mean_ns: median(&mean.ns),
        }
    };
    tracks.iter().map(result).collect()
}
