//! Multiple importance sampling: techniques that the optimal weights can hardly tell apart.

use crate::errors::ratio;
use crate::table::ErrorRow;
use noisefloor::mis::{self, OptimalMis, Solver};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::root_mean_square;

/// A density on the unit interval.
#[derive(Clone, Copy)]
enum Density {
    /// 1 + slope (2 x - 1).
    Linear(f64),
    /// Constant on an interval.
    Box(f64, f64),
}

impl Density {
    fn at(self, x: f64) -> f64 {
        match self {
            Self::Linear(slope) => 1.0 + slope * (2.0 * x - 1.0),
            Self::Box(low, high) => f64::from(u8::from((low..high).contains(&x))) / (high - low),
        }
    }

    fn draw(self, rng: &mut SplitMix64) -> f64 {
        let u = rng.uniform();
        match self {
            // The root of slope x^2 + (1 - slope) x = u, without a division by a slope of nought.
            Self::Linear(slope) => {
                let b = 1.0 - slope;
                2.0 * u / (b + (b * b + 4.0 * slope * u).sqrt())
            }
            Self::Box(low, high) => low + u * (high - low),
        }
    }
}

struct Case {
    name: &'static str,
    techniques: Vec<Density>,
    rounds: usize,
    /// All densities are multiplied by it, and the result divided.
    scale: f64,
}

pub(crate) fn measure(rows: &mut Vec<ErrorRow>, repetitions: usize) {
    let linear = |slopes: &[f64]| slopes.iter().map(|&slope| Density::Linear(slope)).collect::<Vec<_>>();
    let many: Vec<f64> = (0..16).map(|j| f64::from(j) / 16.0).collect();
    let cases = [
        Case { name: "two techniques", techniques: linear(&[0.0, -0.9]), rounds: 16, scale: 1.0 },
        Case { name: "identical techniques", techniques: linear(&[0.5, 0.5]), rounds: 16, scale: 1.0 },
        Case { name: "densities 1e-1 apart", techniques: linear(&[0.0, 1e-1]), rounds: 16, scale: 1.0 },
        Case { name: "densities 1e-3 apart", techniques: linear(&[0.0, 1e-3]), rounds: 16, scale: 1.0 },
        Case { name: "densities 1e-6 apart", techniques: linear(&[0.0, 1e-6]), rounds: 16, scale: 1.0 },
        Case { name: "16 techniques of rank 2, one sample each", techniques: linear(&many), rounds: 1, scale: 1.0 },
        Case {
            name: "a technique on 1e-4 of the domain",
            techniques: vec![Density::Linear(0.0), Density::Box(0.4, 0.4001)],
            rounds: 16,
            scale: 1.0,
        },
        Case { name: "densities times 1e-30", techniques: linear(&[0.0, -0.9]), rounds: 16, scale: 1e-30 },
        Case { name: "densities times 1e30", techniques: linear(&[0.0, -0.9]), rounds: 16, scale: 1e30 },
    ];
    for (seed, case) in cases.iter().enumerate() {
        rows.push(row(case, repetitions, seed as u64));
    }
}

/// exp(-2 x), whose integral the techniques share.
fn row(case: &Case, repetitions: usize, seed: u64) -> ErrorRow {
    let exact = (1.0 - (-2.0_f64).exp()) / 2.0;
    let techniques = case.techniques.len();
    let mut rng = SplitMix64::new(500 + seed);
    let (mut balance, mut errors, mut failed) = (vec![], [const { vec![] }; 2], 0);
    let memory = vec![0.0; mis::len(techniques, 1)];
    let mut omis = OptimalMis::new(memory, &vec![1; techniques], 1).expect("valid counts");
    for _ in 0..repetitions {
        omis.reset();
        for _ in 0..case.rounds {
            for (technique, density) in case.techniques.iter().enumerate() {
                let x = density.draw(&mut rng);
                let pdf: Vec<f32> = case.techniques.iter().map(|other| (case.scale * other.at(x)) as f32).collect();
                omis.add(technique, &pdf, &[(-2.0 * x).exp() as f32]).expect("a valid sample");
            }
        }
        let solve = |solver| {
            let mut estimate = [f32::NAN];
            let result = omis.solve(solver, &mut estimate);
            result.ok().map(|()| f64::from(estimate[0]) * case.scale - exact).filter(|error| error.is_finite())
        };
        balance.extend(solve(Solver::Balance));
        for (solver, errors) in [Solver::default(), Solver::Plain].into_iter().zip(&mut errors) {
            let error = solve(solver);
            failed += usize::from(error.is_none());
            errors.extend(error);
        }
    }
    let names = [crate::errors::DEFAULT, "plain solve"];
    ErrorRow {
        group: "optimal weights",
        case: case.name.to_owned(),
        n: case.rounds * techniques,
        terms: techniques,
        repetitions,
        failed,
        plain_rmse: root_mean_square(&balance),
        ratios: names.into_iter().zip(errors.iter().map(|errors| ratio(errors, &balance))).collect(),
    }
}
