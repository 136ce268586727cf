//! The optimisation of a point set, step by step.

use super::check;
use super::contested::contested;
use super::direction::direction;
use super::group::{self, Group};
use super::problem::{Domain, Problem};
use super::schedule::{MOST_OBJECTIVES, SLICES, Schedule, is_windowed, objectives, window_count};
use super::slice::{Bins, Offset, Slice, Workspace, advance, transport};
use crate::class::{Class, Filter, RUN, normalised};
use crate::error::Result;
use crate::memory;
use crate::points::{BELOW_ONE, Points};
use crate::random::stream;
use crate::run::Optimization;
use crate::target::MAX_DIMS;
use noisefloor::rng::Rng;
use rayon::prelude::*;
use std::sync::Mutex;

/// An optimisation of a point set (5.18).
///
/// One step draws a few slices, each a class, a threshold and a direction, finds where one-dimensional optimal
/// transport moves each slice's points, and moves every point by the mean of what its slices want. Memory: about 200
/// bytes per point, and 32 for each thread up to 16, or as many threads as there is memory for; and what class
/// functions of many values need.
#[derive(Debug)]
pub struct Optimizer {
    pub(super) problem: Problem,
    pub(super) filters: Vec<Filter>,
    /// Of the classes, without the empty ones; empty if no class has points.
    pub(super) weights: Vec<f64>,
    /// Of the classes: whether another one gives the same points another target.
    contested: Vec<bool>,
    /// How windows share the points; empty without windows.
    pub(super) groups: Vec<Group>,
    schedule: Schedule,
    pub(super) iteration: u64,
    pub(super) coordinates: Vec<f32>,
    offsets: Vec<Vec<Offset>>,
    workspaces: Mutex<Vec<Workspace>>,
    /// How many slices there is memory to work on at once.
    workers: usize,
}

/// How many threads there is memory for, each of which needs a workspace, beside coordinates, the offsets of all slices
/// and classes.
fn workers(problem: &Problem) -> Result<usize> {
    let points = problem.points as u64;
    let (shared, each) = (points * (4 * problem.dims + SLICES * size_of::<Offset>()) as u64, 32 * points);
    // Before the class functions are looked at.
    memory::check(shared + each)?;
    let count = |class: &Class| Filter::count(&class.function, &problem.class_coordinates, problem.points);
    let runs = problem.classes.iter().map(|class| count(class) as u64).sum();
    let classes = class_bytes(runs, problem.classes.len() as u64, points, is_windowed(problem));
    memory::workers(shared.saturating_add(classes), each, rayon::current_num_threads().min(SLICES))
}

/// The memory of classes that have so many runs together: their filters, and what [`group::groups`] makes of them.
fn class_bytes(runs: u64, classes: u64, points: u64, windowed: bool) -> u64 {
    let ends = 2 * runs + 2;
    let kinds = ends.min(points + 1);
    let groups = 4 * ends + kinds * (4 * classes + 8) + 8 * points;
    RUN as u64 * runs + if windowed { groups } else { 0 }
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
        let workers = workers(&problem)?;
        let points = problem.points;
        let filters: Vec<Filter> = problem
            .classes
            .iter()
            .map(|class| Filter::new(&class.function, &problem.class_coordinates, points))
            .collect();
        let weights = problem.classes.iter().zip(&filters).map(|(class, filter)| (class.weight, filter.members() == 0));
        let weights = normalised(weights).unwrap_or_default();
        let contested = contested(&problem.classes, &filters, &weights);
        let schedule = Schedule::new(&problem, objectives(filters.iter().map(|filter| filter.values(MOST_OBJECTIVES))));
        let windows = if schedule.has_windows() { window_count(points, problem.dims) } else { 0 };
        let groups = if windows == 0 { Vec::new() } else { group::groups(&filters, points, windows) };
        let coordinates = super::initial::coordinates(&problem);
        let offsets = vec![Vec::new(); SLICES];
        let workspaces = Mutex::default();
        Ok(Optimizer {
            problem,
            filters,
            weights,
            contested,
            groups,
            schedule,
            iteration: 0,
            coordinates,
            offsets,
            workspaces,
            workers,
        })
    }

    /// The points as they are now.
    pub fn points(&self) -> Points {
        Points::new(self.problem.dims, self.coordinates.clone())
    }

    /// What is being optimised.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    fn step_whole(&mut self, step: f32) -> f64 {
        let (points, dims) = (self.problem.points, self.problem.dims);
        let mut offsets = std::mem::take(&mut self.offsets);
        offsets.iter_mut().for_each(|offsets| offsets.resize(points, [0.0; 2]));

        let one = |(number, offsets): (usize, &mut Vec<Offset>)| {
            let mut rng = stream(self.problem.seed, self.iteration, number as u64);
            let (class, slice) = self.draw(number, &mut rng);
            let mut workspace = self.workspaces.lock().ok().and_then(|mut all| all.pop()).unwrap_or_default();
            let target = &self.problem.classes[class].target;
            let write = |means: &mut [f32], density: &mut [f32], scratch: &mut Vec<f32>| {
                target.bins(&slice.direction, means, density, scratch);
                if self.contested[class] {
                    density.fill(1.0);
                }
            };
            let bins = Bins { write, uniform: target.is_uniform() };
            let energy = transport(&slice, &[1.0; MAX_DIMS][..dims], &self.coordinates, bins, offsets, &mut workspace);
            if let Ok(mut all) = self.workspaces.lock() {
                all.push(workspace);
            }
            (slice, energy)
        };
        // What a thread costs to wake is more than a few points do.
        let alone = rayon::current_num_threads() == 1 || points < 256;
        let slices: Vec<(Slice, f64)> = if alone {
            offsets.iter_mut().enumerate().map(one).collect()
        } else {
            let least = if self.workers < rayon::current_num_threads() { SLICES.div_ceil(self.workers) } else { 1 };
            offsets.par_iter_mut().enumerate().with_min_len(least).map(one).collect()
        };
        let energy = slices.iter().map(|(_, energy)| energy).sum::<f64>() / SLICES as f64;

        let moved: Vec<(&Slice, &[Offset])> =
            slices.iter().zip(&offsets).map(|((slice, _), offsets)| (slice, &offsets[..])).collect();
        let settle = settle(self.problem.domain);
        if alone {
            advance(&moved, dims, 0, step, &mut self.coordinates, settle);
        } else {
            const CHUNK: usize = 1024;
            self.coordinates
                .par_chunks_mut(CHUNK * dims)
                .enumerate()
                .for_each(|(chunk, coordinates)| advance(&moved, dims, chunk * CHUNK, step, coordinates, settle));
        }
        self.offsets = offsets;
        self.iteration += 1;
        energy
    }

    /// Draws slice `number` of an iteration.
    fn draw(&self, number: usize, rng: &mut Rng) -> (usize, Slice) {
        let mut slice = Slice::default();
        let (class, z) = self.draw_subclass(number, rng);
        slice.direction = direction(self.problem.dims, rng, self.problem.axis_priority);
        if self.problem.domain == Domain::Toroidal {
            slice.shift = (0..self.problem.dims).map(|_| rng.uniform_f32()).collect();
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
        let step = self.schedule.step(self.iteration);
        if self.schedule.in_windows(self.iteration) { self.step_in_windows(step) } else { self.step_whole(step) }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::class::ramp;

    /// Ten million points in 500 classes, each of which tells all points apart.
    #[test]
    fn classes_count() {
        let (runs, classes, points) = (5_000_000_000, 500, 10_000_000);
        assert!(class_bytes(runs, classes, points, false) >= 60_000_000_000);
        assert!(class_bytes(runs, classes, points, true) >= 80_000_000_000);
        assert!(class_bytes(1, 1, points, false) < 100 && class_bytes(1, 1, 1 << 28, true) < 1 << 32);
        let problem = Problem { classes: ramp(2), ..Problem::new(1000, 2) };
        let filters =
            problem.classes.iter().map(|class| Filter::new(&class.function, &problem.class_coordinates, 1000));
        let held: usize = filters.map(|filter| RUN * filter.ends().count() / 2).sum();
        assert_eq!(class_bytes(2000, 2, 1000, false), held as u64);
    }

    /// Whoever has more cores may not be refused what others make.
    #[test]
    fn threads_are_only_as_many_as_there_is_memory_for() {
        let of = |threads: usize, points| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| workers(&Problem::new(points, 2)))
        };
        assert_eq!([1, 3, 40].map(|threads| of(threads, 1000).unwrap()), [1, 3, 16]);
        let [one, many] = [1, 40].map(|threads| of(threads, 200_000_000).unwrap_err().to_string());
        assert_eq!(one, many);
    }

    #[test]
    fn fewer_threads_than_there_are_make_the_same() {
        let of = |workers: Option<usize>| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(7).build().unwrap();
            let mut optimizer = Optimizer::new(Problem { classes: ramp(2), seed: 3, ..Problem::new(700, 2) }).unwrap();
            optimizer.workers = workers.unwrap_or(optimizer.workers);
            let energies: Vec<u64> = (0..5).map(|_| pool.install(|| optimizer.step().to_bits())).collect();
            let made = optimizer.workspaces.lock().unwrap().len();
            assert!(workers.is_none_or(|workers| made <= workers), "{made}");
            (energies, optimizer.coordinates)
        };
        let all = of(None);
        assert!([1, 2, 3, 5, 16].iter().all(|workers| of(Some(*workers)) == all));
    }
}
