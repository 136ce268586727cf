//! Seconds against quality of point sets: `cargo bench --package noisefloor-bench --bench point_sets`.
//!
//! Sets of 256 to a million points and of 1 to 15 classes are optimised and measured beside random and Owen-scrambled
//! Sobol points; longer and shorter runs of the same sizes say what a second buys. What the report's chapter on points
//! shows, as CSV.

use anyhow::{Context, Result};
use clap::Parser;
use fsot::class::{Class, ClassFunction, Step};
use fsot::metrics::discrepancy::discrepancy;
use fsot::metrics::neighbours::neighbours;
use fsot::metrics::prefix_errors;
use fsot::metrics::transport::slice_distance;
use fsot::optimize::{Optimizer, Problem, Quality};
use fsot::points::Points;
use fsot::run::Optimization;
use fsot::target::Uniform;
use noisefloor::tile::{Builtin, Sampler};
use noisefloor_bench::{Extent, Options};
use noisefloor_tests::random::SplitMix64;
use std::f64::consts::PI;
use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

/// Points of a million.
const MILLION: usize = 1 << 20;
/// Steps of a million points where the time is short: draft quality has 80.
const FEW_STEPS: u64 = 24;

/// How often random and Sobol points are measured: from so many on one set is like another, and measuring takes
/// seconds.
fn peer_seeds(points: usize, full: bool) -> u64 {
    match points {
        ..=16_384 => 4,
        16_385..=65_536 if full => 4,
        16_385..=65_536 => 2,
        _ => 1,
    }
}

/// One set to make.
#[derive(Clone, Copy)]
struct Run {
    /// Which part of the study.
    study: &'static str,
    /// Colours: there is a class for each of their combinations.
    colours: usize,
    points: usize,
    quality: Quality,
    seeds: u64,
}

/// Scaling: draft quality, as many points as the time allows. Then the quality that longer runs reach.
fn runs(extent: Extent) -> Vec<Run> {
    let (quick, full) = (extent == Extent::Quick, extent == Extent::Full);
    let more = |seeds: u64| if full { 4 * seeds } else { seeds };
    let sizes: &[usize] = extent.choose(
        &[256, 512, 1024],
        &[256, 1024, 4096, 8192, 16_384, 65_536],
        &[256, 1024, 4096, 8192, 16_384, 65_536, 262_144],
    );
    let mut runs = Vec::new();
    for colours in 1..=4 {
        // Draft quality takes steps for each class, up to eight.
        let most = match colours {
            1 => usize::MAX,
            _ if full => 65_536,
            _ => 16_384,
        };
        for &points in sizes.iter().filter(|&&points| points <= most) {
            let seeds = if quick { 1 } else { more(if points <= 4096 { 4 } else { 2 }) };
            runs.push(Run { study: "scaling", colours, points, quality: Quality::Draft, seeds });
        }
    }
    let single = |study, points, quality, seeds| Run { study, colours: 1, points, quality, seeds };
    if quick {
        runs.push(single("steps", 256, Quality::Iterations(64), 1));
        runs.push(single("standard", 256, Quality::Standard, 1));
        return runs;
    }
    if full {
        runs.push(single("scaling", MILLION, Quality::Draft, 1));
    } else {
        runs.push(single("scaling", 262_144, Quality::Draft, 1));
        runs.push(single("million", MILLION, Quality::Iterations(FEW_STEPS), 1));
    }
    runs.push(single("one thread", 4096, Quality::Iterations(512), 3));
    for points in [1024, 4096] {
        for steps in [32, 128, 512, 2048, 8192] {
            let seeds = if steps > 2048 { more(1) } else { more(2) };
            runs.push(single("steps", points, Quality::Iterations(steps), seeds));
        }
    }
    for points in [256, 1024, 4096, 16_384] {
        runs.push(single("standard", points, Quality::Standard, more(if points > 4096 { 1 } else { 2 })));
    }
    runs
}

fn main() -> Result<()> {
    let options = Options::parse();
    let extent = options.extent();
    let mut out = "study,set,sampler,classes,points,steps,seed,threads,seconds,part,of_points,w2,bound,\
                   discrepancy,discrepancy_relative,neighbour,\
                   half_planes,gaussians,half_planes_relative,gaussians_relative\n"
        .to_owned();
    let runs = runs(extent);
    for run in &runs {
        eprintln!("{}: {} points, {} classes", run.study, run.points, (1 << run.colours) - 1);
        for seed in 0..run.seeds {
            optimised(run, seed, &mut out)?;
        }
    }
    let mut sizes: Vec<(usize, u64)> =
        runs.iter().map(|run| (run.points, peer_seeds(run.points, extent == Extent::Full))).collect();
    sizes.sort_unstable();
    sizes.dedup();
    for (points, seeds) in sizes {
        eprintln!("random and Sobol: {points} points");
        for seed in 0..extent.choose(1, seeds, seeds) {
            for (name, of) in [("random", random as fn(usize, u64) -> Result<Points>), ("Owen-Sobol", sobol)] {
                let start = Instant::now();
                let set = of(points, seed)?;
                let seconds = start.elapsed().as_secs_f64();
                write!(out, "peer,{name},{name},1,{points},0,{seed},1,{seconds:.5e},")?;
                figures(&set, "all", &mut out)?;
            }
        }
    }
    options.write("point_sets", &[("points.csv", out)])
}

/// Rows of all points, and of the first colour's where there are several.
fn optimised(run: &Run, seed: u64, out: &mut String) -> Result<()> {
    let classes = combinations(run.colours);
    let count = classes.len();
    let problem = Problem { classes, seed: seed + 1, quality: run.quality, ..Problem::new(run.points, 2) };
    let threads = if run.study == "one thread" { 1 } else { rayon::current_num_threads() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let start = Instant::now();
    let optimizer = pool.install(|| -> Result<Optimizer> {
        let mut optimizer = Optimizer::new(problem)?;
        while optimizer.iteration() < optimizer.iterations() {
            optimizer.step();
        }
        Ok(optimizer)
    })?;
    let seconds = start.elapsed().as_secs_f64();
    let points = optimizer.points();
    let set = match run.study {
        "scaling" => "draft",
        "million" => "few steps",
        study => study,
    };
    let head = format!(
        "{},{set},optimised,{count},{},{},{seed},{threads},{seconds:.5e},",
        run.study,
        run.points,
        optimizer.iterations()
    );
    *out += &head;
    figures(&points, "all", out)?;
    if run.colours > 1 {
        let first = points.coordinates()[..2 * (run.points / run.colours)].to_vec();
        *out += &head;
        figures(&Points::new(2, first), "colour", out)?;
    }
    Ok(())
}

/// Equal shares of the points are colours; each combination of colours is a class of its own, and uniform.
fn combinations(colours: usize) -> Vec<Class> {
    let target: Arc<dyn fsot::target::Target> = Arc::new(Uniform::new(2));
    let class = |set: usize| {
        let step = |colour: usize| Step {
            to: if colour + 1 == colours { 1.0 } else { (colour + 1) as f32 / colours as f32 },
            value: f32::from(u8::from(set >> colour & 1 == 1)),
        };
        let function = ClassFunction::Staircase((0..colours).map(step).collect());
        Class { function, target: Arc::clone(&target), weight: 1.0, name: format!("{set:b}") }
    };
    (1..1 << colours).map(class).collect()
}

fn random(points: usize, seed: u64) -> Result<Points> {
    let mut rng = SplitMix64::new(seed);
    Ok(Points::new(2, (0..2 * points).map(|_| rng.uniform_f32()).collect()))
}

/// The sequence by which a tile of one sample goes on, scrambled for each seed.
fn sobol(points: usize, seed: u64) -> Result<Points> {
    let tile = Builtin::Size128Spp1Dims2.tile().map_err(|error| anyhow::anyhow!("{error}"))?;
    let draw = |index| Sampler::pixel(&tile, 0, 0, 0, index).domain(seed as u32).draw::<2>();
    Ok(Points::new(2, (0..points as u32).flat_map(draw).collect()))
}

/// Slices of the distance, and integrands of each family: fewer of large sets.
fn effort(points: usize) -> (usize, usize) {
    match points {
        0..=16_384 => (256, 512),
        16_385..=65_536 => (64, 256),
        _ => (24, 64),
    }
}

/// The figures of a set, as the last columns of its row.
fn figures(points: &Points, part: &str, out: &mut String) -> Result<()> {
    let (slices, integrands) = effort(points.len());
    let centred: Vec<f64> = points.coordinates().iter().map(|&x| f64::from(x) - 0.5).collect();
    let slice = |index: usize| {
        let angle = (index as f64 + 0.5) / slices as f64 * PI;
        slice_distance(&centred, &[angle.cos(), angle.sin()])
    };
    let (mut distance, mut bound) = (0.0, 0.0);
    for (of, least) in (0..slices).map(slice) {
        distance += of / slices as f64;
        bound += least / slices as f64;
    }
    // Relative: over what as many random points have on average.
    let [star, relative] = discrepancy(points).map_or([f64::NAN; 2], |of| [of.l2_star, of.relative]);
    // Of a million points it would take as long as making them.
    let near = if points.len() > 65_536 { None } else { neighbours(points) };
    let near = near.map_or(f64::NAN, |of| of.mean);
    let count = points.len();
    let errors = prefix_errors(std::slice::from_ref(points), &[count], integrands)?;
    let of = errors.first().context("no integration errors")?;
    writeln!(
        out,
        "{part},{count},{:.5e},{:.5e},{star:.5e},{relative:.5e},{near:.5e},{:.5e},{:.5e},{:.5e},{:.5e}",
        distance.sqrt(),
        bound.sqrt(),
        of.half_spaces,
        of.gaussians,
        of.half_spaces_relative.sqrt(),
        of.gaussians_relative.sqrt()
    )?;
    Ok(())
}
