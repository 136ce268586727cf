//! The cells as comma-separated values: what the report compares of `f32` and `f64`.

use crate::Run;
use anyhow::Result;
use std::fmt::Write;

pub(crate) fn cells(run: &Run) -> Result<String> {
    let mut out = "integrand,degree,n,method,ns_per_sample,rmse_to_f64,difference_from_f64\n".to_owned();
    for cell in &run.cells {
        write!(out, "{},{},{},{},{:.2},", cell.integrand, cell.degree, cell.n, cell.method, cell.ns)?;
        match cell.narrow {
            Some(narrow) => writeln!(out, "{:.5},{:e}", narrow.ratio.value, narrow.difference)?,
            None => writeln!(out, ",")?,
        }
    }
    Ok(out)
}
