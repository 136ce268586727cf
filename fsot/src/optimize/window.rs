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
use crate::target::{MEAN_COMPONENT, uniform_bins};
use rayon::prelude::*;

/// The stream that places the windows; those of slices are below.
const PLACES: u64 = u64::MAX;

/// A window and its points.
struct Window<const D: usize> {
    number: usize,
    start: [f32; D],
    lengths: [f32; D],
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
    pub(super) fn step_in_windows<const D: usize>(&mut self, step: f32) -> f64 {
        let mut rng = stream(self.problem.seed, self.iteration, PLACES);
        let per_axis = windows_per_axis(self.problem.points, D).max(2);
        // A torus is turned at random, then cut at fixed places.
        let turn: [f32; D] = match self.problem.domain {
            Domain::Bounded => [0.0; D],
            Domain::Toroidal => std::array::from_fn(|_| rng.uniform_f32()),
        };
        let (all, _) = self.coordinates.as_chunks_mut::<D>();
        let turned = |point: &[f32; D]| {
            std::array::from_fn(|k| {
                let x = point[k] + turn[k];
                if x >= 1.0 { x - 1.0 } else { x }
            })
        };
        let places: Vec<[f32; D]> = all.par_iter().with_min_len(4096).map(turned).collect();
        let windows = cut(&places, &self.groups, per_axis, self.problem.domain, &mut rng);

        let this = &*self;
        let done: Vec<(Window<D>, f64)> = windows
            .into_par_iter()
            .enumerate()
            .map_init(WindowWorkspace::default, |workspace, (number, Piece { start, lengths, members })| {
                let mut numbers = members.concat();
                numbers.sort_unstable();
                let place = |&i: &u32| (0..D).map(move |k| (i, k));
                let coordinates =
                    numbers.iter().flat_map(place).map(|(i, k)| places[i as usize][k] - start[k]).collect();
                let mut window = Window { number, start, lengths, numbers, coordinates };
                let energy = this.optimize_window(&mut window, step, workspace);
                (window, energy)
            })
            .collect();

        let (all, _) = self.coordinates.as_chunks_mut::<D>();
        for (window, _) in &done {
            let (local, _) = window.coordinates.as_chunks::<D>();
            for (&i, local) in window.numbers.iter().zip(local) {
                for k in 0..D {
                    let x = window.start[k] + local[k] - turn[k];
                    all[i as usize][k] = (if x < 0.0 && turn[k] > 0.0 { x + 1.0 } else { x }).clamp(0.0, BELOW_ONE);
                }
            }
        }
        self.iteration += 1;
        done.iter().map(|(_, energy)| energy).sum::<f64>() / self.problem.points as f64
    }

    /// A few iterations in a window. Returns the sum over its points of the mean squared distance before them.
    fn optimize_window<const D: usize>(
        &self,
        window: &mut Window<D>,
        step: f32,
        workspace: &mut WindowWorkspace,
    ) -> f64 {
        let Window { number, lengths, numbers, coordinates, .. } = window;
        let (number, lengths) = (*number, *lengths);
        let WindowWorkspace { transport: memory, offsets } = workspace;
        offsets.resize_with(SLICES, Vec::new);
        offsets
            .iter_mut()
            .filter(|offsets| offsets.len() < numbers.len())
            .for_each(|o| o.resize(numbers.len(), [0.0; 2]));
        let mut slices: Vec<Slice<D>> = (0..SLICES).map(|_| Slice::new()).collect();
        let mut first_energy = 0.0;
        let range = lengths.iter().sum::<f32>() * MEAN_COMPONENT[D];
        for iteration in 0..WINDOW_ITERATIONS {
            for (k, (slice, offsets)) in slices.iter_mut().zip(offsets.iter_mut()).enumerate() {
                let turn = (number * WINDOW_ITERATIONS + iteration) * SLICES + k;
                let mut rng = stream(self.problem.seed, self.iteration, turn as u64);
                let (class, z) = self.draw_subclass(k, &mut rng);
                slice.direction = direction(&mut rng, self.problem.axis_priority);
                slice.count = self.filters[class].select_of(z, numbers, &mut slice.selected);
                let write = |means: &mut [f32], density: &mut [f32], _: &mut Vec<f32>| {
                    let mut extents: [f32; D] = std::array::from_fn(|k| slice.direction[k].abs() * lengths[k]);
                    let center = (0..D).map(|k| 0.5 * slice.direction[k] * lengths[k]).sum();
                    uniform_bins(center, &mut extents, range, means, density);
                };
                let bins = Bins { write, uniform: true };
                let energy = transport(slice, &lengths, coordinates, bins, offsets, memory);
                if iteration == 0 {
                    first_energy += energy;
                }
            }
            let moved: Vec<(&Slice<D>, &[Offset])> =
                slices.iter().zip(offsets.iter().map(|offsets| &offsets[..])).collect();
            // Points may begin outside, by a little; none goes farther out.
            let settle = |from: f32, to: f32, k: usize| to.clamp(from.min(0.0), from.max(lengths[k]));
            advance(&moved, 0, step, coordinates, settle);
        }
        first_energy / SLICES as f64 * numbers.len() as f64
    }
}
