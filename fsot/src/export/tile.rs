//! Tiles for programs that do not link noisefloor: textures, raw numbers, C and Rust source.
//!
//! A texture stacks its layers from top to bottom, each `size` x `size` texels: layer
//! `(frame * spp + sample) * groups + group`, where group 0 has coordinates 1 to 4, group 1 coordinates 5 to 8. In memory
//! that is the layout of a texture array. Red, green, blue and alpha are the coordinates in order. An integer texel v of b bits
//! stands for the coordinate (v + 0.5) / 2^b, never 1; a GPU that reads v / (2^b - 1) must undo that.

use crate::error::{Error, Result};
use image::{DynamicImage, ImageBuffer, ImageFormat};
use std::fmt::Write;
use std::io::Cursor;

/// Numbers per line of source code.
const PER_LINE: usize = 16;
/// Coordinates per texel.
const CHANNELS: usize = 4;

/// What a tile consists of.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Pixels along each side.
    pub size: usize,
    /// Samples per pixel.
    pub spp: usize,
    /// Coordinates per sample, 1 to 8.
    pub dims: usize,
    /// Frames of an animation.
    pub frames: usize,
    /// Bits per coordinate, 8 or 16.
    pub bits: usize,
    /// Integers of that many bits, little-endian, `[frame][y][x][sample][dim]`.
    pub payload: &'a [u8],
}

impl View<'_> {
    /// The number of coordinates.
    fn count(&self) -> usize {
        self.frames * self.size * self.size * self.spp * self.dims
    }

    /// # Errors
    /// The payload has another length than the header says.
    fn checked(&self) -> Result<()> {
        if matches!(self.bits, 8 | 16)
            && (1..=8).contains(&self.dims)
            && self.payload.len() == self.count() * self.bits / 8
        {
            return Ok(());
        }
        Err(Error::Input(format!(
            "a tile of {} coordinates of {} bits cannot have {} bytes",
            self.count(),
            self.bits,
            self.payload.len()
        )))
    }

    /// The integer at an index of the payload.
    fn integer(&self, index: usize) -> u16 {
        let byte = |index: usize| self.payload.get(index).copied().unwrap_or_default();
        if self.bits == 8 { byte(index).into() } else { u16::from_le_bytes([byte(2 * index), byte(2 * index + 1)]) }
    }

    /// The coordinate of an integer.
    fn coordinate(&self, integer: u16) -> f32 {
        (f32::from(integer) + 0.5) / if self.bits == 8 { 256.0 } else { 65536.0 }
    }

    /// All coordinates, in the order of the payload.
    pub fn coordinates(&self) -> Vec<f32> {
        (0..self.count()).map(|index| self.coordinate(self.integer(index))).collect()
    }

    fn groups(&self) -> usize {
        self.dims.div_ceil(CHANNELS)
    }

    /// Width and height of the texture.
    fn extent(&self) -> (u32, u32) {
        (self.size as u32, (self.size * self.frames * self.spp * self.groups()) as u32)
    }

    /// The texels in order, `channels` numbers each; missing coordinates are `absent`.
    fn texels<T: Copy>(&self, channels: usize, absent: T, value: impl Fn(u16) -> T) -> Vec<T> {
        let groups = self.groups();
        let mut texels = Vec::with_capacity(self.count() / self.dims * groups * channels);
        for layer in 0..self.frames * self.spp * groups {
            let (group, sample, frame) = (layer % groups, layer / groups % self.spp, layer / groups / self.spp);
            for pixel in 0..self.size * self.size {
                let first = ((frame * self.size * self.size + pixel) * self.spp + sample) * self.dims;
                for axis in group * CHANNELS..group * CHANNELS + channels {
                    texels.push(if axis < self.dims { value(self.integer(first + axis)) } else { absent });
                }
            }
        }
        texels
    }
}

/// A PNG texture with the tile's bits per channel: grey for 1 coordinate, RGB for 2 (blue is 0) and 3, RGBA for more.
///
/// # Errors
/// The payload has another length than the header says.
pub fn png(tile: &View<'_>) -> Result<Vec<u8>> {
    tile.checked()?;
    let (width, height) = tile.extent();
    let channels = match tile.dims {
        1 => 1,
        2 | 3 => 3,
        _ => 4,
    };
    let picture = if tile.bits == 8 {
        let texels = tile.texels(channels, 0, |integer| integer as u8);
        match channels {
            1 => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageLuma8),
            3 => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgb8),
            _ => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgba8),
        }
    } else {
        let texels = tile.texels(channels, 0, |integer| integer);
        match channels {
            1 => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageLuma16),
            3 => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgb16),
            _ => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgba16),
        }
    };
    encode(picture, ImageFormat::Png)
}

/// An OpenEXR texture of 32-bit floats, the coordinates themselves: RGB for 1 to 3 of them (absent ones are 0), RGBA for more.
///
/// # Errors
/// The payload has another length than the header says.
pub fn exr(tile: &View<'_>) -> Result<Vec<u8>> {
    tile.checked()?;
    let (width, height) = tile.extent();
    let coordinate = |integer| tile.coordinate(integer);
    let picture = if tile.dims <= 3 {
        let texels = tile.texels(3, 0.0, coordinate);
        ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgb32F)
    } else {
        let texels = tile.texels(4, 0.0, coordinate);
        ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgba32F)
    };
    encode(picture, ImageFormat::OpenExr)
}

fn encode(picture: Option<DynamicImage>, format: ImageFormat) -> Result<Vec<u8>> {
    let picture = picture.ok_or_else(|| Error::input("the tile is too large for a picture"))?;
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).map_err(|error| Error::Input(format!("cannot make the picture: {error}")))?;
    Ok(bytes.into_inner())
}

/// C99 and C++: the dimensions as macros, the integers as a static constant array `NAME`.
///
/// # Errors
/// The payload has another length than the header says.
pub fn c_header(tile: &View<'_>, name: &str) -> Result<Vec<u8>> {
    tile.checked()?;
    let name = identifier(name).to_ascii_lowercase();
    let upper = name.to_ascii_uppercase();
    let mut text = format!(
        "/* Sample tile: {name}[{upper}_FRAMES][{upper}_SIZE (y)][{upper}_SIZE (x)][{upper}_SPP][{upper}_DIMS];\n   \
         coordinate = (integer + 0.5) / 2^{}, in [0, 1). */\n#ifndef {upper}_H\n#define {upper}_H\n\n\
         #include <stdint.h>\n\n",
        tile.bits
    );
    for (field, value) in fields(tile) {
        writeln!(text, "#define {upper}_{field} {value}").ok();
    }
    write!(text, "\nstatic const uint{}_t {name}[{}] = {{\n", tile.bits, tile.count()).ok();
    integers(tile, &mut text);
    write!(text, "}};\n\n#endif\n").ok();
    Ok(text.into_bytes())
}

/// A Rust module: the dimensions as constants, the integers as a static array `TILE`.
///
/// # Errors
/// The payload has another length than the header says.
pub fn rust(tile: &View<'_>, name: &str) -> Result<Vec<u8>> {
    tile.checked()?;
    let mut text = format!(
        "//! Sample tile {}: `TILE` is `[FRAMES][SIZE (y)][SIZE (x)][SPP][DIMS]`, coordinate = (integer + 0.5) / 2^{}, in [0, 1).\n\n",
        identifier(name),
        tile.bits
    );
    for (field, value) in fields(tile) {
        writeln!(text, "/// See `TILE`.\npub const {field}: usize = {value};").ok();
    }
    write!(text, "\n/// The integers.\n#[rustfmt::skip]\npub static TILE: [u{}; {}] = [\n", tile.bits, tile.count())
        .ok();
    integers(tile, &mut text);
    text.push_str("];\n");
    Ok(text.into_bytes())
}

fn fields(tile: &View<'_>) -> [(&'static str, usize); 5] {
    [("SIZE", tile.size), ("SPP", tile.spp), ("DIMS", tile.dims), ("FRAMES", tile.frames), ("BITS", tile.bits)]
}

fn integers(tile: &View<'_>, text: &mut String) {
    for index in 0..tile.count() {
        let end = if index % PER_LINE == PER_LINE - 1 || index + 1 == tile.count() { ",\n" } else { "," };
        write!(text, "{}{end}", tile.integer(index)).ok();
    }
}

/// A name that C and Rust accept: what is no letter, digit or underscore becomes `_`; a leading digit gets `tile_` before it.
fn identifier(name: &str) -> String {
    let name: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) { name } else { format!("tile_{name}") }
}
