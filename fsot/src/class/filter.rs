//! Point-set filtering (section 5.3.1): which points make a subclass.

use super::function::ClassFunction;
use super::weighted::ClassCoordinates;
use std::ops::Range;

/// Neighbours of equal value above 0.
type Run = (Range<u32>, f32);

/// The memory of a run.
pub(crate) const RUN: usize = size_of::<Run>();

/// The runs of a class function, ascending.
fn runs(function: &ClassFunction, coordinates: &ClassCoordinates, points: usize) -> impl Iterator<Item = Run> {
    let value = move |i: usize| (i as u32, coordinates.value(function, i, points));
    let mut values = (0..points).map(value).peekable();
    std::iter::from_fn(move || {
        let (start, value) = values.find(|(_, value)| *value > 0.0)?;
        let mut end = start + 1;
        while values.next_if(|(_, next)| *next == value).is_some() {
            end += 1;
        }
        Some((start..end, value))
    })
}

/// A class function at all points of a set: neighbours of equal value are one run, so a box costs one entry and a ramp
/// one per point.
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    runs: Vec<Run>,
    highest: f32,
    members: usize,
}

impl Filter {
    pub(crate) fn new(function: &ClassFunction, coordinates: &ClassCoordinates, points: usize) -> Filter {
        let mut runs: Vec<Run> = runs(function, coordinates, points).collect();
        runs.shrink_to_fit();
        let highest = runs.iter().map(|(_, value)| *value).fold(0.0, f32::max);
        let members = runs.iter().map(|(run, _)| run.len()).sum();
        Filter { runs, highest, members }
    }

    /// How many runs the filter of a class function has, each of [`RUN`] bytes.
    pub(crate) fn count(function: &ClassFunction, coordinates: &ClassCoordinates, points: usize) -> usize {
        runs(function, coordinates, points).count()
    }

    /// The largest value at a point: thresholds at or above it select nothing. 0 if the class is empty.
    pub(crate) fn highest(&self) -> f32 {
        self.highest
    }

    /// The points of threshold 0.
    pub(crate) fn members(&self) -> usize {
        self.members
    }

    /// Where runs of equal values begin and end: the points next to each other that it tells apart are there.
    pub(crate) fn ends(&self) -> impl Iterator<Item = u32> {
        self.runs.iter().flat_map(|(run, _)| [run.start, run.end])
    }

    /// The value at a point, 0 if it is none of the class's.
    pub(crate) fn value(&self, number: u32) -> f32 {
        let run = self.runs.partition_point(|(run, _)| run.end <= number);
        self.runs.get(run).filter(|(run, _)| run.contains(&number)).map_or(0.0, |(_, value)| *value)
    }

    /// How many different values it has above 0, but at most `most`.
    pub(crate) fn values(&self, most: usize) -> usize {
        let mut values: Vec<f32> = Vec::new();
        for (_, value) in &self.runs {
            if values.len() < most && !values.contains(value) {
                values.push(*value);
            }
        }
        values.len()
    }

    /// The points with `w > z`, as ranges in ascending order that do not touch; returns their number.
    pub(crate) fn select(&self, z: f32, selected: &mut Vec<Range<u32>>) -> usize {
        selected.clear();
        let mut count = 0;
        for (run, _) in self.runs.iter().filter(|(_, value)| *value > z) {
            count += run.len();
            match selected.last_mut() {
                Some(last) if last.end == run.start => last.end = run.end,
                _ => selected.push(run.clone()),
            }
        }
        count
    }

    /// As [`select`](Filter::select), among the points with the given ascending numbers: ranges of places in `numbers`.
    pub(crate) fn select_of(&self, z: f32, numbers: &[u32], selected: &mut Vec<Range<u32>>) -> usize {
        selected.clear();
        let mut count = 0;
        let mut add = |places: Range<usize>| {
            let places = places.start as u32..places.end as u32;
            count += places.len();
            match selected.last_mut() {
                Some(last) if last.end == places.start => last.end = places.end,
                _ if places.is_empty() => {}
                _ => selected.push(places),
            }
        };
        if self.runs.len() <= numbers.len() {
            // Few runs: find the places of each.
            let mut before = 0;
            for (run, value) in &self.runs {
                let begin = before + numbers[before..].partition_point(|&number| number < run.start);
                before = begin + numbers[begin..].partition_point(|&number| number < run.end);
                if *value > z {
                    add(begin..before);
                }
            }
        } else {
            for (place, &number) in numbers.iter().enumerate() {
                let run = self.runs.partition_point(|(run, _)| run.end <= number);
                if self.runs.get(run).is_some_and(|(run, value)| run.contains(&number) && *value > z) {
                    add(place..place + 1);
                }
            }
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::class::Step;
    use proptest::prelude::*;

    fn functions() -> impl Strategy<Value = ClassFunction> {
        let unit = 0.0f32..=1.0;
        prop_oneof![
            Just(ClassFunction::Constant),
            any::<bool>().prop_map(|rising| ClassFunction::Ramp { rising }),
            (0.0f32..0.9, 0.0f32..0.1).prop_map(|(from, length)| ClassFunction::Box { from, to: from + length }),
            (unit.clone(), 0.01f32..2.0)
                .prop_map(|(center, sigma)| ClassFunction::Gaussian { center: vec![center], sigma }),
            prop::collection::vec(unit.clone(), 1..9).prop_map(ClassFunction::Tabulated),
            prop::collection::vec(unit, 1..9).prop_map(|values| {
                let count = values.len() as f32;
                let step = |(i, value)| Step { to: (i + 1.0) / count, value };
                ClassFunction::Staircase(
                    (0..).zip(values).map(|(i, value): (u16, f32)| step((f32::from(i), value))).collect(),
                )
            }),
        ]
    }

    fn places(selected: &[Range<u32>]) -> Vec<u32> {
        selected.iter().cloned().flatten().collect()
    }

    proptest! {
        #[test]
        fn a_subclass_has_the_points_above_its_threshold(
            function in functions(),
            points in 1usize..200,
            z in 0.0f32..1.0,
        ) {
            let coordinates = ClassCoordinates::Index;
            let filter = Filter::new(&function, &coordinates, points);
            let above = |z: f32| -> Vec<u32> {
                (0..points as u32).filter(|&i| coordinates.value(&function, i as usize, points) > z).collect()
            };
            let mut selected = Vec::new();
            let count = filter.select(z, &mut selected);
            prop_assert_eq!(count, places(&selected).len());
            prop_assert_eq!(places(&selected), above(z));
            prop_assert!(selected.windows(2).all(|pair| pair[0].end < pair[1].start));
            prop_assert_eq!(filter.members(), above(0.0).len());
            prop_assert_eq!(Filter::count(&function, &coordinates, points), filter.runs.len());
            prop_assert!(filter.runs.windows(2).all(|pair| pair[0].0.end < pair[1].0.start || pair[0].1 != pair[1].1));
            // Larger thresholds select subsets, and none is left at the highest value.
            let mut fewer = Vec::new();
            filter.select((z + 0.1).min(filter.highest()), &mut fewer);
            let larger = places(&selected);
            if z <= filter.highest() {
                prop_assert!(places(&fewer).iter().all(|i| larger.contains(i)));
            }
            prop_assert_eq!(filter.select(filter.highest(), &mut fewer), 0);
        }

        #[test]
        fn a_subclass_of_some_points(
            function in functions(),
            points in 1usize..200,
            z in 0.0f32..1.0,
            some in prop::collection::btree_set(0u32..200, 0..60),
        ) {
            let filter = Filter::new(&function, &ClassCoordinates::Index, points);
            let numbers: Vec<u32> = some.into_iter().filter(|&i| (i as usize) < points).collect();
            let (mut all, mut selected) = (Vec::new(), Vec::new());
            filter.select(z, &mut all);
            let count = filter.select_of(z, &numbers, &mut selected);
            let all = places(&all);
            let within = |k: &u32| all.contains(&numbers[*k as usize]);
            let expected: Vec<u32> = (0..numbers.len() as u32).filter(within).collect();
            prop_assert_eq!(count, expected.len());
            prop_assert_eq!(places(&selected), expected);
            prop_assert!(selected.windows(2).all(|pair| pair[0].end < pair[1].start));
        }

        #[test]
        fn values_stay_in_the_unit_interval(function in functions(), c in 0.0f32..1.0, y in 0.0f32..1.0) {
            prop_assert!(function.check("it").is_ok());
            prop_assert!((0.0..=1.0).contains(&function.value(&[c])));
            prop_assert!((0.0..=1.0).contains(&function.value(&[c, y])));
        }
    }
}
