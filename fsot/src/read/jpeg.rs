//! JPEG files, the whole of them: the `image` crate decodes whatever there is, and invents the rest.

use image::{ColorType, DynamicImage, GrayImage, RgbImage};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// The pixels, of the colour that [`image`] gives such a file.
///
/// # Errors
/// What is wrong with the file, or that its end is missing.
pub(super) fn decode(bytes: &[u8], size: (u32, u32), colour: ColorType) -> Result<DynamicImage, String> {
    // A cut within the last row of blocks is none to the decoder.
    if !has_end(bytes) {
        return Err("it is truncated".to_owned());
    }
    let grey = colour == ColorType::L8;
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_out_colorspace(if grey { ColorSpace::Luma } else { ColorSpace::RGB });
    let pixels = JpegDecoder::new_with_options(ZCursor::new(bytes), options).decode();
    let pixels = pixels.map_err(|error| error.to_string())?;
    let image = if grey {
        GrayImage::from_raw(size.0, size.1, pixels).map(DynamicImage::from)
    } else {
        RgbImage::from_raw(size.0, size.1, pixels).map(DynamicImage::from)
    };
    image.ok_or_else(|| "it has another number of pixels than its header says".to_owned())
}

/// Whether the marker of the image's end is there, outside of segments such as a thumbnail's.
fn has_end(bytes: &[u8]) -> bool {
    const MARKER: u8 = 0xff;
    let mut rest = bytes;
    loop {
        let Some(at) = rest.iter().position(|byte| *byte == MARKER) else { return false };
        match rest.get(at + 1) {
            Some(0xd9) => return true,
            // Two bytes of this value may be one that fills, and a marker.
            Some(&MARKER) => rest = &rest[at + 1..],
            // A value of the pixels' data, or markers without a segment: restarts, the start of the image.
            Some(0x00 | 0x01 | 0xd0..=0xd8) => rest = &rest[at + 2..],
            Some(_) => {
                let length = rest[at + 2..].first_chunk().map_or(0, |length| u16::from_be_bytes(*length));
                let Some(behind) = rest.get(at + 2 + usize::from(length)..) else { return false };
                rest = behind;
            }
            None => return false,
        }
    }
}
