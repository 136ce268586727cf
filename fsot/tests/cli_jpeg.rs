//! JPEG files: whole ones of every kind are read, damaged ones are refused.

use crate::cli_support::Place;
use fsot::read;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, GrayImage, Luma, Rgb, RgbImage};

/// Of 24 x 24 pixels: red grows to the right, green downwards, blue is 90.
const PROGRESSIVE: &[u8] = include_bytes!("jpeg/progressive.jpg");
const CMYK: &[u8] = include_bytes!("jpeg/cmyk.jpg");

fn encoded(image: &DynamicImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 90).encode_image(image).unwrap();
    bytes
}

fn baseline() -> Vec<u8> {
    encoded(&RgbImage::from_fn(24, 24, |x, y| Rgb([x * 11, y * 11, 90].map(|value| value as u8))).into())
}

#[test]
fn whole_files_of_every_kind_are_read() {
    let place = Place::new();
    let whole = baseline();
    let (start, rest) = whole.split_at(2);
    for (name, bytes) in [
        ("baseline", whole.clone()),
        ("progressive", PROGRESSIVE.to_vec()),
        ("CMYK", CMYK.to_vec()),
        ("a comment, and bytes that fill", [start, b"\xff\xff\xff\xfe\x00\x06what", rest].concat()),
        ("an unknown segment with an end in it", [start, b"\xff\xef\x00\x06ab\xff\xd9", rest].concat()),
        ("trailing bytes", [&whole[..], b"more \xff\xd8 of it"].concat()),
    ] {
        place.write("in.jpg", bytes);
        let (photo, _) = read::photo(&place.path("in.jpg")).unwrap_or_else(|error| panic!("{name}: {error}"));
        let difference = |i: usize| {
            let expected = [(i % 24 * 11) as f32, (i / 24 * 11) as f32, 90.0];
            (0..3).map(|k| (photo.pixels[i][k] - expected[k] / 255.0).abs()).fold(0.0, f32::max)
        };
        let mean = (0..24 * 24).map(difference).sum::<f32>() / (24.0 * 24.0);
        assert!((photo.width, photo.height) == (24, 24) && mean < 0.06, "{name}: {mean}");
    }
    place.write("in.jpg", encoded(&GrayImage::from_fn(9, 5, |x, _| Luma([(x * 30) as u8])).into()));
    let (photo, _) = read::photo(&place.path("in.jpg")).unwrap();
    assert!((0..9).all(|x| (photo.pixels[x][0] - x as f32 * 30.0 / 255.0).abs() < 0.02));
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let place = Place::new();
    for whole in [baseline(), PROGRESSIVE.to_vec(), CMYK.to_vec()] {
        for length in 3..whole.len() {
            place.write("cut.jpg", &whole[..length]);
            let error = read::photo(&place.path("cut.jpg")).unwrap_err().to_string();
            assert!(error.contains("cut.jpg is a damaged JPEG file: "), "{length} of {}: {error}", whole.len());
        }
    }
    let damaged = "cut.jpg is a damaged JPEG file: it is truncated";
    place.refuse("stipple cut.jpg -n 9 -o out.png", damaged);
    place.refuse("stipple --frames c*.jpg --window 9 --step 9 -o out.png", damaged);
    place.refuse("points -n 9 --density cut.jpg -o out.txt", damaged);
    place.refuse("place -n 9 --map cut.jpg -o out.csv", damaged);
}

#[test]
fn data_that_is_no_pixels_is_refused() {
    let place = Place::new();
    let mut bytes = encoded(&RgbImage::from_fn(64, 64, |x, y| Rgb([(x * y) as u8, (x * 7) as u8, y as u8])).into());
    let middle = bytes.len() * 2 / 3;
    // A marker of an empty segment that no pixels may have among them.
    bytes[middle..middle + 4].copy_from_slice(b"\xff\x02\x00\x02");
    place.write("bad.jpg", bytes);
    place.refuse("stipple bad.jpg -n 9 -o out.png", "bad.jpg is a damaged JPEG file: ");
}
