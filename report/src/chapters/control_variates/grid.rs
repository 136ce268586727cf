//! Tables: bases and orders of every estimator; every integrand by the recommended setting.

use super::cells::{BASES, Cells, DEFAULT, ESTIMATORS, MEAN, Setting, Summary};
use crate::chapters::chapter::{self, Chapter, row};
use crate::chapters::figure::{Figure, Unit};

const ORDERS: [usize; 4] = [1, 2, 3, 5];
/// Up to so many dims all of these orders have at most as many terms as the library admits.
const DIMS: usize = 3;

pub(super) fn write(chapter: &mut Chapter, cells: &Cells) {
    chapter.section("Estimators, bases, orders", "");
    chapter.setting("dims of the table of estimators, at most", DIMS);
    for &n in &cells.counts {
        let all = cells.summaries(|dims| dims <= DIMS, n);
        let mut rows = Vec::new();
        for estimator in ESTIMATORS {
            for basis in BASES {
                let mut line = row![n as u32, estimator, basis];
                line.extend(ORDERS.map(|order| {
                    let setting = Setting { estimator: estimator.to_owned(), basis: basis.to_owned(), order };
                    cell(all.iter().find(|summary| summary.setting == setting))
                }));
                rows.push(line);
            }
        }
        let columns = ["samples", "estimator", "basis", "order 1", "order 2", "order 3", "order 5"];
        chapter.table("estimators, bases, orders", &columns, 3, rows);
    }
    integrands(chapter, cells);
}

fn cell(summary: Option<&Summary>) -> chapter::Cell {
    summary.map_or(chapter::Cell::Missing, |summary| {
        let [mean, worst] = [summary.ratio.value, summary.worst.value].map(|value| Unit::Ratio.text(value));
        format!("{mean}; {worst}").into()
    })
}

/// Each integrand: the recommended setting, and the one of least error.
fn integrands(chapter: &mut Chapter, cells: &Cells) {
    chapter.section("Each integrand", "");
    let mut rows = Vec::new();
    for mean in cells.all.iter().filter(|cell| cell.setting.estimator == MEAN) {
        let here: Vec<_> =
            cells.all.iter().filter(|cell| cell.integrand == mean.integrand && cell.n == mean.n).collect();
        let advised = cells.recommended(mean.dims, mean.n);
        let Some(own) = here.iter().find(|cell| cell.setting == advised) else { continue };
        let Some(best) = here.iter().min_by(|a, b| a.ratio.value.total_cmp(&b.ratio.value)) else { continue };
        let square = own.ratio.value.powi(2);
        let cost = (square < 1.0).then(|| ((square * own.ns - own.mean_ns) / (1.0 - square)).max(0.0));
        let small = |value: f64| if value < 0.0095 { Unit::Error } else { Unit::Ratio };
        rows.push(row![
            mean.integrand.clone(),
            mean.dims as u32,
            mean.n as u32,
            if advised.estimator == DEFAULT { format!("order {}", advised.order) } else { "MC".to_owned() },
            Figure::new(own.ratio, small(own.ratio.value)),
            Figure::exact(own.ns, Unit::Nanoseconds),
            cost.map(|cost| Figure::exact(cost, Unit::Nanoseconds)),
            best.setting.name(),
            Figure::brief(best.ratio, small(best.ratio.value)),
            Figure::exact(best.ns, Unit::Nanoseconds),
        ]);
    }
    let columns = [
        "integrand",
        "dims",
        "samples",
        "recommended",
        "its error",
        "its ns",
        "pays from, ns",
        "least error by",
        "that error",
        "its ns ",
    ];
    chapter.table("each integrand", &columns.map(str::trim), 1, rows);
}
