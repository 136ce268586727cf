//! Stochastic descent of the sliced barycentre (5.18) of all pixels' classes, one slice per pixel and step.

use super::directions;
use super::problem::TileProblem;
use super::projection::Projection;
use super::rank::{POSITION_BITS, Sorter};
use super::samples::TileSamples;
use super::stencil::{Lattice, Stencils, WEIGHT_UNIT};
use crate::error::Result;
use crate::memory;
use crate::points::BELOW_ONE;
use crate::random::stream;
use crate::run::Optimization;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Rows of pixels that one task works on.
const ROWS: usize = 4;

/// Projected coordinates are integers: this many for the whole length of the projection.
const POSITIONS: f64 = (1u64 << POSITION_BITS) as f64;

/// Streams of random numbers that are not those of a row of pixels.
const START_STREAM: u64 = u64::MAX;
const STEP_STREAM: u64 = u64::MAX - 1;

/// Optimises a tile.
///
/// All sums over slices are sums of integers, so the result does not depend on the number of threads. Memory: the
/// samples, their projections on a step's directions and, for each thread, or as many as there is memory for, their
/// displacements.
#[derive(Debug)]
pub struct TileOptimizer {
    problem: TileProblem,
    stencils: Stencils,
    iteration: u64,
    coordinates: Vec<f32>,
    /// One sample's position on each direction of the step: `[direction][sample of the lattice]`.
    positions: Vec<u32>,
    /// The bins of each direction: `[direction][bin of all lengths]`.
    bins: Vec<Bin>,
    /// The displacements found by each worker.
    sums: Mutex<Vec<Vec<i64>>>,
    /// How many work at once, at most.
    workers: usize,
}

/// What the sample of a rank is moved to.
#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    /// The bin's mean, as a position.
    mean: i32,
    /// What the displacement counts: the offset correction (5.24), in units of 1 / [`WEIGHT_UNIT`].
    weight: i32,
}

/// How many threads there is memory for, each of which needs displacements, beside the coordinates and the positions of
/// all samples with their margins.
fn workers(problem: &TileProblem, samples: usize) -> Result<usize> {
    let (directions, samples) = (problem.directions as u64, samples as u64);
    let shared = 4 * problem.coordinates() as u64 + 4 * directions * samples;
    memory::workers(shared, 8 * (directions + 1) * samples, rayon::current_num_threads())
}

impl TileOptimizer {
    /// Starts from random samples. An [`Error::Input`](crate::Error::Input) if the problem is not valid, or needs more
    /// memory than [`memory::MOST`] or than the system gives.
    pub fn new(problem: TileProblem) -> Result<TileOptimizer> {
        let stencils = problem.stencils()?;
        let workers = workers(&problem, stencils.lattice.samples())?;
        let mut rng = stream(problem.seed, 0, START_STREAM);
        let coordinates = (0..problem.coordinates()).map(|_| rng.uniform_f32()).collect();
        let positions = vec![0; problem.directions * stencils.lattice.samples()];
        let bins = vec![Bin::default(); problem.directions * stencils.bins()];
        Ok(TileOptimizer {
            problem,
            stencils,
            iteration: 0,
            coordinates,
            positions,
            bins,
            sums: Mutex::new(Vec::new()),
            workers,
        })
    }

    /// The samples as they are now; unless they are progressive, those of each pixel [ordered](TileSamples::ordered).
    pub fn samples(&self) -> TileSamples {
        let TileProblem { size, spp, dims, frames, .. } = self.problem;
        let samples = TileSamples { size, spp, dims, frames, coordinates: self.coordinates.clone() };
        if self.problem.progressive { samples } else { samples.ordered() }
    }

    /// The bins of every direction and length.
    fn cut(&mut self, projections: &[Projection]) {
        let correction = f64::from(self.problem.offset_correction);
        let lengths = &self.stencils.lengths;
        let all = self.stencils.bins();
        self.bins.par_chunks_exact_mut(all).zip(projections).for_each(|(bins, projection)| {
            let scale = POSITIONS / projection.length;
            for &(length, start) in lengths {
                let bins = &mut bins[start..start + length];
                let mut below = 0.0;
                projection.bins(length, |index, mean, end| {
                    let density = projection.length / length as f64 / (end - below).max(1e-9);
                    let weight = if correction == 0.0 { 1.0 } else { libm::pow(density, correction) };
                    let weight = libm::round(weight * f64::from(WEIGHT_UNIT)).clamp(1.0, 65536.0) as i32;
                    bins[index] = Bin { mean: libm::round(mean * scale) as i32, weight };
                    below = end;
                });
            }
        });
    }

    /// The positions of all samples, margins included, on every direction.
    fn project(&mut self, projections: &[Projection]) {
        let TileProblem { spp, dims, .. } = self.problem;
        let lattice = self.stencils.lattice;
        let coordinates = &self.coordinates;
        for (positions, projection) in self.positions.chunks_exact_mut(lattice.samples()).zip(projections) {
            let scale = (POSITIONS / projection.length) as f32;
            let offset = -projection.lowest;
            let rows = positions.par_chunks_exact_mut(lattice.side() * spp).enumerate();
            rows.for_each(|(row, positions)| {
                let (frame, y) = (row / lattice.side(), row % lattice.side());
                let from = lattice.row(frame, y);
                for (x, pixel) in positions.chunks_exact_mut(spp).enumerate() {
                    let source = (from * lattice.size + lattice.column(x)) * spp * dims;
                    let samples = coordinates[source..source + spp * dims].chunks_exact(dims);
                    for (position, sample) in pixel.iter_mut().zip(samples) {
                        let dot: f32 = sample.iter().zip(&projection.direction).map(|(x, d)| x * d).sum();
                        *position = ((dot + offset) * scale).clamp(0.0, (POSITIONS - 1.0) as f32) as u32;
                    }
                }
            });
        }
    }

    /// One slice for every pixel of some rows: adds the displacements to `sums`, each direction's and then their
    /// weight, sample by sample. Returns the slices' squared distances, in units of 2^-32 squared lengths, per
    /// direction.
    fn slices(&self, rows: std::ops::Range<usize>, sums: &mut [i64]) -> Vec<u64> {
        let lattice = self.stencils.lattice;
        let directions = self.problem.directions;
        let stride = directions + 1;
        let samples = lattice.samples();
        let all = self.stencils.bins();
        let mut sorter = Sorter::new(self.stencils.longest);
        let mut positions = vec![0u32; self.stencils.longest];
        let mut energy = vec![0; directions];
        for row in rows {
            let mut rng = stream(self.problem.seed, self.iteration, row as u64);
            let (frame, y) = (row / lattice.size, row % lattice.size);
            for x in 0..lattice.size {
                let direction = rng.below(directions as u32) as usize;
                let stencil = self.stencils.pick(rng.next_u32());
                let first =
                    lattice.index(frame + lattice.past, y + lattice.margin, x + lattice.margin) - self.stencils.lowest;
                let length = stencil.samples.len();
                let projected = &self.positions[direction * samples + first..(direction + 1) * samples];
                let positions = &mut positions[..length];
                for (position, &sample) in positions.iter_mut().zip(&stencil.samples) {
                    *position = projected[sample as usize];
                }
                let bins = &self.bins[direction * all + stencil.bins..][..length];
                let sums = &mut sums[first * stride..];
                let mut squares = 0u64;
                sorter.sort(positions, |rank, number| {
                    let bin = bins[rank];
                    let offset = i64::from(bin.mean - positions[number] as i32);
                    let weight = i64::from(bin.weight) * stencil.weight;
                    let sum = &mut sums[stencil.samples[number] as usize * stride..][..stride];
                    sum[direction] += offset * weight;
                    sum[directions] += weight;
                    squares += (offset * offset) as u64;
                });
                energy[direction] += (squares / length as u64) >> 16;
            }
        }
        energy
    }

    /// Moves every sample by the weighted mean of its displacements, times the step size.
    fn apply(&mut self, projections: &[Projection], sums: &[Vec<i64>]) {
        let TileProblem { size, spp, dims, directions, .. } = self.problem;
        let lattice = self.stencils.lattice;
        let step = self.problem.step_size(self.iteration) / POSITIONS;
        let stride = directions + 1;
        let rows = self.coordinates.par_chunks_exact_mut(size * spp * dims).enumerate();
        rows.for_each(|(row, coordinates)| {
            let mut total = vec![0i64; size * spp * stride];
            let (frame, y) = (row / size, row % size);
            for frame in lattice.frames_of(frame) {
                for y in lattice.places_of(y) {
                    for sums in sums {
                        lattice.gather(
                            &sums[lattice.index(frame, y, 0) * stride..][..lattice.side() * spp * stride],
                            &mut total,
                            spp * stride,
                        );
                    }
                }
            }
            for (sample, total) in coordinates.chunks_exact_mut(dims).zip(total.chunks_exact(stride)) {
                if total[directions] == 0 {
                    continue;
                }
                let scale = step / total[directions] as f64;
                for (dim, coordinate) in sample.iter_mut().enumerate() {
                    let along = projections.iter().zip(total);
                    let offset: f64 =
                        along.map(|(p, &sum)| f64::from(p.direction[dim]) * (p.length * sum as f64)).sum();
                    let moved = f64::from(*coordinate) + scale * offset;
                    *coordinate = (moved as f32).clamp(0.0, BELOW_ONE);
                }
            }
        });
    }
}

impl Optimization for TileOptimizer {
    fn iterations(&self) -> u64 {
        self.problem.iterations
    }

    fn iteration(&self) -> u64 {
        self.iteration
    }

    fn step(&mut self) -> f64 {
        let mut rng = stream(self.problem.seed, self.iteration, STEP_STREAM);
        let projections: Vec<Projection> =
            directions::draw(&self.problem, &mut rng).into_iter().map(Projection::new).collect();
        self.cut(&projections);
        self.project(&projections);

        let lattice = self.stencils.lattice;
        let (all_rows, stride) = (lattice.frames * lattice.size, self.problem.directions + 1);
        let lock = || self.sums.lock().unwrap_or_else(PoisonError::into_inner);
        for sums in lock().iter_mut() {
            sums.fill(0);
        }
        let add = |mut a: Vec<u64>, b: Vec<u64>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        let none = || vec![0; self.problem.directions];
        let (tasks, next) = (all_rows.div_ceil(ROWS), AtomicUsize::new(0));
        let work = |_| {
            let taken = lock().pop();
            let mut sums = taken.unwrap_or_else(|| vec![0; lattice.samples() * stride]);
            let mine = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed)).take_while(|task| *task < tasks);
            let energy =
                mine.map(|task| self.slices(task * ROWS..all_rows.min((task + 1) * ROWS), &mut sums)).fold(none(), add);
            lock().push(sums);
            energy
        };
        let energy = (0..self.workers.min(tasks)).into_par_iter().map(work).reduce(none, add);
        let sums = std::mem::take(&mut *lock());
        self.apply(&projections, &sums);
        self.sums = Mutex::new(sums);
        self.iteration += 1;

        let squared = projections.iter().zip(&energy).map(|(p, &energy)| p.length * p.length * energy as f64);
        squared.sum::<f64>() / 4_294_967_296.0 / (all_rows * lattice.size) as f64
    }

    fn coordinates(&self) -> &[f32] {
        &self.coordinates
    }

    fn restore(&mut self, iteration: u64, coordinates: &[f32]) -> bool {
        let good = iteration <= self.problem.iterations
            && coordinates.len() == self.coordinates.len()
            && coordinates.iter().all(|value| (0.0..1.0).contains(value));
        if good {
            self.iteration = iteration;
            self.coordinates.copy_from_slice(coordinates);
        }
        good
    }
}

impl Lattice {
    /// The row of pixels (over all frames, without margins) that a row with margins repeats.
    fn row(&self, frame: usize, y: usize) -> usize {
        let frame = (frame + self.frames * self.past - self.past) % self.frames;
        frame * self.size + (y + self.size - self.margin) % self.size
    }

    /// The pixel that one with margins repeats.
    fn column(&self, x: usize) -> usize {
        (x + self.size - self.margin) % self.size
    }

    /// Where a row or column is found, its repetitions in the margins included.
    fn places_of(&self, place: usize) -> impl Iterator<Item = usize> + use<> {
        let (size, side, first) = (self.size, self.side(), (place + self.margin) % self.size);
        (0..).map(move |turn| first + turn * size).take_while(move |&place| place < side)
    }

    /// Where a frame is found.
    fn frames_of(&self, frame: usize) -> impl Iterator<Item = usize> + use<> {
        let (frames, all, first) = (self.frames, self.frames + self.past, (frame + self.past) % self.frames);
        (0..).map(move |turn| first + turn * frames).take_while(move |&frame| frame < all)
    }

    /// Adds a row with margins to one without; a pixel is `length` numbers.
    fn gather(&self, row: &[i64], total: &mut [i64], length: usize) {
        let mut x = 0;
        while x < self.side() {
            let column = self.column(x);
            let run = (self.size - column).min(self.side() - x);
            let from = &row[x * length..(x + run) * length];
            total[column * length..].iter_mut().zip(from).for_each(|(total, sum)| *total += sum);
            x += run;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_threads_than_there_are_make_the_same() {
        let of = |workers: Option<usize>| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(7).build().unwrap();
            let mut optimizer = pool.install(|| TileOptimizer::new(TileProblem::new(32, 2, 2)).unwrap());
            assert_eq!(optimizer.workers, 7);
            optimizer.workers = workers.unwrap_or(optimizer.workers);
            let energies: Vec<u64> = (0..4).map(|_| pool.install(|| optimizer.step().to_bits())).collect();
            let made = optimizer.sums.lock().unwrap().len();
            assert!(made <= optimizer.workers, "{made}");
            (energies, optimizer.coordinates)
        };
        let all = of(None);
        assert!([1, 2, 5, 64].iter().all(|workers| of(Some(*workers)) == all));
    }

    /// Whoever has more cores may not be refused what others make.
    #[test]
    fn threads_are_only_as_many_as_there_is_memory_for() {
        let of = |threads: usize, samples| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| workers(&TileProblem::new(64, 1, 2), samples))
        };
        assert_eq!([1, 3, 40].map(|threads| of(threads, 1 << 12).unwrap()), [1, 3, 40]);
        let [one, many] = [1, 40].map(|threads| of(threads, 1 << 30).unwrap_err().to_string());
        assert_eq!(one, many);
    }
}
