//! Drawings beside a table of points.

use crate::names;
use fsot::error::Result;
use fsot::output::Outputs;
use fsot::picture::{Drawing, png, rasterise, svg};
use std::path::{Path, PathBuf};

/// Where to draw what is also written as a table.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct Pictures {
    /// Also draw what is written (points by their first two coordinates, objects as trees)
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// The same as a vector graphic
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

impl Pictures {
    /// Refuses names of other pictures.
    pub(crate) fn check(&self) -> Result<()> {
        self.png.iter().try_for_each(|path| names::picture(path, &["png"]))?;
        self.svg.iter().try_for_each(|path| names::picture(path, &["svg"]))
    }

    /// The files that are asked for.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.png.iter().chain(&self.svg).map(PathBuf::as_path)
    }

    /// Adds them, `side` pixels along the longer side; nothing is drawn if none is asked for.
    pub(crate) fn add(&self, outputs: &mut Outputs, side: f32, draw: impl FnOnce() -> Drawing) -> Result<()> {
        if self.paths().next().is_none() {
            return Ok(());
        }
        let drawing = draw();
        if let Some(path) = &self.png {
            outputs.add(path, &png(&rasterise(&drawing, side)?)?)?;
        }
        if let Some(path) = &self.svg {
            outputs.add(path, svg(&drawing, side).as_bytes())?;
        }
        Ok(())
    }
}
