//! How visible the error of a sample tile is: its energy after a filter over the image, and without.

use super::border;
use super::integrands::{Family, Integrand};
use super::plane::{Plane, Transform};
use super::spectrum::Spectrum;
use crate::counted;
use crate::error::{Error, Result, check};
use crate::tile::TileSamples;
use rayon::prelude::*;
use rustfft::num_complex::Complex;
use serde::Serialize;

/// Integrands are shared out in this many parts, whose sums are then added in order.
const PARTS: usize = 16;
const SEED: u64 = 0x711e;
/// The least weight of the newest frame: that of [`TemporalKernel::Ema`](crate::tile::TemporalKernel::Ema).
const LEAST_ALPHA: f64 = 1e-6;

/// The samples of a tile: `coordinates` is laid out `[frame][y][x][sample][dim]`.
#[derive(Clone, Copy, Debug)]
pub struct TileView<'a> {
    size: usize,
    spp: usize,
    dims: usize,
    frames: usize,
    coordinates: &'a [f32],
}

impl<'a> TileView<'a> {
    /// A view of `frames * size * size * spp * dims` coordinates in [0, 1].
    ///
    /// Errors: a size, count of samples, of frames or of dimensions that is 0, more than 8 dimensions, a number of
    /// coordinates that is not their product, a coordinate that is not in [0, 1].
    pub fn new(size: usize, spp: usize, dims: usize, frames: usize, coordinates: &'a [f32]) -> Result<TileView<'a>> {
        if size == 0 || spp == 0 || frames == 0 || !(1..=8).contains(&dims) {
            return Err(Error::input(format!(
                "a tile of {}: every number must be at least 1, and there are at most 8 dimensions",
                counted::tile(size, spp, dims, frames)
            )));
        }
        let needed = [size, spp, dims, frames].iter().try_fold(size, |product, &n| product.checked_mul(n));
        if needed != Some(coordinates.len()) {
            return Err(Error::input(format!(
                "{} cannot make {}",
                counted::counted(coordinates.len(), "coordinate"),
                counted::tile(size, spp, dims, frames)
            )));
        }
        super::check_coordinates(dims, coordinates)?;
        Ok(TileView { size, spp, dims, frames, coordinates })
    }

    /// A view of samples. Errors: as [`new`](TileView::new).
    pub fn of(samples: &'a TileSamples) -> Result<TileView<'a>> {
        let TileSamples { size, spp, dims, frames, coordinates } = samples;
        TileView::new(*size, *spp, *dims, *frames, coordinates)
    }

    /// Numbers of samples whose error is measured: the powers of two up to the tile's, and the tile's own.
    pub fn prefixes(&self) -> Vec<usize> {
        let powers = (0..usize::BITS).map(|i| 1 << i).take_while(|&p| p < self.spp);
        powers.chain([self.spp]).collect()
    }
}

/// Energies of one kind of error image under every filter: mean squares relative to those of white noise, i.e. of
/// independent uniform samples, of which there are as many per pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energies {
    /// Filtered by a Gaussian of standard deviation 2.1 pixels.
    #[serde(rename = "G2.1")]
    pub wide: f64,
    /// Filtered by exp(-r^2 / 2.1^2): standard deviation 1.485 pixels.
    #[serde(rename = "A")]
    pub perceptual: f64,
    /// Filtered by a Gaussian of standard deviation 1 pixel.
    #[serde(rename = "G1")]
    pub narrow: f64,
    /// Not filtered: the error of single pixels.
    pub raw: f64,
}

/// Standard deviations in pixels of the filters, in the order of [`Energies`].
pub const FILTERS: [f64; 3] = [2.1, 2.1 * std::f64::consts::FRAC_1_SQRT_2, 1.0];

/// Energies over both families of integrands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FamilyEnergies {
    /// Random half-spaces.
    pub half_spaces: Energies,
    /// Random Gaussian bumps.
    pub gaussians: Energies,
}

/// Energies of the first samples of every pixel.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PrefixEnergies {
    /// Samples per pixel.
    pub spp: usize,
    /// Their energies, averaged over frames.
    pub energies: FamilyEnergies,
}

/// Energies of two of the tile's dimensions.
#[derive(Clone, Debug, Serialize)]
pub struct MarginalEnergies {
    /// Which dimensions, from 0; in JSON from 1.
    #[serde(serialize_with = "super::from_one")]
    pub axes: [usize; 2],
    /// Their energies by number of samples.
    pub prefixes: Vec<PrefixEnergies>,
}

/// Energies after a filter over time, on the endlessly repeated tile.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TemporalEnergies {
    /// The weight of the newest frame in the exponential moving average.
    pub alpha: f64,
    /// Energies relative to white noise in space and time that repeats after as many frames and goes through the same
    /// filters.
    pub energies: FamilyEnergies,
}

/// What [`measure_tile`] measures.
#[derive(Clone, Debug, Serialize)]
pub struct TileReport {
    /// Pixels per side.
    pub size: usize,
    /// Samples per pixel.
    pub spp: usize,
    /// Coordinates per sample.
    pub dims: usize,
    /// Frames.
    pub frames: usize,
    /// The least and the greatest density of an axis within 1/64 of a border, relative to a uniform one.
    pub border: [f32; 2],
    /// Integrands of each family.
    pub integrands: usize,
    /// Energies by number of samples.
    pub prefixes: Vec<PrefixEnergies>,
    /// Energies of every pair of dimensions, when there are more than two.
    pub marginals: Vec<MarginalEnergies>,
    /// Energies of every frame with all samples, when there are several.
    pub per_frame: Vec<FamilyEnergies>,
    /// Energies after filters over time, when there are several frames.
    pub temporal: Vec<TemporalEnergies>,
}

/// What to measure of a tile.
#[derive(Clone, Debug)]
pub struct TileOptions {
    /// Random integrands of each family, at least 1; the published figures use 512.
    pub integrands: usize,
    /// Weights of the newest frame, 1e-6 to 1, of the exponential moving averages applied to tiles of several frames.
    pub alphas: Vec<f64>,
}

impl Default for TileOptions {
    /// 512 integrands, alpha .1 and .2.
    fn default() -> Self {
        TileOptions { integrands: 512, alphas: vec![0.1, 0.2] }
    }
}

impl TileOptions {
    /// Errors: no integrand; an alpha out of range.
    pub fn check(&self) -> Result<()> {
        if self.integrands == 0 {
            return Err(Error::input("0 integrands: give at least 1"));
        }
        let range = LEAST_ALPHA..=1.0;
        self.alphas.iter().try_for_each(|alpha| check(range.contains(alpha), "alpha", alpha, "1e-6 to 1"))
    }
}

/// Measures a tile: for every random integrand, the same at every pixel, the image of (pixel's estimate - integral) is
/// filtered by toroidal convolution with a normalised kernel; energies are sums over integrands of its mean square over
/// sums of its expectation for white noise, `variance / spp * sum of the kernel's squares`. With 512 integrands, two
/// draws of them differ by 1-5 %.
///
/// Errors: those of [`TileOptions::check`].
pub fn measure_tile(tile: &TileView, options: &TileOptions) -> Result<TileReport> {
    options.check()?;
    let prefixes = tile.prefixes();
    let mut whole = energies(tile, &(0..tile.dims).collect::<Vec<_>>(), &prefixes, 0, options);
    let pairs = (0..tile.dims).flat_map(|b| (0..b).map(move |a| [a, b]));
    let marginal = |axes: [usize; 2]| {
        let alone = TileOptions { integrands: options.integrands, alphas: Vec::new() };
        MarginalEnergies { axes, prefixes: energies(tile, &axes, &prefixes, 0, &alone).prefixes }
    };
    if tile.dims > 2 {
        whole.marginals = pairs.map(marginal).collect();
    }
    Ok(whole)
}

/// Energies of all samples and all dimensions on `count` integrands of each family (an odd number is rounded up), from
/// number `first` on: other numbers are other integrands, so that several draws say how much of a figure is theirs.
/// [`measure_tile`] begins with 0.
///
/// Errors: no integrand.
pub fn measure_energies(tile: &TileView, first: u64, count: usize) -> Result<FamilyEnergies> {
    let options = TileOptions { integrands: count, alphas: Vec::new() };
    let axes: Vec<usize> = (0..tile.dims).collect();
    match energies(tile, &axes, &[tile.spp], first, &options).prefixes.last() {
        Some(all) if count > 0 => Ok(all.energies),
        _ => Err(Error::input("0 integrands: give at least 1")),
    }
}

/// The spectrum of the tile's error with all samples, averaged over integrands of both families and over frames and
/// relative to white noise: what figure 5.20 shows of a rendering's error.
pub fn error_spectrum(tile: &TileView, integrands: usize) -> Result<Spectrum> {
    if integrands == 0 {
        return Err(Error::input("0 integrands: give at least 1"));
    }
    let axes: Vec<usize> = (0..tile.dims).collect();
    let transform = Transform::new(tile.size);
    let pairs: Vec<[Integrand; 2]> =
        [Family::HalfSpace, Family::Gaussian].iter().flat_map(|&f| pairs_of(f, &axes, 0, integrands)).collect();
    let pixels = tile.size * tile.size;
    let part = |part: usize| {
        let mut power = vec![0.0; pixels];
        for pair in pairs.iter().skip(part).step_by(PARTS) {
            let weight = tile.spp as f64 / (pair.iter().map(|i| i.variance).sum::<f64>() * pixels as f64);
            for mut image in errors(tile, &axes, pair, &[tile.spp]) {
                transform.forward(&mut image);
                power.iter_mut().zip(&image).for_each(|(sum, z)| *sum += z.norm_sqr() * weight);
            }
        }
        power
    };
    let parts: Vec<Vec<f64>> = (0..PARTS).into_par_iter().map(part).collect();
    let images = (pairs.len() * tile.frames) as f64;
    let size = tile.size;
    let sum = |i: usize| parts.iter().map(|p| p[i]).sum::<f64>() / images;
    let mut power = vec![0.0; pixels];
    for y in 0..size {
        for x in 0..size {
            // Transposed by the transform; two real images in one complex one: only even parts are theirs.
            let (here, mirrored) = (x * size + y, (size - x) % size * size + (size - y) % size);
            let to = (y + size / 2) % size * size + (x + size / 2) % size;
            power[to] = 0.5 * (sum(here) + sum(mirrored));
        }
    }
    Ok(Spectrum::new(size, power, size as f64, tile.frames))
}

/// The integrands that tiles of `dims` dimensions are measured with, from number `first` on. Normals of half-spaces
/// have no component below .001 (.03 in more than two dimensions).
pub fn integrands(family: Family, dims: usize, first: u64, count: usize) -> Vec<Integrand> {
    let smallest = if dims > 2 { 0.03 } else { 1e-3 };
    (first..first + count as u64).map(|i| Integrand::random(family, dims, smallest, SEED, i)).collect()
}

/// Two integrands share one complex transform. An odd number is rounded up.
fn pairs_of(family: Family, axes: &[usize], first: u64, count: usize) -> Vec<[Integrand; 2]> {
    let all = integrands(family, axes.len(), first, count.next_multiple_of(2));
    all.chunks_exact(2).map(|pair| [pair[0].clone(), pair[1].clone()]).collect()
}

/// Error images of a pair of integrands, as real and imaginary parts, of the first samples of every pixel:
/// `[frame][prefix]` of `[y][x]`.
fn errors(tile: &TileView, axes: &[usize], pair: &[Integrand; 2], prefixes: &[usize]) -> Vec<Plane> {
    let pixels = tile.size * tile.size;
    let mut images = vec![vec![Complex::new(0.0, 0.0); pixels]; tile.frames * prefixes.len()];
    let all_axes = axes.len() == tile.dims;
    let mut chosen = [0.0_f32; 8];
    for (frame, images) in images.chunks_mut(prefixes.len()).enumerate() {
        let samples = &tile.coordinates[frame * pixels * tile.spp * tile.dims..][..pixels * tile.spp * tile.dims];
        for (pixel, samples) in samples.chunks_exact(tile.spp * tile.dims).enumerate() {
            let mut sums = [0.0; 2];
            let mut prefix = 0;
            for (index, sample) in samples.chunks_exact(tile.dims).enumerate() {
                let point = if all_axes {
                    sample
                } else {
                    axes.iter().zip(&mut chosen).for_each(|(&axis, x)| *x = sample[axis]);
                    &chosen[..axes.len()]
                };
                sums[0] += pair[0].value(point);
                sums[1] += pair[1].value(point);
                if index + 1 == prefixes[prefix] {
                    let count = prefixes[prefix] as f64;
                    images[prefix][pixel] =
                        Complex::new(sums[0] / count - pair[0].integral, sums[1] / count - pair[1].integral);
                    prefix = (prefix + 1).min(prefixes.len() - 1);
                }
            }
        }
    }
    images
}

/// Sums over integrands of mean squares: `[family]` of each filter.
type Sums = [f64; 4];

/// Sums of one family.
struct Parts {
    /// `[prefix]`, over frames.
    prefixes: Vec<Sums>,
    /// `[frame]`, all samples.
    frames: Vec<Sums>,
    /// `[temporal frequency]`, all samples.
    times: Vec<Sums>,
}

fn energies(tile: &TileView, axes: &[usize], prefixes: &[usize], first: u64, options: &TileOptions) -> TileReport {
    let transform = Transform::new(tile.size);
    let filters: Vec<Plane> = FILTERS.iter().map(|&deviation| transform.gaussian(deviation)).collect();
    let filters: Vec<Vec<f64>> = filters.iter().map(|k| k.iter().map(|z| z.norm_sqr()).collect()).collect();
    // The mean of |K|^2 over frequencies is the sum of the kernel's squares (Parseval).
    let pixels = (tile.size * tile.size) as f64;
    let white: Sums =
        std::array::from_fn(|f| filters.get(f).map_or(1.0, |k: &Vec<f64>| k.iter().sum::<f64>() / pixels));
    let temporal = tile.frames > 1 && !options.alphas.is_empty();
    let measure = |image: &Plane| -> Sums {
        std::array::from_fn(|f| {
            let sum: f64 = match filters.get(f) {
                Some(filter) => image.iter().zip(filter).map(|(z, k)| z.norm_sqr() * k).sum(),
                None => image.iter().map(|z| z.norm_sqr()).sum(),
            };
            sum / (pixels * pixels)
        })
    };
    let add = |sums: &mut Sums, more: Sums| sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    let families = [Family::HalfSpace, Family::Gaussian].map(|family| {
        let pairs = pairs_of(family, axes, first, options.integrands);
        let variance: f64 = pairs.iter().flatten().map(|i| i.variance).sum();
        let part = |part: usize| {
            let mut sums = Parts {
                prefixes: vec![[0.0; 4]; prefixes.len()],
                frames: vec![[0.0; 4]; tile.frames],
                times: vec![[0.0; 4]; if temporal { tile.frames } else { 0 }],
            };
            for pair in pairs.iter().skip(part).step_by(PARTS) {
                let mut images = errors(tile, axes, pair, prefixes);
                for (frame, images) in images.chunks_mut(prefixes.len()).enumerate() {
                    let mut whole = [0.0; 4];
                    for (image, sums) in images.iter_mut().zip(&mut sums.prefixes) {
                        transform.forward(image);
                        whole = measure(image);
                        add(sums, whole);
                    }
                    add(&mut sums.frames[frame], whole);
                }
                if temporal {
                    let mut last: Vec<Plane> =
                        images.into_iter().skip(prefixes.len() - 1).step_by(prefixes.len()).collect();
                    super::plane::over_time(&mut last);
                    last.iter().zip(&mut sums.times).for_each(|(image, sums)| add(sums, measure(image)));
                }
            }
            sums
        };
        let parts: Vec<Parts> = (0..PARTS).into_par_iter().map(part).collect();
        let relative = |get: &dyn Fn(&Parts) -> Sums, scale: f64| {
            let total = parts.iter().fold([0.0; 4], |sum: Sums, p| std::array::from_fn(|f| sum[f] + get(p)[f]));
            let ratio: Sums = std::array::from_fn(|f| total[f] * scale / (variance * white[f]));
            Energies { wide: ratio[0], perceptual: ratio[1], narrow: ratio[2], raw: ratio[3] }
        };
        let by_prefix: Vec<Energies> = (prefixes.iter().enumerate())
            .map(|(i, &spp)| relative(&|p| p.prefixes[i], spp as f64 / tile.frames as f64))
            .collect();
        let by_frame: Vec<Energies> = (0..tile.frames).map(|f| relative(&|p| p.frames[f], tile.spp as f64)).collect();
        let by_alpha: Vec<Energies> = (options.alphas.iter().filter(|_| temporal))
            .map(|&alpha| {
                let response = super::plane::moving_average_response(alpha, tile.frames);
                let total: f64 = response.iter().sum();
                let weighted = |p: &Parts| -> Sums {
                    std::array::from_fn(|f| p.times.iter().zip(&response).map(|(sums, r)| sums[f] * r).sum())
                };
                relative(&weighted, tile.spp as f64 / total)
            })
            .collect();
        (by_prefix, by_frame, by_alpha)
    });
    let [half, bumps] = families;
    let pair = |h: &[Energies], g: &[Energies]| -> Vec<FamilyEnergies> {
        h.iter().zip(g).map(|(&half_spaces, &gaussians)| FamilyEnergies { half_spaces, gaussians }).collect()
    };
    let by_prefix = pair(&half.0, &bumps.0);
    TileReport {
        size: tile.size,
        spp: tile.spp,
        dims: tile.dims,
        frames: tile.frames,
        border: border::density(tile.dims, tile.coordinates),
        integrands: options.integrands.next_multiple_of(2),
        prefixes: prefixes.iter().zip(by_prefix).map(|(&spp, energies)| PrefixEnergies { spp, energies }).collect(),
        marginals: Vec::new(),
        per_frame: if tile.frames > 1 { pair(&half.1, &bumps.1) } else { Vec::new() },
        temporal: (options.alphas.iter().zip(pair(&half.2, &bumps.2)))
            .map(|(&alpha, energies)| TemporalEnergies { alpha, energies })
            .collect(),
    }
}
