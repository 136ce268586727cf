//! Which points windows share out together.

use crate::class::Filter;

/// Members per window of a group that windows share out by rank: of fewer, a point could be far from the window that
/// its rank gives it.
const PER_WINDOW: usize = 32;

/// Points that are cut together.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Group {
    /// Their numbers in the set, ascending.
    pub(super) members: Vec<u32>,
    /// Whether cuts give every window its share of them, by rank. Otherwise points are where their coordinates say.
    pub(super) ranked: bool,
}

/// Groups of all points: those that no class tells apart are one, if large enough, which at most about a hundred are;
/// small ones are together, as in a ramp, where every point has values of its own. Points of no class are never moved,
/// and apart from the others.
pub(super) fn groups(filters: &[Filter], points: usize, windows: usize) -> Vec<Group> {
    let least = PER_WINDOW * windows;
    // Two points next to each other by number are told apart where a run of some class begins or ends.
    let mut begins: Vec<u32> = filters.iter().flat_map(Filter::ends).chain([0, points as u32]).collect();
    begins.sort_unstable();
    begins.dedup();
    let values: Vec<u32> = begins.iter().flat_map(|&at| filters.iter().map(move |f| f.value(at).to_bits())).collect();
    let of = |run: usize| &values[run * filters.len()..(run + 1) * filters.len()];
    let mut runs: Vec<usize> = (0..begins.len() - 1).collect();
    runs.sort_unstable_by_key(|&run| (of(run), run));
    let mut groups = Vec::new();
    let (mut small, mut free) = (Vec::new(), Vec::new());
    for kind in runs.chunk_by(|&a, &b| of(a) == of(b)) {
        let members: Vec<u32> = kind.iter().flat_map(|&run| begins[run]..begins[run + 1]).collect();
        if of(kind[0]).iter().all(|&bits| bits == 0) {
            free = members;
        } else if members.len() < least {
            small.extend(members);
        } else {
            groups.push(Group { members, ranked: true });
        }
    }
    // By their first points, not by their values.
    groups.sort_unstable_by_key(|group| group.members[0]);
    small.sort_unstable();
    let ranked = small.len() >= least;
    groups.push(Group { members: small, ranked });
    groups.push(Group { members: free, ranked: false });
    groups.retain(|group| !group.members.is_empty());
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::class::{Class, ClassCoordinates, ClassFunction, progressive, ramp, three_colors};

    fn of(classes: &[Class], points: usize) -> Vec<(usize, bool)> {
        let filter = |class: &Class| Filter::new(&class.function, &ClassCoordinates::Index, points);
        let filters: Vec<Filter> = classes.iter().map(filter).collect();
        let groups = groups(&filters, points, 16);
        let mut all: Vec<u32> = groups.iter().flat_map(|group| group.members.clone()).collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..points as u32), "every point is in one group");
        groups.iter().map(|group| (group.members.len(), group.ranked)).collect()
    }

    #[test]
    fn points_that_no_class_tells_apart() {
        assert_eq!(of(&three_colors(2), 9000), [(3000, true); 3]);
        assert_eq!(of(&ramp(2), 9000), [(9000, true)]);
        // Prefixes of 11, 128, 1448 and 16384.
        assert_eq!(of(&progressive(2, 4, 16_384), 16_384), [(1320, true), (14_936, true), (128, false)]);
        let mut some = progressive(2, 1, 9000);
        some[0].function = ClassFunction::Box { from: 0.5, to: 1.0 };
        assert_eq!(of(&some, 9000), [(4500, true), (4500, false)]);
    }

    #[test]
    fn a_large_kind_behind_many_small_ones_keeps_its_own() {
        // 100 colors of 10 points, then two of 4,000.
        let ends: Vec<f32> = (0..=100u16).map(|k| f32::from(k) / 900.0).chain([5.0 / 9.0, 1.0]).collect();
        let color = |pair: &[f32]| Class {
            function: ClassFunction::Box { from: pair[0], to: pair[1] },
            ..three_colors(2).swap_remove(0)
        };
        let colors: Vec<Class> = ends.windows(2).map(color).collect();
        assert_eq!(of(&colors, 9000), [(4000, true), (4000, true), (1000, true)]);
    }
}
