//! Names, pictures and sizes that are seldom: what is made of them, or why nothing is.

use crate::cli_support::{Place, error};
use fsot::export::sidecar::{self, Sidecar};
use fsot::picture::Photo;
use fsot::read;
use fsot::target::Target;
use image::codecs::jpeg::JpegEncoder;
use image::{GrayImage, ImageEncoder, Luma, Rgb, Rgb32FImage, Rgba, Rgba32FImage, RgbaImage};
use serde_json::Value;
#[cfg(target_os = "linux")]
use std::io::Write;

const FAST: &str = "--iterations 5";

fn json(place: &Place, arguments: &str) -> Value {
    serde_json::from_str(&place.succeed(arguments)).unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_of_memory_in_dev_holds_files_like_any_other() {
    let Ok(folder) = tempfile::tempdir_in("/dev/shm") else {
        // Not captured as what tests print is, and in a line that `cargo xtask test` looks for.
        std::io::stderr().write_all(b"\nnot run: files in /dev/shm, which cannot be written here\n").unwrap();
        return;
    };
    let place = Place::new();
    let out = folder.path().join("t.nft");
    let arguments = format!("tile --size 16 --iterations 2 --integrands 1 --out {}", out.display());
    let printed = place.succeed(&arguments);
    assert!(printed.contains("t.nft"), "{printed}");
    assert!(sidecar::read::<Sidecar>(&out).unwrap().is_some());
    std::fs::write(&out, "old").unwrap();
    place.succeed(&arguments);
    assert!(std::fs::read(&out).unwrap().starts_with(b"\x8eNFT"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    assert!(place.names().is_empty());
}

#[cfg(target_os = "linux")]
#[test]
fn devices_and_open_files_are_written_to() {
    use std::os::unix::fs::FileTypeExt;
    let place = Place::new();
    place.succeed(&format!("points -n 10 --out p.txt {FAST}"));
    place.succeed(&format!("points -n 10 --out /dev/null {FAST}"));
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    let output = place.run(&format!("points -n 10 --quiet --out /dev/stderr {FAST}"));
    assert_eq!(output.stderr, place.read("p.txt"));
    let output = place.run(&format!("points -n 10 --quiet --out /dev/fd/1 {FAST}"));
    assert_eq!(output.stdout, place.read("p.txt"), "{}", error(&output));
    place.refuse(&format!("points -n 10 --out /dev/stderr --svg /dev/fd/2 {FAST}"), "twice");
    assert_eq!(place.names(), ["p.txt"]);
}

#[cfg(target_os = "linux")]
#[test]
fn what_an_open_file_holds_stays() {
    let place = Place::new();
    place.succeed(&format!("points -n 10 --out p.txt {FAST}"));
    let expected = [b"head\n".to_vec(), place.read("p.txt"), b"tail\n".to_vec()].concat();
    for (number, quiet) in [(1, ""), (2, "--quiet"), (3, ""), (17, "")] {
        place.write("log", "head\n");
        let arguments = format!("points -n 10 --out /dev/fd/{number} {quiet} {FAST}");
        let script = format!("exec {number}>>log; '{}' {arguments}; echo tail >&{number}", env!("CARGO_BIN_EXE_fsot"));
        let mut shell = std::process::Command::new("bash");
        let output = shell.args(["-c", &script]).current_dir(place.path("")).output().unwrap();
        assert!(output.status.success(), "{}", error(&output));
        assert_eq!(place.read("log"), expected, "descriptor {number}: {}", error(&output));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn names_that_are_not_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let place = Place::new();
    let name = |name: &[u8]| OsStr::from_bytes(name).to_owned();
    let run = |arguments: &str, file: &[u8]| {
        let output = place.command(arguments).arg(name(file)).output().unwrap();
        assert!(output.status.success(), "{arguments}: {}", error(&output));
        output
    };
    run("points -n 20 --iterations 2 --json --out", b"p\xff.txt");
    run("measure --quick --json", b"p\xff.txt");
    run("measure --prefix --integrands 2 --json", b"p\xff.txt");
    run("tile --size 16 --iterations 2 --integrands 1 --json --out", b"t\xff.nft");
    run("measure --integrands 1 --json", b"t\xff.nft");
    let info = run("info --json", b"t\xff.nft");
    let info: Value = serde_json::from_slice(&info.stdout).unwrap();
    assert_eq!(info["tile"], "t\u{fffd}.nft");
    run("export --format c-header --out t.h", b"t\xff.nft");
    run("place -n 20 --iterations 2 --json --out o.csv --png", b"o\xff.png");
    run("spectrum --out s.png", b"p\xff.txt");
}

#[test]
fn the_command_of_a_sidecar_is_one_of_a_shell() {
    let place = Place::new();
    for (name, words) in [
        ("t.nft", "--out t.nft"),
        ("a b.nft", "--out 'a b.nft'"),
        ("it's.nft", r"--out 'it'\''s.nft'"),
        ("$HOME.nft", "--out '$HOME.nft'"),
    ] {
        let mut command = place.command("tile --size 16 --iterations 1 --integrands 1 --out");
        assert!(command.arg(name).output().unwrap().status.success());
        let sidecar = sidecar::read::<Sidecar>(&place.path(name)).unwrap().unwrap();
        assert!(sidecar.command.ends_with(words), "{}", sidecar.command);
        assert!(!sidecar.command.contains("--reconstruction"), "{}", sidecar.command);
    }
}

#[test]
fn reconstruction_is_the_second_factor_unless_given() {
    let place = Place::new();
    let make = |options: &str| {
        let arguments = "tile --size 16 --spp 4 --iterations 8 --integrands 1 --quiet --out t.nft --kernel";
        place.succeed(&format!("{arguments} {options}"));
        (place.read("t.nft"), sidecar::read::<Sidecar>(&place.path("t.nft")).unwrap().unwrap().command)
    };
    let (gaussian, command) = make("box*gaussian:0.7");
    assert!(!command.contains("--reconstruction"), "{command}");
    assert_eq!(make("box*gaussian:0.7 --reconstruction gaussian:0.7"), (gaussian.clone(), command));
    let (boxed, command) = make("box*gaussian:0.7 --reconstruction box");
    assert!(boxed != gaussian);
    assert!(command.contains(" --reconstruction 'box' "), "{command}");
    let (perceptual, _) = make("perceptual");
    assert!(perceptual == make("perceptual --reconstruction box").0);
    assert!(perceptual != make("perceptual --reconstruction gaussian:0.7").0);
    place.refuse("tile --preset 64_1SPP_2D --reconstruction box --out t.nft", "--reconstruction");
    place.refuse("tile --size 16 --reconstruction sinc --out t.nft", "not a kernel");
}

#[cfg(unix)]
#[test]
fn a_checkpoint_of_another_reconstruction_is_refused() {
    let place = Place::new();
    let arguments = "tile --size 16 --spp 4 --iterations 100000 --checkpoint-every 0 --checkpoint c --out t.nft";
    let mut child = place.start(arguments);
    while !place.path("c").exists() {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let output = place.run(&format!("{arguments} --reconstruction gaussian:0.5"));
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("reconstruction"), "{}", error(&output));
}

#[test]
fn metrics_are_those_of_uniform_classes() {
    let place = Place::new();
    GrayImage::from_fn(8, 8, |x, _| Luma([if x < 4 { 255 } else { 0 }])).save(place.path("left.png")).unwrap();
    let class = |name: &str, function: &str, target: &str| {
        format!("[[class]]\nname = \"{name}\"\nfunction = {function}\ntarget = {target}\n")
    };
    let (half, rest) = ("{ box = { from = 0.0, to = 0.5 } }", "{ box = { from = 0.5, to = 1.0 } }");
    let picture = "{ image = \"left.png\" }";
    let report = |text: String| {
        place.write("c.toml", text);
        let report = json(&place, &format!("points -n 64 --classes c.toml --json --out p.txt {FAST}"));
        let classes = report["classes"].as_array().cloned().unwrap_or_default();
        let names: Vec<String> = classes.iter().map(|class| class["class"].as_str().unwrap().to_owned()).collect();
        (report.get("quality").is_some(), names)
    };
    let both = class("a", half, picture) + &class("b", rest, "\"uniform\"");
    assert_eq!(report(both.clone()), (false, vec!["b".to_owned()]));
    assert_eq!(report(both + &class("all", "\"constant\"", "\"uniform\"")), (true, vec!["b".to_owned()]));
    assert_eq!(report(class("all", "\"constant\"", picture)), (false, vec![]));
    assert_eq!(report(class("all", "{ ramp = { rising = false } }", picture)), (false, vec![]));
    assert_eq!(report(class("all", "\"constant\"", "\"uniform\"")), (true, vec![]));
}

#[test]
fn pictures_of_several_shapes_are_refused() {
    let place = Place::new();
    for (name, width, height) in [("a.png", 20, 10), ("b.png", 40, 20), ("c.png", 10, 20)] {
        GrayImage::from_pixel(width, height, Luma([200])).save(place.path(name)).unwrap();
    }
    let classes = |first: &str, second: &str| {
        format!(
            "[[class]]\nname = \"a\"\nfunction = {{ box = {{ from = 0.0, to = 0.5 }} }}\n\
             target = {{ image = \"{first}\" }}\n\
             [[class]]\nname = \"b\"\nfunction = {{ box = {{ from = 0.5, to = 1.0 }} }}\n\
             target = {{ image = \"{second}\" }}\n"
        )
    };
    place.write("same.toml", classes("a.png", "b.png"));
    place.write("other.toml", classes("a.png", "c.png"));
    place.succeed(&format!("points -n 20 --classes same.toml --png p.png --out p.txt {FAST}"));
    assert_eq!(image::image_dimensions(place.path("p.png")).unwrap(), (1024, 512));
    place.refuse(&format!("points -n 20 --classes other.toml --out q.txt {FAST}"), "another shape");
}

#[test]
fn a_pixel_that_is_no_density_is_refused_inverted_too() {
    let place = Place::new();
    for (value, name) in [(f32::NAN, "nan.exr"), (f32::INFINITY, "infinite.exr"), (-1.0, "negative.exr")] {
        let mut picture = Rgb32FImage::from_pixel(8, 8, Rgb([0.25; 3]));
        picture.put_pixel(3, 5, Rgb([value; 3]));
        picture.save(place.path(name)).unwrap();
        for invert in [false, true] {
            let found = read::density(&place.path(name), 16, invert);
            let message = found.map(|_| ()).unwrap_err().to_string();
            assert!(message.contains("column 3, row 5"), "{message}");
        }
    }
}

/// What a lossy codec leaves of black is black.
#[test]
fn values_a_little_below_0_are_0() {
    let place = Place::new();
    let at = |value| Rgb32FImage::from_fn(8, 8, |x, _| Rgb([if x < 4 { value } else { 0.5 }; 3]));
    for (value, name) in [(0.0, "black.exr"), (-4e-4, "nearly.exr")] {
        at(value).save(place.path(name)).unwrap();
    }
    for options in ["", "--invert"] {
        for name in ["black", "nearly"] {
            place.succeed(&format!("points -n 20 --density {name}.exr {options} --out {name}.txt {FAST}"));
        }
        assert_eq!(place.read("black.txt"), place.read("nearly.txt"));
    }
    at(-6e-4).save(place.path("beyond.exr")).unwrap();
    place.refuse(&format!("points -n 20 --density beyond.exr --out p.txt {FAST}"), "must be finite and not negative");
}

/// Half a picture in half a colour: light that is already multiplied by alpha, and values that are not.
#[test]
fn transparent_halves() {
    let place = Place::new();
    Rgba32FImage::from_fn(8, 8, |x, _| Rgba([0.5, 0.5, 0.5, if x < 4 { 0.5 } else { 1.0 }]))
        .save(place.path("half.exr"))
        .unwrap();
    let centre = |invert| {
        let (target, _) = read::density(&place.path("half.exr"), 16, invert).unwrap();
        let (mut means, mut density) = ([0.0; 1000], [0.0; 1000]);
        target.bins(&[1.0, 0.0], &mut means, &mut density, &mut Vec::new());
        means.iter().sum::<f32>() / 1000.0
    };
    assert!((centre(false) - 0.5).abs() < 0.01 && (centre(true) - 0.75).abs() < 0.01);
    let (photo, _) = read::photo(&place.path("half.exr")).unwrap();
    assert!(photo.pixels[0][0] > 0.999 && photo.pixels[7][0] < 0.8);
    // One that is reduced: opaque white, or a grey, beside transparent black.
    for (grey, mean) in [(255, 1.0), (51, 0.6)] {
        let checks =
            RgbaImage::from_fn(4000, 3000, |x, y| Rgba([[0; 4], [grey, grey, grey, 255]][((x + y) % 2) as usize]));
        let photo = Photo::new(&checks.into()).unwrap();
        let total: f32 = photo.pixels.iter().map(|pixel| pixel[0] - mean).sum();
        assert!((total / photo.pixels.len() as f32).abs() < 1e-3 && photo.pixels.len() <= 8_000_000, "{grey}");
    }
    let mut light = Rgb32FImage::from_pixel(3000, 3000, Rgb([0.25; 3]));
    light.put_pixel(2990, 2980, Rgb([f32::NAN; 3]));
    let error = Photo::new(&light.into()).unwrap_err().to_string();
    assert!(error.contains("column 2990, row 2980"), "{error}");
}

#[test]
fn photographs_stand_upright() {
    let place = Place::new();
    let mut encoder = JpegEncoder::new(std::fs::File::create(place.path("phone.jpg")).unwrap());
    // Of one entry: the orientation, a quarter turn.
    let turned = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
    encoder.set_exif_metadata(turned.to_vec()).unwrap();
    encoder.encode_image(&GrayImage::from_fn(64, 32, |x, _| Luma([if x < 32 { 0 } else { 255 }]))).unwrap();
    let (photo, _) = read::photo(&place.path("phone.jpg")).unwrap();
    assert_eq!((photo.width, photo.height), (32, 64));
    let grey = |x: usize, y: usize| photo.pixels[y * 32 + x][0];
    assert!(grey(16, 4) < 0.25 && grey(16, 60) > 0.75);
}

#[test]
fn points_after_a_byte_order_mark() {
    let place = Place::new();
    for text in ["0.5 0.25\n", "x,y\n0.5,0.25\n", "{\"dims\": 2, \"points\": [[0.5, 0.25]]}"] {
        place.write("p", format!("\u{feff}{text}"));
        assert_eq!(read::points(&place.path("p")).unwrap().points.coordinates(), [0.5, 0.25]);
    }
}

#[test]
fn more_memory_than_there_is() {
    let place = Place::new();
    for arguments in [
        "points -n 268435456 -d 8 --out p.txt",
        "points -n 268435456 --progressive 3 --out p.txt",
        "tile --size 512 --spp 64 -d 1 --temporal 16 --temporal-kernel ema:0.1 --kernel gaussian:0.5 --out t.nft",
    ] {
        place.refuse(arguments, "GiB of memory");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn errors_name_the_file_that_was_asked_for() {
    let output = Place::new().run("points -n 9 --iterations 2 --out /proc/p.txt");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(error(&output), "error: cannot write /proc/p.txt: No such file or directory (os error 2)\n");
}
