//! Cutting the domain into windows that hold their share of the points.

use super::group::Group;
use super::problem::Domain;
use crate::points::Points;
use crate::random::shuffle;
use noisefloor::rng::Rng;
use rayon::prelude::*;

/// A window, or a slab on the way to windows.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) start: Vec<f32>,
    pub(super) lengths: Vec<f32>,
    /// The numbers of its points, by group; in the order in which they were cut.
    pub(super) members: Vec<Vec<u32>>,
}

/// Cuts `points` at random places, each axis into `per_axis` pieces.
///
/// A cut is between two ranks, and at the place where as much of the domain is below it as of the points: so a window's
/// part of the points is its part of the domain, though some points may be outside by a little. If cuts were between
/// coordinates, a window would have some points too many or too few, push them evenly between its walls, and so turn
/// chance at its walls into errors of its own size, which no window sees.
pub(super) fn cut(points: &Points, groups: &[Group], per_axis: usize, domain: Domain, rng: &mut Rng) -> Vec<Piece> {
    let members = groups.iter().map(|group| group.members.clone()).collect();
    let mut pieces = vec![Piece { start: vec![0.0; points.dims()], lengths: vec![1.0; points.dims()], members }];
    // Which axis comes first must not show.
    let mut axes: Vec<usize> = (0..points.dims()).collect();
    shuffle(&mut axes, rng);
    for axis in axes {
        let first = rng.uniform_f64() + 0.5;
        let place = |k: usize| match domain {
            Domain::Bounded => (k as f64 + first) / per_axis as f64,
            Domain::Toroidal => (k as f64 + 1.0) / per_axis as f64,
        };
        let places: Vec<f64> = (0..per_axis - 1).map(place).collect();
        pieces = pieces.into_par_iter().flat_map_iter(|piece| slabs(piece, axis, points, groups, &places)).collect();
    }
    pieces
}

/// The parts of a piece between cuts across an axis, which has not been cut before.
fn slabs(mut piece: Piece, axis: usize, points: &Points, groups: &[Group], places: &[f64]) -> Vec<Piece> {
    let at = |number: u32| points.point(number as usize)[axis];
    for members in &mut piece.members {
        // Coordinates are not negative: in the order of their bits. Equal ones by number.
        let mut keys: Vec<u64> = members.iter().map(|&i| u64::from(at(i).to_bits()) << 32 | u64::from(i)).collect();
        keys.par_sort_unstable();
        members.iter_mut().zip(keys).for_each(|(member, key)| *member = key as u32);
    }
    let ranked =
        || piece.members.iter().zip(groups).filter(|(_, group)| group.ranked).map(|(members, _)| members.len());
    let total: usize = ranked().sum();
    let rank = |place: f64, of: usize| libm::round(place * of as f64) as usize;
    let mut slabs = Vec::with_capacity(places.len() + 1);
    let mut begins = vec![0; groups.len()];
    let mut low = 0.0;
    for place in places.iter().copied().map(Some).chain([None]) {
        let high = match place {
            None => 1.0,
            Some(place) if total == 0 => place as f32,
            Some(place) => (ranked().map(|of| rank(place, of)).sum::<usize>() as f64 / total as f64) as f32,
        };
        let (start, lengths) = (piece.start.clone(), piece.lengths.clone());
        let mut slab = Piece { members: Vec::with_capacity(groups.len()), start, lengths };
        (slab.start[axis], slab.lengths[axis]) = (low, high - low);
        for ((members, group), begin) in piece.members.iter().zip(groups).zip(&mut begins) {
            let end = match place {
                None => members.len(),
                Some(place) if group.ranked => rank(place, members.len()),
                Some(_) => members.partition_point(|&i| at(i) < high),
            };
            slab.members.push(members[*begin..end].to_vec());
            *begin = end;
        }
        slabs.push(slab);
        low = high;
    }
    slabs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn windows_have_their_share(
            points in 200usize..2000,
            per_axis in 2usize..6,
            torus in any::<bool>(),
            seed in any::<u64>(),
        ) {
            let domain = if torus { Domain::Toroidal } else { Domain::Bounded };
            let rng = &mut stream(seed, 0, 0);
            let places = Points::new(2, (0..2 * points).map(|_| rng.uniform_f32()).collect());
            let split = points as u32 / 3;
            let of = |range: std::ops::Range<u32>, ranked| Group { members: range.collect(), ranked };
            let (all, last) = (points as u32, points as u32 - 9);
            let groups = [of(0..split, true), of(split..last, true), of(last..all, false)];
            let windows = cut(&places, &groups, per_axis, domain, rng);
            prop_assert_eq!(windows.len(), per_axis * per_axis);
            let mut area = 0.0;
            let mut all = Vec::new();
            for window in &windows {
                let mine = window.lengths[0] * window.lengths[1];
                let ranked = window.members[0].len() + window.members[1].len();
                prop_assert!((mine - ranked as f32 / (points - 9) as f32).abs() < 1e-5, "{mine} for {ranked}");
                // Each group's too, but for rounding: half a point across each axis.
                let first = mine * split as f32;
                let count = window.members[0].len();
                prop_assert!((first - count as f32).abs() < 4.0, "{first} {count}");
                // The others are where they are.
                for &i in &window.members[2] {
                    let place = places.point(i as usize).iter().zip(&window.start).zip(&window.lengths);
                    for ((at, start), length) in place {
                        prop_assert!((-1e-6..=*length + 1e-6).contains(&(at - start)));
                    }
                }
                area += mine;
                all.extend(window.members.concat());
            }
            prop_assert!((area - 1.0).abs() < 1e-4);
            all.sort_unstable();
            prop_assert!(all.into_iter().eq(0..points as u32));
        }
    }
}
