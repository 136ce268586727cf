//! What is best, and whether `recommend()` says so.

use crate::report::{Summary, summary};
use crate::samplers::Source;
use crate::study::{CHANNELS, Cell, Kind};
use anyhow::{Result, anyhow};
use noisefloor::recommend::{Method as Recommended, Recommendation, Sampling, recommend};
use noisefloor_tests::statistics::{Moments, student};
use std::fmt::Write;

/// Nanoseconds that a sample is taken to cost for each of its dims.
const COST: f64 = 1000.0;
/// How much worse than the plain mean of the same samples an estimator may be for any integrand.
const TOLERANCE: f64 = 1.05;

/// One decision: what is recommended, what was best, and how much worse the first is than the second.
pub(crate) struct Decision {
    dims: usize,
    n: usize,
    samples: &'static str,
    /// Whether neighbouring pixels' samples are at hand; none for the choice of the samples themselves.
    neighbours: &'static str,
    pub(crate) recommended: Choice,
    pub(crate) best: Choice,
    /// Error times time of the first over that of the second, and where it lies with 95 % confidence: of 1, none.
    excess: [f64; 3],
}

pub(crate) struct Choice {
    name: String,
    raw: f64,
    filtered: f64,
    worst: f64,
}

impl Choice {
    fn new(name: String, of: &Summary) -> Self {
        Self { name, raw: of.raw, filtered: of.filtered, worst: of.worst }
    }
}

/// The geometric mean of raw and filtered error.
fn error(s: &Summary) -> f64 {
    (s.raw * s.filtered).sqrt()
}

/// The logarithm of [`error`] for each kind of integrands.
fn logarithms(cell: &Cell) -> Vec<f64> {
    let kind = |all: &[crate::study::Errors]| {
        let count = all.len() as f64;
        let raw = all.iter().map(|errors| errors.raw.ln()).sum::<f64>() / count;
        0.5 * (raw + (all.iter().map(|errors| errors.filtered).sum::<f64>() / count).ln())
    };
    cell.errors.chunks(CHANNELS).map(kind).collect()
}

/// `a`'s error over `b`'s, integrand by integrand, times `times`. Nothing accounts for `b` being the least of several
/// on the same data.
fn excess(a: &Cell, b: &Cell, times: f64) -> [f64; 3] {
    let mut moments = Moments::default();
    logarithms(a).iter().zip(logarithms(b)).for_each(|(a, b)| moments.add(a - b));
    let (middle, spread) = (times.ln() + moments.mean(), student(moments.count() - 1.0) * moments.standard_error());
    [middle.exp(), (middle - spread).exp(), (middle + spread).exp()]
}

/// The recommended kind of samples, or one that stands for it, on which estimators are measured: a tile of 1 sample,
/// continued, is a Sobol sequence.
fn source(says: &Recommendation, stratified: bool, dims: usize, n: usize) -> Source {
    match (stratified, n) {
        (false, _) => Source::Independent,
        (true, ..64) if says.tile_dims == 4 && Source::Tile4.is_main(dims, n) => Source::Tile4,
        (true, ..64) => Source::Tile,
        (true, _) => Source::Sobol,
    }
}

/// All that `recommend()` decides, of the dims and samples that were measured.
pub(crate) fn all(cells: &[Cell]) -> Result<Vec<Decision>> {
    let mut places: Vec<(usize, usize)> = cells.iter().map(|cell| (cell.dims, cell.n)).collect();
    places.dedup();
    let mut all = Vec::new();
    for (dims, n) in places {
        let here: Vec<&Cell> = cells.iter().filter(|cell| (cell.dims, cell.n) == (dims, n)).collect();
        let says =
            |sampling, share| recommend(dims, n, sampling, share, f32::INFINITY).map_err(|error| anyhow!("{error}"));
        all.extend(samples(cells, &here, &says(Sampling::Stratified, false)?));
        for stratified in [false, true] {
            for share in [false, true] {
                let sampling = if stratified { Sampling::Stratified } else { Sampling::Independent };
                let says = says(sampling, share)?;
                let source = source(&says, stratified, dims, n);
                let of: Vec<&Cell> = here.iter().copied().filter(|cell| cell.source == source).collect();
                all.extend(estimator(cells, &of, &says, stratified, share));
            }
        }
    }
    Ok(all)
}

/// Of all kinds of stratified samples that with the least error of the plain mean.
fn samples(cells: &[Cell], here: &[&Cell], says: &Recommendation) -> Option<Decision> {
    let means =
        here.iter().filter(|cell| cell.method.kind == Kind::Mean && cell.source != Source::Independent).copied();
    let means: Vec<(&Cell, Summary)> = means.map(|cell| (cell, summary(cell, cells))).collect();
    let best = means.iter().min_by(|a, b| error(&a.1).total_cmp(&error(&b.1)))?;
    let (dims, n) = (best.0.dims, best.0.n);
    let wanted = match (says.tile_samples, says.tile_dims) {
        (1, 4) if n == 1 => Source::Tile4,
        (1, _) if n > 1 => Source::TileSobol,
        (_, 4) => Source::Tile4,
        _ => Source::Tile,
    };
    let own = means.iter().find(|(cell, _)| cell.source == wanted)?;
    let choice = |of: &(&Cell, Summary)| Choice::new(of.0.source.name().to_owned(), &of.1);
    let excess = excess(own.0, best.0, 1.0);
    Some(Decision {
        dims,
        n,
        samples: "stratified",
        neighbours: "",
        recommended: choice(own),
        best: choice(best),
        excess,
    })
}

/// Of the estimators that are safe, that with the least error times time.
fn estimator(cells: &[Cell], here: &[&Cell], says: &Recommendation, stratified: bool, share: bool) -> Option<Decision> {
    let kind = match (says.method, says.image_stride) {
        (Recommended::PlainMean, _) => Kind::Mean,
        (Recommended::PerPixel, _) => Kind::PerPixel,
        (Recommended::Shared, 8) => Kind::Blocks,
        (Recommended::Shared, _) => Kind::Windows,
    };
    let possible = here.iter().copied().filter(|cell| match cell.method.kind {
        Kind::Mean => true,
        Kind::PerPixel => !stratified,
        // At 16 stratified samples they hardly gain in rendered frames; more are taken to be alike.
        Kind::Blocks | Kind::Windows => share && !(stratified && cell.n >= 64),
    });
    let all: Vec<(&Cell, Summary)> =
        possible.filter(|cell| cell.method.regressed == cell.dims).map(|cell| (cell, summary(cell, cells))).collect();
    let time = |cell: &Cell, s: &Summary| COST * cell.dims as f64 + s.ns;
    let worth = |(cell, s): &(&Cell, Summary)| error(s) * time(cell, s);
    let safe = |(cell, s): &&(&Cell, Summary)| cell.method.kind == Kind::Mean || s.worst < TOLERANCE;
    let best = all.iter().filter(safe).min_by(|a, b| worth(a).total_cmp(&worth(b)))?;
    let order = if kind == Kind::Mean { 0 } else { says.config.order };
    // What took too long to measure cannot be judged.
    let own = all.iter().find(|(cell, _)| (cell.method.kind, cell.method.order) == (kind, order))?;
    let choice = |of: &(&Cell, Summary)| Choice::new(of.0.method.name(of.0.dims), &of.1);
    Some(Decision {
        dims: own.0.dims,
        n: own.0.n,
        samples: if stratified { "stratified" } else { "independent" },
        neighbours: if share { "shared" } else { "alone" },
        recommended: choice(own),
        best: choice(best),
        excess: excess(own.0, best.0, time(own.0, &own.1) / time(best.0, &best.1)),
    })
}

pub(crate) fn csv(all: &[Decision]) -> Result<String> {
    let mut out =
        "dims,n,samples,neighbours,recommended,raw,filtered,worst,best,best_raw,best_filtered,best_worst,excess,\
                   excess_low,excess_high\n"
            .to_owned();
    for decision in all {
        let Decision { dims, n, samples, neighbours, recommended, best, excess: [excess, low, high] } = decision;
        write!(out, "{dims},{n},{samples},{neighbours}")?;
        for Choice { name, raw, filtered, worst } in [recommended, best] {
            write!(out, ",{},{raw:.5e},{filtered:.5e},{worst:.4}", name.replace(',', ";"))?;
        }
        writeln!(out, ",{excess:.4},{low:.4},{high:.4}")?;
    }
    Ok(out)
}
