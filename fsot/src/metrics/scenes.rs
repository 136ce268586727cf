//! The error of samplers in rendered scenes: tables of pixels' integrands, which `tests/embree` writes.
//!
//! Each pixel's error is relative to its value (with a hundredth of the image's mean squared added to its square), and
//! its energy to that of as many independent samples, filtered alike. Integrands are bilinear between the cells.

use crate::error::{Error, Result};
use crate::random::stream;
use rayon::prelude::*;
use serde::Serialize;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Places of the image in the plane of samples that errors are averaged over.
const PLACES: usize = 24;
/// Widths of the Gaussian filters, in pixels; 0 is none.
const FILTERS: [f64; 3] = [2.1, 1.0, 0.0];
/// The most that a table's side or cells may be.
const MOST: usize = 1024;

/// Pixels' integrands.
pub struct SceneTable {
    width: usize,
    height: usize,
    cells: usize,
    values: Vec<f32>,
    /// Each pixel's value, and the variance of one sample.
    moments: Vec<(f64, f64)>,
}

/// The samples of a plane of pixels that repeats.
pub struct Plane {
    /// Pixels along each side.
    pub size: usize,
    /// Samples of each pixel.
    pub samples: usize,
    /// `[y][x][sample]`
    pub points: Vec<[f32; 2]>,
}

/// Energies of the error of the first samples, relative to independent ones.
#[derive(Clone, Debug, Serialize)]
pub struct SceneError {
    /// Samples of each pixel.
    pub spp: usize,
    /// Filtered by a Gaussian of 2.1 pixels.
    pub wide: f64,
    /// Filtered by a Gaussian of one pixel.
    pub narrow: f64,
    /// Not filtered.
    pub raw: f64,
}

impl SceneTable {
    /// Reads a file of `embree_tables`.
    ///
    /// # Errors
    /// It cannot be read, or is none.
    pub fn read(path: &Path) -> Result<SceneTable> {
        let refuse = || Error::Input(format!("{} is no table of a scene, or not a whole one", path.display()));
        let mut file = BufReader::new(File::open(path).map_err(Error::io(path))?);
        let mut line = Vec::new();
        file.by_ref().take(100).read_until(b'\n', &mut line).map_err(Error::io(path))?;
        let line = String::from_utf8(line).map_err(|_| refuse())?;
        let numbers = line.trim_end().strip_prefix("noisefloor-scene ").ok_or_else(refuse)?;
        let numbers: Vec<usize> = numbers.split(' ').map_while(|number| number.parse().ok()).collect();
        let [width, height, cells] = numbers[..] else { return Err(refuse()) };
        if [width, height, cells].iter().any(|side| !(2..=MOST).contains(side)) {
            return Err(refuse());
        }
        let mut bytes = Vec::new();
        let wanted = (width * height * cells * cells * 4) as u64;
        file.take(wanted + 1).read_to_end(&mut bytes).map_err(Error::io(path))?;
        if bytes.len() as u64 != wanted {
            return Err(refuse());
        }
        let values = bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        Ok(SceneTable::new([width, height], cells, values))
    }

    fn new([width, height]: [usize; 2], cells: usize, values: Vec<f32>) -> SceneTable {
        let mut table = SceneTable { width, height, cells, values, moments: Vec::new() };
        table.moments = (0..width * height).into_par_iter().map(|pixel| table.moments_of(pixel)).collect();
        table
    }

    fn pixel(&self, pixel: usize) -> &[f32] {
        let cells = self.cells * self.cells;
        &self.values[pixel * cells..][..cells]
    }

    /// A pixel's integrand.
    fn at(&self, pixel: usize, [x, y]: [f32; 2]) -> f32 {
        let place = |c: f32| (c * self.cells as f32 - 0.5).clamp(0.0, self.cells as f32 - 1.001);
        let (x, y) = (place(x), place(y));
        let (column, row) = (x as usize, y as usize);
        let (a, b) = (x - column as f32, y - row as f32);
        let values = &self.pixel(pixel)[row * self.cells + column..];
        let along = |values: &[f32]| (1.0 - a) * values[0] + a * values[1];
        (1.0 - b) * along(values) + b * along(&values[self.cells..])
    }

    fn moments_of(&self, pixel: usize) -> (f64, f64) {
        let values = self.pixel(pixel);
        let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64;
        let fine = 2 * self.cells;
        let place = |i: usize| (i as f32 + 0.5) / fine as f32;
        let squares = (0..fine * fine).map(|i| {
            let offset = f64::from(self.at(pixel, [place(i % fine), place(i / fine)])) - mean;
            offset * offset
        });
        (mean, squares.sum::<f64>() / (fine * fine) as f64)
    }

    /// The errors of a plane's first samples, for as many as `counts` say.
    ///
    /// # Errors
    /// A pixel of the plane has fewer samples.
    pub fn errors(&self, plane: &Plane, counts: &[usize]) -> Result<Vec<SceneError>> {
        if counts.iter().any(|count| !(1..=plane.samples).contains(count)) {
            return Err(Error::Input(format!("a pixel has {} samples, and more are asked for", plane.samples)));
        }
        let moments = &self.moments;
        let average = moments.iter().map(|(mean, _)| mean).sum::<f64>() / moments.len() as f64;
        let scale: Vec<f64> = moments.iter().map(|(mean, _)| 1.0 / (mean * mean + 0.01 * average * average)).collect();
        let white: Vec<f64> = moments.iter().zip(&scale).map(|((_, variance), scale)| variance * scale).collect();
        let images = self.images(plane, counts, &scale);
        let mut rows: Vec<SceneError> =
            counts.iter().map(|&spp| SceneError { spp, wide: 0.0, narrow: 0.0, raw: 0.0 }).collect();
        for (number, sigma) in FILTERS.into_iter().enumerate() {
            let filter = gaussian(sigma);
            let squared: Vec<f64> = filter.iter().map(|weight| weight * weight).collect();
            let expected: f64 = self.filtered(&white, &squared).iter().sum();
            for (row, images) in rows.iter_mut().zip(images.chunks_exact(PLACES)) {
                let energy = |image: &Vec<f64>| self.filtered(image, &filter).iter().map(|e| e * e).sum::<f64>();
                let sum: f64 = images.par_iter().map(energy).collect::<Vec<_>>().iter().sum();
                let energy = sum / PLACES as f64 / expected * row.spp as f64;
                *[&mut row.wide, &mut row.narrow, &mut row.raw][number] = energy;
            }
        }
        Ok(rows)
    }

    /// Relative errors: `[count][place][pixel]`.
    fn images(&self, plane: &Plane, counts: &[usize], scale: &[f64]) -> Vec<Vec<f64>> {
        let mut rng = stream(11, 0, 0);
        let mut shift = || rng.below(plane.size as u32) as usize;
        let shifts: Vec<(usize, usize)> = (0..PLACES).map(|_| (shift(), shift())).collect();
        let last = counts.iter().copied().max().unwrap_or(0);
        let pixel = |pixel: usize| {
            let mut errors = vec![0.0; counts.len() * PLACES];
            for (place, (dx, dy)) in shifts.iter().enumerate() {
                let (x, y) = ((pixel % self.width + dx) % plane.size, (pixel / self.width + dy) % plane.size);
                let mut sum = 0.0;
                let points = &plane.points[(y * plane.size + x) * plane.samples..][..last];
                for (i, point) in points.iter().enumerate() {
                    sum += f64::from(self.at(pixel, *point));
                    for (number, _) in counts.iter().enumerate().filter(|(_, count)| **count == i + 1) {
                        let error = sum / (i + 1) as f64 - self.moments[pixel].0;
                        errors[number * PLACES + place] = error * libm::sqrt(scale[pixel]);
                    }
                }
            }
            errors
        };
        let pixels: Vec<Vec<f64>> = (0..self.width * self.height).into_par_iter().map(pixel).collect();
        (0..counts.len() * PLACES).map(|image| pixels.iter().map(|errors| errors[image]).collect()).collect()
    }

    /// An image, seen through a filter in both directions; there is nothing beyond its borders.
    fn filtered(&self, image: &[f64], filter: &[f64]) -> Vec<f64> {
        let reach = filter.len() / 2;
        let along = |from: &[f64], length: usize, stride: usize| {
            let mut to = vec![0.0; from.len()];
            for (i, to) in to.iter_mut().enumerate() {
                let place = i / stride % length;
                for (k, weight) in filter.iter().enumerate() {
                    if (reach..length + reach).contains(&(place + k)) {
                        *to += weight * from[i + k * stride - reach * stride];
                    }
                }
            }
            to
        };
        along(&along(image, self.width, 1), self.height, self.width)
    }
}

/// A Gaussian filter along one axis.
fn gaussian(sigma: f64) -> Vec<f64> {
    let reach = libm::ceil(3.5 * sigma) as i32;
    let weight = |i: i32| if i == 0 { 1.0 } else { libm::exp(-f64::from(i * i) / (2.0 * sigma * sigma)) };
    let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x + y in every pixel: samples in the middle have no error, independent ones that of one random sample.
    #[test]
    fn errors_are_relative_to_independent_samples() {
        let (side, cells) = (24, 16);
        let value = |i: usize| ((i % cells) as f32 + (i / cells) as f32 + 1.0) / cells as f32;
        let values = (0..side * side).flat_map(|_| (0..cells * cells).map(value)).collect();
        let table = SceneTable::new([side; 2], cells, values);
        let middle = Plane { size: 1, samples: 1, points: vec![[0.5, 0.5]] };
        assert!(table.errors(&middle, &[1]).unwrap()[0].raw < 1e-9);
        let mut rng = stream(1, 2, 3);
        let points = (0..128 * 128 * 4).map(|_| [rng.uniform_f32(), rng.uniform_f32()]).collect();
        let white = Plane { size: 128, samples: 4, points };
        for row in table.errors(&white, &[1, 3, 4]).unwrap() {
            assert!((row.raw - 1.0).abs() < 0.2 && (row.wide - 1.0).abs() < 0.6, "{row:?}");
        }
        assert!(table.errors(&white, &[5]).is_err());
    }
}
