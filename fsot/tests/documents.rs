//! The numbers of steps in the documents are those of the code.

use fsot::class;
use fsot::optimize::{Domain, Optimizer, Problem, Quality};
use fsot::run::Optimization;
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

fn steps(points: usize, classes: Vec<class::Class>, quality: Quality) -> u64 {
    let problem = Problem {
        points,
        dims: 2,
        classes,
        class_coordinates: class::ClassCoordinates::Index,
        domain: Domain::Bounded,
        axis_priority: 0.0,
        seed: 1,
        quality,
        initial: None,
    };
    Optimizer::new(problem).unwrap().iterations()
}

/// "170 K log2 n": for K objectives and n points.
#[test]
fn the_formulas_of_steps_are_those_of_the_code() {
    let rows = table(&document("fsot.md"), "| | draft | standard | high | one step |");
    for (row, points, log) in [(&rows[0], 4096, 12), (&rows[1], 16_384, 1)] {
        for (cell, quality) in row[1..].iter().zip(QUALITIES) {
            let base = number(cell.split(' ').next().unwrap());
            assert_eq!(base * log, steps(points, class::single(2), quality), "{row:?}");
            assert_eq!(base * log * 3, steps(points, class::two_colors(2), quality), "{row:?}");
        }
    }
}
