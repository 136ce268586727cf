//! Nanoseconds of a draw: constructing a pixel's sampler and drawing its numbers, pixels row by row.

use crate::sampler::{DIMS, SIDE, Sampler, heitz, sobol};
use anyhow::Result;
use noisefloor::rng::Rng;
use noisefloor::sampler;
use noisefloor::tile::{Builtin, Sampler as Draw, Tile};
use noisefloor_bench::{c_abi, c_sampler, c_tile};
use openqmc::{LatticeBnSampler, PmjBnSampler, SobolBnSampler};
use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

/// Images that are timed together: .4 ms at 5 ns a draw.
const IMAGES: usize = 5;

/// What gives the sum of a pixel's numbers, timed image by image.
struct Timed {
    name: &'static str,
    door: &'static str,
    dims: usize,
    spp: usize,
    time: Box<dyn FnMut() -> f64>,
}

/// Nanoseconds per draw of a few images.
#[inline]
fn time(mut draw: impl FnMut(u32, u32) -> f32) -> f64 {
    let start = Instant::now();
    for _ in 0..IMAGES {
        let mut sum = 0.0;
        for y in 0..SIDE as u32 {
            for x in 0..SIDE as u32 {
                // The coordinates are opaque, as a renderer's are.
                sum += draw(black_box(x), y);
            }
        }
        black_box(sum);
    }
    start.elapsed().as_nanos() as f64 / (IMAGES * SIDE * SIDE) as f64
}

/// A row for each round: the samplers take turns, so that another program slows all alike.
pub(crate) fn csv(counts: &[usize], rounds: usize) -> Result<String> {
    eprintln!("times of draws");
    let mut all = Vec::new();
    for (dims, &spp) in DIMS.into_iter().flat_map(|dims| counts.iter().map(move |spp| (dims, spp))) {
        for sampler in Sampler::ALL.into_iter().filter(|sampler| sampler.applies(dims)) {
            all.push(rust(sampler, dims, spp)?);
            if c_abi::LINKED {
                all.extend(c(sampler, dims, spp)?);
                all.extend(c_by_pixel(sampler, dims, spp)?);
            }
        }
    }
    let mut out = "sampler,door,dims,spp,round,ns\n".to_owned();
    for round in 0..=rounds {
        for timed in &mut all {
            let ns = (timed.time)();
            // The first warms up.
            if round > 0 {
                let Timed { name, door, dims, spp, .. } = timed;
                writeln!(out, "{name},{door},{dims},{spp},{round},{ns:.3}")?;
            }
        }
    }
    Ok(out)
}

fn rust(sampler: Sampler, dims: usize, spp: usize) -> Result<Timed> {
    let time = if dims == 2 { boxed::<2>(sampler, spp)? } else { boxed::<4>(sampler, spp)? };
    Ok(Timed { name: sampler.name(), door: "Rust", dims, spp, time })
}

fn sum<const N: usize>(u: [f32; N]) -> f32 {
    u.iter().sum()
}

fn boxed<const N: usize>(sampler: Sampler, spp: usize) -> Result<Box<dyn FnMut() -> f64>> {
    // The last sample: where a tile goes on beyond its own, that is what it costs.
    let last = spp as u32 - 1;
    let (index, tile) = (last as i32, sampler.tile(N, spp)?);
    Ok(match (sampler, tile) {
        (Sampler::Sobol, _) => Box::new(move || {
            time(|x, y| {
                let u = sobol(x, y, last, 0);
                if N == 2 { u[0] + u[1] } else { sum(u) }
            })
        }),
        (Sampler::Heitz, _) => {
            Box::new(move || time(|x, y| (0..N as u32).map(|dim| heitz(x, y, last + 1, last, dim)).sum()))
        }
        (Sampler::OpenQmcSobol, _) => {
            Box::new(move || time(|x, y| sum(SobolBnSampler::new(x as i32, y as i32, 0, index).draw_sample_f32::<N>())))
        }
        (Sampler::OpenQmcPmj, _) => {
            Box::new(move || time(|x, y| sum(PmjBnSampler::new(x as i32, y as i32, 0, index).draw_sample_f32::<N>())))
        }
        (Sampler::OpenQmcLattice, _) => Box::new(move || {
            time(|x, y| sum(LatticeBnSampler::new(x as i32, y as i32, 0, index).draw_sample_f32::<N>()))
        }),
        (Sampler::Default, _) => Box::new(move || time(|x, y| sum(sampler::Sampler::pixel(x, y, 0, last).draw::<N>()))),
        (_, Some(tile)) if tile.shape().dims as usize >= N => Box::new(move || draws::<N>(&tile, last)),
        (_, Some(tile)) => Box::new(move || {
            time(|x, y| {
                let root = Draw::pixel(&tile, x, y, 0, last);
                sum(root.domain(0).draw::<2>()) + sum(root.domain(1).draw::<2>())
            })
        }),
        _ => {
            let mut rng = Rng::seed(1);
            Box::new(move || time(|_, _| (0..N).map(|_| rng.uniform_f32()).sum()))
        }
    })
}

fn draws<const N: usize>(tile: &Tile<'_>, last: u32) -> f64 {
    time(|x, y| sum(Draw::pixel(tile, x, y, 0, last).draw::<N>()))
}

/// The same through the C functions of the archive that ships, of samplers that are the library's.
fn c(sampler: Sampler, dims: usize, spp: usize) -> Result<Option<Timed>> {
    let (name, door, last) = (sampler.name(), "C ABI", spp as u32 - 1);
    if sampler == Sampler::Default {
        let time: Box<dyn FnMut() -> f64> = match dims {
            2 => Box::new(move || time(|x, y| c_sampler::root::<2>(x, y, last))),
            _ => Box::new(move || time(|x, y| c_sampler::root::<4>(x, y, last))),
        };
        return Ok(Some(Timed { name, door, dims, spp, time }));
    }
    let Some(bytes) = sampler.builtin(dims, spp)?.and_then(Builtin::bytes) else { return Ok(None) };
    let tile = c_tile::Tile::new(bytes);
    let time: Box<dyn FnMut() -> f64> = match dims {
        2 => Box::new(move || time(|x, y| tile.root(x, y, last))),
        _ if tile.dims() >= 4 => Box::new(move || time(|x, y| tile.root4(x, y, last))),
        _ => Box::new(move || time(|x, y| tile.children(x, y, last))),
    };
    Ok(Some(Timed { name, door, dims, spp, time }))
}

/// The same, all samples of a pixel in a call; the time of one.
fn c_by_pixel(sampler: Sampler, dims: usize, spp: usize) -> Result<Option<Timed>> {
    let Some(bytes) = sampler.builtin(dims, spp)?.and_then(Builtin::bytes) else { return Ok(None) };
    let (tile, mut u) = (c_tile::Tile::new(bytes), vec![0.0; dims * spp]);
    let draw = move || time(|x, y| tile.samples(x, y, spp as u32, dims as u32, &mut u)) / spp as f64;
    Ok(Some(Timed { name: sampler.name(), door: "C ABI by pixel", dims, spp, time: Box::new(draw) }))
}
