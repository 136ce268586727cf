//! `fsot measure --scenes`: samplers in tables of rendered scenes.

use crate::measure::in_file;
use fsot::error::{Error, Result};
use fsot::export::nft::TileFile;
use fsot::metrics::scenes::{Plane, SceneError, SceneTable};
use fsot::random::stream;
use fsot::sampler::{sidecar, table};
use noisefloor::tile::Shape;
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Pixels and samples of Owen-scrambled points.
const OWEN: (usize, usize) = (128, 256);
/// The first line of a file of points begins so.
const POINTS: &str = "noisefloor-points ";
/// One number of 24 bits in [0, 1).
const UNIT: f32 = 1.0 / 16_777_216.0;

/// A sampler and its errors: `[scene][count]`.
struct Judged {
    name: String,
    plane: Plane,
    errors: Vec<Vec<SceneError>>,
}

/// Judges the samplers in all tables of a folder.
///
/// # Errors
/// A file cannot be read, or is none of a sampler; there is no table.
pub(crate) fn run(folder: &Path, files: &[PathBuf]) -> Result<(String, Value)> {
    let mut judged = vec![Judged { name: "Owen-scrambled Sobol'".to_owned(), plane: owen(), errors: Vec::new() }];
    for path in files {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        judged.push(Judged { name, plane: plane(path)?, errors: Vec::new() });
    }
    let entries = fs::read_dir(folder).map_err(Error::io(folder))?;
    let paths = entries.map(|entry| entry.map(|entry| entry.path()).map_err(Error::io(folder)));
    let mut paths: Vec<PathBuf> = paths.collect::<Result<_>>()?;
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "table"));
    paths.sort();
    if paths.is_empty() {
        return Err(Error::Input(format!("{} has no tables of scenes: embree_tables writes them", folder.display())));
    }
    for path in &paths {
        let table = SceneTable::read(path)?;
        for sampler in &mut judged {
            let counts: Vec<usize> = (0..9).map(|k| 1 << k).filter(|count| *count <= sampler.plane.samples).collect();
            sampler.errors.push(table.errors(&sampler.plane, &counts)?);
        }
    }
    let scene = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(describe(&paths.iter().map(scene).collect::<Vec<_>>(), &judged))
}

fn describe(scenes: &[String], judged: &[Judged]) -> (String, Value) {
    let mut text = String::from("energies relative to independent samples, geometric mean over the scenes\n");
    let mut line = |name: &str, what: &str, values: Vec<f64>| {
        let values: String = values.iter().map(|value| format!(" {value:6.3}")).collect();
        writeln!(text, "{name:<22} {what:<12}{values}").unwrap_or(());
    };
    let counts = (0..9).map(|k| f64::from(1 << k)).collect();
    line("", "samples", counts);
    type Energy = (&'static str, fn(&SceneError) -> f64);
    let energies: [Energy; 3] = [("sigma 2.1", |e| e.wide), ("sigma 1", |e| e.narrow), ("raw", |e| e.raw)];
    for (what, energy) in energies {
        for sampler in judged {
            let counts = 0..sampler.errors.first().map_or(0, Vec::len);
            let mean = |i: usize| {
                let logs = sampler.errors.iter().map(|rows| libm::log(energy(&rows[i]).max(1e-300)));
                libm::exp(logs.sum::<f64>() / scenes.len() as f64)
            };
            line(&sampler.name, what, counts.map(mean).collect());
        }
    }
    for (number, scene) in scenes.iter().enumerate() {
        for sampler in judged {
            line(&sampler.name, scene, sampler.errors[number].iter().map(|row| row.wide).collect());
        }
    }
    let one = |sampler: &Judged| {
        let rows = scenes.iter().zip(&sampler.errors).map(|(scene, rows)| json!({ "scene": scene, "errors": rows }));
        json!({ "sampler": sampler.name, "scenes": rows.collect::<Vec<_>>() })
    };
    (text, json!({ "samplers": judged.iter().map(one).collect::<Vec<_>>() }))
}

/// Sobol's first two dimensions, each pixel's digits scrambled by random trees.
fn owen() -> Plane {
    let (size, samples) = OWEN;
    let scrambled = |value: u32, seed: u32| -> u32 {
        // Each bit depends on those before it: a hash of these, of which one bit is taken.
        (0..32).fold(0, |sum, bit| {
            let before = if bit == 0 { 0 } else { value >> (32 - bit) };
            let mut hash = (before ^ seed).wrapping_add(0x9e37_79b9_u32.wrapping_mul(bit + 1));
            hash = (hash ^ (hash >> 16)).wrapping_mul(0x21f0_aaad);
            hash = (hash ^ (hash >> 15)).wrapping_mul(0x735a_2d97);
            sum | ((value ^ (hash & 0x8000_0000) >> bit) & (0x8000_0000 >> bit))
        })
    };
    let pixel = |pixel: u64| {
        let mut rng = stream(3, 0, pixel);
        let seeds = [rng.next_u32(), rng.next_u32()];
        (0..samples as u32).map(move |i| {
            let [x, y] = table::net(i);
            [scrambled(x, seeds[0]), scrambled(y, seeds[1])].map(|value| (value >> 8) as f32 * UNIT)
        })
    };
    Plane { size, samples, points: (0..(size * size) as u64).flat_map(pixel).collect() }
}

/// The samples that a file stands for.
fn plane(path: &Path) -> Result<Plane> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("nft") => tile(path),
        Some("bin") => {
            let table = sidecar::read(path)?;
            let point = |pixel: usize, i: u32| table.point(pixel, i).map(|value| (value >> 8) as f32 * UNIT);
            let pixels = 0..table.size * table.size;
            let points = pixels.flat_map(|pixel| (0..256).map(move |i| point(pixel, i))).collect();
            Ok(Plane { size: table.size, samples: 256, points })
        }
        _ => points(path),
    }
}

fn tile(path: &Path) -> Result<Plane> {
    let file = TileFile::read(path)?;
    let Shape { size, spp, dims, .. } = file.header().shape();
    let (size, samples, dims) = (size as usize, spp as usize, dims as usize);
    if dims < 2 {
        return Err(in_file(path)(Error::input("a tile of one dimension is not judged by scenes")));
    }
    let coordinates = file.coordinates();
    let points = coordinates.chunks_exact(dims).take(size * size * samples).map(|point| [point[0], point[1]]).collect();
    Ok(Plane { size, samples, points })
}

/// A file that begins with `noisefloor-points WIDTH HEIGHT SAMPLES DIMS`.
fn points(path: &Path) -> Result<Plane> {
    let refuse = || Error::Input(format!("{} is no sampler's table (.bin), tile (.nft) or points", path.display()));
    let bytes = fs::read(path).map_err(Error::io(path))?;
    let end = bytes.iter().take(100).position(|byte| *byte == b'\n').ok_or_else(refuse)?;
    let line = std::str::from_utf8(&bytes[..end]).ok().and_then(|line| line.strip_prefix(POINTS)).ok_or_else(refuse)?;
    let numbers: Vec<usize> = line.split(' ').map_while(|number| number.parse().ok()).collect();
    let [width, height, samples, 2] = numbers[..] else { return Err(refuse()) };
    let values = bytes[end + 1..].as_chunks::<4>().0;
    let wanted = width.checked_mul(height).and_then(|n| n.checked_mul(samples)).and_then(|n| n.checked_mul(2));
    if width != height || width == 0 || samples == 0 || wanted != Some(values.len()) {
        return Err(refuse());
    }
    let points = values.as_chunks::<2>().0.iter().map(|point| point.map(f32::from_le_bytes)).collect();
    Ok(Plane { size: width, samples, points })
}
