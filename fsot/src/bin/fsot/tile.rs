//! `fsot tile`: a tile of samples for the pixels of a renderer, and its sidecar.

use crate::common::Common;
use crate::drive::{Run, drive, finish};
use crate::names;
use fsot::digest::digest;
use fsot::error::{Error, Result};
use fsot::export::nft::{self, TileFile};
use fsot::export::sidecar::{self, Quality, Sidecar};
use fsot::metrics::{TileOptions, TileReport, TileView, measure_tile};
use fsot::output;
use fsot::tile::{self, ClassShare, Kernel, TemporalKernel, TileOptimizer, TileProblem, preset};
use noisefloor::tile::{Builtin, Shape};
use serde_json::{Value, json};
use std::path::Path;

/// As in the published figures.
const INTEGRANDS: u32 = 512;

/// What `fsot tile` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// A tile that comes with noisefloor, such as 128_4SPP_2D: sets size, samples, kernels, shares and
    /// the number of steps (`fsot info` lists them)
    #[arg(long, value_name = "NAME", conflicts_with_all = ["size", "spp", "d", "kernel", "reconstruction", "temporal"])]
    #[arg(conflicts_with_all = ["progressive", "box_share", "box_weight"])]
    preset: Option<String>,
    /// Pixels along each side, a power of two
    #[arg(long, value_name = "PIXELS", default_value_t = 128)]
    size: usize,
    /// Samples per pixel, a power of two
    #[arg(long, value_name = "COUNT", default_value_t = 1)]
    spp: usize,
    /// Coordinates of each sample, 1 to 8
    #[arg(short, long = "dims", value_name = "COUNT", default_value_t = 2)]
    d: usize,
    /// What the image is filtered by: box, perceptual, gaussian:SIGMA (pixels), or a convolution,
    /// perceptual*gaussian:SIGMA
    #[arg(long, default_value = "perceptual")]
    kernel: Kernel,
    /// What the renderer reconstructs a pixel by: the kernel of the slices that --box-share counts [default: the second
    /// factor of a convolution, else box]
    #[arg(long, value_name = "KERNEL")]
    reconstruction: Option<Kernel>,
    /// An animation of this many frames
    #[arg(long, value_name = "FRAMES", requires = "temporal_kernel")]
    temporal: Option<usize>,
    /// What an animation is filtered by: ema:ALPHA (an exponential moving average) or mantiuk (the eye; 8
    /// frames or more)
    #[arg(long, value_name = "KERNEL", requires = "temporal")]
    temporal_kernel: Option<TemporalKernel>,
    /// The first 1, 2, 4, ... samples of all pixels are tiles too
    #[arg(long)]
    progressive: bool,
    /// The share of the slices that look at what a pixel is reconstructed from; at most .5 with --temporal [default:
    /// tuned]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    box_share: Option<f32>,
    /// How much these slices count [default: tuned]
    #[arg(long, value_name = "WEIGHT", allow_negative_numbers = true)]
    box_weight: Option<f32>,
    /// Bits of each stored coordinate
    #[arg(long, default_value_t = 16, value_parser = bits)]
    bits: u32,
    /// Random integrands of each family for the printed quality
    #[arg(long, value_name = "COUNT", default_value_t = INTEGRANDS)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65536))]
    integrands: u32,
    #[command(flatten)]
    pub(crate) common: Common,
}

fn bits(text: &str) -> std::result::Result<u32, String> {
    match text {
        "8" => Ok(8),
        "16" => Ok(16),
        _ => Err("give 8 or 16".to_owned()),
    }
}

/// Makes the tile, writes and measures it.
pub(crate) fn run(args: &Args) -> Result<()> {
    let out = &args.common.out;
    let sidecar = (!output::is_stream(out)).then(|| sidecar::path(out));
    args.common.check_outputs(sidecar.as_deref(), [])?;
    sidecar.iter().try_for_each(|path| sidecar::check::<Sidecar>(path))?;
    names::tile(out)?;
    let problem = problem(args)?;
    let shape = shape(&problem, args.bits);
    let kernel = problem.kernels();
    // Refuses what a tile's file cannot hold before the work.
    nft::header(shape, problem.seed, &kernel)?;
    let mut optimizer = TileOptimizer::new(problem.clone())?;
    let mut run = drive(&mut optimizer, &json!({ "command": "tile", "tile": problem }), &args.common)?;

    let samples = optimizer.samples();
    let file = TileFile::new(shape, problem.seed, &kernel, &samples.coordinates)?;
    // What is stored is measured, after rounding.
    let report = measure(&file, &problem, args.integrands as usize).map_err(|error| run.kept(error))?;
    let (text, json) = describe(out, &report, &run);
    finish(&mut run, |outputs| {
        outputs.add(out, file.bytes())?;
        let Some(path) = &sidecar else { return Ok(()) };
        let sidecar = Sidecar {
            command: command(args, &problem),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: problem.seed,
            kernel,
            iterations: problem.iterations,
            sha256: digest(file.bytes()),
            quality: Quality::new(&report),
        };
        outputs.add(path, &sidecar::encode(&sidecar)?)
    })?;
    args.common.print([], &text, &json)
}

fn problem(args: &Args) -> Result<TileProblem> {
    let mut problem = match &args.preset {
        Some(name) => Builtin::ALL.into_iter().find(|tile| tile.name() == name).map(preset).ok_or_else(|| {
            Error::Input(format!("--preset {name}: there is no such tile; `fsot info` lists those there are"))
        })?,
        None => TileProblem {
            frames: args.temporal.unwrap_or(1),
            kernel: args.kernel.clone(),
            reconstruction: args.reconstruction.clone().unwrap_or_else(|| reconstruction(&args.kernel)),
            temporal: args.temporal_kernel.clone(),
            progressive: args.progressive,
            ..TileProblem::new(args.size, args.spp, args.d)
        },
    };
    let ClassShare { share, weight } = problem.box_class;
    problem.box_class =
        ClassShare { share: args.box_share.unwrap_or(share), weight: args.box_weight.unwrap_or(weight) };
    if problem.box_class.share == 0.0 && (args.reconstruction.is_some() || args.box_weight.is_some()) {
        return Err(Error::input(
            "--reconstruction and --box-weight are for the slices that --box-share counts, and there are none: give \
             --box-share, too",
        ));
    }
    problem.seed = args.common.given_seed().unwrap_or(problem.seed);
    problem.iterations = args.common.given_effort().map_or(problem.iterations, tile::iterations);
    problem.validate()?;
    Ok(problem)
}

/// What a renderer reconstructs by whose images a kernel judges: in `p * r` of 5.6.1 it is r.
fn reconstruction(kernel: &Kernel) -> Kernel {
    match kernel {
        Kernel::Convolution(_, second) => (**second).clone(),
        _ => Kernel::Box,
    }
}

fn shape(problem: &TileProblem, bits: u32) -> Shape {
    Shape {
        size: problem.size as u32,
        spp: problem.spp as u32,
        dims: problem.dims as u32,
        frames: problem.frames as u32,
        bits,
        progressive: problem.progressive,
    }
}

fn measure(file: &TileFile, problem: &TileProblem, integrands: usize) -> Result<TileReport> {
    let mut options = TileOptions { integrands, ..TileOptions::default() };
    if let Some(TemporalKernel::Ema(alpha)) = problem.temporal {
        let alpha = f64::from((alpha * 1e6).round()) / 1e6;
        if !options.alphas.contains(&alpha) {
            options.alphas.push(alpha);
        }
    }
    let coordinates = file.coordinates();
    let view = TileView::new(problem.size, problem.spp, problem.dims, problem.frames, &coordinates)?;
    measure_tile(&view, &options)
}

/// The command that makes the same file wherever it runs.
fn command(args: &Args, problem: &TileProblem) -> String {
    let mut words = vec!["fsot tile".to_owned()];
    if let Some(name) = &args.preset {
        words.push(format!("--preset {name}"));
    } else {
        let TileProblem { size, spp, dims, kernel, frames, .. } = problem;
        words.push(format!("--size {size} --spp {spp} --dims {dims} --kernel '{kernel}'"));
        if problem.reconstruction != reconstruction(kernel) {
            words.push(format!("--reconstruction '{}'", problem.reconstruction));
        }
        if let Some(temporal) = &problem.temporal {
            words.push(format!("--temporal {frames} --temporal-kernel {temporal}"));
        }
        if problem.progressive {
            words.push("--progressive".to_owned());
        }
        words.extend(args.box_share.map(|share| format!("--box-share {share}")));
        words.extend(args.box_weight.map(|weight| format!("--box-weight {weight}")));
    }
    words.push(format!("--bits {} --seed {} --iterations {}", args.bits, problem.seed, problem.iterations));
    if args.integrands != INTEGRANDS {
        words.push(format!("--integrands {}", args.integrands));
    }
    let name = args.common.out.file_name().unwrap_or_default().to_string_lossy();
    words.push(format!("--out {}", quoted(&name)));
    words.join(" ")
}

/// A file's name as a word of a shell, and not an option.
pub(crate) fn quoted(name: &str) -> String {
    let name = if name.starts_with('-') { format!("./{name}") } else { name.to_owned() };
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-+/=:@%,".contains(c);
    if !name.is_empty() && name.chars().all(plain) { name } else { format!("'{}'", name.replace('\'', r"'\''")) }
}

fn describe(out: &Path, report: &TileReport, run: &Run) -> (String, Value) {
    let mut text = format!("{}\n", out.display());
    run.describe(&mut text);
    text.push_str(&report.to_string());
    (text, json!({ "out": out.to_string_lossy(), "run": run.json(), "tile": report }))
}
