//! The tables as comma-separated values.

use crate::grid;
use noisefloor::recommend::{Method, Sampling, recommend};
use std::fmt::Write;

/// All files.
pub(crate) fn all(cells: &[grid::Row]) -> [(&'static str, String); 2] {
    [("grid.csv", grid(cells)), ("recommended.csv", recommended())]
}

fn grid(rows: &[grid::Row]) -> String {
    let mut out = "integrand,dims,n,estimator,basis,order,repetitions,ratio,half_width,ns,mean_ns\n".to_owned();
    for grid::Row { integrand, dims, n, result } in rows {
        let (method, ratio) = (result.setting.method, result.ratio);
        let basis = format!("{:?}", method.basis).to_lowercase();
        let _ = write!(out, "{integrand},{dims},{n},{},{basis},{},", method.name, result.setting.order);
        let _ = write!(out, "{},{:.4e},{:.2e},", result.repetitions, ratio.value, ratio.half_width);
        let _ = writeln!(out, "{:.1},{:.1}", result.ns, result.mean_ns);
    }
    out
}

/// What the library recommends for independent samples of one pixel: the order of the default estimator, 0 for the
/// mean.
fn recommended() -> String {
    let mut out = "dims,n,order\n".to_owned();
    for dims in 1..=16 {
        for n in grid::COUNTS {
            let best = recommend(dims, n, Sampling::Independent, false, f32::INFINITY).expect("at least one of each");
            let order = if best.method == Method::PlainMean { 0 } else { best.config.order };
            let _ = writeln!(out, "{dims},{n},{order}");
        }
    }
    out
}
