use noisefloor::control_variate::*;
fn rng(s: &mut u64) -> f32 {
    *s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    ((*s >> 40) as f32) / 16777216.0
}
fn f(u: &[f32]) -> f32 {
    u.iter().map(|x| (-x).exp()).product()
}
fn main() {
    let mut s = 7u64;
    for (d, o) in [(2usize, 2usize), (1, 3), (5, 2)] {
        for n in [8usize, 16, 64, 256] {
            let exact = (1.0 - (-1f64).exp()).powi(d as i32);
            let reps = 1000;
            let us: Vec<Vec<f32>> = (0..reps).map(|_| (0..n * d).map(|_| rng(&mut s)).collect()).collect();
            let fs: Vec<Vec<f32>> = us.iter().map(|u| u.chunks(d).map(f).collect()).collect();
            let mut em = 0.0;
            for f in &fs {
                em += (f.iter().map(|&x| x as f64).sum::<f64>() / n as f64 - exact).powi(2);
            }
            for (est, solver) in [
                (Estimator::Robust, Solver::Auto),
                (Estimator::KFold, Solver::Auto),
                (Estimator::LeastSquares, Solver::Auto),
                (Estimator::LeastSquares, Solver::SquareRoot),
                (Estimator::GradientDescent, Solver::Auto),
                (Estimator::Incremental, Solver::Auto),
            ] {
                let mut c = Config::new(d, o, 1);
                c.estimator = est;
                c.solver = solver;
                let st = State::<f64>::new(&c).unwrap();
                let mut ws = vec![0f64; st.workspace_len()];
                let mut sums = vec![0f64; st.len()];
                let mut sums2 = vec![0f64; st.len()];
                let (mut e, mut e2, mut es) = (0.0, 0.0, 0.0);
                let mut dm = 0f64;
                let t = std::time::Instant::now();
                for (u, f) in us.iter().zip(&fs) {
                    let mut a = Accumulator::new(&c, &mut sums[..]).unwrap();
                    for (u, f) in u.chunks(d).zip(f.chunks(1)) {
                        a.add(Samples::new(u, f)).unwrap();
                    }
                    let r = a.estimate(&mut ws).unwrap();
                    e += (r.mean[0] as f64 - exact).powi(2);
                    es += (r.std_error[0] as f64).powi(2);
                }
                let t = t.elapsed().as_secs_f64();
                for (u, f) in us.iter().zip(&fs) {
                    let h = n / 2;
                    let mut a = Accumulator::new(&c, &mut sums[..]).unwrap();
                    let mut b = Accumulator::new(&c, &mut sums2[..]).unwrap();
                    a.add(Samples::new(&u[..h * d], &f[..h])).unwrap();
                    b.add(Samples::new(&u[h * d..], &f[h..])).unwrap();
                    a.merge(&b).unwrap();
                    let r = a.estimate(&mut ws).unwrap();
                    let mut w = Accumulator::new(&c, &mut sums2[..]).unwrap();
                    w.add(Samples::new(u, f)).unwrap();
                    let r2 = w.estimate(&mut ws).unwrap();
                    dm = dm.max((r.mean[0] - r2.mean[0]).abs() as f64 / exact);
                    e2 += (r.mean[0] as f64 - exact).powi(2);
                }
                println!(
                    "d{d} o{o} n{n} {est:?} {solver:?}: ratio {:.3} merged {:.3} (diff {dm:.1e}) se/rmse {:.2} ns/sample {:.0}",
                    (e / em).sqrt(),
                    (e2 / em).sqrt(),
                    (es / e).sqrt(),
                    t / (reps * n) as f64 * 1e9
                );
            }
        }
    }
}
