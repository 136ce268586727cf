//! A training step's sampling, 64 draws and 64 updates, by tables of importances and by their public peers:
//! `cargo bench --package noisefloor-bench --bench minibatch_table`.
//!
//! All methods take turns, a chunk of steps at a time, so that a busy machine slows all alike. "Warm" steps follow each
//! other at once; before each "cold" draw and update 64 MB are read, as a training step does. Prints medians
//! and writes every chunk's times (times.csv), the tables' sizes (items.csv) and what many updates did to them
//! (drift.csv).

mod drift;
mod methods;
mod times;

use anyhow::Result;
use clap::Parser;
use methods::{BATCH, Method};
use noisefloor::rng::Rng;
use noisefloor_bench::{Extent, Options, c_abi};
use std::fmt::Write as _;
use times::{Chunks, Memory, Times, median};

/// Steps of a chunk: enough to bring a table of a million items into the caches.
const STEPS: usize = 1000;

/// The CSV files.
struct Tables {
    times: String,
    items: String,
    drift: String,
}

fn main() -> Result<()> {
    let options = Options::parse();
    println!("libnoisefloor.a is {}", c_abi::STATE);
    if !c_abi::LINKED {
        println!("the C functions are skipped: run `cargo xtask library` first");
    }
    let extent = options.extent();
    let all: &[u32] = &[1000, 10_000, 60_000, 1_000_000, 10_000_000];
    let sizes = extent.choose(&[1000, 30_000][..], all, all);
    let mut tables = Tables {
        times: "items,cache,method,chunk,draw,update,step\n".to_owned(),
        items: "items,method,bytes,epsilon\n".to_owned(),
        drift: "items,updates,method,changed,compared,risen,lost,risen_or_lost,error\n".to_owned(),
    };
    let memory = Memory::new();
    for &items in sizes {
        measure(extent, items, &memory, &mut tables)?;
    }
    let updates = extent.choose(100_000, 10_000_000, 100_000_000);
    println!("\n{} items after {updates} updates", drift::ITEMS);
    for drift in drift::measure(updates) {
        let drift::Drift { method, changed, compared, risen, lost, error } = drift;
        println!(
            "{method:28} {changed} of {compared} numbers changed, {risen} of importance 0 drawn, {lost} lost, \
             probabilities to {error:.1e}"
        );
        let wrong = risen + lost;
        writeln!(
            tables.drift,
            "{},{updates},{method},{changed},{compared},{risen},{lost},{wrong},{error:e}",
            drift::ITEMS
        )?;
    }
    let Tables { times, items, drift } = tables;
    options.write("minibatch_table", &[("times.csv", times), ("items.csv", items), ("drift.csv", drift)])
}

/// One size.
fn measure(extent: Extent, items: u32, memory: &Memory, tables: &mut Tables) -> Result<()> {
    let mut rng = Rng::seed(3);
    let q: Vec<f32> = (0..items).map(|_| libm::expf(4.0 * rng.uniform_f32() - 2.0)).collect();
    let mut methods = methods::updated(&q);
    let mut steps = vec![extent.choose(50, STEPS, STEPS); methods.len()];
    let repeat = extent.choose(1, 4, 16);
    println!("\n{items} items; ns of a draw / of an update, us of a step of {BATCH} of both");
    // A chunk of the alias table's is one to ten new tables.
    methods.push(methods::rebuilt(&q));
    steps.push((1_000_000 / items as usize).clamp(1, 10));
    let count = if items > 1_000_000 { 2 } else { 6 } * repeat;
    let warm = times::measure(&mut methods, &Chunks { count, steps: &steps, cold: None });
    for (method, times) in methods.iter().zip(&warm) {
        record(items, "warm", method.as_ref(), times, &mut tables.times)?;
    }
    let alias = methods.pop();
    steps.fill(1);
    let cold = times::measure(&mut methods, &Chunks { count: 12 * repeat, steps: &steps, cold: Some(memory) });
    for (method, times) in methods.iter().zip(&cold) {
        record(items, "cold", method.as_ref(), times, &mut tables.times)?;
    }
    methods.extend(alias);
    for method in &mut methods {
        let epsilon = times::add_epsilon(method.as_mut(), items);
        let epsilon = epsilon.map_or(String::new(), |nanoseconds| format!("{nanoseconds:.4}"));
        let (name, bytes) = (method.name(), method.bytes());
        let per_item = bytes as f64 / f64::from(items);
        println!("{name:28} {per_item:.2} bytes per item; {epsilon} ns per item to add epsilon");
        writeln!(tables.items, "{items},{name},{bytes},{epsilon}")?;
    }
    Ok(())
}

fn record(items: u32, cache: &str, method: &dyn Method, times: &Times, csv: &mut String) -> Result<()> {
    let name = method.name();
    for (chunk, (draw, update)) in times.iter().enumerate() {
        // Microseconds.
        let step = (draw + update) * BATCH as f64 / 1000.0;
        writeln!(csv, "{items},{cache},{name},{chunk},{draw:.3},{update:.3},{step:.6}")?;
    }
    let draw = median(&mut times.iter().map(|time| time.0).collect::<Vec<_>>());
    let update = median(&mut times.iter().map(|time| time.1).collect::<Vec<_>>());
    println!("{name:28} {cache} {draw:8.1} / {update:10.1}  {:10.3} us", (draw + update) * BATCH as f64 / 1000.0);
    Ok(())
}
