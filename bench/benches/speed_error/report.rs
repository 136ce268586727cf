//! The tables as comma-separated values.

use crate::run::Run;
use anyhow::Result;
use std::fmt::Write;

pub(crate) fn cells(run: &Run) -> Result<String> {
    let mut out = "set,integrand,dims,degree,order,n,method,repetitions,rmse,mean_rmse,ratio,ratio_half_width,\
                   ns_per_sample,mean_ns_per_sample,efficiency,break_even_ns,rmse_to_f64,difference_from_f64\n"
        .to_owned();
    for cell in &run.cells {
        write!(out, "{},{},{},{},{},", cell.set.name(), cell.integrand, cell.dims, cell.degree, cell.order)?;
        write!(out, "{},{},{},{:e},{:e},", cell.n, cell.method, cell.repetitions, cell.rmse(), cell.mean_rmse)?;
        write!(out, "{:.5},{:.5},{:.2},", cell.ratio.value, cell.ratio.half_width, cell.ns)?;
        write!(out, "{:.2},{:e},{:.1},", cell.mean_ns, cell.efficiency(), cell.break_even())?;
        match cell.narrow {
            Some(narrow) => writeln!(out, "{:.5},{:e}", narrow.ratio.value, narrow.difference)?,
            None => writeln!(out, ",")?,
        }
    }
    Ok(out)
}

pub(crate) fn speeds(run: &Run) -> Result<String> {
    let mut out = "what,name,door,dims,order,n,ns,lower_quartile,upper_quartile\n".to_owned();
    for (what, list) in [("per sample", &run.speeds), ("per solution", &run.solves)] {
        for speed in list {
            let [lower, upper] = speed.quartiles;
            let name = speed.name.replace(',', "");
            write!(out, "{what},{name},{},{},{},{},", speed.door, speed.dims, speed.order, speed.n)?;
            writeln!(out, "{:.2},{lower:.2},{upper:.2}", speed.ns)?;
        }
    }
    Ok(out)
}
