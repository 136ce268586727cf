//! Images of an error, and its spectrum over many integrands.

use crate::sampler::{SIDE, Sampler};
use anyhow::{Result, anyhow};
use fsot::metrics::integrands::{Family, Integrand};
use fsot::metrics::{TileView, error_spectrum};

/// What is shown: the best of each kind, in two dimensions.
const SHOWN: [(Sampler, &str); 5] = [
    (Sampler::Random, "random"),
    (Sampler::Sobol, "sobol"),
    (Sampler::OpenQmcLattice, "openqmc"),
    (Sampler::Heitz, "heitz"),
    (Sampler::Tile, "tile"),
];

/// NAME-SPP.pfm: in the first channel the error over its standard deviation with one independent sample, in the second
/// the mean power of errors, relative to white noise of as many samples, frequency zero in the middle.
pub(crate) fn write(counts: &[usize], integrands: usize, write: impl Fn(&str, &[u8]) -> Result<()>) -> Result<()> {
    eprintln!("images");
    let shown = Integrand::random(Family::HalfSpace, 2, 0.2, 7, 1);
    for (sampler, name) in SHOWN {
        for &spp in counts.iter().filter(|&&spp| spp <= 16) {
            let points = sampler.points(2, spp, 0)?;
            let pixel = |u: &[f32]| u.chunks_exact(2).map(|u| shown.value(u)).sum::<f64>() / spp as f64;
            let errors = points.chunks_exact(2 * spp).map(|u| (pixel(u) - shown.integral) / shown.variance.sqrt());
            let errors: Vec<f64> = errors.collect();
            let tile = TileView::new(SIDE, spp, 2, 1, &points)?;
            let spectrum = error_spectrum(&tile, integrands)?;
            if spectrum.side != SIDE {
                return Err(anyhow!("a spectrum of {} frequencies for {SIDE} pixels", spectrum.side));
            }
            let mut bytes = format!("PF\n{SIDE} {SIDE}\n-1.0\n").into_bytes();
            // From the bottom up.
            for y in (0..SIDE).rev() {
                for x in 0..SIDE {
                    let place = y * SIDE + x;
                    for value in [errors[place], spectrum.power[place], 0.0] {
                        bytes.extend((value as f32).to_le_bytes());
                    }
                }
            }
            write(&format!("{name}-{spp}.pfm"), &bytes)?;
        }
    }
    Ok(())
}
