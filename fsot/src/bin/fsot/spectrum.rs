//! `fsot spectrum`.

use crate::common::Threads;
use crate::measure::{Content, Tile, draw, idle, title};
use crate::names;
use fsot::error::{Error, Result};
use fsot::metrics::figure::{self, Subject};
use fsot::metrics::{Spectrum, TileView, error_spectrum};
use fsot::output;
use std::path::{Path, PathBuf};

/// What `fsot spectrum` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// Point sets of as many points each, or tiles of the same size; their spectra are averaged
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The picture to write, as SVG if the name ends so, else as PNG
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// Which two coordinates of the points [default: 1 2]
    #[arg(long, value_name = "COORDINATE", num_args = 2, value_parser = clap::value_parser!(u8).range(1..=8))]
    axes: Option<Vec<u8>>,
    /// Random integrands of each family whose error spectra are averaged, for tiles [default: 256]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=65536))]
    integrands: Option<u32>,
    #[command(flatten)]
    tile: Tile,
    #[command(flatten)]
    threads: Threads,
}

/// Computes the spectra and draws their average.
pub(crate) fn run(args: &Args) -> Result<()> {
    names::picture(&args.out, &["png", "svg"])?;
    output::check([args.out.as_path()], args.files.iter().map(PathBuf::as_path))?;
    let (spectrum, subject) = args.threads.install(|| average(args))?;
    draw(&args.out, &figure::spectrum(&title(&args.files), &spectrum, subject))
}

fn average(args: &Args) -> Result<(Spectrum, Subject)> {
    args.tile.check(&args.files)?;
    let spectra: Vec<(Spectrum, Subject)> = args.files.iter().map(|path| one(args, path)).collect::<Result<_>>()?;
    let subject = spectra.first().map_or(Subject::Points, |s| s.1);
    if spectra.iter().any(|s| s.1 != subject) {
        return Err(Error::Input("point sets and tiles have different spectra: give files of one kind".into()));
    }
    let spectra: Vec<Spectrum> = spectra.into_iter().map(|s| s.0).collect();
    Ok((Spectrum::average(&spectra)?, subject))
}

fn one(args: &Args, path: &Path) -> Result<(Spectrum, Subject)> {
    match args.tile.read(path)? {
        Content::Points(_) if args.integrands.is_some() => Err(idle("--integrands", "tiles")),
        Content::Tile(_) if args.axes.is_some() => Err(idle("--axes", "point sets")),
        Content::Points(table) => {
            let dims = table.points.dims();
            let [first, second] = args.axes.as_deref().and_then(<[u8]>::first_chunk).copied().unwrap_or([1, 2]);
            let axes = [usize::from(first) - 1, usize::from(second) - 1];
            if axes[0] == axes[1] || axes.iter().any(|&axis| axis >= dims) {
                return Err(Error::Input(format!(
                    "{}: a spectrum needs two different coordinates, not {first} and {second} of {dims}: see --axes",
                    path.display()
                )));
            }
            Ok((Spectrum::of_points(&table.points, axes)?, Subject::Points))
        }
        Content::Tile(samples) => {
            Ok((error_spectrum(&TileView::of(&samples)?, args.integrands.unwrap_or(256) as usize)?, Subject::Tile))
        }
    }
}
