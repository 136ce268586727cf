//! How good a tile is.

use super::basis::Basis;
use super::border::Border;
use super::energy::{Energy, Places};
use super::fields::Fields;
use super::power::power;
use super::problem::OCTAVES;
use rayon::prelude::*;

/// What there is: for each octave, relative to independent samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct SamplerReport {
    /// The energy of pixels alone.
    pub raw: [f32; OCTAVES],
    /// The energy of pixels together.
    pub filtered: [f32; OCTAVES],
    /// The least and the greatest density of an axis within 1/64 of a border, relative to a uniform one.
    pub border: [[f32; 2]; OCTAVES],
}

impl SamplerReport {
    /// Of the octaves that count.
    pub(crate) fn new(basis: &Basis, energy: &Energy, fields: &Fields, border: &Border, all: &[Places]) -> Self {
        let mut report = SamplerReport::default();
        for &octave in &energy.octaves {
            let owns: Vec<f32> = all.par_iter().map(|places| own_energy(basis, places, 1 << octave)).collect();
            let raw = owns.iter().map(|own| f64::from(*own)).sum::<f64>() / all.len() as f64;
            let cross = |pixel: usize| -> f64 {
                let (own, around) = (&fields.errors[pixel][octave], &fields.around[pixel][octave]);
                let terms = own.iter().zip(around).zip(&basis.energies);
                terms.map(|((own, around), energy)| f64::from(own * around * energy)).sum()
            };
            let together = raw + (0..all.len()).map(cross).sum::<f64>() / all.len() as f64;
            let white = f64::from(basis.total) / (1u32 << octave) as f64;
            report.raw[octave] = (raw / white) as f32;
            report.filtered[octave] = (together / white) as f32;
            report.border[octave] = border.extremes(octave);
        }
        report
    }
}

/// The energy of a pixel's first points.
fn own_energy(basis: &Basis, places: &Places, count: usize) -> f32 {
    let at = |axis: usize, i: usize| (f32::from(places[axis][i]) + 0.5) / 65536.0;
    let (mut alone, mut apart) = (0.0, 0.0);
    for i in 0..count {
        alone += basis.mean_at(at(0, i), at(1, i));
        for j in 0..i {
            let (dx, dy) = (at(0, i) - at(0, j), at(1, i) - at(1, j));
            apart += 2.0 * power(dx * dx + dy * dy, basis.half);
        }
    }
    let share = 1.0 / count as f32;
    2.0 * share * alone - share * share * apart - basis.total
}
