//! `fsot measure --scenes`: samplers in tables of rendered scenes.

use crate::measure::in_file;
use fsot::error::{Error, Result};
use fsot::export::nft::TileFile;
use fsot::metrics::scenes::{self, Count, Energies, Frames, PLACES, Plane, SceneTable};
use fsot::random::stream;
use fsot::read;
use fsot::sampler::{sidecar, table};
use noisefloor::sampler::Sampler;
use noisefloor::tile::Shape;
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Pixels and samples of independent and of Owen-scrambled points.
const PEERS: (usize, usize) = (128, 256);
/// The first line of a file of points begins so.
const POINTS: &str = "noisefloor-points ";
/// One number of 24 bits in [0, 1).
const UNIT: f32 = 1.0 / 16_777_216.0;

/// How frames are averaged, and the samples that they need.
const FRAMES: [(&str, Frames); 3] =
    [("frames", Frames::Still), ("moving", Frames::Moving), ("clamped", Frames::Clamped)];
const FRAMES_OF: usize = 64;
/// Two-sided 95 % of Student's t with as many degrees of freedom as places less one: places are drawn independently.
const STUDENT: f64 = 2.0687;

/// A sampler and its errors.
struct Judged {
    name: String,
    plane: Plane,
    /// What the columns stand for.
    columns: Vec<String>,
    /// `[scene][column]`
    errors: Vec<Vec<Energies>>,
    /// Sums of logarithms over scenes: `[count - 1][place]`
    raw: Vec<[f64; PLACES]>,
}

/// Judges the samplers in all tables of a folder.
///
/// # Errors
/// A file cannot be read, or is none of a sampler; there is no table.
pub(crate) fn run(folder: &Path, files: &[PathBuf]) -> Result<(String, Value)> {
    let (size, samples) = PEERS;
    let mut judged = vec![
        Judged::new("independent".to_owned(), scenes::white(size, samples)),
        Judged::new("Owen-scrambled Sobol'".to_owned(), owen()),
        Judged::new("a domain, frame 0".to_owned(), domain(samples, |number| [0, number])),
        Judged::new("a domain, 16 a frame".to_owned(), domain(FRAMES_OF, |number| [number / 16, number % 16])),
    ];
    for path in files {
        judged.push(Judged::new(path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), plane(path)?));
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
        judged.iter_mut().try_for_each(|sampler| sampler.judge(&table))?;
    }
    let scene = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(describe(&paths.iter().map(scene).collect::<Vec<_>>(), &judged))
}

impl Judged {
    fn new(name: String, plane: Plane) -> Judged {
        let counts = counts(plane.samples).into_iter().map(|count| match count {
            Count::All(count) => count.to_string(),
            Count::Adapted => "adapted".to_owned(),
            Count::Mixed => "mixed".to_owned(),
        });
        let frames = FRAMES.iter().filter(|_| plane.samples >= FRAMES_OF).map(|(name, _)| (*name).to_owned());
        let columns = counts.chain(frames).collect();
        let raw = vec![[0.0; PLACES]; plane.samples];
        Judged { name, plane, columns, errors: Vec::new(), raw }
    }

    fn judge(&mut self, table: &SceneTable) -> Result<()> {
        let mut errors = table.errors(&self.plane, &counts(self.plane.samples))?;
        if self.plane.samples >= FRAMES_OF {
            for (_, way) in FRAMES {
                errors.push(table.frames(&self.plane, way)?);
            }
        }
        self.errors.push(errors);
        for (sums, energies) in self.raw.iter_mut().zip(table.raw(&self.plane)) {
            sums.iter_mut().zip(energies).for_each(|(sum, energy)| *sum += libm::log(energy.max(1e-300)));
        }
        Ok(())
    }

    /// The geometric mean over the scenes, of a column.
    fn mean(&self, column: &str, energy: fn(&Energies) -> f64) -> Option<f64> {
        let column = self.columns.iter().position(|name| name == column)?;
        let logs: f64 = self.errors.iter().map(|row| libm::log(energy(&row[column]).max(1e-300))).sum();
        Some(libm::exp(logs / self.errors.len() as f64))
    }

    /// Raw over that of others, of n samples: geometric means over scenes and places, with half an interval of 95 % for
    /// that over all places. The samples are the same in all of them: how others of their kind differ it does not say.
    fn beside(&self, others: &Judged) -> Vec<(f64, f64)> {
        let scenes = self.errors.len() as f64;
        let ratio = |(own, other): (&[f64; PLACES], &[f64; PLACES])| {
            let logs: [f64; PLACES] = std::array::from_fn(|place| (own[place] - other[place]) / scenes);
            let mean = logs.iter().sum::<f64>() / PLACES as f64;
            let squares: f64 = logs.iter().map(|log| (log - mean) * (log - mean)).sum();
            let error = libm::sqrt(squares / (PLACES * (PLACES - 1)) as f64);
            (libm::exp(mean), libm::exp(mean) * error * STUDENT)
        };
        self.raw.iter().zip(&others.raw).map(ratio).collect()
    }
}

/// The numbers of samples that a plane is judged at.
fn counts(samples: usize) -> Vec<Count> {
    let powers = (0..9).map(|k| 1 << k).filter(|count| *count <= samples).map(Count::All);
    powers.chain([Count::Adapted, Count::Mixed].into_iter().filter(|_| samples >= 8)).collect()
}

fn describe(scenes: &[String], judged: &[Judged]) -> (String, Value) {
    let columns = &judged[0].columns;
    let mut text = String::from("energies relative to independent samples, geometric mean over the scenes\n");
    write!(text, "{:<22} {:<12}", "", "samples").unwrap_or(());
    columns.iter().for_each(|column| write!(text, "{column:>8}").unwrap_or(()));
    text.push('\n');
    let mut line = |sampler: &Judged, what: &str, value: &dyn Fn(&str) -> Option<f64>| {
        let value = |column: &String| value(column).map_or_else(String::new, |value| format!("{value:.3}"));
        let values: String = columns.iter().map(|column| format!("{:>8}", value(column))).collect();
        writeln!(text, "{:<22} {what:<12}{}", sampler.name, values.trim_end()).unwrap_or(());
    };
    type Energy = (&'static str, fn(&Energies) -> f64);
    let energies: [Energy; 3] = [("sigma 2.1", |e| e.wide), ("sigma 1", |e| e.narrow), ("raw", |e| e.raw)];
    for (what, energy) in energies {
        for sampler in judged {
            line(sampler, what, &|column| sampler.mean(column, energy));
        }
    }
    for (number, scene) in scenes.iter().enumerate() {
        for sampler in &judged[1..] {
            let column = |name: &str| sampler.columns.iter().position(|column| column == name);
            line(sampler, scene, &|name| Some(sampler.errors[number][column(name)?].wide));
        }
    }
    let owen = &judged[1];
    for sampler in &judged[2..] {
        let ratios = sampler.beside(owen);
        let worst = (1..).zip(&ratios).max_by(|a, b| a.1.0.total_cmp(&b.1.0));
        if let Some((count, (ratio, half))) = worst {
            let most = ratios.len();
            let name = &sampler.name;
            let what = format!("{ratio:.3} +- {half:.3} of {}'s at {count}", owen.name);
            let note = "+- by where the image lies in these very samples, not by other seeds; as the largest of many, \
                        it tends to be too large";
            writeln!(text, "{name:<22} raw, worst of 1 to {most} samples: {what} ({note})").unwrap_or(());
        }
    }
    let one = |sampler: &Judged| {
        let row = |errors: &Vec<Energies>| -> Value {
            sampler.columns.iter().zip(errors).map(|(column, energies)| (column.clone(), json!(energies))).collect()
        };
        let rows: Value =
            scenes.iter().zip(&sampler.errors).map(|(scene, errors)| (scene.clone(), row(errors))).collect();
        json!({ "sampler": sampler.name, "scenes": rows, "raw over Owen": sampler.beside(owen) })
    };
    (text, json!({ "samplers": judged.iter().map(one).collect::<Vec<_>>() }))
}

/// Sobol's first two dimensions, each pixel's digits scrambled by random trees.
fn owen() -> Plane {
    let (size, samples) = PEERS;
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

/// The library's sampler as a decision of a path draws from it: of each sample the frame and the index there.
fn domain(samples: usize, at: fn(u32) -> [u32; 2]) -> Plane {
    let size = PEERS.0;
    let point = |(pixel, number)| {
        let ([frame, index], [x, y]) = (at(number), [pixel % size, pixel / size].map(|place| place as u32));
        Sampler::pixel(x, y, frame, index).domain(1).draw()
    };
    let samples_of = |pixel| (0..samples as u32).map(move |number| (pixel, number));
    Plane { size, samples, points: (0..size * size).flat_map(samples_of).map(point).collect() }
}

/// The samples that a file stands for.
fn plane(path: &Path) -> Result<Plane> {
    match &read::ending(path)[..] {
        "nft" => tile(path),
        "bin" => {
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
    const NONE: &str = "no sampler's table (.bin), tile (.nft) or `noisefloor-points`";
    let refuse = || Err(Error::Input(format!("{} is {NONE}", path.display())));
    let (numbers, values) = read::floats(path, POINTS, NONE)?;
    let [width, height, samples, 2] = numbers[..] else { return refuse() };
    let wanted = width.checked_mul(height).and_then(|n| n.checked_mul(samples)).and_then(|n| n.checked_mul(2));
    if width != height || width == 0 || samples == 0 || wanted != Some(values.len()) {
        return refuse();
    }
    if let Some(index) = values.iter().position(|value| !(0.0..1.0).contains(value)) {
        return Err(Error::Input(format!(
            "{}: point {} has {} as coordinate {}: coordinates must be numbers in [0, 1)",
            path.display(),
            index / 2 + 1,
            values[index],
            index % 2 + 1
        )));
    }
    Ok(Plane { size: width, samples, points: values.as_chunks::<2>().0.to_vec() })
}
