//! Error against time: every setting of a family of integrands, and which of them no other beats in both.

use super::cells::{Cells, MEAN, Setting, Summary};
use crate::chapters::prelude::*;

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

pub(super) fn write(chapter: &mut Chapter, cells: &Cells) {
    chapter.section("Error against time");
    chapter.setting("worst ratio of a safe setting", SAFE);
    chapter.setting("step of the frontier, percent", 100.0 * STEP);
    for (file, title, [low, high]) in FAMILIES {
        let inside = |dims: usize| (low..=high).contains(&dims);
        let mut names: Vec<&str> =
            cells.all.iter().filter(|cell| inside(cell.dims)).map(|cell| cell.integrand.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        chapter.section(&format!("Error against time, {title}"));
        chapter.setting(format!("integrands, {title}"), names.join(", "));
        let rows =
            cells.counts.iter().flat_map(|&n| listed(n, &cells.summaries(inside, n), &cells.recommended(high, n)));
        let columns = "samples | setting | error | worst | where | ns per sample | efficiency, free samples | \
                       efficiency, 1 us samples | safe | what it is";
        chapter.table(file, columns, 2, rows.collect());
    }
}

/// The frontier, what is recommended, and the best safe setting, by time.
fn listed(n: usize, all: &[Summary], recommended: &Setting) -> Vec<Vec<Cell>> {
    let frontier = frontier(all);
    let is_safe = |summary: &&Summary| is_safe(summary) == Some(true) && summary.setting.estimator != MEAN;
    let best = all.iter().filter(is_safe).max_by(|a, b| a.gains[1].total_cmp(&b.gains[1]));
    let advised = all.iter().find(|summary| summary.setting == *recommended);
    let is = |one: &Summary, other: Option<&Summary>| other.is_some_and(|other| other.setting == one.setting);
    let on = |one: &Summary| frontier.iter().any(|other| is(one, Some(other)));
    let mut listed: Vec<&Summary> = all.iter().filter(|one| on(one) || is(one, advised) || is(one, best)).collect();
    listed.sort_by(|a, b| a.ns.total_cmp(&b.ns));
    let row = |summary: &Summary| {
        let roles =
            [(on(summary), "frontier"), (is(summary, advised), "recommended"), (is(summary, best), "best safe one")];
        let roles: Vec<&str> = roles.into_iter().filter(|(is, _)| *is).map(|(_, role)| role).collect();
        let [free, dear] = summary.gains.map(|gain| Figure::exact(gain, Unit::Ratio));
        row![
            n as u32,
            summary.setting.name(),
            Figure::new(summary.ratio, Unit::Ratio),
            Figure::new(summary.worst, Unit::Ratio),
            summary.place.clone(),
            Figure::exact(summary.ns, Unit::Nanoseconds),
            free,
            dear,
            self::is_safe(summary).map_or("not decided", |is_safe| if is_safe { "yes" } else { "no" }),
            roles.join(", "),
        ]
    };
    listed.into_iter().map(row).collect()
}

/// None: the intervals do not decide.
fn is_safe(summary: &Summary) -> Option<bool> {
    let [low, high] = summary.ends;
    if high <= SAFE { Some(true) } else { (low > SAFE).then_some(false) }
}

/// Settings with less error than every faster one.
fn frontier(all: &[Summary]) -> Vec<&Summary> {
    let mut sorted: Vec<&Summary> = all.iter().collect();
    sorted.sort_by(|a, b| a.ns.total_cmp(&b.ns));
    let mut best = f64::INFINITY;
    sorted.retain(|summary| {
        let better = summary.ratio.value < best * (1.0 - STEP);
        if better {
            best = summary.ratio.value;
        }
        better
    });
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(order: usize, ratio: f64, ns: f64) -> Summary {
        let ratio = Estimate::exact(ratio);
        let setting = Setting { estimator: "robust".to_owned(), basis: "legendre".to_owned(), order };
        Summary {
            setting,
            ratio,
            ns,
            gains: [1.0; 2],
            worst: ratio,
            ends: [ratio.low, ratio.high],
            place: String::new(),
        }
    }

    #[test]
    fn what_intervals_do_not_decide_is_not_safe() {
        let of = |ends| is_safe(&Summary { ends, ..summary(1, 1.0, 20.0) });
        assert_eq!(of([0.9, 1.05]), Some(true));
        assert_eq!(of([0.715, 1.349]), None);
        assert_eq!(of([0.9, f64::INFINITY]), None);
        assert_eq!(of([1.06, 1.2]), Some(false));
    }

    #[test]
    fn the_frontier_has_what_nothing_beats_in_both() {
        let all = [summary(1, 0.5, 20.0), summary(2, 0.3, 40.0), summary(3, 0.4, 50.0), summary(5, 0.6, 10.0)];
        let orders: Vec<usize> = frontier(&all).iter().map(|summary| summary.setting.order).collect();
        assert_eq!(orders, [5, 1, 2]);
    }
}
