//! What may stand where a figure is wrong: measured numbers near it, first those whose row or column the line names.

use super::source::{Measured, Place, words};
use std::collections::HashSet;
use std::fmt::Write;

/// How many are told.
const COUNT: usize = 4;

/// `0.434 (dining, 4 | direct); ...`: the value, its row and its column. `line`: the document's, with the figure.
pub(super) fn of<'a>(value: f64, line: &str, all: impl Iterator<Item = &'a Measured>) -> String {
    let line = words(line);
    let distance = |measured: &Measured| {
        // As ratios: a figure that has changed is still of its size. One of another sign is far.
        let size = |value: f64| value.abs().max(f64::MIN_POSITIVE).ln();
        let sign = if measured.value * value < 0.0 { 1.0 } else { 0.0 };
        (size(measured.value) - size(value)).abs() + sign
    };
    let shared = |Place { row, column }: &Place| {
        let mut own = words(row);
        own.extend(words(column));
        own.intersection(&line).count()
    };
    let mut candidates: Vec<_> = all.map(|measured| (shared(&measured.place), distance(measured), measured)).collect();
    let by_distance = |a: &(usize, f64, &Measured), b: &(usize, f64, &Measured)| a.1.total_cmp(&b.1);
    candidates.sort_by(by_distance);
    // The nearest of all, then those with the most words of the line, where they are not of another size altogether.
    let mut chosen: Vec<_> = candidates.first().copied().into_iter().collect();
    candidates.retain(|&(shared, distance, _)| shared > 0 && distance < f64::ln(3.0));
    candidates.sort_by(|a, b| b.0.cmp(&a.0).then(by_distance(a, b)));
    chosen.extend(candidates);
    let mut told = HashSet::new();
    let mut text = String::new();
    for (_, _, measured) in chosen {
        let value = significant(measured.value);
        if told.len() == COUNT || !told.insert((value.clone(), &measured.place)) {
            continue;
        }
        let separator = if text.is_empty() { "" } else { "; " };
        let Place { row, column } = &*measured.place;
        let place = [row, column].into_iter().filter(|name| !name.is_empty()).cloned().collect::<Vec<_>>().join(" | ");
        let _ = write!(text, "{separator}{value} ({place})");
    }
    text
}

/// Four digits, so that one may round to fewer.
fn significant(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    rounded.to_string()
}

#[test]
fn the_row_that_the_line_names_is_told() {
    let measured = |value, row: &str, column: &str| {
        let place = Place { row: row.to_owned(), column: column.to_owned() };
        Measured { value, other: value, kind: super::source::Kind::Value, place: place.into() }
    };
    let all = [
        measured(0.44, "bathroom", "direct"),
        measured(0.434_44, "dining", "direct"),
        measured(9.0, "dining", "indirect"),
    ];
    assert_eq!(of(0.45, "| dining | .45 |", all.iter()), "0.44 (bathroom | direct); 0.4344 (dining | direct)");
    assert_eq!(of(0.45, "", [].iter()), "");
}
