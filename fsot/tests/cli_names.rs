//! Outputs whose names end in what the file is not.

use crate::cli_support::{Place, error};
use image::{GrayImage, Luma};

const TILE: &str = "tile --size 16 --iterations 1 --integrands 1 --quiet";

#[test]
fn a_tile_ends_in_nft() {
    let place = Place::new();
    for (name, message) in [
        ("a.png", "use --out a.nft, then `fsot export a.nft --format png --out a.png`"),
        ("a.EXR", "--format exr --out a.EXR"),
        ("a.bin", "--format raw --out a.bin"),
        ("a.h", "--format c-header --out a.h"),
        ("a.rs", "--format rust --out a.rs"),
        ("a.txt", "a.txt is no name for a tile: end it in .nft"),
        ("tile.v2", "end it in .nft"),
    ] {
        for options in ["--size 16 --iterations 1 --integrands 1", "--preset 64_1SPP_2D --iterations 1"] {
            let arguments = format!("tile {options} --out {name}");
            place.refuse(&arguments, message);
            // Before the work, whose cost would be said.
            let said = error(&place.run(&arguments));
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    }
    for name in ["a.nft", "b.NFT", "c"] {
        place.succeed(&format!("{TILE} --out {name}"));
        place.succeed(&format!("info {name}"));
    }
    let piped = place.run(&format!("{TILE} --out -"));
    assert_eq!(piped.stdout, place.read("a.nft"));
}

#[test]
fn a_sampler_ends_in_bin() {
    let place = Place::new();
    for name in ["s.nft", "s.toml", "s"] {
        let message = format!("{name} is no name for the table of a sampler: end it in .bin");
        place.refuse(&format!("sampler --iterations 1 --out {name}"), &message);
    }
}

#[test]
fn pictures_end_in_what_they_are() {
    let place = Place::new();
    place.write("p.txt", "0.1 0.2\n0.7 0.4\n0.3 0.9\n0.6 0.6\n");
    GrayImage::from_fn(9, 9, |x, _| Luma([x as u8 * 20])).save(place.path("in.png")).unwrap();
    for (arguments, message) in [
        ("spectrum p.txt --out s.jpg", "s.jpg would be PNG or SVG, not jpg: end its name in .png or .svg"),
        ("measure p.txt --prefix --plot p.jpeg", "p.jpeg would be PNG or SVG, not jpeg: end its name in .png or .svg"),
        ("points -n 9 --out o.txt --png p.svg", "p.svg would be PNG"),
        ("points -n 9 --out o.txt --svg p.png", "p.png would be SVG"),
        ("points -n 9 --out p.png", "p.png would be a table of points, not a picture"),
        ("points -n 9 --out t.nft", "t.nft would be a table of points, not a tile"),
        ("points -n 9 --out o.txt --png t.nft", "t.nft would be PNG, not nft"),
        ("place -n 9 --out o.csv --png p.exr", "p.exr would be PNG"),
        ("stipple in.png -n 9 --out o.png --svg p.png", "p.png would be SVG"),
        ("stipple in.png -n 9 --out o.png --points p.png", "p.png would be a table of points"),
    ] {
        place.refuse(arguments, message);
    }
}

#[test]
fn a_preset_of_classes_is_no_file() {
    let place = Place::new();
    for _ in 0..2 {
        place.succeed("points -n 9 --iterations 1 --classes ramp --quiet --out ramp");
    }
}

#[test]
fn an_export_is_not_named_like_a_tile_or_another_picture() {
    let place = Place::new();
    place.succeed(&format!("{TILE} --out t.nft"));
    for (format, name, message) in [
        ("raw", "t.nft", "t.nft is the name of a tile: give the raw file another"),
        ("png", "t.nft", "t.nft is the name of a tile"),
        ("raw", "t.png", "t.png would be the raw file, not png: give it another ending"),
        ("png", "t.exr", "t.exr would be PNG, not exr: end its name in .png"),
        ("exr", "t.png", "t.png would be EXR"),
    ] {
        place.refuse(&format!("export t.nft --format {format} --out {name}"), message);
    }
}
