//! `fsot measure`.

use crate::common::{Report, Threads};
use crate::names;
use crate::scenes;
use fsot::counted::counted;
use fsot::error::{Error, Result};
use fsot::export::nft::TileFile;
use fsot::export::points::Table;
use fsot::metrics::figure::{self, Sheet};
use fsot::metrics::text::PrefixTable;
use fsot::metrics::{self, TileOptions, TileView};
use fsot::output;
use fsot::points::Points;
use fsot::read;
use fsot::tile::TileSamples;
use noisefloor::tile::Shape;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The most classes of a file that are measured, the first ones.
const CLASSES: usize = 256;
/// Numbers of points per doubling that --prefix prints.
const PER_OCTAVE: usize = 4;

/// What `fsot measure` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// Point sets (text, CSV or JSON) and tiles (.nft); - is standard input, of points
    #[arg(required_unless_present = "scenes", value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Judge samplers (tables .bin, tiles .nft, `noisefloor-points`) in this folder's tables of rendered scenes
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["prefix", "size", "quick", "integrands", "ema"])]
    scenes: Option<PathBuf>,
    /// Print the error against the number of points taken from the start, averaged over the files
    #[arg(long, conflicts_with_all = ["quick", "ema"])]
    prefix: bool,
    /// With --prefix: draw the errors, as SVG if the name ends so, else as PNG
    #[arg(long, value_name = "FILE", requires = "prefix")]
    plot: Option<PathBuf>,
    /// Random integrands of each family, of --prefix and of tiles [default: 512]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=65536))]
    integrands: Option<u32>,
    /// Leave out the integration error of point sets, which takes longest
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    tile: Tile,
    /// Weight of the newest frame in a moving average over the frames of a tile; may be repeated [default: 0.1 and 0.2]
    #[arg(long, value_name = "ALPHA", allow_negative_numbers = true)]
    ema: Vec<f64>,
    #[command(flatten)]
    report: Report,
    #[command(flatten)]
    threads: Threads,
}

/// How the points of a text file make a tile.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct Tile {
    /// Take the points for a tile of this many pixels per side: in order of frames, rows, pixels, samples
    #[arg(long, value_name = "PIXELS")]
    size: Option<usize>,
    /// Samples per pixel of such a tile
    #[arg(long, value_name = "COUNT", default_value_t = 1, requires = "size")]
    spp: usize,
}

/// What a file holds.
pub(crate) enum Content {
    /// Points and their classes.
    Points(Table),
    /// The samples of a tile.
    Tile(TileSamples),
}

impl Tile {
    /// Fails if there is a size, and no file that can have it.
    pub(crate) fn check(&self, files: &[PathBuf]) -> Result<()> {
        if self.size.is_some() && files.iter().all(|path| read::ending(path) == "nft") {
            return Err(idle("--size", "files of points"));
        }
        Ok(())
    }

    /// Reads a file.
    pub(crate) fn read(&self, path: &Path) -> Result<Content> {
        if read::ending(path) == "nft" {
            let file = TileFile::read(path)?;
            let Shape { size, spp, dims, frames, .. } = file.header().shape();
            let [size, spp, dims, frames] = [size, spp, dims, frames].map(|length| length as usize);
            return Ok(Content::Tile(TileSamples { size, spp, dims, frames, coordinates: file.coordinates() }));
        }
        let table = read::points(path)?;
        metrics::check(&table.points).map_err(in_file(path))?;
        let Some(size) = self.size else { return Ok(Content::Points(table)) };
        let per_frame = size.checked_mul(size).and_then(|pixels| pixels.checked_mul(self.spp)).unwrap_or(0);
        if per_frame == 0 || table.points.len() % per_frame != 0 {
            return Err(Error::Input(format!(
                "{}: {} cannot make whole frames of {size}x{size} pixels with {} each",
                path.display(),
                counted(table.points.len(), "point"),
                counted(self.spp, "sample")
            )));
        }
        Ok(Content::Tile(TileSamples {
            size,
            spp: self.spp,
            dims: table.points.dims(),
            frames: table.points.len() / per_frame,
            coordinates: table.points.coordinates().to_vec(),
        }))
    }
}

impl Args {
    fn integrands(&self) -> usize {
        self.integrands.unwrap_or(512) as usize
    }

    fn options(&self) -> TileOptions {
        let default = TileOptions::default();
        let alphas = if self.ema.is_empty() { default.alphas } else { self.ema.clone() };
        TileOptions { integrands: self.integrands(), alphas }
    }
}

/// The name of the first file and how many more there are.
pub(crate) fn title(files: &[PathBuf]) -> String {
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    match files {
        [] => String::new(),
        [file] => name(file),
        [file, more @ ..] => format!("{} and {} more", name(file), more.len()),
    }
}

/// Writes a picture: as SVG if its name ends so, else as PNG.
pub(crate) fn draw(path: &Path, sheet: &Sheet) -> Result<()> {
    let bytes = if read::ending(path) == "svg" { sheet.svg()?.into_bytes() } else { sheet.png()? };
    output::write(path, &bytes)
}

/// That an option, which is for `what`, has no effect.
pub(crate) fn idle(option: &str, what: &str) -> Error {
    Error::Input(format!("{option} is for {what}, and there is none: leave it out"))
}

/// Says of which file an error is.
pub(crate) fn in_file(path: &Path) -> impl Fn(Error) -> Error + '_ {
    move |error| match error {
        Error::Input(sentence) => Error::Input(format!("{}: {sentence}", path.display())),
        other => other,
    }
}

/// Reads every file before it measures the first, so that a wrong name costs no time.
pub(crate) fn run(args: &Args) -> Result<()> {
    if let Some(folder) = &args.scenes {
        let (text, json) = args.threads.install(|| scenes::run(folder, &args.files))?;
        return args.report.print([], &text, &json);
    }
    args.plot.iter().try_for_each(|path| names::picture(path, &["png", "svg"]))?;
    output::check(args.plot.as_deref(), args.files.iter().map(PathBuf::as_path))?;
    args.tile.check(&args.files)?;
    let contents: Vec<Content> = args.files.iter().map(|path| args.tile.read(path)).collect::<Result<_>>()?;
    let tiles = contents.iter().filter(|content| matches!(content, Content::Tile(_))).count();
    if !args.ema.is_empty() && tiles == 0 {
        return Err(idle("--ema", "tiles"));
    }
    let moves = |content: &Content| matches!(content, Content::Tile(TileSamples { frames: 2.., .. }));
    if !args.ema.is_empty() && !contents.iter().any(moves) {
        args.options().check()?;
        return Err(idle("--ema", "tiles of several frames"));
    }
    if args.integrands.is_some() && !args.prefix && tiles == 0 {
        return Err(idle("--integrands", "--prefix and tiles"));
    }
    if args.quick && tiles == contents.len() {
        return Err(idle("--quick", "point sets"));
    }
    let (text, json) =
        args.threads.install(|| if args.prefix { prefix(args, &contents) } else { all(args, &contents) })?;
    args.report.print(args.plot.as_deref(), &text, &json)
}

fn all(args: &Args, contents: &[Content]) -> Result<(String, Value)> {
    let mut text = String::new();
    let mut values = Vec::new();
    for (path, content) in args.files.iter().zip(contents) {
        let value = match content {
            Content::Points(table) => points(args, path, table, &mut text),
            Content::Tile(samples) => tile(args, path, samples, &mut text),
        };
        values.push(value.map_err(in_file(path))?);
    }
    Ok((text, json!({ "files": values })))
}

fn points(args: &Args, path: &Path, table: &Table, text: &mut String) -> Result<Value> {
    let one = |points: &Points| if args.quick { metrics::quick(points) } else { metrics::measure(points) };
    let whole = one(&table.points)?;
    let _ = writeln!(text, "{}\n{whole}", path.display());
    let mut classes = Vec::new();
    if let Some(labels) = &table.classes {
        for (class, name) in labels.names.iter().enumerate().take(CLASSES) {
            let members = metrics::select(&table.points, |i| labels.index[i] == class);
            if members.is_empty() {
                continue;
            }
            let report = one(&members)?;
            let _ = writeln!(text, "{}, class {name}\n{report}", path.display());
            classes.push(json!({ "class": name, "report": report }));
        }
    }
    let mut value = json!({ "file": path.to_string_lossy(), "points": whole });
    if !classes.is_empty() {
        value["classes"] = classes.into();
    }
    let left = table.classes.as_ref().map_or(0, |labels| labels.names.len()).saturating_sub(CLASSES);
    if left > 0 {
        let _ = writeln!(text, "{}: {left} more classes are left out", path.display());
        value["classes_left_out"] = left.into();
    }
    Ok(value)
}

fn tile(args: &Args, path: &Path, samples: &TileSamples, text: &mut String) -> Result<Value> {
    let report = metrics::measure_tile(&TileView::of(samples)?, &args.options())?;
    let _ = writeln!(text, "{}\n{report}", path.display());
    Ok(json!({ "file": path.to_string_lossy(), "tile": report }))
}

fn prefix(args: &Args, contents: &[Content]) -> Result<(String, Value)> {
    let sets: Vec<Points> = contents
        .iter()
        .zip(&args.files)
        .map(|(content, path)| match content {
            Content::Points(table) => Ok(table.points.clone()),
            Content::Tile(_) => Err(Error::Input(format!(
                "{}: --prefix is for point sets; the prefixes of tiles are always printed",
                path.display()
            ))),
        })
        .collect::<Result<_>>()?;
    let counts = metrics::log_spaced(sets.first().map_or(0, Points::len), PER_OCTAVE);
    let errors = metrics::prefix_errors(&sets, &counts, args.integrands())?;
    if let Some(path) = &args.plot {
        draw(path, &figure::prefix_errors(&title(&args.files), &errors))?;
    }
    let text = format!(
        "error of the first points, averaged over {} and {} of each family\n{}",
        counted(sets.len(), "set"),
        counted(args.integrands(), "integrand"),
        PrefixTable(&errors)
    );
    let files: Vec<_> = args.files.iter().map(|path| path.to_string_lossy()).collect();
    Ok((text, json!({ "files": files, "integrands": args.integrands(), "prefix": errors })))
}
