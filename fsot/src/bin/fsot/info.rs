//! `fsot info`: what a tile's file and its sidecar say.

use crate::common::Report;
use crate::say::say;
use fsot::counted::counted;
use fsot::digest::digest;
use fsot::error::Result;
use fsot::export::nft::TileFile;
use fsot::export::sidecar::{self, Row, Sidecar};
use fsot::tile::{TileProblem, preset};
use noisefloor::tile::{Builtin, Shape};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What `fsot info` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// The tile, a .nft file; without it, the presets of `fsot tile` are listed
    #[arg(value_name = "TILE")]
    tile: Option<PathBuf>,
    #[command(flatten)]
    report: Report,
}

/// Reads and prints.
pub(crate) fn run(args: &Args) -> Result<()> {
    let (text, json) = args.tile.as_deref().map_or_else(list, tell)?;
    args.report.print([], &text, &json)
}

fn list() -> Result<(String, Value)> {
    let mut text = String::new();
    let tiles = Builtin::ALL.map(|tile| (tile.name(), preset(tile)));
    for (name, problem) in &tiles {
        let TileProblem { size, spp, dims, frames, iterations, .. } = problem;
        let frames = if *frames > 1 { format!(", {frames} frames") } else { String::new() };
        let kernels = problem.kernels();
        let progressive = if problem.progressive { ", progressive" } else { "" };
        writeln!(
            text,
            "{name:<26}{size} x {size} pixels, {spp} spp, {}{frames}{progressive}, {kernels}, {}",
            counted(dims, "dim"),
            counted(iterations, "step")
        )
        .unwrap_or(());
    }
    Ok((text, json!({ "presets": tiles.map(|(name, _)| name) })))
}

fn tell(tile: &Path) -> Result<(String, Value)> {
    let path = tile.display();
    let file = TileFile::read(tile)?;
    let mut sidecar: Option<Sidecar> = sidecar::read(tile)?;
    if sidecar.as_ref().is_some_and(|sidecar| !sidecar.describes(file.bytes())) {
        say(&format!("warning: {} describes another tile: its sha256 differs", sidecar::path(tile).display()))?;
        sidecar = None;
    }
    let header = file.header();
    let Shape { size, spp, dims, frames, bits, progressive } = header.shape();
    let sha256 = digest(file.bytes());
    let mut text = format!("{path}\n");
    let mut line = |name: &str, value: String| writeln!(text, "  {name:<12}{value}").unwrap_or(());
    line("size", format!("{size} x {size} pixels"));
    line("samples", format!("{spp} per pixel{}", if progressive { ", progressive" } else { "" }));
    line("dimensions", dims.to_string());
    line("frames", frames.to_string());
    line("bits", format!("{bits} per coordinate"));
    line("bytes", file.bytes().len().to_string());
    line("kernel", header.kernel().to_owned());
    line("seed", header.seed().to_string());
    line("sha256", sha256.clone());
    if let Some(sidecar) = &sidecar {
        line("command", sidecar.command.clone());
        line("version", sidecar.version.clone());
        line(
            "quality",
            format!(
                "over {} and as many Gaussians; white noise is 1",
                counted(sidecar.quality.integrands, "half-space")
            ),
        );
        let quality = &sidecar.quality;
        for row in quality.energy.iter().chain(&quality.marginal).chain(&quality.temporal) {
            line("", describe(row));
        }
    }
    let json = json!({
        "tile": tile.to_string_lossy(), "size": size, "spp": spp, "progressive": progressive, "dims": dims,
        "frames": frames, "bits": bits, "bytes": file.bytes().len(), "kernel": header.kernel(),
        "seed": header.seed(), "sha256": sha256, "sidecar": sidecar,
    });
    Ok((text, json))
}

fn describe(row: &Row) -> String {
    let axes = row.axes.map_or(String::new(), |[a, b]| format!(", dims {a} and {b}"));
    let alpha = row.alpha.map_or(String::new(), |alpha| format!(", after EMA {alpha}"));
    let [filtered, raw] =
        [row.filtered, row.raw].map(|[half_spaces, gaussians]| format!("{half_spaces} / {gaussians}"));
    format!("{} spp{axes}{alpha}: filtered {filtered}; raw {raw}", row.spp)
}
