//! The smallest case of each thing, by hand.

use crate::table_support::{memory, table};
use noisefloor::Error;
use noisefloor::basis::{Basis, Family};
use noisefloor::control_variate::{
    Accumulator, Color, Config, Estimator, Image, Optimizer, Regressor, Ridge, Samples, Solver, block_workspace_len,
    estimate, gradient_descent, image_workspace_len,
};
use noisefloor::minibatch::table::{Kernel, Portable, Shard, allocate, check_importances, importance_len, saved_len};
use noisefloor::minibatch::{Batch, Gradient, System, Table, gradient_len, importance};
use noisefloor::mis::{self, OptimalMis};
use noisefloor::recommend::{Method, Sampling, recommend};
use noisefloor::rng::Rng;
use noisefloor::tile::{self, Builtin, Header, Sampler, Shape, Tile};
use noisefloor::warp;

#[test]
fn errors_say_what_was_wrong() {
    let error: Box<dyn std::error::Error> = Error::Range.into();
    assert!(error.to_string().contains("outside its documented range"));
    assert_eq!(Error::NotFinite.message(), "an input value is NaN or infinite");
}

#[test]
fn recommendations() {
    let method = |samples, sampling, share| recommend(2, samples, sampling, share, f32::INFINITY).unwrap().method;
    assert_eq!(method(64, Sampling::Independent, false), Method::PerPixel);
    assert_eq!(method(64, Sampling::Stratified, false), Method::PlainMean);
    assert_eq!(method(4, Sampling::Stratified, true), Method::Shared);
    let filtered = |sampling| recommend(2, 16, sampling, true, f32::INFINITY).unwrap().filtered_error;
    assert!(filtered(Sampling::Stratified) < filtered(Sampling::Independent));
}

#[test]
fn warped_points() {
    assert!((warp::uniform_cone(glam::Vec2::X, 0.5).z - 0.5).abs() < 1e-6);
    assert_eq!(warp::uniform_hemisphere(glam::Vec2::new(0.0, 0.5)), glam::Vec3::Z);
    assert_eq!(warp::uniform_sphere(glam::Vec2::new(0.0, 0.5)), glam::Vec3::Z);
}

// Tiles.

const SHAPE: Shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
const PAYLOAD: [u8; 8] = [0, 64, 128, 192, 64, 0, 192, 128];

#[test]
fn a_shape() {
    let shape = Shape { size: 64, spp: 4, bits: 16, ..SHAPE };
    assert!(shape.is_valid() && !Shape { spp: 3, ..shape }.is_valid());
    assert_eq!((shape.coordinates(), shape.payload_bytes()), (64 * 64 * 4 * 2, 64 * 64 * 4 * 2 * 2));
}

#[test]
fn a_tile() {
    let tile = Tile::new(SHAPE, &PAYLOAD).unwrap();
    assert_eq!((tile.shape(), tile.payload()), (SHAPE, &PAYLOAD[..]));
    assert_eq!(Tile::resume(tile.shape(), tile.payload()), tile);
    assert_eq!(tile.value(0, 0, 1, 0, 0), Some(128.5 / 256.0));
    assert_eq!(tile.value(0, 1, 0, 0, 1), Some(0.5 / 256.0));
    let header = Header::new(SHAPE, 7, "").unwrap();
    assert_eq!((header.shape(), header.seed()), (SHAPE, 7));
    assert_eq!((Builtin::from_id(10), Builtin::Size64Spp1Dims2.name()), (Some(Builtin::Size64Spp1Dims2), "64_1SPP_2D"));
    assert!(Builtin::Size64Spp1Dims2.bytes().unwrap().starts_with(&tile::MAGIC));
}

#[test]
fn a_sampler_and_its_state() {
    let tile = Tile::new(SHAPE, &PAYLOAD).unwrap();
    let sampler = Sampler::pixel(&tile, 1, 0, 0, 0);
    assert_eq!(sampler.tile.shape(), SHAPE);
    assert_eq!(Sampler::pixel(&tile, 1, 1, 0, 0).draw(), [192.5 / 256.0, 128.5 / 256.0]);
    assert_ne!(sampler.domain(1), sampler.domain(2));
    assert_ne!(sampler.domain(1).domain(2), sampler.domain(2).domain(1));
    assert_eq!(Sampler::pixel(&tile, 0, 0, 0, 0).moved(1, 1, 0), Sampler::pixel(&tile, 1, 1, 0, 0));
    let mut u = [0.0; 2];
    // The root within the tile's own samples, and continued by a sequence.
    assert!(sampler.draw_stored(&mut u) && !Sampler::pixel(&tile, 1, 0, 0, 1).draw_stored(&mut u));
    sampler.domain(7).draw_into(&mut u);
    assert_eq!(u, sampler.domain(7).draw());

    let Sampler { x, y, index, .. } = Sampler::pixel(&tile, 3, 2, 0, 5);
    assert_eq!((x, y, index), (1, 0, 5));
}

// Minibatches.

fn one_to_four() -> Table<Vec<f32>, Vec<i64>> {
    table(&[1.0, 2.0, 3.0, 4.0], 0.2)
}

#[test]
fn a_table() {
    let mut table = one_to_four();
    assert_eq!((table.items(), table.capacity(), table.total()), (4, 16, 10.0));
    assert_eq!((table.importance(3), table.importance(4)), (4.0, 0.0));
    assert!((table.probability(3) - (0.8 * 0.4 + 0.2 * 0.25)).abs() < 1e-6);
    assert_eq!((importance_len(17), saved_len(1000)), (32, 4032));
    let state = table.state();
    assert_eq!((state.items, state.uniform_fraction), (4, 0.2));
    let (importance, sums) = memory(4);
    assert!(Table::resume(importance, sums, state).is_ok());
    assert!(table.check_items(&[0, 3]).is_ok());
    assert_eq!(table.check_items(&[4]), Err(Error::Range));
    assert_eq!((check_importances(&[0.0, 1.0]), check_importances(&[-1.0])), (Ok(()), Err(Error::Range)));

    let (mut index, mut weight) = ([0; 8], [0.0; 8]);
    table.draw(&mut Rng::seed(1), &mut index, Some(&mut weight)).unwrap();
    assert!((weight[0] - 1.0 / (4.0 * table.probability(index[0]))).abs() < 1e-5);
    table.draw_stratified(&mut Rng::seed(1), &mut index, None).unwrap();
    assert!(index.contains(&3), "expected 2.96 times: at least twice");

    table.update(&[0], &[5.0], 0.5).unwrap();
    assert_eq!(table.importance(0), 3.0);
    table.add_epsilon(0.5).unwrap();
    assert_eq!((table.importance(0), table.importance(1)), (3.5, 2.5));
    table.append(&[9.0]).unwrap();
    assert_eq!((table.items(), table.importance(4)), (5, 9.0));
    table.set_uniform_fraction(1.0).unwrap();
    assert_eq!(table.probability(3), 0.2);
}

/// A kernel that is named is the one that a table has from the start.
#[test]
fn the_portable_kernel() {
    assert_eq!(Portable::total(&[0.5; 16]), 8.0);
    let seed = || Rng::seed(1);
    let (mut table, mut again) = (one_to_four(), one_to_four().with_kernel::<Portable>());
    let (mut a, mut b) = ([0; 8], [0; 8]);
    table.draw(&mut seed(), &mut a, None).unwrap();
    again.draw(&mut seed(), &mut b, None).unwrap();
    assert_eq!(a, b);
    table.draw_stratified(&mut seed(), &mut a, None).unwrap();
    again.draw_stratified(&mut seed(), &mut b, None).unwrap();
    assert_eq!(a, b);
    table.draw_shard(&table.shard(), &mut seed(), &mut a, None).unwrap();
    again.draw_shard(&again.shard(), &mut seed(), &mut b, None).unwrap();
    assert_eq!(a, b);
    table.draw_distinct(&mut seed(), &mut a[..3], None).unwrap();
    again.draw_distinct(&mut seed(), &mut b[..3], None).unwrap();
    assert_eq!(a, b);
    table.update(&[0], &[5.0], 0.3).unwrap();
    again.update(&[0], &[5.0], 0.3).unwrap();
    table.add_epsilon(0.5).unwrap();
    again.add_epsilon(0.5).unwrap();
    assert_eq!((table.importance(0), table.total()), (again.importance(0), again.total()));
}

#[test]
fn shards() {
    let shard = |importance, items| Shard { importance, items };
    assert_eq!(Shard::sum([shard(3.0, 10), shard(1.0, 20)]), Ok(shard(4.0, 30)));
    assert_eq!(Shard::sum([shard(-1.0, 10)]), Err(Error::Range));
    assert_eq!(Shard::sum([]), Err(Error::NoSamples));
    assert_eq!(one_to_four().shard(), shard(10.0, 4));
    let mut counts = [0; 2];
    allocate([shard(3.0, 10), shard(1.0, 10)].into_iter(), 0.0, &mut Rng::seed(1), 8, &mut counts).unwrap();
    assert_eq!(counts, [6, 2]);
}

#[test]
fn importances() {
    let close = |a: f32, b: f32| (a - b).abs() < 1e-6;
    assert!(close(importance::cross_entropy_loss(&[0.0, 0.0], 0), 2.0_f32.ln()));
    let mut gradient = [0.0; 2];
    importance::cross_entropy_gradient(&[0.0, 0.0], 0, &mut gradient).unwrap();
    assert_eq!(gradient, [-0.5, 0.5]);
    assert_eq!(importance::squared_error(&[1.0, 2.0], &[4.0, 6.0]), 10.0);
    assert_eq!(importance::gradient(&[3.0, -4.0]), 5.0);
}

#[test]
fn a_gradient() {
    let fresh = || Gradient::new([0.0; gradient_len(1, 1)], 1, 1).unwrap();
    let mut gradient = fresh();
    assert_eq!((gradient_len(4, 1000), *gradient.system()), (5000, System::new(1)));
    let batch = Batch::new(100, 1, &[0.01], &[0]).unwrap();
    assert_eq!((batch.len(), batch.techniques()), (1, 1));
    gradient.estimate(&batch, mis::Solver::Balance, 0.5, &[3.0], &mut [0.0]).unwrap();
    assert_ne!(gradient, fresh());
    gradient.reset();
    assert_eq!(gradient, fresh());
    assert_eq!(Gradient::resume([0.0; 2], System::new(1), 1), Ok(fresh()));
    assert_eq!(Gradient::new([0.0; 2], 1, 2).err(), Some(Error::Memory));
    // The technique that drew an item cannot give it the probability 0.
    assert_eq!(Batch::new(100, 2, &[0.0, 0.02], &[0]).err(), Some(Error::Range));
}

// Multiple importance sampling.

#[test]
fn heuristics() {
    let (pdf, counts) = ([1.0, 3.0], [1, 1]);
    assert_eq!(mis::balance(&pdf, &counts, 1), Ok(0.75));
    assert_eq!(mis::power(&pdf, &counts, 1, 2.0), Ok(0.9));
    assert_eq!(mis::cutoff(&pdf, &counts, 0, 0.5), Ok(0.0));
    assert_eq!(mis::maximum(&pdf, &counts, 1), Ok(1.0));
    assert_eq!(mis::optimal(&pdf, &counts, 1, &[0.0, 0.0], 2.0), Ok(0.75));
}

#[test]
fn optimal_mis() {
    assert_eq!((mis::len(2, 1), mis::Solver::default()), (12, mis::Solver::Ridge(2.0)));
    let empty = OptimalMis::new([0.0; mis::len(2, 1)], &[1, 1], 1).unwrap();
    let mut omis = empty.clone();
    // f = 3 p_0, a combination of the densities: exact.
    omis.add(0, &[1.0, 0.5], &[3.0]).unwrap();
    omis.add(1, &[1.0, 1.5], &[3.0]).unwrap();
    let (mut estimate, mut alpha) = ([0.0], [0.0; 2]);
    omis.solve(mis::Solver::Plain, &mut estimate).unwrap();
    omis.alpha(mis::Solver::Plain, &mut alpha).unwrap();
    assert!((estimate[0] - 3.0).abs() < 1e-5 && (alpha[0] - 3.0).abs() < 1e-5 && alpha[1].abs() < 1e-5);
    omis.decay(0.5).unwrap();
    omis.reset();
    assert_eq!(omis, empty);
}

// Control variates.

#[test]
fn configurations() {
    let config = Config::new(3, 2, 1);
    assert_eq!((config.estimator, config.terms()), (Estimator::Robust, Ok(10)));
    assert_eq!(Config { basis: Family::Step, ..Config::new(2, 2, 1) }.terms(), Ok(6));
    // The constant, 5 shared, and for each of six slices an indicator and 5 of its own.
    assert_eq!(Config { slices: 6, ..Config::new(3, 2, 3) }.terms(), Ok(42));
    let base = Config::new(2, 2, 3);
    for config in [
        Config { estimator: Estimator::KFold, ..base },
        Config { estimator: Estimator::LeastSquares, solver: Solver::SquareRoot, ..base },
        Config { color: Color::LuminanceRatio, ..base },
        Config { estimator: Estimator::GradientDescent, optimizer: Optimizer::Adam, ..base },
        Config { estimator: Estimator::LeaveOneOut, ridge: Ridge::Fixed(0.02), ..base },
    ] {
        assert_eq!(config.terms(), Ok(6));
    }
    assert_eq!(Basis::new(Family::Legendre, 2, 3, 0).unwrap().columns(), 9);
    assert!(Basis::new(Family::Sine, 3, 2, 0).is_ok() && Basis::new(Family::Sine, 16, 7, 0).is_err());
    assert!(Samples::new(&[0.1, 0.7, 0.5, 0.2], &[1.0, 3.0]).controls.is_empty());
    assert!(block_workspace_len(&Config::new(2, 2, 1), 64, 1).unwrap() > 64);
    assert!(image_workspace_len(&Config::new(2, 2, 1), &Image::new(8, 8), 1).unwrap() > 64);
}

#[test]
fn an_image() {
    let image = Image { frames: 2, ..Image::new(640, 480) };
    assert_eq!((image.width, image.height, image.window), (640, 480, 0));
    assert!(Image::unordered(100).unordered);
}

#[test]
fn estimates() {
    let mut workspace = [0.0_f64; 64];
    let plain = estimate(&Config::new(1, 0, 1), Samples::new(&[0.2, 0.6], &[1.0, 3.0]), &mut workspace).unwrap();
    assert_eq!((plain.mean[0], plain.std_error[0], plain.samples), (2.0, 1.0, 2));
    let config = Config { estimator: Estimator::GradientDescent, iterations: 200, ..Config::new(1, 1, 1) };
    let (samples, mut slope) = (Samples::new(&[0.1, 0.3, 0.9], &[1.1, 1.3, 1.9]), [0.0]);
    gradient_descent(&config, samples, &mut slope, &mut workspace).unwrap();
    assert!((slope[0] - (1.0_f32 / 12.0).sqrt()).abs() < 0.01);
}

#[test]
fn an_accumulator() {
    let config = Config::new(2, 2, 1);
    let mut state = Accumulator::<f64>::new(&config).unwrap();
    assert!(state.len() == 112 && !state.is_empty() && *state.config() == config);
    assert_eq!(state.reset(&mut [0.0; 111]), Err(Error::Memory));
    let mut sums = vec![f64::NAN; 112];
    state.reset(&mut sums).unwrap();
    state.add(&mut sums, Samples::new(&[0.1, 0.7], &[2.0])).unwrap();
    // Another buffer, too short.
    assert_eq!(state.add(&mut sums[1..], Samples::new(&[0.3, 0.7], &[1.3])), Err(Error::Memory));
    assert_eq!(state.samples(), 1);
    let (mut all, mut merged) = (state, sums.clone());
    all.merge(&mut merged, &state, &sums).unwrap();
    assert_eq!(all.samples(), 2);
    assert_eq!(state.estimate(&sums, &mut vec![0.0; state.workspace_len()]).unwrap().mean[0], 2.0);
    state.reset(&mut sums).unwrap();
    assert_eq!(state.samples(), 0);
    let config = Config { estimator: Estimator::LeaveOneOut, ..config };
    assert_eq!(Accumulator::<f64>::new(&config).err(), Some(Error::Unsupported));
}

#[test]
fn a_regressor() {
    // Order 2 of 3 coordinates has 10 terms.
    assert!(Regressor::<3, 10, 1>::new(Family::Legendre, 2).is_ok());
    assert!(Regressor::<3, 9, 1>::new(Family::Legendre, 2).is_err());
    let mut regressor = Regressor::<1, 2, 1>::new(Family::Legendre, 1).unwrap();
    assert_eq!(regressor.add(&[1.5], &[2.0]), Err(Error::Range));
    for u in [0.1, 0.2, 0.7] {
        regressor.add(&[u], &[3.0 * u]).unwrap();
    }
    assert_eq!(regressor.samples(), 3);
    assert!((regressor.estimate(1e-9).unwrap().mean[0] - 1.5).abs() < 1e-6);
}
