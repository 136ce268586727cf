//! Optimises a tile and prints it as text, one row of coordinates per sample in `[y][x][sample]` order: `tile_text SIZE
//! SPP DIMS [name=value]...` with the names of the fields of `TileProblem`.

use fsot::optimize::Domain;
use fsot::run::Optimization;
use fsot::tile::{ClassShare, Projections, Steps, TileOptimizer, TileProblem, presets};
use std::io::Write;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let sizes: Vec<usize> =
        arguments.iter().take_while(|a| !a.contains('=')).map(|a| a.parse()).collect::<Result<_, _>>()?;
    let [size, spp, dims] = sizes[..] else { return Err("usage: tile_text SIZE SPP DIMS [name=value]...".into()) };
    let mut problem = TileProblem::new(size, spp, dims);
    let mut threads = 1;
    for argument in &arguments[3..] {
        let (name, value) = argument.split_once('=').ok_or("name=value")?;
        let numbers: Vec<f32> = value.split(',').map(|v| v.parse().unwrap_or(0.0)).collect();
        match name {
            "frames" => problem.frames = numbers[0] as usize,
            "kernel" => problem.kernel = value.parse()?,
            "temporal" => problem.temporal = Some(value.parse()?),
            "progressive" => problem.progressive = true,
            "prefixes" => {
                problem.prefixes = numbers.chunks(2).map(|c| ClassShare { share: c[0], weight: c[1] }).collect()
            }
            "box" => problem.box_class = ClassShare { share: numbers[0], weight: numbers[1] },
            "reconstruction" => problem.reconstruction = value.parse()?,
            "preset" => problem = presets::preset(value).ok_or("unknown preset")?,
            "frame_share" => problem.frame_share = numbers[0],
            "seed" => problem.seed = value.parse()?,
            "iterations" => problem.iterations = value.parse()?,
            "directions" => problem.directions = value.parse()?,
            "projections" => problem.projections = Projections { axis: numbers[0], plane: numbers[1] },
            "steps" => problem.steps = Steps { first: numbers[0], last: numbers[1], hold: numbers[2] },
            "correction" => problem.offset_correction = numbers[0],
            "exponent" => problem.threshold_exponent = numbers[0],
            "toroidal" => problem.domain = Domain::Toroidal,
            "threads" => threads = value.parse()?,
            _ => return Err(format!("unknown name {name}").into()),
        }
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let cost = problem.cost()?;
    let started = std::time::Instant::now();
    let mut optimizer = TileOptimizer::new(problem)?;
    let (mut energy, steps) = (0.0, optimizer.iterations());
    while optimizer.iteration() < steps {
        energy = optimizer.step();
    }
    let seconds = started.elapsed().as_secs_f64();
    let slices = (optimizer.samples().frames * size * size) as f64 * steps as f64;
    eprintln!(
        "{seconds:.2} s, {:.2} M slices/s, {:.0} M samples/s, energy {energy:.3e}",
        slices / seconds / 1e6,
        cost * steps as f64 / seconds / 1e6
    );
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    for sample in optimizer.samples().coordinates.chunks_exact(dims) {
        let row: Vec<String> = sample.iter().map(|value| value.to_string()).collect();
        writeln!(out, "{}", row.join(" "))?;
    }
    Ok(())
}
