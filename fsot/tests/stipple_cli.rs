//! `fsot stipple`: its files, and bad pictures.

use image::{ImageFormat, Rgb, RgbImage};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn fsot(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fsot")).current_dir(folder).arg("stipple").args(arguments).output().unwrap()
}

/// A picture with colours, light and dark.
fn picture() -> RgbImage {
    RgbImage::from_fn(60, 40, |x, y| Rgb([(x * 4) as u8, (y * 6) as u8, 255 - (x * 4) as u8]))
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut names: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into()).collect();
    names.sort();
    names
}

/// Runs, expects exit code 2, a sentence with `expected` in it, and no file more than before.
fn refused(folder: &Path, arguments: &[&str], expected: &str) {
    let before = files(folder);
    let output = fsot(folder, arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(said.contains(expected), "{arguments:?}: {said}");
    assert!(!said.contains("panicked"), "{said}");
    assert_eq!(files(folder), before, "{arguments:?}");
}

#[test]
fn a_picture_becomes_png_svg_and_points() {
    let folder = tempfile::tempdir().unwrap();
    picture().save(folder.path().join("in.png")).unwrap();
    let output = fsot(
        folder.path(),
        &[
            "in.png",
            "-n",
            "800",
            "--cmyk",
            "--iterations",
            "30",
            "-o",
            "out.png",
            "--svg",
            "out.svg",
            "--points",
            "out.csv",
        ],
    );
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("blurred PSNR") && said.contains("sigma"), "{said}");
    let drawn = image::open(folder.path().join("out.png")).unwrap();
    assert_eq!((drawn.width(), drawn.height()), (1024, 683));
    let text = std::fs::read_to_string(folder.path().join("out.svg")).unwrap();
    assert_eq!(text.matches("<circle").count(), 800);
    assert!(text.contains("multiply"));
    let table = fsot::read::points(&folder.path().join("out.csv")).unwrap();
    assert_eq!(table.points.len(), 800);
    assert!(table.classes.is_some_and(|labels| labels.names.iter().all(|name| "cmyk".contains(name.as_str()))));
    assert_eq!(files(folder.path()).len(), 4);
}

#[test]
fn threads_do_not_change_a_byte() {
    let folder = tempfile::tempdir().unwrap();
    picture().save(folder.path().join("in.png")).unwrap();
    let mut seen = Vec::new();
    for threads in ["1", "3"] {
        let arguments =
            ["in.png", "-n", "500", "--iterations", "20", "--threads", threads, "-o", "out.png", "--points", "out.txt"];
        assert!(fsot(folder.path(), &arguments).status.success());
        let read = |name| std::fs::read(folder.path().join(name)).unwrap();
        seen.push((read("out.png"), read("out.txt")));
    }
    assert!(seen[0] == seen[1]);
}

#[test]
fn the_content_of_a_picture_counts_and_not_its_name() {
    let folder = tempfile::tempdir().unwrap();
    picture().save_with_format(folder.path().join("jpeg.png"), ImageFormat::Jpeg).unwrap();
    let output = fsot(folder.path(), &["jpeg.png", "-n", "50", "--iterations", "2", "-o", "out.svg"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn bad_pictures_are_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("text.png"), "not a picture").unwrap();
    std::fs::write(path("empty.png"), "").unwrap();
    RgbImage::from_pixel(9, 9, Rgb([0; 3])).save(path("black.png")).unwrap();
    RgbImage::from_pixel(9, 9, Rgb([255; 3])).save(path("white.png")).unwrap();
    picture().save(path("in.png")).unwrap();
    let whole = std::fs::read(path("in.png")).unwrap();
    std::fs::write(path("cut.png"), &whole[..whole.len() / 2]).unwrap();
    // A header that promises 60,000 x 60,000 pixels: its checksum is right, the rest is missing.
    let mut huge = whole[..33].to_vec();
    huge[16..20].copy_from_slice(&60_000_u32.to_be_bytes());
    huge[20..24].copy_from_slice(&60_000_u32.to_be_bytes());
    let checksum = crc(&huge[12..29]);
    huge[29..33].copy_from_slice(&checksum.to_be_bytes());
    std::fs::write(path("huge.png"), &huge).unwrap();
    for (name, expected) in [
        ("missing.png", "missing.png"),
        ("text.png", "text.png is not a picture"),
        ("empty.png", "empty"),
        ("black.png", "black all over"),
        ("white.png", "white all over"),
        ("cut.png", "cut.png"),
        ("huge.png", "huge.png"),
    ] {
        refused(folder.path(), &[name, "-n", "100", "-o", "out.png"], expected);
        refused(folder.path(), &[name, "-n", "100", "--cmyk", "-o", "out.png"], expected);
    }
}

/// The checksum of a PNG chunk (ISO 3309), bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 })
    })
}

#[test]
fn one_pixel_and_long_lines_are_pictures() {
    let folder = tempfile::tempdir().unwrap();
    RgbImage::from_pixel(1, 1, Rgb([90, 120, 200])).save(folder.path().join("one.png")).unwrap();
    RgbImage::from_fn(3000, 1, |x, _| Rgb([(x / 12) as u8; 3])).save(folder.path().join("line.png")).unwrap();
    for name in ["one.png", "line.png"] {
        let output = fsot(folder.path(), &[name, "-n", "60", "--cmyk", "--iterations", "5", "-o", "out.png"]);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn arguments_that_make_no_sense() {
    let folder = tempfile::tempdir().unwrap();
    picture().save(folder.path().join("in.png")).unwrap();
    for (arguments, expected) in [
        (&["in.png", "-n", "0", "-o", "out.png"][..], "0"),
        (&["in.png", "-o", "out.png"], "-n"),
        (&["-n", "5", "-o", "out.png"], "IMAGE"),
        (&["in.png", "-n", "5", "-o", "out.txt"], ".png or .svg"),
        (&["in.png", "-n", "5", "--black", "1.5", "-o", "out.png"], "0 to 1"),
        (&["in.png", "-n", "5", "--black", "-1", "-o", "out.png"], "0 to 1"),
        (&["in.png", "-n", "5", "--black", "nan", "-o", "out.png"], "0 to 1"),
        (&["in.png", "-n", "5", "--black", "0.5", "-o", "out.png"], "--cmyk"),
        (&["in.png", "-n", "5", "--cmyk", "--invert", "-o", "out.png"], "--invert"),
        (&["in.png", "-n", "5", "--window", "3", "-o", "out.png"], "--frames"),
        (&["in.png", "-n", "5", "-o", "nowhere/out.png"], "nowhere"),
        (&["--frames", "in.png", "--window", "9", "--step", "10", "-o", "out.png"], "step of 10"),
        (&["--frames", "none*.png", "--window", "9", "--step", "3", "-o", "out.png"], "no file matches"),
        (&["--frames", "in.png", "--window", "9", "--step", "3", "-o", "-"], "every frame is a file"),
        (&["--frames", "[", "--window", "9", "--step", "3", "-o", "out.png"], "pattern"),
        (&["--frames", "in.png", "--window", "9", "--step", "3", "-n", "10", "-o", "out.png"], "have 9 points"),
    ] {
        refused(folder.path(), arguments, expected);
    }
}

#[test]
fn an_animation_is_a_picture_per_frame() {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..4_u32 {
        let image = RgbImage::from_fn(40, 30, |x, _| Rgb([if x / 10 == frame { 20 } else { 250 }; 3]));
        image.save(folder.path().join(format!("f{frame}.png"))).unwrap();
    }
    let arguments = [
        "--frames",
        "f*.png",
        "--window",
        "100",
        "--step",
        "25",
        "--iterations",
        "20",
        "--size",
        "200",
        "-o",
        "all.png",
        "--points",
        "all.csv",
    ];
    let output = fsot(folder.path(), &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for frame in 0..4 {
        let drawn = image::open(folder.path().join(format!("all-{frame:04}.png"))).unwrap();
        assert_eq!((drawn.width(), drawn.height()), (200, 150));
    }
    assert_eq!(fsot::read::points(&folder.path().join("all.csv")).unwrap().points.len(), 175);
    RgbImage::from_pixel(41, 30, Rgb([9; 3])).save(folder.path().join("f4.png")).unwrap();
    refused(folder.path(), &arguments, "frame 4 has 41 x 30 pixels");
}
