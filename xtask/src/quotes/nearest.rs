//! What may stand where a figure is wrong: measured numbers near it, first those whose row or column the line names.

use super::source::Measured;
use std::collections::HashSet;
use std::fmt::Write;

/// How many are told.
const COUNT: usize = 3;

/// `0.434 (dining, 4: direct), ...`; the number by itself where nothing says what it is. `line`: the document's, with the figure.
pub(super) fn of<'a>(value: f64, line: &str, all: impl Iterator<Item = &'a Measured>) -> String {
    let line = words(line);
    let distance = |measured: &Measured| {
        // As ratios: a figure that has changed is still of its size.
        let (a, b) = (measured.value.abs().max(f64::MIN_POSITIVE), value.max(f64::MIN_POSITIVE));
        (a / b).ln().abs()
    };
    let shared = |measured: &Measured| words(&measured.place).intersection(&line).count();
    let mut candidates: Vec<_> = all.map(|measured| (shared(measured), distance(measured), measured)).collect();
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
        // A cell has its number twice, as it is printed too.
        let value = significant(measured.value);
        if told.len() == COUNT || !told.insert((value.clone(), measured.place.to_string())) {
            continue;
        }
        let separator = if text.is_empty() { "" } else { "; " };
        let place = if measured.place.is_empty() { String::new() } else { format!(" ({})", measured.place) };
        let _ = write!(text, "{separator}{value}{place}");
    }
    text
}

/// Whether the line is a table's row and the number stands in a row of the same name, as far as the first word tells.
pub(super) fn is_in_row(measured: &Measured, line: &str) -> bool {
    let Some(row) = line.strip_prefix('|') else { return false };
    let Some(name) = row.split(|c: char| !c.is_alphanumeric()).find(|word| !word.is_empty()) else { return false };
    // Of a number it cannot be told what it counts.
    let (label, _) = measured.place.split_once(':').unwrap_or_default();
    name.starts_with(char::is_alphabetic) && words(label).contains(&name.to_lowercase())
}

/// Four digits, so that one may round to fewer.
fn significant(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    rounded.to_string()
}

fn words(text: &str) -> HashSet<String> {
    text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

#[test]
fn the_row_that_the_line_names_is_told() {
    let measured = |value, place: &str| Measured { value, place: place.into() };
    let all =
        [measured(0.44, "bathroom: direct"), measured(0.434_44, "dining: direct"), measured(9.0, "dining: indirect")];
    assert_eq!(of(0.45, "| dining | .45 |", all.iter()), "0.44 (bathroom: direct); 0.4344 (dining: direct)");
    assert_eq!(of(0.45, "", [measured(1.0, "")].iter()), "1");
    assert_eq!(all.map(|measured| is_in_row(&measured, "| Dining (2) | .44 |")), [false, true, true]);
    assert_eq!(of(0.45, "", [].iter()), "");
}
