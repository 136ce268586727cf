//! Tile files (`.nft`), written and read through `noisefloor::tile`.

use super::tile;
use crate::counted;
use crate::error::{Error, Result};
use crate::read;
use noisefloor::tile::{HEADER_BYTES, Header, Shape, Tile, quantize};
use std::path::Path;

/// A tile's file, checked.
#[derive(Clone, Debug)]
pub struct TileFile {
    header: Header,
    bytes: Vec<u8>,
}

/// The header of a tile's file, which holds for any coordinates.
///
/// # Errors
/// A shape that tiles cannot have; a kernel's text of more than 80 bytes or not ASCII.
pub fn header(shape: Shape, seed: u64, kernel: &str) -> Result<Header> {
    let Shape { size, spp, dims, frames, bits, .. } = shape;
    Header::new(shape, seed, kernel).map_err(|_| {
        Error::Input(format!(
            "a tile file cannot hold {} in {bits} bits, made for `{kernel}`: the size is a power of two up to 1024, \
             the samples one up to 256, and there are at most 256 frames",
            counted::tile(size as usize, spp as usize, dims as usize, frames as usize)
        ))
    })
}

impl TileFile {
    /// Quantises `coordinates`, `[frame][y][x][sample][dim]` in [0, 1), to `shape.bits` bits. `kernel` says what the
    /// tile was optimised for.
    ///
    /// # Errors
    /// As [`header`]; not as many coordinates as the shape says.
    pub fn new(shape: Shape, seed: u64, kernel: &str, coordinates: &[f32]) -> Result<TileFile> {
        let header = header(shape, seed, kernel)?;
        let payload: Vec<u8> = if shape.bits == 8 {
            coordinates.iter().map(|u| quantize(*u, shape.bits) as u8).collect()
        } else {
            coordinates.iter().flat_map(|u| quantize(*u, shape.bits).to_le_bytes()).collect()
        };
        let head = header.encode(&payload).map_err(|_| {
            Error::Input(format!("{} cannot make such a tile", counted::counted(coordinates.len(), "coordinate")))
        })?;
        Ok(TileFile { header, bytes: [&head[..], &payload].concat() })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read, is no tile, of a newer version, truncated or damaged.
    pub fn read(path: &Path) -> Result<TileFile> {
        let bytes = read::tile(path)?;
        let (header, _) = Header::decode(&bytes).map_err(|error| {
            let why = match error {
                noisefloor::Error::Foreign => "not a tile file (.nft)",
                noisefloor::Error::Version => "a tile file of a newer version: use a newer fsot",
                noisefloor::Error::Length => "a tile file that is truncated, or that has trailing bytes",
                _ => "a damaged tile file",
            };
            Error::Input(format!("{} is {why}", path.display()))
        })?;
        Ok(TileFile { header, bytes })
    }

    /// What the file says about the tile.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The whole file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The integers, as [`export::tile`](super::tile) takes them.
    pub fn view(&self) -> Tile<'_> {
        Tile::resume(self.header.shape(), self.bytes.get(HEADER_BYTES..).unwrap_or_default())
    }

    /// The coordinates as a sampler returns them, `[frame][y][x][sample][dim]`.
    pub fn coordinates(&self) -> Vec<f32> {
        tile::coordinates(&self.view())
    }
}
