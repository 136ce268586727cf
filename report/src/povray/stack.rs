//! Stacks of pictures: rendered when they are needed, and kept in target/povray. tests/povray/stack.hpp reads them and
//! says what is in them.

use super::scenes::Scene;
use super::{frames, ppm};
use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use xtask::paths;

/// The largest value of a picture; POV-Ray writes it for all that is brighter too.
const WHITE: u16 = 65535;

/// The stack of a scene, rendered if it is not there.
pub(crate) fn get(scene: &Scene, cells: &[u32], size: u32) -> Result<PathBuf> {
    let folder = paths::target().join("povray");
    let path = folder.join(format!("{}-{size}-{}.stack", scene.name, key(scene, cells, size)?));
    if path.exists() {
        return Ok(path);
    }
    fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let scratch = tempfile::Builder::new().prefix(".frames-").tempdir_in(&folder);
    let scratch = scratch.with_context(|| format!("cannot write to {}", folder.display()))?;
    let count = cells.iter().product::<u32>() as usize;
    println!("   {}: {count} frames of {size} x {size} pixels", scene.name);
    // The last two tell the surfaces apart.
    frames::render(scene, cells, count + 2, size, scratch.path())?;
    let frame = |number| ppm::read(&frames::path(scratch.path(), number, count + 2), size);
    let surfaces = surfaces(&frame(count)?, &frame(count + 1)?);
    let values = gather((0..count).map(frame), count, size)?;
    let partial = scratch.path().join("stack");
    write(&partial, scene, cells, size, &[surfaces, values].concat())
        .with_context(|| format!("cannot write {}", partial.display()))?;
    fs::rename(&partial, &path).with_context(|| format!("cannot create {}", path.display()))?;
    Ok(path)
}

/// Changes when anything does that the pictures depend on.
fn key(scene: &Scene, cells: &[u32], size: u32) -> Result<String> {
    let mut hash = Sha256::new();
    for name in [format!("{}.pov", scene.name), "stack.inc".to_owned()] {
        let path = frames::folder().join(name);
        hash.update(fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?);
    }
    // How they are rendered and gathered, too.
    hash.update(include_str!("frames.rs"));
    hash.update(include_str!("stack.rs"));
    hash.update(format!("{:?} {cells:?} {size} {}", scene.axes, frames::version()?));
    Ok(hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect())
}

/// Pixel by pixel, and in each frame by frame, what comes frame by frame.
fn gather(frames: impl Iterator<Item = Result<Vec<u16>>>, count: usize, size: u32) -> Result<Vec<u16>> {
    let mut values = vec![0; 3 * count * size as usize * size as usize];
    for (number, frame) in frames.enumerate() {
        let frame = frame?;
        if let Some(at) = frame.iter().position(|&value| value == WHITE) {
            let pixel = at / 3;
            bail!(
                "frame {} is clipped: its pixel ({}, {}) is {WHITE}, which stands for all that is brighter too; \
                 dim the scene's lights",
                number + 1,
                pixel % size as usize,
                pixel / size as usize
            );
        }
        for (pixel, rgb) in frame.chunks_exact(3).enumerate() {
            let at = 3 * (pixel * count + number);
            values[at..at + 3].copy_from_slice(rgb);
        }
    }
    Ok(values)
}

/// Numbers for what pixels show: the material, and which way, of six, the surface faces. 0: nothing.
fn surfaces(materials: &[u16], normals: &[u16]) -> Vec<u16> {
    let pixels = materials.chunks_exact(3).zip(normals.chunks_exact(3));
    pixels
        .map(|(material, normal)| {
            let material = (f64::from(material[0]) / f64::from(WHITE) * 255.0).round() as u16;
            // Half of white is a normal at right angles to the axis.
            let slopes = [0, 1, 2].map(|axis| i32::from(normal[axis]) - i32::from(WHITE / 2));
            let axis = (0..3).max_by_key(|&axis| slopes[axis].abs()).unwrap_or(0);
            let side = 2 * axis as u16 + u16::from(slopes[axis] > 0);
            if material == 0 { 0 } else { 1 + 6 * material + side }
        })
        .collect()
}

fn write(path: &Path, scene: &Scene, cells: &[u32], size: u32, numbers: &[u16]) -> Result<()> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    let mut header = format!("noisefloor-stack 1\nsize {size} {size}\n");
    for (axis, cells) in scene.axes.iter().zip(cells) {
        header += &format!("axis {} {cells}\n", axis.name());
    }
    header += &format!("checksum {:016x}\ndata\n", fnv(&bytes));
    let mut file = BufWriter::new(File::create(path)?);
    file.write_all(header.as_bytes())?;
    file.write_all(&bytes)?;
    file.into_inner()?.sync_all()?;
    Ok(())
}

/// FNV-1a, 64 bits.
fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksum_is_fnv_1a() {
        // From the authors' list of test vectors.
        assert_eq!(fnv(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn values_are_gathered_by_pixel_and_clipped_ones_refused() {
        let frames = [vec![1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12], vec![0; 12]];
        let values = gather(frames.iter().cloned().map(Ok), 2, 2).expect("two frames");
        assert_eq!(values[..9], [1, 2, 3, 0, 0, 0, 4, 5, 6]);
        let mut white = vec![0; 12];
        white[9] = WHITE;
        let error = gather([Ok(white)].into_iter(), 1, 2).expect_err("a clipped frame");
        assert!(error.to_string().contains("pixel (1, 1)"), "{error}");
    }

    #[test]
    fn surfaces_tell_materials_and_sides() {
        let material = |number: u32| (number * u32::from(WHITE) / 255) as u16;
        let normals = [40000, 30000, 32000, 32767, 32767, 0, 0, 0, 0];
        let numbers = surfaces(&[material(3), 0, 0, material(255), 0, 0, 0, 0, 0], &normals);
        assert_eq!(numbers, [1 + 18 + 1, 1 + 6 * 255 + 4, 0]);
    }
}
