//! Tiles for programs that do not link noisefloor: textures, raw numbers, C and Rust source.
//!
//! A texture stacks its layers from top to bottom, each `size` x `size` texels: layer
//! `(frame * spp + sample) * groups + group`, where group 0 has coordinates 1 to 4, group 1 coordinates 5 to 8. In
//! memory that is the layout of a texture array. Red, green, blue and alpha are the coordinates in order. An integer
//! texel v of b bits stands for the coordinate (v + 0.5) / 2^b, never 1; a GPU that reads v / (2^b - 1) must undo that.

use crate::error::{Error, Result};
use image::{DynamicImage, ImageBuffer, ImageFormat};
use noisefloor::tile::{Shape, Tile};
use std::fmt::Write;
use std::io::Cursor;

/// Numbers per line of source code.
const PER_LINE: usize = 16;
/// Coordinates per texel.
const CHANNELS: usize = 4;
/// The words of C and C++ in small letters, but for those that end in `_t`, and two macros of their compilers.
const KEYWORDS: &str = "alignas alignof and and_eq asm auto bitand bitor bool break case catch char class co_await \
    co_return co_yield compl concept const const_cast consteval constexpr constinit continue decltype default delete \
    do double dynamic_cast else enum explicit export extern false float for friend goto if inline int long mutable \
    namespace new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast \
    requires restrict return short signed sizeof static static_assert static_cast struct switch template this \
    thread_local throw true try typedef typeid typename typeof typeof_unqual union unsigned using virtual void \
    volatile while xor xor_eq linux unix";

fn count(tile: &Tile<'_>) -> usize {
    tile.shape().coordinates() as usize
}

/// The integer at an index of the payload.
fn integer(tile: &Tile<'_>, index: usize) -> u16 {
    let byte = |index: usize| tile.payload().get(index).copied().unwrap_or_default();
    if tile.shape().bits == 8 { byte(index).into() } else { u16::from_le_bytes([byte(2 * index), byte(2 * index + 1)]) }
}

/// The coordinate of an integer.
fn coordinate(tile: &Tile<'_>, integer: u16) -> f32 {
    (f32::from(integer) + 0.5) / if tile.shape().bits == 8 { 256.0 } else { 65536.0 }
}

/// All coordinates, in the order of the payload.
pub fn coordinates(tile: &Tile<'_>) -> Vec<f32> {
    (0..count(tile)).map(|index| coordinate(tile, integer(tile, index))).collect()
}

/// A texture's width, its height, and its texels in order, `channels` numbers each; missing coordinates are `absent`.
fn texture<T: Copy>(tile: &Tile<'_>, channels: usize, absent: T, value: impl Fn(u16) -> T) -> (u32, u32, Vec<T>) {
    let Shape { size, spp, dims, frames, .. } = tile.shape();
    let [side, spp, dims, frames] = [size, spp, dims, frames].map(|length| length as usize);
    let groups = dims.div_ceil(CHANNELS);
    let layers = frames * spp * groups;
    let mut texels = Vec::with_capacity(layers * side * side * channels);
    for layer in 0..layers {
        let (group, sample, frame) = (layer % groups, layer / groups % spp, layer / groups / spp);
        for pixel in 0..side * side {
            let first = ((frame * side * side + pixel) * spp + sample) * dims;
            for axis in group * CHANNELS..group * CHANNELS + channels {
                texels.push(if axis < dims { value(integer(tile, first + axis)) } else { absent });
            }
        }
    }
    (size, size * layers as u32, texels)
}

/// A PNG texture with the tile's bits per channel: grey for 1 coordinate, RGB for 2 (blue is 0) and 3, RGBA for more.
///
/// # Errors
/// A picture of this size cannot be encoded.
pub fn png(tile: &Tile<'_>) -> Result<Vec<u8>> {
    let channels = match tile.shape().dims {
        1 => 1,
        2 | 3 => 3,
        _ => 4,
    };
    let picture = if tile.shape().bits == 8 {
        let (width, height, texels) = texture(tile, channels, 0, |integer| integer as u8);
        match channels {
            1 => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageLuma8),
            3 => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgb8),
            _ => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgba8),
        }
    } else {
        let (width, height, texels) = texture(tile, channels, 0, |integer| integer);
        match channels {
            1 => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageLuma16),
            3 => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgb16),
            _ => ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgba16),
        }
    };
    encode(picture, ImageFormat::Png)
}

/// An OpenEXR texture of 32-bit floats, the coordinates themselves: RGB for 1 to 3 of them (absent ones are 0), RGBA
/// for more.
///
/// # Errors
/// As [`png`].
pub fn exr(tile: &Tile<'_>) -> Result<Vec<u8>> {
    let coordinate = |integer| coordinate(tile, integer);
    let picture = if tile.shape().dims <= 3 {
        let (width, height, texels) = texture(tile, 3, 0.0, coordinate);
        ImageBuffer::from_raw(width, height, texels).map(DynamicImage::ImageRgb32F)
    } else {
        let (width, height, texels) = texture(tile, 4, 0.0, coordinate);
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

/// C99 and C++: the dimensions as macros, the integers as a static constant array `NAME`, or `tile_NAME` if the
/// language or `stdint.h` may have given the name a meaning.
pub fn c_header(tile: &Tile<'_>, name: &str) -> Vec<u8> {
    let mut name = identifier(name).to_ascii_lowercase();
    if name.ends_with("_t") || KEYWORDS.split_whitespace().any(|word| word == name) {
        name.insert_str(0, "tile_");
    }
    let upper = name.to_ascii_uppercase();
    let mut text = format!(
        "/* Sample tile: {name}[{upper}_FRAMES][{upper}_SIZE (y)][{upper}_SIZE (x)][{upper}_SPP][{upper}_DIMS];\n   \
         coordinate = (integer + 0.5) / 2^{}, in [0, 1). */\n#ifndef {upper}_H\n#define {upper}_H\n\n\
         #include <stdint.h>\n\n",
        tile.shape().bits
    );
    for (field, value) in fields(tile) {
        writeln!(text, "#define {upper}_{field} {value}").ok();
    }
    write!(text, "\nstatic const uint{}_t {name}[{}] = {{\n", tile.shape().bits, count(tile)).ok();
    integers(tile, &mut text);
    text.push_str("};\n\n#endif\n");
    text.into_bytes()
}

/// A Rust module: the dimensions as constants, the integers as a static array `TILE`.
pub fn rust(tile: &Tile<'_>, name: &str) -> Vec<u8> {
    let mut text = format!(
        "//! Sample tile {}: `TILE` is `[FRAMES][SIZE (y)][SIZE (x)][SPP][DIMS]`, coordinate = (integer + 0.5) \
         / 2^{}, in [0, 1).\n\n",
        identifier(name),
        tile.shape().bits
    );
    for (field, value) in fields(tile) {
        writeln!(text, "/// See `TILE`.\npub const {field}: usize = {value};").ok();
    }
    write!(
        text,
        "\n/// The integers.\n#[rustfmt::skip]\npub static TILE: [u{}; {}] = [\n",
        tile.shape().bits,
        count(tile)
    )
    .ok();
    integers(tile, &mut text);
    text.push_str("];\n");
    text.into_bytes()
}

fn fields(tile: &Tile<'_>) -> [(&'static str, u32); 5] {
    let Shape { size, spp, dims, frames, bits, .. } = tile.shape();
    [("SIZE", size), ("SPP", spp), ("DIMS", dims), ("FRAMES", frames), ("BITS", bits)]
}

fn integers(tile: &Tile<'_>, text: &mut String) {
    for index in 0..count(tile) {
        let end = if index % PER_LINE == PER_LINE - 1 || index + 1 == count(tile) { ",\n" } else { "," };
        write!(text, "{}{end}", integer(tile, index)).ok();
    }
}

/// A name that C and Rust accept: what is no letter, digit or underscore becomes `_`; a leading digit gets `tile_`
/// before it.
fn identifier(name: &str) -> String {
    let name: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) { name } else { format!("tile_{name}") }
}
