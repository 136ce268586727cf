//! The tile optimiser: its gradient, and that nothing but the problem decides the result.

use fsot::run::Optimization;
use fsot::tile::{ClassShare, Kernel, Projections, Steps, TemporalKernel, TileOptimizer, TileProblem, TileSamples};

/// A problem whose slices all select 3x3 pixels: each sample takes part in 9 of them.
fn even(dims: usize, spp: usize) -> TileProblem {
    let mut problem = TileProblem::new(8, spp, dims);
    problem.kernel = Kernel::Tabulated(vec![vec![1.0; 3]; 3]);
    problem.box_class.share = 0.0;
    problem.steps = Steps { first: 1.0, last: 1.0, hold: 1.0 };
    problem.projections = Projections { axis: 0.2, plane: 0.3 };
    problem.directions = 4;
    problem.offset_correction = 0.0;
    problem
}

/// The energy of the same slices at other coordinates: steps are random, but the same iteration of the same problem
/// takes the same.
fn energy(problem: &TileProblem, coordinates: &[f32]) -> f64 {
    let mut optimizer = TileOptimizer::new(problem.clone()).unwrap();
    assert!(optimizer.restore(3, coordinates));
    optimizer.step()
}

/// A step goes down the gradient of the slices' energy. With m samples in each slice and P slices, E = 1/P sum 1/m sum
/// (x - b)^2, so that the mean of a sample's 9 displacements (no offset correction) is -(m P / 18) dE/dx. Central
/// differences: where two samples change places within the difference, the energy has a kink, so a few may be off.
#[test]
fn a_step_follows_the_gradient_of_the_energy() {
    for (dims, spp) in [(1, 1), (2, 1), (2, 4), (4, 2), (8, 1)] {
        let problem = even(dims, spp);
        let mut optimizer = TileOptimizer::new(problem.clone()).unwrap();
        let start: Vec<f32> = optimizer.coordinates().iter().map(|value| 0.05 + 0.9 * value).collect();
        assert!(optimizer.restore(3, &start));
        optimizer.step();
        let scale = (9 * spp * 64) as f64 / 18.0;
        let h = 1.0 / 4096.0;
        let step = (start.len() / 64).max(1);
        let (mut tried, mut wrong) = (0, 0);
        for index in (0..start.len()).step_by(step) {
            let at = |offset: f32| {
                let mut moved = start.clone();
                moved[index] += offset;
                energy(&problem, &moved)
            };
            let gradient = (at(h) - at(-h)) / f64::from(2.0 * h);
            let expected = -scale * gradient;
            let moved = f64::from(optimizer.coordinates()[index]) - f64::from(start[index]);
            tried += 1;
            wrong += usize::from((moved - expected).abs() > 2e-3 + 0.02 * expected.abs());
        }
        assert!(wrong * 20 <= tried, "{dims} dimensions, {spp} samples: {wrong} of {tried} steps are off the gradient");
    }
}

/// Problems that use every part of the engine.
fn varied() -> Vec<TileProblem> {
    let base = |spp, dims| TileProblem { iterations: 12, ..TileProblem::new(16, spp, dims) };
    vec![
        base(1, 2),
        TileProblem {
            progressive: true,
            box_class: ClassShare { share: 0.2, weight: 4.0 },
            offset_correction: 1.0,
            ..base(4, 2)
        },
        TileProblem { projections: Projections { axis: 0.1, plane: 0.4 }, directions: 5, ..base(2, 4) },
        TileProblem { frames: 4, temporal: Some(TemporalKernel::Ema(0.5)), frame_share: 0.3, ..base(1, 2) },
        TileProblem {
            frames: 16,
            temporal: Some(TemporalKernel::Mantiuk),
            kernel: Kernel::Gaussian(0.7),
            ..base(1, 1)
        },
    ]
}

fn made(problem: &TileProblem) -> TileSamples {
    let mut optimizer = TileOptimizer::new(problem.clone()).unwrap();
    optimizer.run();
    optimizer.samples()
}

fn run(problem: &TileProblem, threads: usize) -> Vec<u32> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| made(problem)).coordinates.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for problem in varied() {
        let one = run(&problem, 1);
        for threads in [2, 3, 7] {
            assert_eq!(run(&problem, threads), one, "{threads} threads: {problem:?}");
        }
    }
}

#[test]
fn an_optimisation_resumed_anywhere_continues_with_the_same_bits() {
    for problem in varied() {
        let mut whole = TileOptimizer::new(problem.clone()).unwrap();
        let mut energies = Vec::new();
        let mut saved = Vec::new();
        while whole.iteration() < whole.iterations() {
            saved.push(whole.coordinates().to_vec());
            energies.push(whole.step().to_bits());
        }
        for at in [1, 5, 11] {
            let mut resumed = TileOptimizer::new(problem.clone()).unwrap();
            assert!(resumed.restore(at as u64, &saved[at]));
            for energy in &energies[at..] {
                assert_eq!(resumed.step().to_bits(), *energy);
            }
            assert_eq!(resumed.coordinates(), whole.coordinates());
        }
    }
}

#[test]
fn a_state_of_another_problem_is_refused() {
    let problem = TileProblem { iterations: 4, ..TileProblem::new(16, 1, 2) };
    let mut optimizer = TileOptimizer::new(problem).unwrap();
    let before = optimizer.coordinates().to_vec();
    assert!(!optimizer.restore(1, &before[1..]));
    assert!(!optimizer.restore(5, &before));
    for bad in [f32::NAN, -0.1, 1.0] {
        let mut coordinates = before.clone();
        coordinates[7] = bad;
        assert!(!optimizer.restore(1, &coordinates));
    }
    assert_eq!((optimizer.iteration(), optimizer.coordinates()), (0, &before[..]));
    assert!(optimizer.restore(4, &before));
}

/// Pinned: a change of these bits changes every tile that is made again.
#[test]
fn the_bits_of_a_small_tile() {
    let problem = TileProblem { iterations: 32, ..TileProblem::new(16, 4, 2) };
    let samples = made(&problem);
    let hash = samples.coordinates.iter().fold(0xcbf2_9ce4_8422_2325u64, |hash, &value| {
        (hash ^ u64::from(noisefloor::tile::quantize(value, 16))).wrapping_mul(0x100_0000_01b3)
    });
    assert_eq!(hash, 0x00d4_516a_78be_43f8, "{hash:#x}");
}

/// Every sample stays in the cube, whatever the step.
#[test]
fn samples_stay_inside() {
    let steps = Steps { first: 16.0, last: 16.0, hold: 1.0 };
    let problem = TileProblem { iterations: 8, steps, ..TileProblem::new(16, 2, 3) };
    let samples = made(&problem);
    assert!(samples.coordinates.iter().all(|value| (0.0..1.0).contains(value)));
}

#[test]
fn whatever_is_out_of_range_is_named() {
    let with = |change: fn(&mut TileProblem)| {
        let mut problem = TileProblem::new(16, 4, 2);
        change(&mut problem);
        problem.validate().expect_err("accepted").to_string()
    };
    let cases: [(&str, String); 27] = [
        ("size is 24", with(|p| p.size = 24)),
        ("size is 4", with(|p| p.size = 4)),
        ("size is 2048", with(|p| p.size = 2048)),
        ("spp is 3", with(|p| p.spp = 3)),
        ("spp is 0", with(|p| p.spp = 0)),
        ("spp is 512", with(|p| p.spp = 512)),
        ("dims is 0", with(|p| p.dims = 0)),
        ("dims is 9", with(|p| p.dims = 9)),
        ("frames is 0", with(|p| p.frames = 0)),
        ("frames is 257", with(|p| p.frames = 257)),
        ("iterations is 0", with(|p| p.iterations = 0)),
        ("directions is 17", with(|p| p.directions = 17)),
        ("box class's share is 1.5", with(|p| p.box_class.share = 1.5)),
        ("box class's weight is NaN", with(|p| p.box_class.weight = f32::NAN)),
        ("frame share is -1", with(|p| p.frame_share = -1.0)),
        (
            "box class's share is 0.9; use at most 0.5",
            with(|p| {
                (p.frames, p.temporal) = (16, Some(TemporalKernel::Ema(0.5)));
                (p.box_class.share, p.frame_share) = (0.9, 0.5);
            }),
        ),
        (
            "all classes weigh",
            with(|p| {
                (p.progressive, p.reconstruction) = (true, Kernel::Gaussian(2.5));
                p.box_class = ClassShare { share: 0.5, weight: 1024.0 };
            }),
        ),
        ("probability of an axis is 2", with(|p| p.projections.axis = 2.0)),
        ("probability of a plane is 0.7", with(|p| p.projections = Projections { axis: 0.5, plane: 0.7 })),
        ("first step size is 0", with(|p| p.steps.first = 0.0)),
        ("last step size is inf", with(|p| p.steps.last = f32::INFINITY)),
        ("step size falls is 1.5", with(|p| p.steps.hold = 1.5)),
        ("offset correction is 3", with(|p| p.offset_correction = 3.0)),
        ("threshold exponent is 0", with(|p| p.threshold_exponent = 0.0)),
        ("radius of 11 pixels", with(|p| p.kernel = Kernel::Gaussian(4.0))),
        ("temporal kernel is for an animation", with(|p| p.temporal = Some(TemporalKernel::Mantiuk))),
        ("2^28", with(|p| (p.size, p.spp, p.dims) = (1024, 256, 8))),
    ];
    for (expected, message) in cases {
        assert!(message.contains(expected), "'{message}' does not say '{expected}'");
    }
}

#[test]
fn a_still_tile_has_no_frame_class() {
    let mut problem = TileProblem::new(16, 4, 2);
    (problem.box_class.share, problem.frame_share) = (0.9, 0.5);
    problem.validate().unwrap();
    (problem.frames, problem.temporal) = (2, None);
    problem.validate().unwrap();
}

/// Sums of displacements are of 64 bits: two classes of 6,587 pixels (about) hold 2^18 = 262,144 times the weight 1
/// between them when one weighs 1 and the other 38.8.
#[test]
fn weights_have_a_largest_sum() {
    let weighing = |kernel: Kernel, size: usize, weight: f32| TileProblem {
        kernel: kernel.clone(),
        reconstruction: kernel,
        box_class: ClassShare { share: 0.5, weight },
        ..TileProblem::new(size, 1, 2)
    };
    weighing(Kernel::Gaussian(16.0), 128, 38.0).validate().unwrap();
    assert!(weighing(Kernel::Gaussian(16.0), 128, 40.0).validate().is_err());
    // The perceptual kernel takes every weight that a class may have.
    weighing(Kernel::Perceptual, 16, 1024.0).validate().unwrap();
}
