//! Inputs without end, and inputs that are too large: a sentence, soon, and in little memory.

#![cfg(target_os = "linux")]

use crate::cli_support::{Place, error};
use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use image::{GrayImage, Luma};
use std::fs::File;
use std::io::Read;
use std::process::Command;
use std::time::{Duration, Instant};

/// The longest that anything here may take on a slow machine that does other things too.
const PATIENCE: Duration = Duration::from_secs(30);
/// The most address space, in KiB.
const MEMORY: u32 = 1 << 20;

/// Runs a script in which `fsot` is the program, and expects exit code 2 and these words.
fn refuse(place: &Place, script: &str, words: &str) {
    let program = env!("CARGO_BIN_EXE_fsot");
    let script = format!("ulimit -v {MEMORY}; {}", script.replace("fsot ", &format!("'{program}' ")));
    let start = Instant::now();
    let output = Command::new("sh").args(["-c", &script]).current_dir(place.path("")).output().unwrap();
    let said = error(&output);
    assert_eq!(output.status.code(), Some(2), "{script}: {said}");
    assert!(said.starts_with("error: ") && said.contains(words), "{script}\nexpected `{words}` in: {said}");
    assert_eq!(said.lines().count(), 1, "{script}: {said}");
    assert!(start.elapsed() < PATIENCE, "{script}");
    assert!(output.stdout.is_empty(), "{script}");
}

#[test]
fn devices_without_end_are_told_by_their_first_bytes() {
    let place = Place::new();
    place.succeed("tile --size 16 --iterations 1 --integrands 1 --quiet --out t.nft");
    place.write("c.toml", "[[class]]\nname = \"a\"\nfunction = \"constant\"\ntarget = { image = \"/dev/zero\" }\n");
    for (name, target) in [("zero.nft", "/dev/zero"), ("zero.json", "/dev/zero")] {
        std::os::unix::fs::symlink(target, place.path(name)).unwrap();
    }
    let (points, none) = ("fsot points -n 9 --out p.txt --iterations 1", "not a picture that can be read");
    for device in ["/dev/zero", "/dev/urandom"] {
        for (script, words) in [
            (format!("fsot measure {device}"), "not a point set: it is not text"),
            (format!("fsot spectrum {device} --out s.png"), "not a point set"),
            (format!("fsot info {device}"), "not a tile file"),
            (format!("fsot export {device} --format raw --out x"), "not a tile file"),
            (format!("{points} --density {device}"), none),
            (format!("{points} --classes {device}"), "not a class file: it is not text"),
            (format!("{points} --checkpoint {device}"), "a checkpoint is read again, so it must be a file"),
            (
                format!("fsot measure --scenes . {device}"),
                "no sampler's table (.bin), tile (.nft) or `noisefloor-points`",
            ),
            (format!("fsot stipple {device} -n 9 --out s.png"), none),
            (format!("fsot place -n 9 --map {device} --out o.csv"), none),
        ] {
            refuse(&place, &script, &words.replace("{}", device));
        }
    }
    refuse(&place, "fsot measure zero.nft", "zero.nft is not a tile file");
    refuse(&place, &format!("{points} --classes zero.json"), "zero.json is not a class file");
    refuse(&place, &format!("{points} --classes c.toml"), none);
    std::fs::remove_file(place.path("t.toml")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", place.path("t.toml")).unwrap();
    refuse(&place, "fsot info t.nft", "t.toml is not a sidecar: it is not text");
}

#[test]
fn pipes_without_end_are_read_so_far() {
    let place = Place::new();
    place.succeed("tile --size 16 --iterations 1 --integrands 1 --quiet --out t.nft");
    GrayImage::from_pixel(9, 9, Luma([90])).save(place.path("in.png")).unwrap();
    assert!(Command::new("mkfifo").arg(place.path("fifo")).status().unwrap().success());
    let words = "has not ended after 134217728 bytes, and no more are read: save what comes from it to a file first";
    for script in [
        "yes '0.5 0.25' | fsot measure /dev/stdin",
        "yes '0.5,0.25' > fifo & fsot measure fifo",
        "yes '#' | fsot points -n 9 --classes /dev/stdin --out p.txt",
        "(cat in.png; yes) | fsot points -n 9 --density /dev/stdin --out p.txt",
        "(cat in.png; cat /dev/zero) | fsot stipple /dev/stdin -n 9 --out s.png",
        "(cat t.nft; cat /dev/zero) | fsot info /dev/stdin",
    ] {
        refuse(&place, script, words);
    }
    refuse(&place, "fsot points -n 9 --iterations 2 --out p.txt --checkpoint fifo", "it must be a file");
}

#[test]
fn files_that_are_too_large_are_not_read() {
    let place = Place::new();
    place.succeed("tile --size 16 --iterations 1 --integrands 1 --quiet --out t.nft");
    GrayImage::from_pixel(9, 9, Luma([90])).save(place.path("in.png")).unwrap();
    place.write("p.txt", "0.5 0.25\n".repeat(1000));
    for name in ["in.png", "t.nft", "p.txt"] {
        File::options().write(true).open(place.path(name)).unwrap().set_len(8 << 30).unwrap();
    }
    let words = "is too large: it has 8589934592 bytes, and at most 1073741824 are read";
    refuse(&place, "fsot points -n 9 --density in.png --out o.txt", words);
    refuse(&place, "fsot info t.nft", words);
    refuse(&place, "fsot measure p.txt", words);
}

#[test]
fn a_checkpoint_is_read_as_far_as_the_problem_goes() {
    let place = Place::new();
    let command = "points -n 600 --iterations 100000 --checkpoint-every 0 --quiet --out p.txt";
    let mut child = place.start(command);
    while !place.path("p.txt.checkpoint").exists() {
        assert!(child.try_wait().unwrap().is_none());
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let good = place.read("p.txt.checkpoint");
    let grow = |bytes: &[u8]| {
        place.write("c", bytes);
        File::options().write(true).open(place.path("c")).unwrap().set_len(8 << 30).unwrap();
    };
    let command = format!("fsot {command} --checkpoint c");
    grow(&good);
    refuse(&place, &command, "c: it is damaged");
    grow(&good[..12]);
    refuse(&place, &command, "c: it is damaged");
    grow(b"");
    refuse(&place, &command, "c: it is not a checkpoint of fsot");
    // A header that promises as much as there is.
    let text = String::from_utf8_lossy(&good[12..]).into_owned();
    let header = &text[..=text.find("\"coordinates\":").unwrap() + 18];
    let header = header[..header.rfind('}').unwrap() + 1].replace("\"coordinates\":1200", "\"coordinates\":2147483000");
    let mut bytes = [&good[..8], &(header.len() as u32).to_le_bytes(), header.as_bytes()].concat();
    let length = bytes.len() as u64 + 4 * 2_147_483_000 + 32;
    bytes.push(0);
    place.write("c", &bytes);
    File::options().write(true).open(place.path("c")).unwrap().set_len(length).unwrap();
    refuse(&place, &command, "c: its state is not one of this problem's");
}

/// A PNG file of this size, black, with a bit per pixel.
fn png(width: u32, height: u32) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |name: &[u8; 4], content: &[u8]| {
        let mut crc = Crc::new();
        crc.update(name);
        crc.update(content);
        file.extend((content.len() as u32).to_be_bytes());
        file.extend_from_slice(name);
        file.extend_from_slice(content);
        file.extend(crc.sum().to_be_bytes());
    };
    chunk(b"IHDR", &[&width.to_be_bytes()[..], &height.to_be_bytes(), &[1, 0, 0, 0, 0]].concat());
    let mut rows = ZlibEncoder::new(Vec::new(), Compression::fast());
    let bytes = u64::from(height) * (1 + u64::from(width).div_ceil(8));
    std::io::copy(&mut std::io::repeat(0).take(bytes), &mut rows).unwrap();
    chunk(b"IDAT", &rows.finish().unwrap());
    chunk(b"IEND", &[]);
    file
}

#[test]
fn a_picture_with_too_many_pixels_is_too_large_and_not_damaged() {
    let place = Place::new();
    place.write("small.png", png(30, 20));
    assert_eq!(image::open(place.path("small.png")).unwrap().into_luma8().dimensions(), (30, 20));
    place.write("large.png", png(30_000, 30_000));
    place.write("long.png", png(600_000_000, 1));
    // The size of a JPEG file, after the marker of its frame.
    GrayImage::from_pixel(9, 9, Luma([90])).save(place.path("in.jpg")).unwrap();
    let mut jpeg = place.read("in.jpg");
    let frame = jpeg.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0xff, 0, 0xff, 0]);
    place.write("large.jpg", jpeg);
    let words = |size: &str| format!(".png is too large: it has {size} pixels, and at most 536870912");
    for (name, words) in [
        ("large.png", words("30000 x 30000")),
        ("long.png", words("600000000 x 1")),
        ("large.jpg", "large.jpg is too large: it has 65280 x 65280 pixels, and at most".to_owned()),
    ] {
        refuse(&place, &format!("fsot points -n 9 --density {name} --out o.txt"), &words);
        refuse(&place, &format!("fsot stipple {name} -n 9 --out o.png"), &words);
        refuse(&place, &format!("fsot place -n 9 --map {name} --out o.csv"), &words);
    }
    place.refuse("points -n 9 --density small.png --out o.txt", "black everywhere");
}
