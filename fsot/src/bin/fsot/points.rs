//! `fsot points`: points in the unit cube, uniform or by a density, in classes, progressive.

mod classes;
mod report;

use crate::common::Common;
use crate::drive::{drive, finish};
use crate::measure::in_file;
use crate::names;
use crate::pictures::Pictures;
use classes::Classes;
use fsot::class::{self, Class, ClassCoordinates};
use fsot::digest::digest;
use fsot::error::{Error, Result};
use fsot::export::points::{Format, Table, encode};
use fsot::optimize::{Domain, Optimizer, Problem};
use fsot::picture::{BLACK, Colour, Drawing};
use fsot::read;
use fsot::target::Target;
use fsot::target::image::ImageTarget;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Pixels along the longer side of a picture.
const PICTURE: f32 = 1024.0;
/// Pictures whose sides differ by no more than this part have the same shape: their sides are whole pixels.
const SAME_SHAPE: f32 = 0.01;
/// The colours of classes in pictures, in order; then they repeat.
const COLOURS: [Colour; 8] = [
    [214, 39, 40],
    [31, 119, 180],
    [44, 160, 44],
    [148, 103, 189],
    [255, 127, 14],
    [23, 190, 207],
    [140, 86, 75],
    [127, 127, 127],
];

/// What `fsot points` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// How many points
    #[arg(short, long = "points", value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=1 << 28))]
    n: u32,
    /// Coordinates of each point, 1 to 8
    #[arg(short, long = "dims", value_name = "COUNT", default_value_t = 2)]
    #[arg(value_parser = clap::value_parser!(u8).range(1..=8))]
    d: u8,
    /// Opposite faces of the cube are one: for points that will be repeated like a tile, or shifted; without --density
    #[arg(long, conflicts_with = "density")]
    toroidal: bool,
    /// The probability of a projection along an axis: helps integrands that vary along axes (.3 is a good value)
    #[arg(long, value_name = "PROBABILITY", default_value_t = 0.0, allow_negative_numbers = true)]
    axis_priority: f32,
    /// The first points are uniform too, for this many numbers of points, evenly spaced on a logarithmic scale; without
    /// --classes
    #[arg(long, value_name = "LEVELS", conflicts_with = "classes", value_parser = clap::value_parser!(u32).range(1..))]
    progressive: Option<u32>,
    /// 2color, 3color, ramp, or a TOML or JSON file of classes
    #[arg(long, value_name = "CLASSES")]
    classes: Option<String>,
    /// Points where the picture is bright, none where it is transparent: PNG, JPEG or OpenEXR (its longer side is the
    /// unit)
    #[arg(long, value_name = "IMAGE")]
    density: Option<PathBuf>,
    /// Points where the picture is dark
    #[arg(long, requires = "density")]
    invert: bool,
    #[command(flatten)]
    pictures: Pictures,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// Makes the points, writes and measures them.
pub(crate) fn run(args: &Args) -> Result<()> {
    args.pictures.check()?;
    names::table(&args.common.out, "; --png and --svg draw the points")?;
    args.common.check_outputs(args.pictures.paths(), args.density.as_deref())?;
    if args.d < 2 && args.pictures.paths().next().is_some() {
        return Err(Error::input("points of 1 coordinate cannot be drawn: leave out --png and --svg"));
    }
    let (problem, description, extent) = problem(args)?;
    let mut optimizer = Optimizer::new(problem)?;
    let classes = Classes::of(optimizer.problem());
    if let Some(file) = args.classes.as_deref().filter(|name| preset(name, 1).is_none()) {
        classes.check().map_err(in_file(Path::new(file)))?;
    }
    let mut run = drive(&mut optimizer, &description, &args.common)?;

    let table = Table { points: optimizer.points(), classes: classes.labels() };
    drop(optimizer);
    finish(&mut run, |outputs| {
        outputs.add(&args.common.out, &encode(&table, Format::of(&args.common.out))?)?;
        args.pictures.add(outputs, PICTURE, || draw(&table, extent))
    })?;
    if args.common.is_silent() {
        return Ok(());
    }
    // Of many points it takes more memory than their optimisation: the points are safe before.
    let (text, json) = report::report(&args.common.out, &table, &classes, &run)?;
    args.common.print(args.pictures.paths(), &text, &json)
}

/// The problem, all that its result depends on, and the extent of the drawing.
fn problem(args: &Args) -> Result<(Problem, Value, [f32; 2])> {
    let (points, dims) = (args.n as usize, usize::from(args.d));
    let mut files = Vec::new();
    let mut extent = [1.0; 2];
    let ready = args.classes.as_deref().and_then(|name| preset(name, dims));
    let mut classes = match (args.progressive, args.classes.as_deref(), ready) {
        (Some(levels), ..) => class::progressive(dims, levels as usize, points),
        (None, None, _) => class::single(dims),
        (None, _, Some(classes)) => classes,
        (None, Some(name), None) => {
            let path = Path::new(name);
            if !path.exists() {
                return Err(Error::Input(format!("--classes {name}: give 2color, 3color, ramp or the name of a file")));
            }
            args.common.check_outputs(args.pictures.paths(), [path])?;
            let text = read::text(path, "a class file")?;
            files.push(digest(text.as_bytes()));
            // Pictures are named relative to the file that names them.
            let folder = path.parent().unwrap_or(Path::new(""));
            let mut shape: Option<[f32; 2]> = None;
            let classes = class::ClassFile::parse(path, &text)?.classes(dims, |image| {
                if args.density.is_some() {
                    return Err(Error::Input(format!("{name} has densities of its own: leave out --density")));
                }
                let image = folder.join(image);
                args.common.check_outputs(args.pictures.paths(), [image.as_path()])?;
                let target = density(&image, dims, points, false, &mut files)?;
                let this = target.extent();
                if shape.is_some_and(|first| (0..2).any(|axis| (first[axis] - this[axis]).abs() > SAME_SHAPE)) {
                    return Err(Error::Input(format!(
                        "{}: {} has another shape than the picture before: give all of them the same ratio of \
                         width to height",
                        path.display(),
                        image.display()
                    )));
                }
                shape.get_or_insert(this);
                Ok(Arc::new(target) as Arc<dyn Target>)
            })?;
            // Uniform points are in the whole square.
            if let Some(shape) = shape.filter(|_| !classes.iter().any(|class| class.target.is_uniform())) {
                extent = shape;
            }
            classes
        }
    };
    if let Some(path) = &args.density {
        let target = density(path, dims, points, args.invert, &mut files)?;
        extent = target.extent();
        let target: Arc<dyn Target> = Arc::new(target);
        classes.iter_mut().for_each(|class| class.target = Arc::clone(&target));
    }
    let common = &args.common;
    let problem = Problem {
        points,
        dims,
        classes,
        class_coordinates: ClassCoordinates::Index,
        domain: if args.toroidal { Domain::Toroidal } else { Domain::Bounded },
        axis_priority: args.axis_priority,
        seed: common.seed(),
        quality: common.effort(),
        initial: None,
    };
    let description = json!({
        "command": "points", "points": points, "dims": dims, "toroidal": args.toroidal,
        "axis-priority": args.axis_priority, "progressive": args.progressive, "classes": args.classes,
        "density": args.density.is_some(), "invert": args.invert, "files": files, "seed": common.seed(),
        "quality": common.effort().to_string(),
    });
    Ok((problem, description, extent))
}

/// The classes that need no file. A colour of theirs may have none of a few points.
fn preset(name: &str, dims: usize) -> Option<Vec<Class>> {
    match name {
        "2color" => Some(class::two_colors(dims)),
        "3color" => Some(class::three_colors(dims)),
        "ramp" => Some(class::ramp(dims)),
        _ => None,
    }
}

fn density(path: &Path, dims: usize, points: usize, invert: bool, files: &mut Vec<String>) -> Result<ImageTarget> {
    if dims != 2 {
        return Err(Error::Input(format!(
            "{}: a picture is a density of 2 coordinates, not {dims}: use -d 2",
            path.display()
        )));
    }
    let (target, digest) = read::density(path, points, invert)?;
    files.push(digest);
    Ok(target)
}

fn draw(table: &Table, extent: [f32; 2]) -> Drawing {
    let mut drawing = Drawing::new(extent);
    // A tenth of the area is ink.
    let radius = (0.1 * extent[0] * extent[1] / (std::f32::consts::PI * table.points.len() as f32)).sqrt();
    let radius = radius.clamp(0.5 / PICTURE, 0.02);
    match &table.classes {
        None => drawing.dots(table.points.iter(), radius, BLACK),
        Some(labels) => {
            for (class, colour) in (0..labels.names.len()).zip(COLOURS.iter().cycle()) {
                let members = table.points.iter().zip(&labels.index).filter(|(_, index)| **index == class);
                drawing.dots(members.map(|(point, _)| point), radius, *colour);
            }
        }
    }
    drawing
}
