//! Regression against the test oracle, in double precision: least squares with a ridge, and leave-one-out.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use noisefloor::control_variate::{Config, Estimator, Ridge, Samples, estimate, workspace_len};
use noisefloor_tests::oracle::{Design, Regression};

fn run(bytes: &[u8]) -> Result<()> {
    let source = &mut Unstructured::new(bytes);
    let dims = 1 + usize::from(u8::arbitrary(source)? % 3);
    let order = 1 + usize::from(u8::arbitrary(source)? % 3);
    let n = 2 + usize::from(u8::arbitrary(source)? % 30);
    // Small ridges amplify roundings, whose size is not this target's question.
    let strength = [1e-3, 1e-2, 1e-1, 1.0_f32][usize::from(u8::arbitrary(source)? % 4)];
    let left_out = bool::arbitrary(source)?;
    let coordinate = |source: &mut Unstructured<'_>| Ok(f32::from(u16::arbitrary(source)?) / 65536.0);
    let value = |source: &mut Unstructured<'_>| Ok(f32::from(i16::arbitrary(source)?) / 256.0);
    let u = (0..n * dims).map(|_| coordinate(source)).collect::<Result<Vec<f32>>>()?;
    let f = (0..n).map(|_| value(source)).collect::<Result<Vec<f32>>>()?;
    let config = Config {
        estimator: if left_out { Estimator::LeaveOneOut } else { Estimator::LeastSquares },
        ridge: Ridge::Fixed(strength),
        ..Config::new(dims, order, 1)
    };
    let mut workspace = vec![f64::NAN; workspace_len::<f64>(&config, n).unwrap()];
    let found = f64::from(estimate(&config, Samples::new(&u, &f), &mut workspace).unwrap().mean[0]);
    let wide = |values: &[f32]| values.iter().copied().map(f64::from).collect::<Vec<f64>>();
    let (design, f) = (Design::legendre(&wide(&u), dims, order), wide(&f));
    let ridge = f64::from(strength) * n as f64;
    let expected = if left_out {
        Regression::leave_one_out(&design, &f, ridge).mean()
    } else {
        Regression::fit(&design, &f, ridge).intercept
    };
    let largest = f.iter().fold(1.0_f64, |largest, f| largest.max(f.abs()));
    assert!((found - expected).abs() < 1e-6 * largest, "{config:?}, {n} samples: {found}, the oracle {expected}");
    Ok(())
}

fuzz_target!(|bytes: &[u8]| {
    // Bytes that ran out are no input.
    run(bytes).ok();
});
