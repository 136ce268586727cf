//! Densities given as functions.

use super::cdf::bins_of_cdf;
use super::distribution::{MAX_DIMS, MEAN_COMPONENT, Target};
use super::image::ImageTarget;
use crate::Error;
use crate::error::Result;
use crate::points::BELOW_ONE;
use noisefloor::rng::Rng;

/// A distribution whose density is a function on `[0, 1]^dims`, known up to a factor.
///
/// The function is taken at many places, once: in one dimension at 4,096, in two at a grid of eight cells per point,
/// 128 x 128 to 4,096 x 4,096, whose projections are exact, in more at eight places per point of a low-discrepancy
/// sequence, 2^14 to 2^22.
#[derive(Clone, Debug)]
pub struct Function(Form);

#[derive(Clone, Debug)]
enum Form {
    /// The cumulative distribution at equidistant nodes.
    Line(Vec<f64>),
    Plane(Box<ImageTarget>),
    Space(Cloud),
}

/// Nodes in one dimension, less one.
const LINE: usize = 4096;
/// The least number of places in three dimensions and more.
const CLOUD: usize = 16_384;
/// The places for each point.
const PER_POINT: usize = 8;
/// Cells of the projection of a cloud.
const CELLS: usize = 512;

impl Function {
    /// The distribution of density `density`, up to a factor, for about `points` points of `dims` coordinates. A
    /// constant is as well served by [`Uniform`](super::Uniform).
    ///
    /// # Errors
    /// [`Error::Input`] if `dims` is not 1 to 8, or the density is negative or not finite somewhere, or 0 wherever it
    /// is taken.
    pub fn new(dims: usize, points: usize, density: impl Fn(&[f32]) -> f32) -> Result<Function> {
        if dims == 0 || dims > MAX_DIMS {
            return Err(Error::Input(format!("a density of {dims} dimensions: give 1 to {MAX_DIMS}")));
        }
        let checked = |x: &[f32]| {
            let value = density(x);
            if value >= 0.0 && value.is_finite() {
                Ok(value)
            } else {
                Err(Error::Input(format!("the density at {x:?} is {value}: it must be finite and not negative")))
            }
        };
        match dims {
            1 => line(checked),
            2 => plane(points, checked),
            _ => Cloud::new(dims, points, checked).map(|cloud| Function(Form::Space(cloud))),
        }
    }
}

fn nothing() -> Error {
    Error::input("the density is 0 everywhere: there is nowhere to put a point")
}

fn line(density: impl Fn(&[f32]) -> Result<f32>) -> Result<Function> {
    let mut cdf = vec![0.0];
    let mut sum = 0.0;
    for i in 0..LINE {
        sum += f64::from(density(&[(i as f32 + 0.5) / LINE as f32])?);
        cdf.push(sum);
    }
    if sum > 0.0 { Ok(Function(Form::Line(cdf))) } else { Err(nothing()) }
}

fn plane(points: usize, density: impl Fn(&[f32]) -> Result<f32>) -> Result<Function> {
    let side = ((points.saturating_mul(PER_POINT) as f64).sqrt().ceil() as usize).clamp(128, 4096);
    let mut cells = Vec::with_capacity(side * side);
    let center = |i: usize| (i as f32 + 0.5) / side as f32;
    for y in 0..side {
        for x in 0..side {
            cells.push(density(&[center(x), center(y)])?);
        }
    }
    Ok(Function(Form::Plane(Box::new(ImageTarget::new(side, side, &cells, points)?))))
}

/// Places with masses.
#[derive(Clone, Debug)]
struct Cloud {
    dims: usize,
    /// Places with mass, one after the other.
    places: Vec<f32>,
    /// The largest is from 1/2 to 1.
    masses: Vec<f32>,
    /// Running sums of the masses.
    cumulative: Vec<f64>,
    /// The distance between places.
    spacing: f32,
}

impl Cloud {
    fn new(dims: usize, points: usize, density: impl Fn(&[f32]) -> Result<f32>) -> Result<Cloud> {
        let count = points.saturating_mul(PER_POINT).clamp(CLOUD, 1 << 22);
        // The additive recurrence of the generalised golden ratio, the root of x^(dims + 1) = x + 1.
        let mut root = 2.0f64;
        for _ in 0..64 {
            root = libm::pow(1.0 + root, 1.0 / (dims as f64 + 1.0));
        }
        let mut steps = [0.0f64; MAX_DIMS];
        steps.iter_mut().enumerate().for_each(|(k, step)| *step = libm::pow(root, -(k as f64 + 1.0)));
        let mut cloud = Cloud { dims, places: Vec::new(), masses: Vec::new(), cumulative: Vec::new(), spacing: 0.0 };
        for i in 0..count {
            let mut place = [0.0f32; MAX_DIMS];
            for (x, step) in place.iter_mut().zip(steps) {
                let u = 0.5 + i as f64 * step;
                *x = ((u - u.floor()) as f32).min(BELOW_ONE);
            }
            let mass = density(&place[..dims])?;
            if mass > 0.0 {
                cloud.places.extend(&place[..dims]);
                cloud.masses.push(mass);
            }
        }
        let largest = cloud.masses.iter().copied().fold(0.0, f32::max);
        if largest <= 0.0 {
            return Err(nothing());
        }
        // Any scale is allowed, but sums are in f32. A power of two, so that no mass is rounded.
        let scale = libm::ldexp(1.0, -libm::frexp(f64::from(largest)).1);
        let mut sum = 0.0;
        for mass in &mut cloud.masses {
            *mass = (f64::from(*mass) * scale) as f32;
            sum += f64::from(*mass);
            cloud.cumulative.push(sum);
        }
        cloud.spacing = libm::pow(count as f64, -1.0 / dims as f64) as f32;
        Ok(cloud)
    }

    fn bins(&self, direction: &[f32], means: &mut [f32], density: &mut [f32], scratch: &mut Vec<f32>) {
        let low: f32 = direction.iter().map(|x| x.min(0.0)).sum();
        let width: f32 = direction.iter().map(|x| x.abs()).sum();
        // Each place's mass goes to the two nearest of CELLS + 1 nodes; a node's mass is spread over a cell around it.
        scratch.clear();
        scratch.resize(CELLS + 2, 0.0);
        let scale = CELLS as f32 / width.max(f32::MIN_POSITIVE);
        for (place, &mass) in self.places.chunks_exact(self.dims).zip(&self.masses) {
            let t: f32 = place.iter().zip(direction).map(|(x, direction)| x * direction).sum();
            let cell = ((t - low) * scale).clamp(0.0, CELLS as f32);
            let node = cell as usize;
            let right = mass * (cell - node as f32);
            scratch[node] += mass - right;
            scratch[node + 1] += right;
        }
        let mut cdf = [0.0f64; CELLS + 2];
        for node in 0..=CELLS {
            cdf[node + 1] = cdf[node] + f64::from(scratch[node]);
        }
        let step = f64::from(width) / CELLS as f64;
        let range = f64::from(self.dims as f32 * MEAN_COMPONENT[self.dims]);
        bins_of_cdf(f64::from(low) - 0.5 * step, step, range, &cdf, means, density);
    }

    fn sample(&self, rng: &mut Rng, point: &mut [f32]) {
        let total = self.cumulative.last().copied().unwrap_or(0.0);
        let at = rng.uniform_f64() * total;
        let place = self.cumulative.partition_point(|sum| *sum <= at).min(self.masses.len() - 1);
        for (x, center) in point.iter_mut().zip(&self.places[place * self.dims..]) {
            // Reflected at the faces.
            let moved = (center + (rng.uniform_f32() - 0.5) * self.spacing).abs();
            *x = if moved >= 1.0 { (2.0 - moved).min(BELOW_ONE) } else { moved };
        }
    }
}

impl Target for Function {
    fn dims(&self) -> usize {
        match &self.0 {
            Form::Line(_) => 1,
            Form::Plane(_) => 2,
            Form::Space(cloud) => cloud.dims,
        }
    }

    fn bins(&self, direction: &[f32], means: &mut [f32], density: &mut [f32], scratch: &mut Vec<f32>) {
        match &self.0 {
            Form::Line(cdf) => {
                bins_of_cdf(0.0, 1.0 / LINE as f64, 1.0, cdf, means, density);
                if direction.first().is_some_and(|&x| x < 0.0) {
                    means.reverse();
                    density.reverse();
                    means.iter_mut().for_each(|mean| *mean = -*mean);
                }
            }
            Form::Plane(image) => image.bins(direction, means, density, scratch),
            Form::Space(cloud) => cloud.bins(direction, means, density, scratch),
        }
    }

    fn sample(&self, rng: &mut Rng, point: &mut [f32]) {
        match &self.0 {
            Form::Line(cdf) => {
                let total = cdf.last().copied().unwrap_or(0.0);
                let at = rng.uniform_f64() * total;
                let cell = cdf.partition_point(|sum| *sum <= at).clamp(1, LINE) - 1;
                point[0] = ((cell as f32 + rng.uniform_f32()) / LINE as f32).min(BELOW_ONE);
            }
            Form::Plane(image) => image.sample(rng, point),
            Form::Space(cloud) => cloud.sample(rng, point),
        }
    }
}
