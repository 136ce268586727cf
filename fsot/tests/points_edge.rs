//! Small, empty, uneven and wrong problems.

use fsot::class::{self, Class, ClassCoordinates, ClassFunction, Step};
use fsot::optimize::{Domain, Optimizer, Problem, Quality, optimize};
use fsot::points::Points;
use fsot::run::Optimization;
use fsot::target::{Function, Uniform};
use std::sync::Arc;
use std::time::{Duration, Instant};

fn short(points: usize, dims: usize) -> Problem {
    Problem { quality: Quality::Iterations(60), ..Problem::new(points, dims) }
}

fn class_of(function: ClassFunction, dims: usize) -> Class {
    Class { function, target: Arc::new(Uniform::new(dims)), weight: 1.0, name: "it".into() }
}

fn inside(points: &Points) -> bool {
    points.coordinates().iter().all(|x| (0.0..1.0).contains(x))
}

#[test]
fn one_point_goes_to_the_centre() {
    for dims in 1..=8 {
        let mut problem = short(1, dims);
        problem.quality = Quality::Iterations(300);
        let points = optimize(problem).unwrap();
        assert_eq!(points.len(), 1);
        assert!(points.coordinates().iter().all(|x| (x - 0.5).abs() < 1e-3), "{points:?}");
    }
    assert!(inside(&optimize(Problem { domain: Domain::Toroidal, ..short(1, 2) }).unwrap()));
}

#[test]
fn points_on_a_line_become_equidistant() {
    let points = optimize(short(100, 1)).unwrap();
    let mut sorted = points.coordinates().to_vec();
    sorted.sort_by(f32::total_cmp);
    for (i, x) in sorted.iter().enumerate() {
        assert!((x - (i as f32 + 0.5) / 100.0).abs() < 1e-4, "{x}");
    }
}

#[test]
fn points_stay_in_the_domain() {
    for domain in [Domain::Bounded, Domain::Toroidal] {
        for (points, dims) in [(2, 1), (3, 2), (65, 2), (300, 2), (200, 3), (100, 8)] {
            let corner = Points::new(dims, vec![1.0 - f32::EPSILON / 2.0; points * dims]);
            let mut optimizer =
                Optimizer::new(Problem { domain, initial: Some(corner), ..short(points, dims) }).unwrap();
            while optimizer.iteration() < optimizer.iterations() {
                assert!(optimizer.step().is_finite());
                assert!(inside(&optimizer.points()));
            }
        }
    }
}

/// The least distance between two points.
fn nearest(points: &Points) -> f32 {
    let mut nearest = f32::INFINITY;
    for (i, a) in points.iter().enumerate() {
        for b in points.iter().skip(i + 1) {
            nearest = nearest.min(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt());
        }
    }
    nearest
}

/// Of points at one place all but one are moved, by at most 1/4096; the others begin where they are.
#[test]
fn points_begin_where_they_are() {
    let coordinates = vec![0.25, 0.5, 0.0, 0.75, 0.25, 0.5, 0.5, 0.25, 0.0, 0.75, 0.25, 0.25];
    let initial = Some(Points::new(2, coordinates.clone()));
    let begin = optimize(Problem { initial, quality: Quality::Iterations(0), ..Problem::new(6, 2) }).unwrap();
    for (i, (point, given)) in begin.iter().zip(coordinates.chunks(2)).enumerate() {
        assert_eq!(point != given, i == 2 || i == 4, "point {i}: {point:?}");
        assert!(point.iter().zip(given).all(|(x, given)| (x - given).abs() <= 1.0 / 4096.0), "point {i}: {point:?}");
    }
    assert!(inside(&begin));
}

#[test]
fn identical_points_part() {
    for (points, dims) in [(50, 2), (64, 3)] {
        let initial = Points::new(dims, vec![0.25; points * dims]);
        let problem =
            Problem { initial: Some(initial), quality: Quality::Iterations(400), ..Problem::new(points, dims) };
        let optimised = optimize(problem).unwrap();
        // Of the spacing of a grid.
        let spacing = (points as f32).powf(-1.0 / dims as f32);
        assert!(nearest(&optimised) > 0.5 * spacing, "{} of {spacing}", nearest(&optimised));
    }
}

#[test]
fn classes_of_one_point_and_of_none() {
    let mut problem = short(64, 2);
    problem.classes.push(class_of(ClassFunction::Box { from: 0.0, to: 0.016 }, 2));
    problem.classes.push(class_of(ClassFunction::Box { from: 0.001, to: 0.002 }, 2));
    problem.classes.push(class_of(ClassFunction::Tabulated(vec![0.0]), 2));
    problem.classes.push(class_of(ClassFunction::Staircase(vec![class::Step { to: 0.5, value: 0.0 }]), 2));
    let points = optimize(problem).unwrap();
    // The first point is alone in a class: its place is the centre, as far as the others allow.
    let first = points.iter().next().unwrap();
    assert!(first.iter().all(|x| (x - 0.5).abs() < 0.1), "{first:?}");
}

#[test]
fn without_any_member_nothing_moves() {
    let mut problem = short(1, 2);
    problem.classes = vec![class_of(ClassFunction::Box { from: 0.0, to: 0.4 }, 2)];
    let mut optimizer = Optimizer::new(problem).unwrap();
    let before = optimizer.points();
    while optimizer.iteration() < optimizer.iterations() {
        assert_eq!(optimizer.step(), 0.0);
    }
    assert_eq!(optimizer.points(), before);
}

#[test]
fn numbers_that_classes_do_not_divide() {
    for points in [5, 7, 100, 101] {
        for classes in [class::two_colors(2), class::three_colors(2), class::ramp(2), class::progressive(2, 4, points)]
        {
            let points = optimize(Problem { classes, ..short(points, 2) }).unwrap();
            assert!(inside(&points));
        }
    }
}

#[test]
fn prefixes_end_where_they_should() {
    assert_eq!(class::progressive_prefixes(1, 100), [100]);
    assert_eq!(class::progressive_prefixes(14, 16_384), (1..=14).map(|k| 1 << k).collect::<Vec<_>>());
    assert_eq!(class::progressive_prefixes(2, 16_384), [128, 16_384]);
    assert_eq!(class::progressive_prefixes(9, 3), [1, 2, 3]);
    assert_eq!(class::progressive_prefixes(5, 1), [1]);
    for (levels, points) in [(3, 1000), (7, 999), (5, 16_384)] {
        let class = &class::progressive(2, levels, points)[0];
        for end in class::progressive_prefixes(levels, points) {
            let value = |i: usize| ClassCoordinates::Index.value(&class.function, i, points);
            assert!(end == points || value(end - 1) > value(end), "{end} of {points}");
            assert!(end < 2 || value(end - 1) > 0.0);
        }
    }
    let all = &class::progressive(2, 64, 64)[0];
    assert_eq!(all.function, ClassFunction::Ramp { rising: false });
}

/// In single precision the last coordinates would be 1.
#[test]
fn the_last_of_many_points_is_in_a_class() {
    let function = ClassFunction::Box { from: 0.5, to: 1.0 };
    for points in [1 << 24, 1 << 28] {
        assert_eq!(ClassCoordinates::Index.value(&function, points - 1, points), 1.0);
    }
}

/// A staircase of as many steps as points would take minutes if each point were looked for from the first step on.
#[test]
fn long_staircases_are_searched_in_halves() {
    let (start, count) = (Instant::now(), 1 << 18);
    let steps = (1..=count).map(|i| Step { to: i as f32 / count as f32, value: (i % 2) as f32 });
    let function = ClassFunction::Staircase(steps.collect());
    let value = |i: usize| ClassCoordinates::Index.value(&function, i, count);
    assert!((0..count).all(|i| value(i) == ((i + 1) % 2) as f32));
    assert_eq!(function.value(&[1.0]), 0.0);
    assert!(start.elapsed() < Duration::from_secs(10));
}

#[test]
fn the_plane_chooses_points() {
    let places: Vec<[f32; 2]> = (0..64).map(|i| [(i % 8) as f32 / 8.0, (i / 8) as f32 / 8.0]).collect();
    let mut problem = short(64, 2);
    problem.class_coordinates = ClassCoordinates::Plane(places);
    let before = Optimizer::new(problem.clone()).unwrap().points();
    problem.classes = vec![class_of(ClassFunction::Rectangle { from: [0.0, 0.25], to: [0.5, 0.5] }, 2)];
    let after = optimize(problem.clone()).unwrap();
    let moved = before.iter().zip(after.iter()).zip(0..).filter(|((before, after), _)| before != after);
    let rectangle = [16, 17, 18, 19, 24, 25, 26, 27];
    assert_eq!(moved.map(|(_, number)| number).collect::<Vec<usize>>(), rectangle);
    problem.classes.push(class_of(ClassFunction::Gaussian { center: vec![0.5, 0.5], sigma: 0.2 }, 2));
    let after = optimize(problem).unwrap();
    assert!(inside(&after) && before.iter().zip(after.iter()).all(|(before, after)| before != after));
}

#[test]
fn every_error_says_what_is_wrong() {
    let torus = || {
        let mut problem = Problem { domain: Domain::Toroidal, ..Problem::new(10, 2) };
        problem.classes[0].target = Arc::new(Function::new(2, 10, |x| x[0]).unwrap());
        problem
    };
    let with = |change: fn(&mut Problem)| {
        let mut problem = Problem::new(10, 2);
        change(&mut problem);
        problem
    };
    for (problem, says) in [
        (Problem::new(0, 2), "0 points"),
        (Problem::new((1 << 28) + 1, 2), "268435457 points"),
        (Problem { dims: 0, ..Problem::new(1, 1) }, "0 dimensions"),
        (Problem { dims: 9, ..Problem::new(1, 1) }, "9 dimensions"),
        (with(|p| p.axis_priority = 1.5), "axis priority 1.5"),
        (with(|p| p.axis_priority = f32::NAN), "axis priority NaN"),
        (with(|p| p.classes.clear()), "no class"),
        (with(|p| p.classes[0].weight = -1.0), "weight is -1"),
        (with(|p| p.classes[0].weight = f32::NAN), "weight is NaN"),
        (with(|p| p.classes[0].weight = 0.0), "weight 0"),
        (with(|p| p.classes[0].target = Arc::new(Uniform::new(3))), "target of 3 dimensions"),
        (with(|p| p.classes[0].function = ClassFunction::Box { from: 0.5, to: 0.5 }), "from 0.5 to 0.5"),
        (
            with(|p| p.classes[0].function = ClassFunction::Rectangle { from: [0.0; 2], to: [1.0; 2] }),
            "points have only an index",
        ),
        (with(|p| p.class_coordinates = ClassCoordinates::Plane(vec![[0.0; 2]; 9])), "9 class coordinates"),
        (with(|p| p.class_coordinates = ClassCoordinates::Plane(vec![[2.0; 2]; 10])), "coordinate is 2"),
        (with(|p| p.initial = Some(Points::new(2, vec![0.0; 18]))), "9 initial points"),
        (with(|p| p.initial = Some(Points::new(1, vec![0.0; 10]))), "of 1 dimension, for 10 of 2"),
        (with(|p| p.initial = Some(Points::new(2, vec![1.0; 20]))), "coordinate is 1"),
        (torus(), "only uniform targets"),
    ] {
        let error = optimize(problem).unwrap_err().to_string();
        assert!(error.contains(says), "{error:?} does not say {says:?}");
    }
}
