//! `fsot export`: a tile for programs that do not link noisefloor.

use crate::names;
use clap::ValueEnum;
use clap::builder::PossibleValue;
use fsot::error::{Error, Result};
use fsot::export::nft::TileFile;
use fsot::export::tile;
use fsot::output;
use std::path::PathBuf;

/// What `fsot export` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// The tile, a .nft file
    #[arg(value_name = "TILE")]
    tile: PathBuf,
    /// What to write
    #[arg(long, value_enum)]
    format: Format,
    /// The file to write; an older one is replaced
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// The name of the C array and its macros, also named in Rust's comment [default: the tile's file name]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// A texture of the tile's integers: layers from top to bottom, a coordinate per channel
    Png,
    /// The same of 32-bit floats, the coordinates
    Exr,
    /// The integers alone, little-endian: [frame][y][x][sample][dim]
    Raw,
    /// A C and C++ header with an array
    CHeader,
    /// A Rust module with an array
    Rust,
}

/// Reads the tile and writes it anew.
pub(crate) fn run(args: &Args) -> Result<()> {
    names::export(&args.out, args.format.to_possible_value().as_ref().map_or("", PossibleValue::get_name))?;
    output::check([args.out.as_path()], [args.tile.as_path()])?;
    let file = TileFile::read(&args.tile)?;
    let view = file.view();
    let stem = || args.tile.file_stem().map_or_else(|| "tile".into(), |stem| stem.to_string_lossy().into_owned());
    if args.name.is_some() && !matches!(args.format, Format::CHeader | Format::Rust) {
        return Err(Error::input("--name is for the arrays of --format c-header and rust: leave it out"));
    }
    let name = args.name.clone().unwrap_or_else(stem);
    if name.is_empty() {
        return Err(Error::input("--name is empty: give a name of letters, digits and _"));
    }
    let bytes = match args.format {
        Format::Png => tile::png(&view)?,
        Format::Exr => tile::exr(&view)?,
        Format::Raw => view.payload().to_vec(),
        Format::CHeader => tile::c_header(&view, &name),
        Format::Rust => tile::rust(&view, &name),
    };
    output::write(&args.out, &bytes)
}
