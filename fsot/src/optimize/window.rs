//! Windows: large uniform sets are optimised in boxes of about a thousand points, which costs less per point and moves them farther.

use super::Domain;
use super::direction::direction;
use super::optimizer::Optimizer;
use super::schedule::{SLICES, WINDOW, WINDOW_ITERATIONS};
use super::slice::{Bins, Offset, Slice, Workspace, advance, transport};
use crate::points::BELOW_ONE;
use crate::random::stream;
use crate::target::{MEAN_COMPONENT, uniform_bins};
use noisefloor::rng::Rng;
use rayon::prelude::*;

/// The stream that places the windows; those of slices are below.
const PLACES: u64 = u64::MAX;

/// How an axis is cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cuts {
    /// Windows along the axis, at least 2.
    count: usize,
    /// The first cut, in units of a window: in [1/2, 3/2) if bounded. On a torus, how far points are moved before they are cut at whole windows.
    offset: f32,
    domain: Domain,
}

impl Cuts {
    pub(super) fn new(count: usize, domain: Domain, rng: &mut Rng) -> Cuts {
        let offset = rng.uniform_f32() + if domain == Domain::Bounded { 0.5 } else { 0.0 };
        Cuts { count, offset, domain }
    }

    /// The window of a coordinate in [0, 1), and the coordinate relative to its lower end.
    pub(super) fn place(&self, x: f32) -> (usize, f32) {
        let last = self.count - 1;
        let mut u = x * self.count as f32;
        let window = match self.domain {
            Domain::Bounded => {
                if u < self.offset {
                    0
                } else {
                    ((u - self.offset) as usize + 1).min(last)
                }
            }
            Domain::Toroidal => {
                u += self.offset;
                u = if u >= self.count as f32 { u - self.count as f32 } else { u };
                (u as usize).min(last)
            }
        };
        let (start, length) = self.extent(window);
        (window, (u / self.count as f32 - start).clamp(0.0, length))
    }

    /// Lower end (before moving, on a torus) and length of a window.
    pub(super) fn extent(&self, window: usize) -> (f32, f32) {
        let count = self.count as f32;
        match self.domain {
            Domain::Toroidal => (window as f32 / count, 1.0 / count),
            Domain::Bounded => {
                let cut = |k: usize| (k as f32 - 1.0 + self.offset) / count;
                let start = if window == 0 { 0.0 } else { cut(window) };
                let end = if window + 1 == self.count { 1.0 } else { cut(window + 1) };
                (start, end - start)
            }
        }
    }

    /// The coordinate of a place in a window.
    pub(super) fn coordinate(&self, window: usize, local: f32) -> f32 {
        let x = self.extent(window).0 + local;
        match self.domain {
            Domain::Bounded => x.clamp(0.0, BELOW_ONE),
            Domain::Toroidal => {
                let x = x - self.offset / self.count as f32;
                (if x < 0.0 { x + 1.0 } else { x }).clamp(0.0, BELOW_ONE)
            }
        }
    }
}

/// How many windows each axis has for a number of points; fewer than 2: none.
pub(super) fn windows_per_axis(points: usize, dims: usize) -> usize {
    let windows = points as f64 / WINDOW as f64;
    match dims {
        1 => windows as usize,
        2 => windows.sqrt() as usize,
        _ => libm::cbrt(windows) as usize,
    }
}

/// A window and its points.
struct Window<'a, const D: usize> {
    number: usize,
    lengths: [f32; D],
    /// The numbers of its points in the set, ascending.
    numbers: &'a [u32],
    coordinates: &'a mut [f32],
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
        let points = self.problem.points;
        let mut rng = stream(self.problem.seed, self.iteration, PLACES);
        let per_axis = windows_per_axis(points, D).max(2);
        let cuts: [Cuts; D] = std::array::from_fn(|_| Cuts::new(per_axis, self.problem.domain, &mut rng));
        let count = per_axis.pow(D as u32);

        // Points in the order of windows, and by number inside.
        let mut home = vec![0u32; points];
        let mut local = vec![0.0f32; points * D];
        let (all, _) = self.coordinates.as_chunks::<D>();
        let (local_points, _) = local.as_chunks_mut::<D>();
        home.par_iter_mut().zip(local_points).zip(all).with_min_len(4096).for_each(|((home, local), point)| {
            let mut window = 0;
            for k in 0..D {
                let (place, x) = cuts[k].place(point[k]);
                window = window * per_axis + place;
                local[k] = x;
            }
            *home = window as u32;
        });
        let mut starts = vec![0usize; count + 1];
        home.iter().for_each(|&window| starts[window as usize + 1] += 1);
        for window in 0..count {
            starts[window + 1] += starts[window];
        }
        let mut next = starts.clone();
        let mut numbers = vec![0u32; points];
        let mut coordinates = vec![0.0f32; points * D];
        for (i, &window) in home.iter().enumerate() {
            let place = next[window as usize];
            next[window as usize] += 1;
            numbers[place] = i as u32;
            coordinates[place * D..(place + 1) * D].copy_from_slice(&local[i * D..(i + 1) * D]);
        }

        let mut windows = Vec::with_capacity(count);
        let mut rest = &mut coordinates[..];
        for number in 0..count {
            let (begin, end) = (starts[number], starts[number + 1]);
            let (mine, others) = rest.split_at_mut((end - begin) * D);
            rest = others;
            let places = place_of::<D>(number, per_axis);
            let lengths: [f32; D] = std::array::from_fn(|k| cuts[k].extent(places[k]).1);
            windows.push(Window { number, lengths, numbers: &numbers[begin..end], coordinates: mine });
        }
        let energies: Vec<f64> = windows
            .into_par_iter()
            .map_init(WindowWorkspace::default, |workspace, window| self.optimize_window(window, step, workspace))
            .collect();

        for (number, range) in starts.windows(2).enumerate() {
            let places = place_of::<D>(number, per_axis);
            for at in range[0]..range[1] {
                let point = &mut self.coordinates[numbers[at] as usize * D..][..D];
                for (k, x) in point.iter_mut().enumerate() {
                    *x = cuts[k].coordinate(places[k], coordinates[at * D + k]);
                }
            }
        }
        self.iteration += 1;
        energies.iter().sum::<f64>() / points as f64
    }

    /// A few iterations in a window. Returns the sum over its points of the mean squared distance before them.
    fn optimize_window<const D: usize>(
        &self,
        window: Window<'_, D>,
        step: f32,
        workspace: &mut WindowWorkspace,
    ) -> f64 {
        let Window { number, lengths, numbers, coordinates } = window;
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
            advance(&moved, 0, step, coordinates, |x, k| x.clamp(0.0, lengths[k]));
        }
        first_energy / SLICES as f64 * numbers.len() as f64
    }
}

/// The window's place along every axis.
fn place_of<const D: usize>(mut number: usize, per_axis: usize) -> [usize; D] {
    let mut places = [0; D];
    for place in places.iter_mut().rev() {
        *place = number % per_axis;
        number /= per_axis;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_point_comes_back_from_its_window(x in 0.0f32..1.0, count in 2usize..60, torus in any::<bool>(), seed in any::<u64>()) {
            let domain = if torus { Domain::Toroidal } else { Domain::Bounded };
            let cuts = Cuts::new(count, domain, &mut stream(seed, 0, 0));
            let (window, local) = cuts.place(x);
            let (start, length) = cuts.extent(window);
            prop_assert!(window < count && (0.0..=length).contains(&local) && (0.0..1.0).contains(&start));
            let back = cuts.coordinate(window, local);
            let apart = (back - x).abs();
            prop_assert!(apart.min(1.0 - apart) < 1e-6, "{x} became {back}");
            prop_assert!((0.0..1.0).contains(&back));
            // The windows cover the axis, none of them much smaller than the others.
            let total: f32 = (0..count).map(|k| cuts.extent(k).1).sum();
            prop_assert!((total - 1.0).abs() < 1e-5);
            prop_assert!((0..count).all(|k| cuts.extent(k).1 * count as f32 > 0.499));
        }
    }
}
