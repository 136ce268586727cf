//! Errors: mean squares over those of white noise, on half-spaces and Gaussians, raw and through three filters.

use crate::sampler::{DIMS, SIDE, Sampler};
use anyhow::{Context, Result};
use fsot::metrics::{TileView, measure_energies};
use std::fmt::Write;

/// Draws of integrands, and of the samplers' seeds: the intervals are theirs.
const BATCHES: u32 = 8;

/// Integrands of each family in a batch: fewer where samples are many, since evaluating them is what takes time.
fn integrands(spp: usize, share: f64) -> usize {
    let all = match spp {
        0..=4 => 64.0,
        5..=16 => 32.0,
        // No target is there; `--full` has more.
        _ if share > 1.0 => 16.0,
        _ => 8.0,
    };
    ((all * share) as usize).max(2)
}

/// A row for each sampler, number of samples, batch and family.
pub(crate) fn csv(counts: &[usize], share: f64) -> Result<String> {
    let mut out = "sampler,dims,spp,batch,family,integrands,raw,g1,a,g2\n".to_owned();
    for (dims, &spp) in DIMS.into_iter().flat_map(|dims| counts.iter().map(move |spp| (dims, spp))) {
        eprintln!("errors of {spp} samples of {dims} dims");
        let count = integrands(spp, share);
        for batch in 0..BATCHES {
            // The same integrands for every sampler: ratios are paired.
            for sampler in Sampler::ALL.into_iter().filter(|sampler| sampler.applies(dims)) {
                let points = sampler.points(dims, spp, batch)?;
                let tile = TileView::new(SIDE, spp, dims, 1, &points).context(sampler.name())?;
                let energies = measure_energies(&tile, u64::from(batch) << 32, count)?;
                for (family, of) in [("half-planes", energies.half_spaces), ("Gaussians", energies.gaussians)] {
                    let name = sampler.name();
                    write!(out, "{name},{dims},{spp},{batch},{family},{count},")?;
                    writeln!(out, "{:.5e},{:.5e},{:.5e},{:.5e}", of.raw, of.narrow, of.perceptual, of.wide)?;
                }
            }
        }
    }
    Ok(out)
}
