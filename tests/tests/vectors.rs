//! Pinned outputs, to the bit: `tests/vectors/cv.txt`, which the C tests read too.
//!
//! A change of any figure is a change of the library's results: regenerate the file with
//! `NOISEFLOOR_WRITE_VECTORS=1 cargo test -p noisefloor-tests --test noisefloor vectors::`, and say why in
//! CHANGELOG.md.

use noisefloor::basis::Family;
use noisefloor::control_variate::{Color, Config, Estimate, Estimator, Samples, Solver, estimate, workspace_len};
use noisefloor::real::Real;
use noisefloor::rng::Rng;
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::stream::Stream;
use std::fmt::Write;
use std::path::PathBuf;

const SOLVERS: [Solver; 4] = [Solver::Auto, Solver::NormalEquations, Solver::SquareRoot, Solver::Dual];

/// Bases that stand among the other cases. Later ones come last, so that no other case's seed changes.
const FIRST_BASES: usize = 4;

const HEAD: &str = "\
# Outputs of the control variates, to the bit. Written by tests/tests/vectors.rs, which says how; read by it and by
# tests/c/vectors.c.
#
# Sample i of n: u[i][0..dims] are the next numbers of nf_rng_uniform() after nf_rng_seed(seed); channel c of
# f[i] is (c + 1) * ((1 + a) / (2 + b) + (a > 1/2 ? 1 : 0)), in float, with a = u[i][c % dims] and b = u[i][dims - 1].
#
# form (0: nf_cv_estimate, 1: accumulator) estimator basis dims order channels slices solver precision color n seed :
# samples gain mean[4] std_error[4], floats as hexadecimal bits
";

/// One line: a configuration, how it is used, and its samples.
#[derive(Clone, Copy)]
struct Case {
    streaming: bool,
    estimator: usize,
    basis: usize,
    dims: usize,
    order: usize,
    channels: usize,
    slices: usize,
    solver: usize,
    narrow: bool,
    luminance: bool,
    n: usize,
    seed: u64,
}

const PLAIN: Case = Case {
    streaming: false,
    estimator: 0,
    basis: 0,
    dims: 2,
    order: 2,
    channels: 1,
    slices: 0,
    solver: 0,
    narrow: false,
    luminance: false,
    n: 32,
    seed: 1,
};

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (estimator, kind) in ESTIMATORS.into_iter().enumerate() {
        for narrow in [false, true] {
            for (dims, order, channels, n) in
                [(1, 3, 1, 8), (2, 2, 1, 16), (2, 2, 3, 64), (3, 2, 4, 37), (15, 1, 3, 20)]
            {
                for streaming in [false, true] {
                    if !(streaming && kind == Estimator::LeaveOneOut) {
                        cases.push(Case { streaming, estimator, dims, order, channels, n, narrow, ..PLAIN });
                    }
                }
            }
        }
        for basis in 1..FIRST_BASES {
            cases.push(Case { estimator, basis, ..PLAIN });
        }
        cases.push(Case { estimator, dims: 3, slices: 4, n: 128, ..PLAIN });
        cases.push(Case { estimator, channels: 3, luminance: true, ..PLAIN });
    }
    cases.extend((1..SOLVERS.len()).map(|solver| Case { estimator: 1, solver, order: 3, ..PLAIN }));
    cases.push(Case { dims: 3, order: 7, n: 300, ..PLAIN });
    cases.push(Case { dims: 15, order: 2, n: 64, ..PLAIN });
    for basis in (0..Family::ALL.len()).skip(FIRST_BASES) {
        cases.extend((0..ESTIMATORS.len()).map(|estimator| Case { estimator, basis, ..PLAIN }));
    }
    for (index, case) in cases.iter_mut().enumerate() {
        case.seed = index as u64 + 1;
    }
    cases
}

fn samples(case: &Case) -> (Vec<f32>, Vec<f32>) {
    let mut rng = Rng::seed(case.seed);
    let u: Vec<f32> = (0..case.n * case.dims).map(|_| rng.uniform_f32()).collect();
    let f = u.chunks(case.dims).flat_map(|u| {
        let b = u[case.dims - 1];
        (0..case.channels).map(move |c| {
            let a = u[c % case.dims];
            (c + 1) as f32 * ((1.0 + a) / (2.0 + b) + if a > 0.5 { 1.0 } else { 0.0 })
        })
    });
    let f = f.collect();
    (u, f)
}

fn compute<R: Real>(case: &Case) -> Estimate {
    let config = Config {
        estimator: ESTIMATORS[case.estimator],
        basis: Family::ALL[case.basis],
        slices: case.slices,
        solver: SOLVERS[case.solver],
        color: if case.luminance { Color::LuminanceRatio } else { Color::PerChannel },
        ..Config::new(case.dims, case.order, case.channels)
    };
    let (u, f) = samples(case);
    let result = if case.streaming {
        let mut accumulator = Stream::<R>::new(&config).unwrap();
        accumulator.add(Samples::new(&u, &f)).unwrap();
        accumulator.estimate(&mut accumulator.workspace())
    } else {
        estimate(&config, Samples::new(&u, &f), &mut vec![R::ZERO; workspace_len::<R>(&config, case.n).unwrap()])
    };
    result.unwrap()
}

fn line(case: &Case) -> String {
    let estimate = if case.narrow { compute::<f32>(case) } else { compute::<f64>(case) };
    let mut line = format!(
        "{} {} {} {} {} {} {} {} {} {} {} {} : {}",
        u8::from(case.streaming),
        case.estimator,
        case.basis,
        case.dims,
        case.order,
        case.channels,
        case.slices,
        case.solver,
        u8::from(case.narrow),
        u8::from(case.luminance),
        case.n,
        case.seed,
        estimate.samples,
    );
    for value in [estimate.gain].iter().chain(&estimate.mean).chain(&estimate.std_error) {
        write!(line, " {:08x}", value.to_bits()).unwrap();
    }
    line
}

#[test]
fn outputs_are_the_pinned_ones() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("vectors/cv.txt");
    let mut text = HEAD.to_owned();
    for case in cases() {
        text += &line(&case);
        text.push('\n');
    }
    if std::env::var_os("NOISEFLOOR_WRITE_VECTORS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let pinned = std::fs::read_to_string(&path).unwrap();
    for (index, (pinned, actual)) in pinned.lines().zip(text.lines()).enumerate() {
        assert_eq!(pinned, actual, "line {}; see the head of tests/tests/vectors.rs", index + 1);
    }
    assert_eq!(pinned.lines().count(), text.lines().count());
}
