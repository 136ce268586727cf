//! The report: Markdown to read, CSV to plot.

use crate::cells::{COUNTS, Cell, DEGREES, Set, geometric_mean, mean_of, worst};
use crate::run::Run;
use crate::{must_reach, speed};
use anyhow::Result;
use noisefloor_bench::c_abi;
use noisefloor_bench::method::METHODS;
use noisefloor_tests::statistics::{self, Ratio};
use std::fmt::Write;
use std::path::Path;

/// Writes report.md, must_reach.csv (columns divided by semicolons), cells.csv and speed.csv.
pub(crate) fn write(run: &Run, folder: &Path) -> Result<()> {
    let files = [
        ("report.md", markdown(run)?),
        ("must_reach.csv", must_reach::csv(run)),
        ("cells.csv", cells(run)?),
        ("speed.csv", speeds(run)?),
    ];
    for (name, text) in files {
        noisefloor_bench::write(&folder.join(name), text)?;
    }
    Ok(())
}

fn markdown(run: &Run) -> Result<String> {
    let mut out = String::new();
    let machine = &run.machine;
    writeln!(
        out,
        "# Error against speed\n\nWritten by `cargo bench --package noisefloor-bench --bench speed_error`.\n"
    )?;
    writeln!(
        out,
        "- {} with {} threads, one used; load average {}",
        machine.processor,
        machine.threads,
        machine.load()
    )?;
    writeln!(out, "- {} mode, {:.0} s", run.extent.name(), machine.elapsed.as_secs_f64())?;
    writeln!(out, "- through the {}; libnoisefloor.a was {}", run.door.name(), c_abi::STATE)?;
    writeln!(out, "- ratios are RMSE over the plain mean's on the same samples, ± half of the 95 % interval")?;
    writeln!(
        out,
        "- times are medians over chunks of samples, each of which all methods see one right after the other\n"
    )?;
    writeln!(out, "## Must reach\n\n{}", must_reach::table(run))?;
    writeln!(
        out,
        "QR and Cholesky are Algorithm 1 as published, re-implemented and timed in this run. The quoted times were"
    )?;
    writeln!(
        out,
        "measured on another machine: here, the QR re-implementation takes {:.2} of them.\n",
        must_reach::pace(run)
    )?;
    speed_tables(run, &mut out)?;
    for degree in DEGREES {
        summary(run, degree, &mut out)?;
    }
    narrow(run, &mut out)?;
    for degree in DEGREES {
        nine(run, degree, &mut out)?;
    }
    Ok(out)
}

fn speed_tables(run: &Run, out: &mut String) -> Result<()> {
    writeln!(out, "## Nanoseconds per sample\n\nWithout the integrand. In brackets the quartiles.\n")?;
    for (dims, order) in speed::SIZES {
        let header: String = speed::COUNTS.iter().map(|n| format!(" n = {n} |")).collect();
        writeln!(out, "| {dims}D, order {order} | through |{header}\n|---|---|{}", "---|".repeat(speed::COUNTS.len()))?;
        let here: Vec<_> = run.speeds.iter().filter(|speed| (speed.dims, speed.order) == (dims, order)).collect();
        for first in here.iter().filter(|speed| speed.n == speed::COUNTS[0]) {
            write!(out, "| {} | {} |", first.name, first.door)?;
            for speed in here.iter().filter(|speed| (&speed.name, speed.door) == (&first.name, first.door)) {
                write!(out, " {:.1} ({:.1}-{:.1}) |", speed.ns, speed.quartiles[0], speed.quartiles[1])?;
            }
            writeln!(out)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Worst ratios and geometric means of every method.
fn summary(run: &Run, degree: usize, out: &mut String) -> Result<()> {
    let at = |method: &'static str, set: Set| {
        run.cells.iter().filter(move |cell| cell.method == method && cell.degree == degree && cell.set == set)
    };
    writeln!(out, "## Order {degree}, at most 136 terms\n\nWorst ratio over n = 8 to 256, and where.\n")?;
    writeln!(out, "| | nine | held out | adversarial |\n|---|---|---|---|")?;
    for method in &METHODS[1..] {
        write!(out, "| {} |", method.name)?;
        for set in Set::ALL {
            if let Some(cell) = worst(at(method.name, set)) {
                let Ratio { value, half_width } = cell.ratio;
                write!(out, " {value:.3} ± {half_width:.3} ({}, {}) |", cell.integrand, cell.n)?;
            }
        }
        writeln!(out)?;
    }
    writeln!(out, "\nGeometric mean over the nine.\n")?;
    let header: String = COUNTS.iter().map(|n| format!(" n = {n} |")).collect();
    writeln!(out, "| |{header}\n|---|{}", "---|".repeat(COUNTS.len()))?;
    for method in &METHODS[1..] {
        write!(out, "| {} |", method.name)?;
        for n in COUNTS {
            let mean = geometric_mean(at(method.name, Set::Nine).filter(|cell| cell.n == n));
            write!(out, " {:.3} ± {:.3} |", mean.value, mean.half_width)?;
        }
        writeln!(out)?;
    }
    writeln!(out)?;
    Ok(())
}

/// What `f32` accumulation costs and saves.
fn narrow(run: &Run, out: &mut String) -> Result<()> {
    writeln!(
        out,
        "## f32 against f64\n\nOver all integrands and n, on the same samples: geometric mean of the f32 path's"
    )?;
    writeln!(
        out,
        "RMSE over the f64 path's (without integrands that f64 integrates exactly), the largest RMS difference"
    )?;
    writeln!(out, "between the two estimates over the plain mean's RMSE, and the f32 path's time over the other's.\n")?;
    writeln!(out, "| | order | RMSE | difference | where | time | largest |\n|---|---|---|---|---|---|---|")?;
    for method in METHODS.iter().filter(|method| method.narrow) {
        for degree in DEGREES {
            let at = |name: &str| -> Vec<&Cell> {
                run.cells.iter().filter(|cell| cell.method == name && cell.degree == degree).collect()
            };
            let (narrow, wide) = (at(method.name), at(method.name.trim_end_matches(" f32")));
            let ratios = narrow.iter().filter_map(|cell| Some(cell.narrow?.ratio));
            let mean = mean_of(ratios.filter(|ratio| ratio.value.is_finite()));
            let difference = |cell: &Cell| cell.narrow.map_or(f64::NAN, |narrow| narrow.difference);
            let Some(largest) = narrow.iter().max_by(|a, b| difference(a).total_cmp(&difference(b))) else { continue };
            let times: Vec<f64> = narrow.iter().zip(&wide).map(|(narrow, wide)| narrow.ns / wide.ns).collect();
            writeln!(
                out,
                "| {} | {degree} | {:.4} | {:.2e} | {}, {} | {:.2} | {:.2} |",
                method.name,
                mean.value,
                difference(largest),
                largest.integrand,
                largest.n,
                statistics::geometric_mean(&times),
                times.iter().copied().fold(0.0, f64::max)
            )?;
        }
    }
    writeln!(out)?;
    Ok(())
}

/// Each of the nine.
fn nine(run: &Run, degree: usize, out: &mut String) -> Result<()> {
    writeln!(
        out,
        "## Each of the nine, order {degree}\n\nRatio; nanoseconds per sample; nanoseconds that a sample must"
    )?;
    writeln!(out, "cost for the method to be worth its time (- if it is not at any cost).\n")?;
    let methods = &METHODS[1..8];
    let header: String = methods.iter().map(|method| format!(" {} |", method.name)).collect();
    writeln!(out, "| integrand | n |{header}\n|---|---|{}", "---|".repeat(methods.len()))?;
    let here: Vec<_> = run.cells.iter().filter(|cell| cell.degree == degree && cell.set == Set::Nine).collect();
    for first in here.iter().filter(|cell| cell.method == METHODS[0].name) {
        write!(out, "| {} | {} |", first.integrand, first.n)?;
        for method in methods {
            let same = |cell: &&&Cell| (cell.integrand, cell.n, cell.method) == (first.integrand, first.n, method.name);
            if let Some(cell) = here.iter().find(same) {
                let cost = cell.break_even();
                let cost = if cost.is_finite() { format!("{cost:.0}") } else { "-".to_owned() };
                write!(out, " {:.3}; {:.0}; {cost} |", cell.ratio.value, cell.ns)?;
            }
        }
        writeln!(out)?;
    }
    writeln!(out)?;
    Ok(())
}

fn cells(run: &Run) -> Result<String> {
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

fn speeds(run: &Run) -> Result<String> {
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
