//! Error against time: every setting of a family of integrands, and which of them no other beats in both.

use super::cells::{BASES, Cells, ESTIMATORS, MEAN, Setting, Summary};
use crate::chapters::Report;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::measure::panels::{Key, Mark, Panel, Panels, Shape};
use crate::measure::plot::{Axis, Series};
use anyhow::Result;

/// A family: name of the file, title, dims.
const FAMILIES: [(&str, &str, [usize; 2]); 4] = [
    ("control_variates_1d", "1 dim", [1, 1]),
    ("control_variates_2d", "2 dims", [2, 2]),
    ("control_variates_5d", "3 to 5 dims", [3, 5]),
    ("control_variates_15d", "15 dims", [15, 15]),
];
/// Settings that are worse than this are left out of the plots.
const LARGEST: f64 = 2.0;
const SHAPES: [Shape; 4] = [Shape::Circle, Shape::Square, Shape::Triangle, Shape::Cross];
/// A setting is safe if no integrand's error is larger: the targets' 1.03, and an allowance.
const SAFE: f64 = 1.05;
/// On the frontier each point has so much less error than every faster one: less is noise.
const STEP: f64 = 0.02;

pub(super) fn write(report: &Report, chapter: &mut Chapter, cells: &Cells) -> Result<()> {
    chapter.section("Error against time", "");
    let safe = chapter.setting("worst ratio of a safe setting", SAFE);
    let step = chapter.setting("step of the frontier, percent", 100.0 * STEP);
    let largest = chapter.setting("largest ratio that is shown", LARGEST);
    chapter.paragraph(&format!(
        "Each point is a setting: an estimator (colour), a basis (shape), an order. Across: the geometric mean of the error over the family's integrands; up: time. The black \
         line is the frontier: each of its points has at least {step} percent less error than every faster setting; numbers beside it are orders. Coloured lines lead from the \
         frontier's points and the recommended setting to their worst integrand. Ringed: what `recommend()` says for independent samples, the default with polynomials. \
         Errors above {largest} are not shown, nor settings slower than twice the slowest of the frontier. The tables have the frontier, the recommended setting, and the \
         most efficient of the safe settings if a sample costs a microsecond: safe is a setting of which every integrand's interval ends at or below {safe} of MC's error, not safe one of which some integrand's begins above; in \
         between it is not decided, and is not named the best safe one. The worst is the largest of several noisy figures, so that it lies above the largest true \
         one on average, and its interval is that integrand's alone; safety does not follow from it. That is no \
         promise for others: least squares is safe on smooth families only, the default by its construction."
    ));
    for (file, title, [low, high]) in FAMILIES {
        family(report, chapter, cells, (file, title, [low, high]))?;
    }
    Ok(())
}

fn family(
    report: &Report,
    chapter: &mut Chapter,
    cells: &Cells,
    (file, title, [low, high]): (&'static str, &str, [usize; 2]),
) -> Result<()> {
    let inside = |dims: usize| (low..=high).contains(&dims);
    let mut names: Vec<&str> =
        cells.all.iter().filter(|cell| inside(cell.dims)).map(|c| c.integrand.as_str()).collect();
    names.dedup();
    names.sort_unstable();
    names.dedup();
    let (mut panels, mut rows, mut verdicts) = (Vec::new(), Vec::new(), Vec::new());
    for &n in &cells.counts {
        let all = cells.summaries(inside, n);
        let frontier = frontier(&all);
        let recommended = cells.recommended(high.min(15), n);
        panels.push(panel(&all, &frontier, &recommended, n));
        let is_safe = |summary: &&Summary| is_safe(summary) == Some(true) && summary.setting.estimator != MEAN;
        let best = all.iter().filter(is_safe).max_by(|a, b| a.gains[1].total_cmp(&b.gains[1]));
        let advised = all.iter().find(|summary| summary.setting == recommended);
        let mut listed: Vec<&Summary> = frontier.clone();
        for extra in advised.into_iter().chain(best) {
            if !listed.iter().any(|summary| summary.setting == extra.setting) {
                listed.push(extra);
            }
        }
        listed.sort_by(|a, b| a.ns.total_cmp(&b.ns));
        for summary in listed {
            let is = |other: Option<&Summary>| other.is_some_and(|other| other.setting == summary.setting);
            let on = frontier.iter().any(|other| other.setting == summary.setting);
            let roles = [(on, "frontier"), (is(advised), "recommended"), (is(best), "best safe one")];
            let roles: Vec<&str> = roles.into_iter().filter(|(is, _)| *is).map(|(_, role)| role).collect();
            rows.push(table_row(n, summary, &roles.join(", ")));
        }
        verdicts.extend(verdict(chapter, title, n, advised, best));
    }
    chapter.section(&format!("Error against time, {title}"), "");
    let joined = names.join(", ");
    chapter.setting(format!("integrands, {title}"), joined.as_str());
    chapter.paragraph(&format!("Integrands: {joined}."));
    let x = Axis { label: "RMSE over MC's, geometric mean", logarithmic: true, range: None };
    let y = Axis { label: "ns per sample", logarithmic: true, range: None };
    let title = format!("Error against time, {title}");
    let plots = Panels { title: &title, x, y, columns: 3, panels: &panels, legend: &legend() };
    report.output.write_text(&format!("{file}.svg"), &plots.svg()?)?;
    chapter.picture(&format!("{file}.svg"), &title);
    let columns = [
        "samples",
        "setting",
        "error",
        "worst",
        "where",
        "ns per sample",
        "efficiency, free samples",
        "efficiency, 1 us samples",
        "safe",
        "what it is",
    ];
    chapter.table(file, &columns, 2, rows);
    chapter.list(&verdicts);
    Ok(())
}

fn table_row(n: usize, summary: &Summary, roles: &str) -> Vec<Cell> {
    let ns = Figure::exact(summary.ns, Unit::Nanoseconds);
    let [free, dear] = summary.gains.map(|gain| Figure::exact(gain, Unit::Ratio));
    let worst = Figure::new(summary.worst, Unit::Ratio);
    row![
        n as u32,
        summary.setting.name(),
        Figure::new(summary.ratio, Unit::Ratio),
        worst,
        summary.place.clone(),
        ns,
        free,
        dear,
        safety(summary),
        roles,
    ]
}

/// None: the intervals do not decide.
fn is_safe(summary: &Summary) -> Option<bool> {
    let [low, high] = summary.ends;
    if high <= SAFE { Some(true) } else { (low > SAFE).then_some(false) }
}

fn safety(summary: &Summary) -> &'static str {
    is_safe(summary).map_or("not decided", |is_safe| if is_safe { "yes" } else { "no" })
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

fn panel(all: &[Summary], frontier: &[&Summary], recommended: &Setting, n: usize) -> Panel {
    let at = |summary: &Summary| (summary.ratio.value, summary.ns);
    let mut series = vec![Series {
        // Steps: from each point up to the next one's time, then over to its error.
        points: frontier
            .windows(2)
            .flat_map(|pair| [at(pair[0]), (pair[0].ratio.value, pair[1].ns), at(pair[1])])
            .collect(),
        colour: Some(0),
        ..Series::default()
    }];
    let mut marks = Vec::new();
    let slowest = frontier.iter().map(|summary| summary.ns).fold(0.0, f64::max) * 2.0;
    let is_shown = |summary: &&Summary| {
        summary.ratio.value <= LARGEST && (summary.ns <= slowest || &summary.setting == recommended)
    };
    for summary in all.iter().filter(is_shown) {
        let on = frontier.iter().any(|other| other.setting == summary.setting);
        let is_recommended = &summary.setting == recommended;
        let estimator = ESTIMATORS.iter().position(|name| *name == summary.setting.estimator);
        let basis = BASES.iter().position(|name| *name == summary.setting.basis).unwrap_or(0);
        let colour = estimator.map_or(0, |index| index + 1);
        let text = match (on && estimator.is_some(), is_recommended) {
            (false, false) => String::new(),
            _ => summary.setting.order.to_string(),
        };
        if on || is_recommended {
            let worst = (summary.worst.value.min(LARGEST), summary.ns);
            series.push(Series {
                points: vec![at(summary), worst],
                dashed: true,
                colour: Some(colour),
                ..Series::default()
            });
        }
        if is_recommended {
            marks.push(Mark { at: at(summary), shape: Shape::Ring, colour: 0, text: String::new() });
        }
        marks.push(Mark { at: at(summary), shape: SHAPES[basis], colour, text });
    }
    Panel { title: format!("{n} samples"), series, marks }
}

fn legend() -> Vec<Key> {
    let estimator = |(index, name): (usize, &&str)| {
        let name = if index == 0 { "robust (default)" } else { name };
        Key::Mark { name: name.to_owned(), colour: index + 1, shape: Shape::Circle }
    };
    let basis = |(name, shape): (&str, Shape)| Key::Mark { name: name.to_owned(), colour: 0, shape };
    let bases = ["polynomials, MC", "step functions", "sines", "Gaussians"].into_iter().zip(SHAPES).map(basis);
    let rest = [
        Key::Line { name: "frontier".to_owned(), colour: 0, dashed: false },
        Key::Mark { name: "recommended".to_owned(), colour: 0, shape: Shape::Ring },
    ];
    ESTIMATORS.iter().enumerate().map(estimator).chain(bases).chain(rest).collect()
}

/// Why the recommended setting is, or what speaks against it.
fn verdict(
    chapter: &mut Chapter,
    family: &str,
    n: usize,
    advised: Option<&Summary>,
    best: Option<&Summary>,
) -> Option<String> {
    let (advised, best) = (advised?, best?);
    let mut quote =
        |what: &str, value: f64| chapter.quote(format!("{what}, {family}, n = {n}"), Figure::exact(value, Unit::Ratio));
    let own = quote("efficiency of the recommended setting", advised.gains[1]);
    let worst = quote("worst ratio of the recommended setting", advised.worst.value);
    let other = quote("efficiency of the best safe setting", best.gains[1]);
    let name = advised.setting.name();
    let text = if best.setting == advised.setting {
        format!(
            "{n} samples: {name} is recommended because no safe setting is more efficient ({own} times MC's, worst error {worst})"
        )
    } else if is_safe(advised) != Some(true) {
        let is = if is_safe(advised).is_some() { "is not safe" } else { "is not decided to be safe" };
        format!(
            "{n} samples: {name} is recommended, but {is} (worst error {worst}); {}, which is, has an efficiency of {other}",
            best.setting.name()
        )
    } else {
        let share =
            quote("efficiency of the recommended setting over the best safe one's", advised.gains[1] / best.gains[1]);
        format!(
            "{n} samples: {name} is recommended, safe (worst error {worst}) with an efficiency of {own}, {share} of that of {} ({other}), the most efficient on this family",
            best.setting.name()
        )
    };
    chapter.setting(format!("verdict, {family}, n = {n}"), text.as_str());
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapters::statistics::Estimate;

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
