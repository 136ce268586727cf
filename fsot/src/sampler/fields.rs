//! The errors of pixels, and what each sees of the others'.

use super::basis::{Basis, SPECTRUM, Spectrum};
use super::energy::{Energy, Places};
use super::pixels::Weights;
use super::problem::OCTAVES;
use rayon::prelude::*;

/// Changes that are added around all pixels at a time.
const WAITING: usize = 64;

/// The errors of a pixel's octaves.
pub(crate) type Errors = [Spectrum; OCTAVES];

/// Sums over pixels, for the octaves that count.
#[derive(Debug)]
pub(crate) struct Fields {
    /// Each pixel's own.
    pub(crate) errors: Vec<Errors>,
    /// What each sees of the others', but for changes that wait.
    pub(crate) around: Vec<Errors>,
    /// Of all pixels.
    pub(crate) total: Errors,
    /// Changes that wait to be added around all pixels.
    changes: Vec<(usize, Errors)>,
    /// How many of them each pixel has.
    added: Vec<usize>,
}

impl Fields {
    pub(crate) fn new(basis: &Basis, weights: &Weights, energy: &Energy, all: &[Places]) -> Fields {
        let own: Vec<Errors> = all.par_iter().map(|places| errors(basis, energy, places)).collect();
        let around = (0..all.len()).into_par_iter().map(|pixel| {
            let mut around = [[0.0; SPECTRUM]; OCTAVES];
            for (other, weight) in weights.around(pixel) {
                for &octave in &energy.octaves {
                    weight.add(&own[other][octave], &mut around[octave]);
                }
            }
            around
        });
        let around = around.collect();
        let mut total = [[0.0; SPECTRUM]; OCTAVES];
        own.iter().for_each(|errors| add(&mut total, errors));
        Fields { errors: own, around, total, changes: Vec::new(), added: vec![0; all.len()] }
    }

    /// Adds what waits around a pixel.
    pub(crate) fn catch_up(&mut self, weights: &Weights, energy: &Energy, pixel: usize) {
        for &octave in &energy.octaves {
            add_around(weights, pixel, &self.changes[self.added[pixel]..], octave, &mut self.around[pixel][octave]);
        }
        self.added[pixel] = self.changes.len();
    }

    /// Changes a pixel's errors; what others see of it waits.
    pub(crate) fn change(&mut self, pixel: usize, change: Errors) {
        add(&mut self.errors[pixel], &change);
        add(&mut self.total, &change);
        self.changes.push((pixel, change));
    }

    /// Adds what waits around all pixels, once there is enough.
    pub(crate) fn spread_if_many(&mut self, weights: &Weights, energy: &Energy) {
        if self.changes.len() >= WAITING {
            self.spread(weights, energy);
        }
    }

    /// Adds what waits around all pixels: an octave at a time, whose changes a processor's cache holds.
    pub(crate) fn spread(&mut self, weights: &Weights, energy: &Energy) {
        let Fields { around, changes, added, .. } = self;
        for &octave in &energy.octaves {
            let around = around.par_iter_mut().zip(&*added).enumerate().with_min_len(64);
            around.for_each(|(pixel, (around, added))| {
                add_around(weights, pixel, &changes[*added..], octave, &mut around[octave]);
            });
        }
        changes.clear();
        added.fill(0);
    }
}

/// The errors of a pixel's points.
pub(crate) fn errors(basis: &Basis, energy: &Energy, places: &Places) -> Errors {
    let mut errors = [[0.0; SPECTRUM]; OCTAVES];
    let mut sum = [0.0; SPECTRUM];
    let mut point = 0;
    for &octave in &energy.octaves {
        while point < 1 << octave {
            basis.add(places[0][point], places[1][point], &mut sum);
            point += 1;
        }
        let share = 1.0 / (1u32 << octave) as f32;
        errors[octave].iter_mut().zip(&sum).for_each(|(error, sum)| *error = share * sum);
        errors[octave][0] = 0.0;
    }
    errors
}

/// What changes of pixels add to an octave's errors around one.
fn add_around(weights: &Weights, pixel: usize, changes: &[(usize, Errors)], octave: usize, around: &mut Spectrum) {
    for (other, change) in changes {
        if let Some(weight) = weights.between(pixel, *other) {
            weight.add(&change[octave], around);
        }
    }
}

fn add(sum: &mut Errors, errors: &Errors) {
    sum.iter_mut().flatten().zip(errors.iter().flatten()).for_each(|(sum, error)| *sum += error);
}

pub(crate) fn subtract(sum: &mut Errors, errors: &Errors) {
    sum.iter_mut().flatten().zip(errors.iter().flatten()).for_each(|(sum, error)| *sum -= error);
}
