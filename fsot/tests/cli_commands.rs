//! Every subcommand's ordinary use, in small.

use crate::cli_support::{Place, error};
use fsot::export::nft::TileFile;
use fsot::export::sidecar::{self, Sidecar};
use fsot::read;
use image::{GrayImage, Luma};
use noisefloor::tile::Shape;
use serde_json::Value;
use std::io::Write;
use std::process::Stdio;

const FAST: &str = "--iterations 20";

#[test]
fn points_as_text_csv_and_json_are_the_same() {
    let place = Place::new();
    let mut tables = Vec::new();
    for name in ["p.txt", "p.csv", "p.json"] {
        let printed = place.succeed(&format!("points -n 100 -d 3 --classes 2color --out {name} {FAST}"));
        assert!(printed.contains("20 steps") && printed.contains("NN"), "{printed}");
        tables.push(read::points(&place.path(name)).unwrap());
    }
    assert_eq!(tables[0], tables[1]);
    assert_eq!(tables[0], tables[2]);
    let points = &tables[0].points;
    assert_eq!((points.len(), points.dims()), (100, 3));
    assert!(points.coordinates().iter().all(|x| (0.0..1.0).contains(x)));
    let classes = tables[0].classes.as_ref().unwrap();
    assert_eq!(classes.names, ["red", "blue"]);
    assert_eq!(classes.index.iter().filter(|index| **index == 0).count(), 50);
    assert_eq!(place.names(), ["p.csv", "p.json", "p.txt"]);
}

#[test]
fn points_with_every_option() {
    let place = Place::new();
    for options in [
        "-n 1",
        "-n 2 -d 1",
        "-n 50 -d 8",
        "-n 64 --toroidal",
        "-n 64 --axis-priority .3",
        "-n 64 --progressive 6",
        "-n 64 --progressive 1000",
        "-n 64 --classes ramp",
        "-n 64 --classes 3color",
        "-n 64 --seed 7 --quality draft --threads 1",
    ] {
        let json = place.succeed(&format!("points {options} --out p.txt --iterations 10 --json"));
        let json: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["run"]["iterations"], 10, "{options}");
    }
    // Of many prefixes some are measured, but no others.
    let json = place.succeed("points -n 1000 --progressive 20 --out p.txt --iterations 10 --json");
    let json: Value = serde_json::from_str(&json).unwrap();
    let measured = json["prefixes"].as_array().unwrap().iter().map(|row| row["points"].as_u64().unwrap() as usize);
    let (measured, all) = (measured.collect::<Vec<_>>(), fsot::class::progressive_prefixes(20, 1000));
    assert!(measured.iter().all(|count| all.contains(count)) && measured.last() == Some(&1000), "{measured:?}");
    let printed = place.succeed("points -n 64 --progressive 3 --out p.txt --iterations 10");
    assert!(printed.contains("errors of the first points"), "{printed}");
    assert!(place.succeed("points -n 64 --out p.txt --iterations 10 --quiet").is_empty());
}

#[test]
fn quiet_json_is_the_report_alone() {
    let place = Place::new();
    GrayImage::from_fn(9, 9, |x, _| Luma([20 * x as u8])).save(place.path("in.png")).unwrap();
    for command in [
        "points -n 9 --out p.txt",
        "place -n 9 --out o.csv",
        "stipple in.png -n 9 --out s.png",
        "stipple --frames in.png --window 9 --step 1 --out s.png",
        "tile --size 16 --integrands 1 --out t.nft",
    ] {
        let output = place.run(&format!("{command} --iterations 2 --quiet --json"));
        assert!(output.stderr.is_empty(), "{command}: {}", error(&output));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json["run"]["iterations"], 2, "{command}: {json}");
    }
    let output = place.run("points -n 9 --iterations 2 --quiet --json --out -");
    let json: Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!(json["run"]["iterations"], 2, "{json}");
}

#[cfg(unix)]
#[test]
fn standard_input_is_measured() {
    let place = Place::new();
    let points = place.succeed(&format!("points -n 10 --out - {FAST}"));
    place.write("p.txt", &points);
    let expected = place.succeed("measure --quick p.txt").replace("p.txt", "-");
    let mut child = place.command("measure --quick -").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(points.as_bytes()).unwrap();
    assert_eq!(String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap(), expected);
    place.refuse("measure -", "- is empty");
}

#[test]
fn points_by_a_density_are_drawn() {
    let place = Place::new();
    let bright_left = GrayImage::from_fn(40, 20, |x, _| Luma([if x < 20 { 255 } else { 0 }]));
    bright_left.save(place.path("left.png")).unwrap();
    place.succeed("points -n 300 --density left.png --out p.txt --png p.png --svg p.svg --quality draft");
    let table = read::points(&place.path("p.txt")).unwrap();
    assert!(table.points.iter().all(|point| point[0] < 0.52 && point[1] <= 0.5));
    let picture = image::open(place.path("p.png")).unwrap().into_luma8();
    assert_eq!(picture.dimensions(), (1024, 512));
    assert!(picture.pixels().any(|pixel| pixel.0[0] < 64));
    assert_eq!(String::from_utf8(place.read("p.svg")).unwrap().matches("<circle").count(), 300);

    place.succeed("points -n 300 --density left.png --invert --out p.txt --quality draft");
    let table = read::points(&place.path("p.txt")).unwrap();
    assert!(table.points.iter().all(|point| point[0] > 0.48));
}

#[test]
fn a_class_file_names_its_pictures_from_where_it_is() {
    let place = Place::new();
    std::fs::create_dir(place.path("classes")).unwrap();
    GrayImage::from_fn(8, 8, |x, _| Luma([if x < 4 { 255 } else { 0 }])).save(place.path("classes/left.png")).unwrap();
    place.write(
        "classes/c.toml",
        "[[class]]\nname = \"left\"\nfunction = { box = { from = 0.0, to = 0.5 } }\ntarget = { image = \"left.png\" }\n\
         [[class]]\nname = \"any where\"\nfunction = { box = { from = 0.5, to = 1.0 } }\n",
    );
    place.succeed("points -n 100 --classes classes/c.toml --out p.csv --quality draft");
    let table = read::points(&place.path("p.csv")).unwrap();
    let classes = table.classes.unwrap();
    assert_eq!(classes.names, ["left", "any where"]);
    let left = table.points.iter().zip(&classes.index).filter(|(_, class)| **class == 0);
    assert!(left.clone().count() == 50 && left.clone().all(|(point, _)| point[0] < 0.55));
}

#[test]
fn a_jpeg_named_png_is_read_by_its_content() {
    let place = Place::new();
    let picture = GrayImage::from_fn(16, 16, |x, y| Luma([(x * y) as u8]));
    picture.save(place.path("photo.jpg")).unwrap();
    std::fs::rename(place.path("photo.jpg"), place.path("photo.png")).unwrap();
    place.succeed(&format!("points -n 50 --density photo.png --out p.txt {FAST}"));
}

#[test]
fn a_tile_and_its_sidecar() {
    let place = Place::new();
    for (options, shape) in [
        ("--spp 2 --kernel perceptual*gaussian:0.5 --progressive", (16, 2, 2, 1, 16)),
        ("-d 4 --kernel box --bits 8", (16, 1, 4, 1, 8)),
        ("--temporal 2 --temporal-kernel ema:0.5 --kernel gaussian:1", (16, 1, 2, 2, 16)),
    ] {
        let printed =
            place.succeed(&format!("tile --size 16 {options} --seed 3 --integrands 8 --out t.nft --iterations 4"));
        assert!(printed.contains("half-spaces"), "{printed}");
        let file = TileFile::read(&place.path("t.nft")).unwrap();
        let Shape { size, spp, dims, frames, bits, .. } = file.view().shape();
        assert_eq!((size, spp, dims, frames, bits), shape);
        let sidecar = sidecar::read::<Sidecar>(&place.path("t.nft")).unwrap().unwrap();
        assert!(sidecar.describes(file.bytes()));
        assert_eq!((sidecar.seed, sidecar.iterations), (3, 4));
        assert_eq!(place.names(), ["t.nft", "t.toml"]);

        // The sidecar's command makes the same bytes again.
        let again = Place::new();
        let command = sidecar.command.replace('\'', "");
        again.succeed(command.strip_prefix("fsot ").unwrap());
        assert_eq!(again.read("t.nft"), file.bytes(), "{command}");
        assert_eq!(again.read("t.toml"), place.read("t.toml"), "{command}");
    }
}

#[test]
fn a_tile_is_told_about_and_exported() {
    let place = Place::new();
    place.succeed("tile --size 16 --spp 2 --integrands 8 --out t.nft --iterations 2");
    let info = place.succeed("info t.nft");
    for part in ["16 x 16 pixels", "2 per pixel", "perceptual", "fsot tile --size 16", "filtered"] {
        assert!(info.contains(part), "{part} in {info}");
    }
    let json: Value = serde_json::from_str(&place.succeed("info t.nft --json")).unwrap();
    assert_eq!(json["spp"], 2);
    assert_eq!(json["sha256"], json["sidecar"]["sha256"]);
    let measured = place.succeed("measure t.nft --integrands 8");
    assert!(measured.contains("2 samples of 2 dimensions"), "{measured}");

    for format in ["png", "exr", "raw", "c-header", "rust"] {
        place.succeed(&format!("export t.nft --format {format} --out t.{format}"));
    }
    let file = TileFile::read(&place.path("t.nft")).unwrap();
    assert_eq!(place.read("t.raw"), file.view().payload());
    assert_eq!(image::open(place.path("t.png")).unwrap().into_rgb16().dimensions(), (16, 32));
    let exr = image::open(place.path("t.exr")).unwrap().into_rgb32f();
    assert_eq!(exr.get_pixel(0, 0).0[..2], file.coordinates()[..2]);
    assert!(String::from_utf8(place.read("t.c-header")).unwrap().contains("#define T_SPP 2"));
    place.succeed("export t.nft --format c-header --name int --out t.h");
    assert!(String::from_utf8(place.read("t.h")).unwrap().contains("uint16_t tile_int["));
    assert!(String::from_utf8(place.read("t.rust")).unwrap().contains("pub const SPP: usize = 2;"));

    place.write("t.toml", String::from_utf8(place.read("t.toml")).unwrap().replace("sha256 = \"", "sha256 = \"0"));
    let output = place.run("info t.nft");
    assert!(output.status.success());
    assert!(error(&output).contains("describes another tile"));
}

#[test]
fn info_lists_the_presets() {
    let list = Place::new().succeed("info");
    assert!(list.lines().any(|line| line.starts_with("64_1SPP_2D")), "{list}");
}

#[test]
fn points_go_to_standard_output() {
    let place = Place::new();
    let file = place.succeed(&format!("points -n 10 --out p.txt {FAST}"));
    assert!(!file.is_empty());
    for out in ["-", "/dev/stdout"] {
        let printed = place.succeed(&format!("points -n 10 --out {out} {FAST}"));
        assert_eq!(printed.as_bytes(), place.read("p.txt"));
    }
    // What is drawn or plotted is alone there, too.
    GrayImage::from_fn(9, 9, |x, _| Luma([20 * x as u8])).save(place.path("in.png")).unwrap();
    for (command, file) in [
        ("stipple in.png -n 9 --iterations 2 --out OUT", "s.png"),
        ("place -n 9 --iterations 2 --out OUT", "o.csv"),
        ("points -n 9 --iterations 2 --out q.txt --png OUT", "q.png"),
        ("measure p.txt --prefix --integrands 2 --plot OUT", "plot.png"),
    ] {
        place.succeed(&command.replace("OUT", file));
        let output = place.run(&command.replace("OUT", "-"));
        assert!(output.status.success(), "{}", error(&output));
        assert!(output.stdout == place.read(file), "{command}");
    }
}

#[test]
fn an_older_output_is_replaced_and_keeps_its_permissions() {
    let place = Place::new();
    place.write("p.txt", "old");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        std::fs::set_permissions(place.path("p.txt"), PermissionsExt::from_mode(0o640)).unwrap();
        place.succeed(&format!("points -n 10 --out p.txt {FAST}"));
        assert_eq!(std::fs::metadata(place.path("p.txt")).unwrap().permissions().mode() & 0o777, 0o640);
        // A link stays one: what it leads to is replaced.
        std::os::unix::fs::symlink("p.txt", place.path("link.txt")).unwrap();
        place.succeed(&format!("points -n 11 --out link.txt {FAST}"));
        assert!(std::fs::symlink_metadata(place.path("link.txt")).unwrap().is_symlink());
    }
    assert_eq!(read::points(&place.path("p.txt")).unwrap().points.len(), 11);
}
