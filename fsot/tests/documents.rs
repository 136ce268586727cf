//! The numbers of steps in the documents are those of the code.

use fsot::class;
use fsot::optimize::{Optimizer, Problem, Quality};
use fsot::picture::Photo;
use fsot::run::Optimization;
use fsot::stipple::{Options, Stipple};
use fsot::{sampler, tile};
use std::fs;
use std::path::Path;

const QUALITIES: [Quality; 3] = [Quality::Draft, Quality::Standard, Quality::High];

fn document(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name)).unwrap()
}

/// The cells of the table below a row of titles.
fn table(document: &str, titles: &str) -> Vec<Vec<String>> {
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    let rows = document.lines().skip_while(|line| *line != titles).skip(2).take_while(|line| line.starts_with('|'));
    let rows: Vec<Vec<String>> = rows.map(cells).collect();
    assert!(!rows.is_empty(), "no table begins with {titles}");
    rows
}

fn number(text: &str) -> u64 {
    text.replace(',', "").parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

fn steps(problem: Problem) -> u64 {
    Optimizer::new(problem).unwrap().iterations()
}

/// "170 K log2 n": for K objectives and n points.
#[test]
fn the_formulas_of_steps_are_those_of_the_code() {
    let rows = table(&document("fsot.md"), "| | draft | standard | high | one step |");
    for (row, points, log) in [(&rows[0], 4096, 12), (&rows[1], 16_384, 1)] {
        for (cell, quality) in row[1..].iter().zip(QUALITIES) {
            let base = number(cell.split(' ').next().unwrap());
            let of = |classes| steps(Problem { classes, quality, ..Problem::new(points, 2) });
            assert_eq!(base * log, of(class::single(2)), "{row:?}");
            assert_eq!(base * log * 3, of(class::two_colors(2)), "{row:?}");
        }
    }
}

#[test]
fn the_numbers_of_steps_are_those_of_the_code() {
    let rows = table(&document("fsot.md"), "| | draft | standard | high | one step |");
    let photo = Photo::from_fn(9, 9, |x, _| [x as f32 / 9.0; 3]);
    let stipple = |quality| steps(Stipple::new(&photo, &Options { quality, ..Options::new(9) }).unwrap().problem);
    let of: [(&str, &dyn Fn(Quality) -> u64); 3] =
        [("`stipple`", &stipple), ("`tile`", &tile::iterations), ("`sampler`", &sampler::problem::iterations)];
    assert_eq!(rows.len(), 2 + of.len());
    for (row, (name, steps)) in rows[2..].iter().zip(of) {
        assert_eq!(row[0], name);
        assert_eq!([&row[1], &row[2], &row[3]].map(|cell| number(cell)), QUALITIES.map(steps), "{name}");
    }
}
