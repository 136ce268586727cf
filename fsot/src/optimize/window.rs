//! Windows: large uniform sets are optimised in boxes of at least 1,024 points in the mean, which costs less per point
//! and moves them farther.

use super::cut::{Piece, cut};
use super::direction::direction;
use super::optimizer::Optimizer;
use super::problem::Domain;
use super::schedule::{SLICES, WINDOW_ITERATIONS, windows_per_axis};
use super::slice::{Bins, Offset, Slice, Workspace, advance, transport};
use crate::points::BELOW_ONE;
use crate::random::stream;
use crate::target::{MAX_DIMS, MEAN_COMPONENT, uniform_bins};
use rayon::prelude::*;

/// The stream that places the windows; those of slices are below.
const PLACES: u64 = u64::MAX;

/// A window and its points.
struct Window {
    number: usize,
    start: Vec<f32>,
    lengths: Vec<f32>,
    /// The numbers of its points in the set, ascending.
    numbers: Vec<u32>,
    /// Relative to its start.
    coordinates: Vec<f32>,
}

/// What a thread needs for a window.
#[derive(Default)]
pub(super) struct WindowWorkspace {
    transport: Workspace,
    offsets: Vec<Vec<Offset>>,
}

impl Optimizer {
    /// Cuts the domain at random places and optimises each window alone, as a box with uniform targets.
    pub(super) fn step_in_windows(&mut self, step: f32) -> f64 {
        let dims = self.problem.dims;
        let mut rng = stream(self.problem.seed, self.iteration, PLACES);
        let per_axis = windows_per_axis(self.problem.points, dims).max(2);
        // A torus is turned at random, then cut at fixed places.
        let turn: Vec<f32> = match self.problem.domain {
            Domain::Bounded => vec![0.0; dims],
            Domain::Toroidal => (0..dims).map(|_| rng.uniform_f32()).collect(),
        };
        let mut places = self.points();
        for point in places.iter_mut() {
            for (x, turn) in point.iter_mut().zip(&turn) {
                *x += turn;
                *x -= if *x >= 1.0 { 1.0 } else { 0.0 };
            }
        }
        let windows = cut(&places, &self.groups, per_axis, self.problem.domain, &mut rng);

        let this = &*self;
        let done: Vec<(Window, f64)> = windows
            .into_par_iter()
            .enumerate()
            .map_init(WindowWorkspace::default, |workspace, (number, Piece { start, lengths, members })| {
                let mut numbers = members.concat();
                numbers.sort_unstable();
                let place = |&i: &u32| places.point(i as usize).iter().zip(&start).map(|(x, start)| x - start);
                let coordinates = numbers.iter().flat_map(place).collect();
                let mut window = Window { number, start, lengths, numbers, coordinates };
                let energy = this.optimize_window(&mut window, step, workspace);
                (window, energy)
            })
            .collect();

        for (window, _) in &done {
            for (&i, local) in window.numbers.iter().zip(window.coordinates.chunks_exact(dims)) {
                let point = &mut self.coordinates[i as usize * dims..][..dims];
                for k in 0..dims {
                    let x = window.start[k] + local[k] - turn[k];
                    point[k] = (if x < 0.0 && turn[k] > 0.0 { x + 1.0 } else { x }).clamp(0.0, BELOW_ONE);
                }
            }
        }
        self.iteration += 1;
        done.iter().map(|(_, energy)| energy).sum::<f64>() / self.problem.points as f64
    }

    /// A few iterations in a window. Returns the sum over its points of the mean squared distance before them.
    fn optimize_window(&self, window: &mut Window, step: f32, workspace: &mut WindowWorkspace) -> f64 {
        let Window { number, lengths, numbers, coordinates, .. } = window;
        let dims = lengths.len();
        let WindowWorkspace { transport: memory, offsets } = workspace;
        offsets.resize_with(SLICES, Vec::new);
        offsets
            .iter_mut()
            .filter(|offsets| offsets.len() < numbers.len())
            .for_each(|o| o.resize(numbers.len(), [0.0; 2]));
        let mut slices = vec![Slice::default(); SLICES];
        let mut first_energy = 0.0;
        let range = lengths.iter().sum::<f32>() * MEAN_COMPONENT[dims];
        for iteration in 0..WINDOW_ITERATIONS {
            for (k, (slice, offsets)) in slices.iter_mut().zip(offsets.iter_mut()).enumerate() {
                let turn = (*number * WINDOW_ITERATIONS + iteration) * SLICES + k;
                let mut rng = stream(self.problem.seed, self.iteration, turn as u64);
                let (class, z) = self.draw_subclass(k, &mut rng);
                slice.direction = direction(dims, &mut rng, self.problem.axis_priority);
                slice.count = self.filters[class].select_of(z, numbers, &mut slice.selected);
                let write = |means: &mut [f32], density: &mut [f32], _: &mut Vec<f32>| {
                    let mut extents = [0.0; MAX_DIMS];
                    let mut center = 0.0;
                    for (extent, (direction, length)) in extents.iter_mut().zip(slice.direction.iter().zip(&*lengths)) {
                        *extent = direction.abs() * length;
                        center += 0.5 * direction * length;
                    }
                    uniform_bins(center, &mut extents[..dims], range, means, density);
                };
                let bins = Bins { write, uniform: true };
                let energy = transport(slice, lengths, coordinates, bins, offsets, memory);
                if iteration == 0 {
                    first_energy += energy;
                }
            }
            let moved: Vec<(&Slice, &[Offset])> =
                slices.iter().zip(offsets.iter().map(|offsets| &offsets[..])).collect();
            // Points may begin outside, by a little; none goes farther out.
            let settle = |from: f32, to: f32, k: usize| to.clamp(from.min(0.0), from.max(lengths[k]));
            advance(&moved, dims, 0, step, coordinates, settle);
        }
        first_energy / SLICES as f64 * numbers.len() as f64
    }
}
