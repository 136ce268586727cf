//! Whole reports: what is refused, what is absent, threads, text and JSON.

use crate::metrics_common::random;
use fsot::metrics::tile::{TileOptions, TileView};
use fsot::metrics::{check, measure, measure_tile, prefix_errors, quick};
use fsot::points::Points;

#[test]
fn points_that_cannot_be_measured_are_refused_by_value() {
    assert!(check(&Points::new(2, vec![])).unwrap_err().to_string().contains("no points"));
    assert!(check(&Points::new(9, vec![0.5; 9])).unwrap_err().to_string().contains("9 coordinates"));
    for (bad, shown) in [(f32::NAN, "NaN"), (1.000_001, "1.000001"), (-1e-9, "-0.000000001"), (f32::INFINITY, "inf")] {
        let error = measure(&Points::new(2, vec![0.0, 1.0, 0.5, bad])).unwrap_err().to_string();
        assert!(error.contains(&format!("point 2 has {shown} as coordinate 2")), "{error}");
    }
}

#[test]
fn the_fewest_and_the_most_equal_points_are_measured() {
    for dims in [1, 2, 4, 8] {
        for points in [
            Points::new(dims, vec![0.5; dims]),
            Points::new(dims, vec![0.0; dims]),
            Points::new(dims, vec![1.0; 5 * dims]),
            Points::new(dims, vec![0.999_999_94; 300 * dims]),
            random(2, dims, 1),
            random(3, dims, 1),
        ] {
            let report = measure(&points).unwrap();
            assert_eq!(report.spectra.len(), dims * (dims - 1) / 2);
            assert_eq!(report.neighbours.is_some(), points.len() > 1);
            assert!(report.discrepancy.as_ref().unwrap().l2_star.is_finite());
            assert!(report.transport.sliced_w2.is_finite() && report.transport.shifted.is_finite());
            let text = report.to_string();
            assert!(!text.contains("NaN") && !text.contains("inf "), "{text}");
            serde_json::to_string(&report).unwrap();
        }
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let points = random(6000, 3, 2);
    let coordinates = random(16 * 16 * 2 * 3, 2, 3);
    let all = || {
        let tile = TileView::new(16, 2, 2, 3, coordinates.coordinates()).unwrap();
        let options = TileOptions { integrands: 50, ..TileOptions::default() };
        let report = measure_tile(&tile, &options).unwrap();
        let prefixes = prefix_errors(std::slice::from_ref(&points), &[10, 6000], 64).unwrap();
        serde_json::to_string(&(quick(&points).unwrap(), report, prefixes)).unwrap()
    };
    let on = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(all);
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}

#[test]
fn text_is_aligned() {
    let text = measure(&random(100, 2, 1)).unwrap().to_string();
    for name in ["P_low", "P_max", "anisotropy", "NN", "NN torus min", "L2* e3", "SW2 e3", "half-spaces", "Gaussians"] {
        assert!(text.lines().any(|line| line.trim_start().starts_with(name)), "{name} in\n{text}");
    }
    assert!(text.starts_with("  points                 100  in 2 dimensions\n"), "{text}");
    // Names, then numbers that end in the same column.
    assert!(text.lines().all(|line| line.as_bytes()[27] != b' ' && &line[28..30] == "  "), "{text}");
    let coordinates = random(4 * 4, 3, 1);
    let tile = TileView::new(4, 1, 3, 1, coordinates.coordinates()).unwrap();
    let table = measure_tile(&tile, &TileOptions { integrands: 4, ..TileOptions::default() }).unwrap().to_string();
    let rows: Vec<&str> = table.lines().filter(|line| line.contains('|')).collect();
    assert_eq!(rows.len(), 2 + 1 + 3);
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{table}");
}
