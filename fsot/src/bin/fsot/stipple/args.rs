//! What `fsot stipple` is asked for.

use crate::common::Common;
use crate::names;
use fsot::error::{Error, Result};
use fsot::export::points::{Format, Table, encode};
use fsot::output::{self, Outputs};
use fsot::picture::{Drawing, png, rasterise, svg};
use fsot::read;
use fsot::stipple::{Options, Tone};
use serde_json::json;
use std::path::{Path, PathBuf};

/// What `fsot stipple` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// The picture: PNG, JPEG or OpenEXR
    #[arg(required_unless_present = "frames", conflicts_with = "frames")]
    pub(super) image: Option<PathBuf>,
    /// Dots of all inks together; with --frames it follows from the frames, the window and the step
    #[arg(short, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    #[arg(required_unless_present = "frames")]
    pub(super) n: Option<u32>,
    /// Cyan, magenta, yellow and black dots instead of black ones; without --invert and --frames
    #[arg(long, conflicts_with = "frames")]
    pub(super) cmyk: bool,
    /// White dots on black paper
    #[arg(long, conflicts_with = "cmyk")]
    invert: bool,
    /// What "half as dark" means: of encoded values, or of light
    #[arg(long, value_enum, default_value_t)]
    tone: Tone,
    /// The part of what cyan, magenta and yellow have in common that black replaces, 0 to 1
    #[arg(long, value_name = "PART", default_value_t = 1.0, value_parser = part, allow_negative_numbers = true)]
    #[arg(requires = "cmyk")]
    black: f32,
    /// Draw an animation: the pictures of its frames, in the order of their names ('frames/*.png')
    #[arg(long, value_name = "GLOB", requires_all = ["window", "step"])]
    pub(super) frames: Option<String>,
    /// Dots that a frame shows
    #[arg(long, value_name = "COUNT", requires = "frames", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) window: Option<u32>,
    /// Dots that the next frame replaces
    #[arg(long, value_name = "COUNT", requires = "frames", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) step: Option<u32>,
    /// The first frame follows the last one
    #[arg(long, requires = "frames")]
    pub(super) cyclic: bool,
    /// Pixels on the longer side of the drawing [default: dots are 8 apart in the mean; 1024 to 16384]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(16..=20_000))]
    size: Option<u32>,
    #[command(flatten)]
    pub(super) copies: Copies,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// What is drawn, in other forms.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Copies {
    /// Also write the drawing as SVG
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Also write the points: CSV or JSON by the name's ending, else text
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
}

fn part(text: &str) -> std::result::Result<f32, String> {
    match text.parse() {
        Ok(part) if (0.0..=1.0).contains(&part) => Ok(part),
        _ => Err("give a number from 0 to 1".to_owned()),
    }
}

impl Copies {
    pub(super) fn check(&self) -> Result<()> {
        self.svg.iter().try_for_each(|path| names::picture(path, &["svg"]))?;
        self.points.iter().try_for_each(|path| names::table(path, ""))
    }

    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.svg.iter().chain(&self.points).map(PathBuf::as_path)
    }

    pub(super) fn add(&self, outputs: &mut Outputs, drawing: &Drawing, size: u32, table: &Table) -> Result<()> {
        if let Some(path) = &self.svg {
            outputs.add(path, svg(drawing, size as f32).as_bytes())?;
        }
        if let Some(path) = &self.points {
            outputs.add(path, &encode(table, Format::of(path))?)?;
        }
        Ok(())
    }
}

impl Args {
    pub(super) fn options(&self, points: usize) -> Options {
        Options {
            points,
            cmyk: self.cmyk,
            invert: self.invert,
            tone: self.tone,
            grey_component: self.black,
            seed: self.common.seed(),
            quality: self.common.effort(),
        }
    }

    pub(super) fn linear(&self) -> bool {
        self.tone == Tone::Linear
    }

    pub(super) fn size(&self, spacing: f32) -> u32 {
        self.size.unwrap_or_else(|| ((8.0 / spacing).ceil() as u32).clamp(1024, 16_384))
    }

    /// What the points depend on, beside the program's version.
    pub(super) fn description(&self, pictures: &[String], options: &Options) -> serde_json::Value {
        json!({
            "command": "stipple",
            "pictures": pictures,
            "points": options.points,
            "cmyk": options.cmyk,
            "invert": options.invert,
            "tone": options.tone,
            "black": options.grey_component,
            "window": self.window,
            "step": self.step,
            "cyclic": self.cyclic,
            "seed": options.seed,
            "quality": options.quality.to_string(),
        })
    }
}

/// The file format of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Picture {
    Png,
    Svg,
}

impl Picture {
    pub(super) fn of(path: &Path) -> Result<Picture> {
        match read::ending(path).as_str() {
            "svg" => Ok(Picture::Svg),
            ending if ending == "png" || output::is_stream(path) => Ok(Picture::Png),
            _ => Err(Error::Input(format!("{} is no name for a drawing: end it in .png or .svg", path.display()))),
        }
    }

    pub(super) fn encode(self, drawing: &Drawing, size: u32) -> Result<Vec<u8>> {
        match self {
            Picture::Png => png(&rasterise(drawing, size as f32)?),
            Picture::Svg => Ok(svg(drawing, size as f32).into_bytes()),
        }
    }
}
