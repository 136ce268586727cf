//! Distances to the nearest neighbour.

use crate::points::Points;
use kiddo::SquaredEuclidean;
use kiddo::immutable::float::kdtree::ImmutableKdTree;
use rayon::prelude::*;
use serde::Serialize;
use std::num::NonZeroUsize;

/// Distances to the nearest other point, divided by the largest possible smallest distance of a toroidal set of as many
/// points (the densest lattice: hexagonal in two dimensions). Random points in two dimensions: mean .465.
#[derive(Clone, Debug, Serialize)]
pub struct Neighbours {
    /// Mean, distances within the unit cube.
    pub mean: f64,
    /// Smallest, distances within the unit cube.
    pub min: f64,
    /// Mean, distances on the torus.
    pub mean_toroidal: f64,
    /// Smallest, distances on the torus.
    pub min_toroidal: f64,
}

/// The nearest-neighbour distance of the densest lattice with `points` points per unit volume in 1 to 8 dimensions.
///
/// Conway and Sloane, "Sphere Packings, Lattices and Groups", table 1.2: Z, A2, A3, D4, D5, E6, E7, E8.
pub fn lattice_distance(points: usize, dims: usize) -> f64 {
    let centre_density = match dims {
        1 => 0.5,
        2 => 1.0 / 12.0_f64.sqrt(),
        3 => 1.0 / 32.0_f64.sqrt(),
        4 => 0.125,
        5 => 1.0 / 128.0_f64.sqrt(),
        6 => 1.0 / 192.0_f64.sqrt(),
        _ => 1.0 / 16.0,
    };
    2.0 * libm::pow(centre_density / points as f64, 1.0 / dims as f64)
}

/// Nearest-neighbour statistics; none for fewer than two points, or of what [`check`](super::check) refuses.
pub fn neighbours(points: &Points) -> Option<Neighbours> {
    if points.len() < 2 || super::check(points).is_err() {
        return None;
    }
    let [bounded, toroidal] = match points.dims() {
        1 => distances::<1>(points),
        2 => distances::<2>(points),
        3 => distances::<3>(points),
        4 => distances::<4>(points),
        5 => distances::<5>(points),
        6 => distances::<6>(points),
        7 => distances::<7>(points),
        _ => distances::<8>(points),
    };
    let unit = lattice_distance(points.len(), points.dims());
    let mean = |d: &[f64]| d.iter().sum::<f64>() / d.len() as f64 / unit;
    let min = |d: &[f64]| d.iter().fold(f64::INFINITY, |m, &x| m.min(x)) / unit;
    Some(Neighbours {
        mean: mean(&bounded),
        min: min(&bounded),
        mean_toroidal: mean(&toroidal),
        min_toroidal: min(&toroidal),
    })
}

/// The distance from every point to its nearest neighbour, bounded and toroidal.
fn distances<const D: usize>(points: &Points) -> [Vec<f64>; 2] {
    // On the torus 1 is 0; within the cube it is not.
    let place = |p: &[f32]| std::array::from_fn::<f64, D, _>(|i| f64::from(p[i]));
    let wrap = |p: [f64; D]| p.map(|x| if x >= 1.0 { x - 1.0 } else { x });
    let bounded: Vec<[f64; D]> = points.iter().map(place).collect();
    let wrapped: Vec<[f64; D]> = bounded.iter().map(|&p| wrap(p)).collect();
    let two = NonZeroUsize::MIN.saturating_add(1);
    let search = |set: &[[f64; D]], toroidal: bool| -> Vec<f64> {
        let tree = ImmutableKdTree::<f64, u32, D, 32>::new_from_slice(set);
        let nearest = |point: &[f64; D], own: u32, best: f64| {
            let found = tree.nearest_n::<SquaredEuclidean>(point, two);
            found.iter().filter(|n| n.item != own).fold(best, |best, n| best.min(n.distance))
        };
        each(set.len(), &|index| {
            let (point, own) = (&set[index], index as u32);
            let mut best = nearest(point, own, f64::INFINITY);
            if toroidal {
                images(
                    point,
                    &mut |image, beyond, best| if beyond < best { nearest(image, own, best) } else { best },
                    &mut best,
                );
            }
            best.sqrt()
        })
    };
    [search(&bounded, false), search(&wrapped, true)]
}

/// What `one` says of so many points. Compiled once, not for each number of dimensions.
fn each(points: usize, one: &(dyn Fn(usize) -> f64 + Sync)) -> Vec<f64> {
    (0..points).into_par_iter().with_min_len(256).map(one).collect()
}

/// Visits the copies of a point in the neighbouring cells of the torus that are nearer to the unit cube than the best
/// squared distance so far: `visit(copy, squared distance to the cube, best)` returns the new best.
fn images<const D: usize>(point: &[f64; D], visit: &mut impl FnMut(&[f64; D], f64, f64) -> f64, best: &mut f64) {
    fn axis<const D: usize>(
        image: &mut [f64; D],
        axis_index: usize,
        beyond: f64,
        moved: bool,
        visit: &mut impl FnMut(&[f64; D], f64, f64) -> f64,
        best: &mut f64,
    ) {
        if axis_index == D {
            if moved {
                *best = visit(image, beyond, *best);
            }
            return;
        }
        let x = image[axis_index];
        axis(image, axis_index + 1, beyond, moved, visit, best);
        for (shifted, gap) in [(x + 1.0, x), (x - 1.0, 1.0 - x)] {
            let beyond = beyond + gap * gap;
            if beyond < *best {
                image[axis_index] = shifted;
                axis(image, axis_index + 1, beyond, true, visit, best);
                image[axis_index] = x;
            }
        }
    }
    axis(&mut { *point }, 0, 0.0, false, visit, best);
}
