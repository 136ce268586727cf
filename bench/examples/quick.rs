use noisefloor::control_variate::*;
use std::time::Instant;
fn rng(s: &mut u64) -> f32 {
    *s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    ((*s >> 40) as f32) / 16777216.0
}
fn f(u: &[f32]) -> f32 {
    u.iter().map(|x| (-x).exp()).product()
}
fn main() {
    let mut s = 7u64;
    for (d, o) in [(2usize, 2usize), (3, 2), (2, 3), (1, 3), (5, 2), (15, 2)] {
        for n in [8usize, 16, 64, 256] {
            let exact = (1.0 - (-1f64).exp()).powi(d as i32);
            let reps = if d == 15 { 20 } else { 2000 };
            let us: Vec<Vec<f32>> = (0..reps).map(|_| (0..n * d).map(|_| rng(&mut s)).collect()).collect();
            let fs: Vec<Vec<f32>> = us.iter().map(|u| u.chunks(d).map(f).collect()).collect();
            for est in [
                Estimator::Robust,
                Estimator::LeastSquares,
                Estimator::LeaveOneOut,
                Estimator::KFold,
                Estimator::GradientDescent,
            ] {
                let mut c = Config::new(d, o, 1);
                c.estimator = est;
                let mut ws = vec![0f64; workspace_len::<f64>(&c, n).unwrap()];
                let (mut e, mut em) = (0.0, 0.0);
                let mut best = f64::MAX;
                for _ in 0..5 {
                    e = 0.0;
                    em = 0.0;
                    let t = Instant::now();
                    for (u, f) in us.iter().zip(&fs) {
                        let r = estimate(&c, Samples::new(u, f), &mut ws).unwrap();
                        e += (r.mean[0] as f64 - exact).powi(2);
                    }
                    best = best.min(t.elapsed().as_secs_f64());
                }
                for f in &fs {
                    em += (f.iter().map(|&x| x as f64).sum::<f64>() / n as f64 - exact).powi(2);
                }
                println!(
                    "d{d} o{o} n{n} {est:?}: ratio {:.3} ns/sample {:.1}",
                    (e / em).sqrt(),
                    best / (reps * n) as f64 * 1e9
                );
            }
        }
    }
}
