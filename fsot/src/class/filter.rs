//! Point-set filtering (5.3.1): which points make a subclass.

use super::{ClassCoordinates, ClassFunction};
use std::ops::Range;

/// A class function at all points of a set: neighbours of equal value are one run, so a box costs one entry and a ramp one per point.
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    runs: Vec<(Range<u32>, f32)>,
    highest: f32,
    members: usize,
}

impl Filter {
    pub(crate) fn new(function: &ClassFunction, coordinates: &ClassCoordinates, points: usize) -> Filter {
        let mut runs: Vec<(Range<u32>, f32)> = Vec::new();
        let (mut highest, mut members) = (0.0f32, 0);
        for i in 0..points {
            let value = coordinates.value(function, i, points);
            if !(value > 0.0) {
                continue;
            }
            highest = highest.max(value);
            members += 1;
            match runs.last_mut() {
                Some((run, last)) if *last == value && run.end == i as u32 => run.end += 1,
                _ => runs.push((i as u32..i as u32 + 1, value)),
            }
        }
        Filter { runs, highest, members }
    }

    /// The largest value at a point: thresholds at or above it select nothing. 0 if the class is empty.
    pub(crate) fn highest(&self) -> f32 {
        self.highest
    }

    /// The points of threshold 0.
    pub(crate) fn members(&self) -> usize {
        self.members
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
