//! What a tile shall be.

use super::kernel::Kernel;
use super::temporal::TemporalKernel;
use crate::error::{Error, Result, check};
use crate::optimize::Quality;
use noisefloor::tile::{MAX_DIMS, MAX_FRAMES, MAX_SIZE, MAX_SPP};
use serde::Serialize;

/// The most coordinates in all.
const MAX_COORDINATES: usize = 1 << 28;
/// The most iterations.
const MAX_ITERATIONS: u64 = 1 << 24;
/// The most directions of an iteration.
const MAX_DIRECTIONS: usize = 16;

/// A tile to be optimised. [`TileProblem::new`] gives one whose parameters were tuned; any may be changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TileProblem {
    /// Pixels along each side: a power of two from 8 to 1024, more than twice the kernel's radius.
    pub size: usize,
    /// Samples per pixel: a power of two from 1 to 256.
    pub spp: usize,
    /// Coordinates per sample: 1 to 8.
    pub dims: usize,
    /// Frames: 1 for a still tile, else 2 to 256 that loop.
    pub frames: usize,
    /// The spatial class function.
    pub kernel: Kernel,
    /// The temporal class function that multiplies it; None: the frames are independent tiles.
    pub temporal: Option<TemporalKernel>,
    /// Whether the first 1, 2, 4, ... samples of all pixels are tiles too.
    pub progressive: bool,
    /// The class of what the renderer reconstructs a pixel from, beside the perceptual one: it lowers the error that is
    /// there before any perception, such as that of single pixels. In an animation with a temporal kernel, over time.
    pub box_class: ClassShare,
    /// The spatial class function of that class: [`Kernel::Box`] unless the renderer reconstructs with another one.
    pub reconstruction: Kernel,
    /// The share of the slices of an animation that look at one frame only: 0 to 1. Ignored without
    /// [`temporal`](Self::temporal).
    pub frame_share: f32,
    /// Seed of everything random.
    pub seed: u64,
    /// Steps in all: 1 to 2^24. See [`iterations`].
    pub iterations: u64,
    /// Directions drawn for each step; every slice takes one of them. 1 to 16.
    pub directions: usize,
    /// How the directions are drawn.
    pub projections: Projections,
    /// How far a step goes.
    pub steps: Steps,
    /// The exponent of the offset correction (5.24): 1 is the thesis's, 0 none. 0 to 2.
    pub offset_correction: f32,
    /// The threshold of a slice is z = u^e with u uniform on [0, 1): above 1 prefers wide subclasses. For a Gaussian
    /// kernel it is the same as a standard deviation sqrt(e) times as large. 0.25 to 4.
    pub threshold_exponent: f32,
}

/// What a class counts beside the others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClassShare {
    /// The share of the slices: 0 to 1.
    pub share: f32,
    /// What its displacements count, those of the perceptual class of all samples counting 1: above 0, at most 1024.
    /// The weight of a class times that of a prefix may be less: times the pixels of the class, over all classes, it
    /// adds up to at most 2^18, so that sums of displacements fit 64 bits. The perceptual kernel has 113 pixels.
    pub weight: f32,
}

/// What a slice is projected on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Projections {
    /// The probability of an axis.
    pub axis: f32,
    /// The probability of a direction in the plane of two axes.
    pub plane: f32,
}

/// The step size: `first`, then from `hold` (as a part of all iterations) falling linearly to `last`. 1 moves a sample
/// by the mean of the displacements that its slices ask for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Steps {
    /// The step size at first: above 0, at most 16.
    pub first: f32,
    /// The step size at the end: 0 to 16.
    pub last: f32,
    /// Where it begins to fall: 0 to 1.
    pub hold: f32,
}

/// The steps that a tile takes: those to look at it, the knee of error against time, or those of most shipped tiles.
pub fn iterations(quality: Quality) -> u64 {
    match quality {
        Quality::Draft => 256,
        Quality::Standard => 1024,
        Quality::High => 4096,
        Quality::Iterations(iterations) => iterations,
    }
}

impl TileProblem {
    /// A still tile for the perceptual kernel, of standard quality.
    pub fn new(size: usize, spp: usize, dims: usize) -> TileProblem {
        TileProblem {
            size,
            spp,
            dims,
            frames: 1,
            kernel: Kernel::Perceptual,
            temporal: None,
            progressive: false,
            box_class: ClassShare { share: if spp > 1 { 0.1 } else { 0.0 }, weight: 1.0 },
            reconstruction: Kernel::Box,
            frame_share: 0.5,
            seed: 1,
            iterations: iterations(Quality::Standard),
            directions: 4,
            projections: Projections { axis: 0.0, plane: if dims > 2 { 0.2 } else { 0.0 } },
            steps: Steps { first: 4.0, last: 0.05, hold: 0.3 },
            offset_correction: if spp > 1 && dims <= 2 { 0.5 } else { 0.0 },
            threshold_exponent: if spp > 1 { 1.4 } else { 1.2 },
        }
    }

    /// The spatial and the temporal class function in words, as a tile's file names them.
    pub fn kernels(&self) -> String {
        match &self.temporal {
            None => self.kernel.to_string(),
            Some(temporal) => format!("{}, over frames {temporal}", self.kernel),
        }
    }

    /// All coordinates: of every dimension of every sample of every pixel of every frame.
    pub fn coordinates(&self) -> usize {
        self.frames * self.size * self.size * self.spp * self.dims
    }

    /// An [`Error::Input`] that names the first number out of its range.
    pub(super) fn check_ranges(&self) -> Result<()> {
        let within = |n: usize, from: usize, to: u32| (from..=to as usize).contains(&n);
        let power = |n: usize, from: usize, to: u32| n.is_power_of_two() && within(n, from, to);
        check(power(self.size, 8, MAX_SIZE), "size", self.size, "a power of two from 8 to 1024 pixels")?;
        check(power(self.spp, 1, MAX_SPP), "spp", self.spp, "a power of two from 1 to 256 samples per pixel")?;
        check(within(self.dims, 1, MAX_DIMS), "dims", self.dims, "1 to 8 dimensions")?;
        check(within(self.frames, 1, MAX_FRAMES), "frames", self.frames, "1 to 256 frames")?;
        check(self.coordinates() <= MAX_COORDINATES, "the number of coordinates", self.coordinates(), "at most 2^28")?;
        check((1..=MAX_ITERATIONS).contains(&self.iterations), "iterations", self.iterations, "1 to 2^24")?;
        check((1..=MAX_DIRECTIONS).contains(&self.directions), "directions", self.directions, "1 to 16 per step")?;
        let ClassShare { share, weight } = self.box_class;
        check((0.0..=1.0).contains(&share), "the box class's share", share, "0 to 1")?;
        check(weight > 0.0 && weight <= 1024.0, "the box class's weight", weight, "above 0 and at most 1024")?;
        check((0.0..=1.0).contains(&self.frame_share), "the frame share", self.frame_share, "0 to 1")?;
        check(
            self.temporal.is_none() || share + self.frame_share <= 1.0,
            "the box class's share",
            share,
            &format!("at most {}, as the slices of single frames have the rest", 1.0 - self.frame_share),
        )?;
        let Projections { axis, plane } = self.projections;
        check((0.0..=1.0).contains(&axis), "the probability of an axis", axis, "0 to 1")?;
        check(
            (0.0..=1.0 - axis).contains(&plane),
            "the probability of a plane",
            plane,
            "0 to 1, together with that of an axis",
        )?;
        let Steps { first, last, hold } = self.steps;
        check(first > 0.0 && first <= 16.0, "the first step size", first, "above 0 and at most 16")?;
        check((0.0..=16.0).contains(&last), "the last step size", last, "0 to 16")?;
        check((0.0..=1.0).contains(&hold), "the iterations before the step size falls", hold, "0 to 1 of all")?;
        check(
            (0.0..=2.0).contains(&self.offset_correction),
            "the offset correction",
            self.offset_correction,
            "0 to 2",
        )?;
        check(
            (0.25..=4.0).contains(&self.threshold_exponent),
            "the threshold exponent",
            self.threshold_exponent,
            "0.25 to 4",
        )?;
        if self.temporal.is_some() && self.frames < 2 {
            return Err(Error::input("a temporal kernel is for an animation: ask for at least 2 frames"));
        }
        Ok(())
    }

    /// The step size of an iteration.
    pub(super) fn step_size(&self, iteration: u64) -> f64 {
        let Steps { first, last, hold } = self.steps;
        let done = iteration as f64 / self.iterations as f64;
        let falling = ((done - f64::from(hold)) / (1.0 - f64::from(hold)).max(1e-9)).clamp(0.0, 1.0);
        f64::from(first) + falling * (f64::from(last) - f64::from(first))
    }
}
