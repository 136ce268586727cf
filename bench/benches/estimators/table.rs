//! The tables as comma-separated values.

use crate::race::Result;
use crate::{convergence, fits, grid};
use noisefloor::recommend::{Method, Sampling, recommend};
use std::fmt::Write;

/// All files.
pub(crate) fn all(cells: &[grid::Row], points: &[convergence::Row], fits: &[fits::Row]) -> [(&'static str, String); 4] {
    [
        ("grid.csv", grid(cells)),
        ("convergence.csv", convergence(points)),
        ("fits.csv", curves(fits)),
        ("recommended.csv", recommended()),
    ]
}

const MEASURED: &str = "estimator,basis,slices,order,terms,repetitions,rmse,ratio,half_width,ns,mean_ns,efficiency\n";

/// The columns of [`MEASURED`]. Efficiency: 1 / (MSE x seconds of an estimate), samples for free.
fn measured(result: &Result, n: usize) -> String {
    let (method, ratio) = (result.setting.method, result.ratio);
    let mut text = format!("{},{},", method.name, format!("{:?}", method.basis).to_lowercase());
    let _ = write!(text, "{},{},{},{},", method.slices, result.setting.order, result.terms, result.repetitions);
    let efficiency = 1e9 / (result.rmse().powi(2) * result.ns * n as f64);
    let _ = write!(text, "{:.4e},{:.4e},{:.2e},", result.rmse(), ratio.value, ratio.half_width);
    let _ = writeln!(text, "{:.1},{:.1},{efficiency:.3e}", result.ns, result.mean_ns);
    text
}

fn grid(rows: &[grid::Row]) -> String {
    let mut out = format!("set,integrand,dims,n,{MEASURED}");
    for row in rows {
        let _ = write!(out, "{},{},{},{},{}", row.set, row.integrand, row.dims, row.n, measured(&row.result, row.n));
    }
    out
}

fn convergence(rows: &[convergence::Row]) -> String {
    let mut out = format!("figure,panel,x,n,deviation,{MEASURED}");
    for row in rows {
        let _ = write!(out, "{},{},{},{},{:.4e},", row.figure, row.panel, row.x, row.n, row.deviation);
        out += &measured(&row.result, row.n);
    }
    out
}

fn curves(rows: &[fits::Row]) -> String {
    let orders = fits::ORDERS.map(|order| format!("order {order}")).join(",");
    let mut out = format!("function,samples,x,value,mean,{orders}\n");
    for row in rows {
        let fits = row.fits.map(|fit| format!("{fit:.4}")).join(",");
        let _ =
            writeln!(out, "{},{},{:.4},{:.4},{:.4},{fits}", row.function, fits::SAMPLES, row.x, row.value, row.mean);
    }
    out
}

/// What the library recommends for independent samples of one pixel: the order of the default estimator, 0 for the
/// mean.
fn recommended() -> String {
    let mut out = "dims,n,order\n".to_owned();
    for dims in 1..=16 {
        for n in grid::COUNTS {
            let best = recommend(dims, n, Sampling::Independent, false, 0.0).expect("at least one of each");
            let order = if best.method == Method::PlainMean { 0 } else { best.config.order };
            let _ = writeln!(out, "{dims},{n},{order}");
        }
    }
    out
}
