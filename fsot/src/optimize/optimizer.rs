//! The optimisation of a point set, step by step.

use super::check;
use super::direction::direction;
use super::group::{self, Group};
use super::problem::{Domain, Problem};
use super::schedule::{MOST_OBJECTIVES, SLICES, Schedule, objectives, window_count};
use super::slice::{Bins, Offset, Slice, Workspace, advance, transport};
use crate::class::{Filter, normalised};
use crate::error::Result;
use crate::memory;
use crate::points::{BELOW_ONE, Points};
use crate::random::stream;
use crate::run::Optimization;
use noisefloor::rng::Rng;
use rayon::prelude::*;
use std::sync::Mutex;

/// An optimisation of a point set (5.18).
///
/// One step draws a few slices, each a class, a threshold and a direction, finds where one-dimensional optimal
/// transport moves each slice's points, and moves every point by the mean of what its slices want. Memory: about 200
/// bytes per point, and 32 for each thread up to 16.
pub struct Optimizer {
    pub(super) problem: Problem,
    pub(super) filters: Vec<Filter>,
    /// Of the classes, without the empty ones; empty if no class has points.
    pub(super) weights: Vec<f64>,
    /// How windows share the points; empty without windows.
    pub(super) groups: Vec<Group>,
    schedule: Schedule,
    pub(super) iteration: u64,
    pub(super) coordinates: Vec<f32>,
    offsets: Vec<Vec<Offset>>,
    workspaces: Mutex<Vec<Workspace>>,
}

/// The memory of an optimisation: coordinates, the offsets of all slices, and a workspace for each thread.
fn bytes(problem: &Problem) -> u64 {
    let threads = rayon::current_num_threads().min(SLICES);
    let per_point = 4 * problem.dims + SLICES * size_of::<Offset>() + 32 * threads;
    problem.points as u64 * per_point as u64
}

impl Optimizer {
    /// Prepares an optimisation.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for numbers out of range, targets of other dimensions than the points,
    /// functions that are not class functions, initial points that do not fit, a torus with targets that are not
    /// uniform, and more memory than [`memory::MOST`] or than the system gives.
    pub fn new(problem: Problem) -> Result<Optimizer> {
        check::check(&problem)?;
        memory::check(bytes(&problem))?;
        let points = problem.points;
        let filters: Vec<Filter> = problem
            .classes
            .iter()
            .map(|class| Filter::new(&class.function, &problem.class_coordinates, points))
            .collect();
        let weights = problem.classes.iter().zip(&filters).map(|(class, filter)| (class.weight, filter.members() == 0));
        let weights = normalised(weights).unwrap_or_default();
        let schedule = Schedule::new(&problem, objectives(filters.iter().map(|filter| filter.values(MOST_OBJECTIVES))));
        let windows = if schedule.has_windows() { window_count(points, problem.dims) } else { 0 };
        let groups = if windows == 0 { Vec::new() } else { group::groups(&filters, points, windows) };
        let coordinates = super::initial::coordinates(&problem);
        let offsets = vec![Vec::new(); SLICES];
        let workspaces = Mutex::default();
        Ok(Optimizer { problem, filters, weights, groups, schedule, iteration: 0, coordinates, offsets, workspaces })
    }

    /// The points as they are now.
    pub fn points(&self) -> Points {
        Points::new(self.problem.dims, self.coordinates.clone())
    }

    /// What is being optimised.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    fn step_in<const D: usize>(&mut self) -> f64 {
        let step = self.schedule.step(self.iteration);
        let points = self.problem.points;
        let mut offsets = std::mem::take(&mut self.offsets);
        offsets.iter_mut().for_each(|offsets| offsets.resize(points, [0.0; 2]));

        let one = |(number, offsets): (usize, &mut Vec<Offset>)| {
            let mut rng = stream(self.problem.seed, self.iteration, number as u64);
            let (class, slice) = self.draw::<D>(number, &mut rng);
            let mut workspace = self.workspaces.lock().ok().and_then(|mut all| all.pop()).unwrap_or_default();
            let target = &self.problem.classes[class].target;
            let write = |means: &mut [f32], density: &mut [f32], scratch: &mut Vec<f32>| {
                target.bins(&slice.direction, means, density, scratch);
            };
            let bins = Bins { write, uniform: target.is_uniform() };
            let energy = transport(&slice, &[1.0; D], &self.coordinates, bins, offsets, &mut workspace);
            if let Ok(mut all) = self.workspaces.lock() {
                all.push(workspace);
            }
            (slice, energy)
        };
        // What a thread costs to wake is more than a few points do.
        let alone = rayon::current_num_threads() == 1 || points < 256;
        let slices: Vec<(Slice<D>, f64)> = if alone {
            offsets.iter_mut().enumerate().map(one).collect()
        } else {
            offsets.par_iter_mut().enumerate().map(one).collect()
        };
        let energy = slices.iter().map(|(_, energy)| energy).sum::<f64>() / SLICES as f64;

        let moved: Vec<(&Slice<D>, &[Offset])> =
            slices.iter().zip(&offsets).map(|((slice, _), offsets)| (slice, &offsets[..])).collect();
        let settle = settle(self.problem.domain);
        if alone {
            advance(&moved, 0, step, &mut self.coordinates, settle);
        } else {
            const CHUNK: usize = 1024;
            self.coordinates
                .par_chunks_mut(CHUNK * D)
                .enumerate()
                .for_each(|(chunk, coordinates)| advance(&moved, chunk * CHUNK, step, coordinates, settle));
        }
        self.offsets = offsets;
        self.iteration += 1;
        energy
    }

    /// Draws slice `number` of an iteration.
    fn draw<const D: usize>(&self, number: usize, rng: &mut Rng) -> (usize, Slice<D>) {
        let mut slice = Slice::new();
        let (class, z) = self.draw_subclass(number, rng);
        slice.direction = direction(rng, self.problem.axis_priority);
        if self.problem.domain == Domain::Toroidal {
            slice.shift = std::array::from_fn(|_| rng.uniform_f32());
        }
        slice.count = self.filters[class].select(z, &mut slice.selected);
        (class, slice)
    }

    /// A class, by weight, and a threshold. Slices take turns, each a part of all (class, threshold).
    pub(super) fn draw_subclass(&self, number: usize, rng: &mut Rng) -> (usize, f32) {
        let u = (number as f64 + rng.uniform_f64()) / SLICES as f64;
        let (mut class, mut below) = (0, 0.0);
        while class + 1 < self.weights.len() && (u >= below + self.weights[class] || self.weights[class] == 0.0) {
            below += self.weights[class];
            class += 1;
        }
        let weight = self.weights.get(class).copied().unwrap_or(1.0);
        let within = if weight > 0.0 { ((u - below) / weight).clamp(0.0, 1.0) } else { 0.0 };
        (class, within as f32 * self.filters[class].highest())
    }
}

/// What keeps a coordinate in the domain.
fn settle(domain: Domain) -> impl Fn(f32, f32, usize) -> f32 + Copy + Send + Sync {
    move |_, x, _| match domain {
        Domain::Bounded => x.clamp(0.0, BELOW_ONE),
        Domain::Toroidal => {
            let x = x - x.floor();
            if x < 1.0 { x } else { 0.0 }
        }
    }
}

impl Optimization for Optimizer {
    fn iterations(&self) -> u64 {
        self.schedule.iterations()
    }

    fn iteration(&self) -> u64 {
        self.iteration
    }

    fn step(&mut self) -> f64 {
        if self.weights.is_empty() {
            self.iteration += 1;
            return 0.0;
        }
        if self.schedule.in_windows(self.iteration) {
            let step = self.schedule.step(self.iteration);
            return match self.problem.dims {
                1 => self.step_in_windows::<1>(step),
                2 => self.step_in_windows::<2>(step),
                _ => self.step_in_windows::<3>(step),
            };
        }
        match self.problem.dims {
            1 => self.step_in::<1>(),
            2 => self.step_in::<2>(),
            3 => self.step_in::<3>(),
            4 => self.step_in::<4>(),
            5 => self.step_in::<5>(),
            6 => self.step_in::<6>(),
            7 => self.step_in::<7>(),
            _ => self.step_in::<8>(),
        }
    }

    fn coordinates(&self) -> &[f32] {
        &self.coordinates
    }

    fn restore(&mut self, iteration: u64, coordinates: &[f32]) -> bool {
        let valid = iteration <= self.iterations()
            && coordinates.len() == self.coordinates.len()
            && coordinates.iter().all(|x| (0.0..1.0).contains(x));
        if valid {
            self.iteration = iteration;
            self.coordinates.copy_from_slice(coordinates);
        }
        valid
    }
}
