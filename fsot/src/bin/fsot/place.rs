//! `fsot place`.

use crate::common::Common;
use crate::drive::{drive, finish};
use crate::pictures::Pictures;
use fsot::counted::counted;
use fsot::error::{Error, Result};
use fsot::optimize::Optimizer;
use fsot::output;
use fsot::picture::hex;
use fsot::place::{Object, Options, Placement, colour_of, drawing};
use fsot::read;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Pixels along the longer side of the ground.
const PICTURE: f32 = 1200.0;

/// What `fsot place` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// How many objects
    #[arg(short, value_name = "COUNT", default_value_t = 2048)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    n: u32,
    /// Colours: the objects of each are spread evenly, and so are all together
    #[arg(long, alias = "colours", value_name = "COUNT", default_value_t = 1)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=256))]
    colors: u16,
    /// Sizes from 0 to 1: objects above, and below, any size are spread evenly
    #[arg(long)]
    sizes: bool,
    /// Objects where this picture is dark: PNG, JPEG or OpenEXR (its longer side is the unit)
    #[arg(long, value_name = "IMAGE")]
    map: Option<PathBuf>,
    #[command(flatten)]
    pictures: Pictures,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// Places objects; writes a table of them, and pictures.
pub(crate) fn run(args: &Args) -> Result<()> {
    let format = Format::of(&args.common.out)?;
    args.pictures.check()?;
    args.common.check_outputs(args.pictures.paths(), args.map.as_deref())?;
    let (points, colours) = (args.n as usize, usize::from(args.colors));
    let map = args.map.as_ref().map(|path| read::density(path, points, true)).transpose()?;
    let (map, map_digest) = map.unzip();
    let (seed, quality) = (args.common.seed(), args.common.effort());
    let placement = Placement::new(&Options { points, colours, sizes: args.sizes, map, seed, quality })?;
    let mut optimizer = Optimizer::new(placement.problem.clone())?;
    let description = json!({
        "command": "place", "points": points, "colors": colours, "sizes": args.sizes, "map": map_digest, "seed": seed,
        "quality": quality.to_string(),
    });
    let mut run = drive(&mut optimizer, &description, &args.common)?;

    let objects = placement.objects(&optimizer.points());
    let classes = placement.problem.classes.len();
    let mut text = format!(
        "{}, {}{}: {}\n",
        counted(points, "object"),
        counted(colours, "colour"),
        if args.sizes { ", sizes from 0 to 1" } else { "" },
        counted(classes, "class"),
    );
    run.describe(&mut text);
    let json = json!({
        "objects": points, "colors": colours, "sizes": args.sizes, "classes": classes, "run": run.json(),
    });
    finish(&mut run, |outputs| {
        outputs.add(&args.common.out, &format.encode(&objects, colours)?)?;
        args.pictures.add(outputs, PICTURE, || drawing(&objects, colours, placement.extent()))
    })?;
    args.common.print(args.pictures.paths(), &text, &json)
}

/// The file format of a table of objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// A header row `x,y,color,size`, then a row per object.
    Csv,
    /// `{"colors": ["#rrggbb", ...], "objects": [{"x": .., "y": .., "color": 0, "size": ..}, ...]}`.
    Json,
}

impl Format {
    fn of(path: &Path) -> Result<Format> {
        match read::ending(path).as_str() {
            "json" => Ok(Format::Json),
            ending if ending == "csv" || output::is_stream(path) => Ok(Format::Csv),
            _ => Err(Error::Input(format!("{} is no name for a table: end it in .csv or .json", path.display()))),
        }
    }

    fn encode(self, objects: &[Object], colours: usize) -> Result<Vec<u8>> {
        let failed = |error: &dyn std::fmt::Display| Error::Input(format!("the table cannot be encoded: {error}"));
        match self {
            Format::Csv => {
                let mut writer = csv::Writer::from_writer(Vec::new());
                objects.iter().try_for_each(|object| writer.serialize(object)).map_err(|error| failed(&error))?;
                writer.into_inner().map_err(|error| failed(&error))
            }
            Format::Json => {
                let palette: Vec<String> = (0..colours).map(|color| hex(colour_of(color, colours))).collect();
                let mut bytes = serde_json::to_vec(&json!({ "colors": palette, "objects": objects }))
                    .map_err(|error| failed(&error))?;
                bytes.push(b'\n');
                Ok(bytes)
            }
        }
    }
}
