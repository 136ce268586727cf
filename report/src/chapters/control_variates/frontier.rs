//! Error against time: every setting of a family of integrands, and which of them no other beats in both.

use super::cells::{Cells, MEAN, Setting, Summary};
use crate::chapters::prelude::*;
use itertools::Itertools;

/// A family: name of the file, title, dims.
const FAMILIES: [(&str, &str, [usize; 2]); 4] = [
    ("control_variates_1d", "1 dim", [1, 1]),
    ("control_variates_2d", "2 dims", [2, 2]),
    ("control_variates_5d", "3 to 5 dims", [3, 5]),
    ("control_variates_15d", "15 dims", [15, 15]),
];
/// A setting is safe if no integrand's error is larger: the targets' 1.03, and an allowance.
const SAFE: f64 = 1.05;
/// On the frontier each point has so much less error than every faster one: less is noise.
const STEP: f64 = 0.02;
/// Nanoseconds.
const MICROSECOND: f64 = 1000.0;

pub(super) fn write(chapter: &mut Chapter, cells: &Cells) {
    chapter.section("Error against time");
    chapter.setting("worst ratio of a safe setting", SAFE);
    chapter.setting("step of the frontier, percent", 100.0 * STEP);
    for (file, title, [low, high]) in FAMILIES {
        let inside = |dims: usize| (low..=high).contains(&dims);
        let integrands = cells.all.iter().filter(|cell| inside(cell.dims)).map(|cell| &cell.integrand);
        chapter.section(&format!("Error against time, {title}"));
        chapter.setting(&format!("integrands, {title}"), integrands.sorted().dedup().join(", "));
        let rows =
            cells.counts.iter().flat_map(|&n| listed(n, &cells.summaries(inside, n), &cells.recommended(high, n)));
        let columns = "samples | setting | error | worst | where | ns per sample | efficiency, free samples | \
                       efficiency, 1 us samples | safe | what it is";
        chapter.table(file, columns, 2, rows.collect::<Vec<_>>());
    }
}

/// The frontier, what is recommended, and the best safe setting, by time.
fn listed(n: usize, all: &[Summary], recommended: &Setting) -> Vec<Value> {
    let frontier = frontier(all);
    let is_safe = |one: &&Summary| one.is_within(SAFE) == Some(true) && one.setting.estimator != MEAN;
    let best = all.iter().filter(is_safe).max_by(|a, b| a.gain(MICROSECOND).total_cmp(&b.gain(MICROSECOND)));
    let row = |one: &Summary| {
        let roles = [
            ("frontier", frontier.contains(&one.setting)),
            ("recommended", one.setting == recommended),
            ("best safe one", best.is_some_and(|best| best.setting == one.setting)),
        ];
        let roles = roles.into_iter().filter(|(_, has)| *has).map(|(role, _)| role).join(", ");
        let (worst, ratio) = (one.worst(), |value: f64| Figure::exact(value, Unit::Ratio));
        let row = json!([
            n.to_string(),
            one.setting.name(),
            Figure::new(one.ratio(), Unit::Ratio),
            Figure::new(worst.ratio, Unit::Ratio),
            worst.integrand,
            Figure::exact(one.ns(), Unit::Nanoseconds),
            ratio(one.gain(0.0)),
            ratio(one.gain(MICROSECOND)),
            one.is_within(SAFE).map_or("not decided", |is_safe| if is_safe { "yes" } else { "no" }),
            roles,
        ]);
        (!roles.is_empty()).then_some(row)
    };
    by_time(all).filter_map(row).collect()
}

fn by_time<'a>(all: &'a [Summary]) -> impl Iterator<Item = &'a Summary<'a>> {
    all.iter().sorted_by(|a, b| a.ns().total_cmp(&b.ns()))
}

/// Settings with less error than every faster one.
fn frontier<'a>(all: &'a [Summary]) -> Vec<&'a Setting> {
    let mut best = f64::INFINITY;
    let is_better = |one: &&Summary| {
        let error = one.ratio().value;
        let is_better = error < best * (1.0 - STEP);
        best = if is_better { error } else { best };
        is_better
    };
    by_time(all).filter(is_better).map(|one| one.setting).collect()
}

#[cfg(test)]
mod tests {
    use super::super::cells::Cell;
    use super::*;

    #[test]
    fn the_frontier_has_what_nothing_beats_in_both() {
        let cell = |(order, ratio, ns)| Cell {
            integrand: String::new(),
            dims: 2,
            n: 16,
            setting: Setting { estimator: "robust".to_owned(), basis: "legendre".to_owned(), order },
            ratio: Estimate::exact(ratio),
            ns,
            mean_ns: 5.0,
        };
        let cells = [(1, 0.5, 20.0), (2, 0.3, 40.0), (3, 0.4, 50.0), (5, 0.6, 10.0)].map(cell);
        let all = cells.each_ref().map(|cell| Summary { setting: &cell.setting, cells: vec![cell] });
        let orders: Vec<usize> = frontier(&all).iter().map(|setting| setting.order).collect();
        assert_eq!(orders, [5, 1, 2]);
    }
}
