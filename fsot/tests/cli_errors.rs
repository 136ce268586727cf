//! Everything bad that a person can give: exit code 2, a sentence, and no file changed.

use crate::cli_support::{Place, error};
use image::GrayImage;

#[test]
fn numbers_out_of_range() {
    let place = Place::new();
    for (arguments, message) in [
        ("points -n 0 --out p.txt", "0 is not in"),
        ("points -n -5 --out p.txt", "-5"),
        ("points -n 9999999999 --out p.txt", "9999999999"),
        ("points -n 10 -d 0 --out p.txt", "0"),
        ("points -n 10 -d 9 --out p.txt", "9 is not in 1..=8"),
        ("points -n 10 --axis-priority 1.5 --out p.txt", "axis priority 1.5"),
        ("points -n 10 --axis-priority nan --out p.txt", "axis priority NaN"),
        ("points -n 10 --axis-priority -0.5 --out p.txt", "axis priority -0.5"),
        ("points -n 10 --progressive 0 --out p.txt", "0"),
        ("points -n 10 --iterations 0 --out p.txt", "0"),
        ("points -n 10 --quality best --out p.txt", "draft"),
        ("points -n 10 --threads 0 --out p.txt", "1 to 1024"),
        ("points -n 10 --threads 99999 --out p.txt", "1 to 1024"),
        ("points -n 10 --seed -1 --out p.txt", "-1"),
        ("points -n 10 -d 1 --png p.png --out p.txt", "cannot be drawn"),
        ("points -n 10", "--out"),
        ("points --out p.txt", "--points"),
        ("tile --size 100 --out t.nft", "size is 100"),
        ("tile --size 16 --box-share -1 --out t.nft", "share is -1"),
        ("tile --size 16 --spp 2 --box-weight -1 --out t.nft", "weight is -1"),
        ("tile --size 16 --box-weight 2 --out t.nft", "give --box-share, too"),
        ("tile --size 16 --reconstruction gaussian:16 --out t.nft", "give --box-share, too"),
        ("tile --size 16 --temporal 4 --temporal-kernel ema:0.5 --box-share .6 --out t.nft", "0.6; use at most 0.5"),
        ("tile --size 16 --temporal 4 --temporal-kernel ema:1e-7 --out t.nft", "from 1e-6 to 1, not 0.0000001"),
        ("tile --kernel gaussian:0 --out t.nft", "Gaussian"),
        ("tile --kernel sinc --out t.nft", "not a kernel"),
        ("tile --size 16 --temporal 1 --temporal-kernel mantiuk --out t.nft", "frames"),
        ("tile --size 16 --temporal 2 --temporal-kernel mantiuk --out t.nft", "the animation has 2"),
        ("tile --size 16 --temporal 4 --temporal-kernel ema:2 --out t.nft", "ema:2"),
        ("tile --size 16 --temporal 4 --out t.nft", "--temporal-kernel"),
        ("tile --size 16 --bits 12 --out t.nft", "8 or 16"),
        ("tile --size 16 --integrands 0 --out t.nft", "0"),
        ("tile --preset nothing --out t.nft", "fsot info"),
        ("tile --preset 64_1SPP_2D --size 32 --out t.nft", "--size"),
        ("blow", "blow"),
        ("", "Usage"),
    ] {
        if arguments.is_empty() {
            assert_eq!(place.run(arguments).status.code(), Some(2));
        } else {
            place.refuse(arguments, message);
        }
    }
}

#[test]
fn pictures_that_are_none() {
    let place = Place::new();
    GrayImage::new(16, 16).save(place.path("black.png")).unwrap();
    GrayImage::from_pixel(16, 16, image::Luma([255])).save(place.path("white.png")).unwrap();
    image::RgbaImage::new(16, 16).save(place.path("clear.png")).unwrap();
    let png = place.read("white.png");
    place.write("cut.png", &png[..png.len() / 2]);
    place.write("empty.png", "");
    place.write("text.png", "no picture at all");
    place.write("broken.jpg", b"\xff\xd8\xff\xe0 and no more");
    std::fs::create_dir(place.path("folder.png")).unwrap();
    // Of channels B, G and Y.
    image::Rgb32FImage::new(4, 4).save(place.path("grey.exr")).unwrap();
    let exr = place.read("grey.exr");
    let red = exr.windows(2).position(|name| name == b"R\0").unwrap();
    place.write("grey.exr", [&exr[..red], b"Y", &exr[red + 1..]].concat());
    for (options, message) in [
        ("--density missing.png", "missing.png"),
        ("--density black.png", "black.png is black everywhere"),
        ("--density white.png --invert", "white.png is white everywhere"),
        ("--density clear.png", "clear.png is transparent everywhere"),
        ("--density cut.png", "cut.png is a damaged PNG file"),
        ("--density empty.png", "empty.png is empty"),
        ("--density text.png", "text.png is not a picture"),
        ("--density broken.jpg", "broken.jpg is a damaged JPEG file"),
        ("--density grey.exr", "grey.exr is OpenEXR without red, green and blue, or deep: save it with flat"),
        ("--density folder.png", "folder.png is a folder"),
        ("--density white.png -d 3", "use -d 2"),
        ("--density white.png --toroidal", "cannot be used with '--toroidal'"),
        ("--invert", "--density"),
    ] {
        place.refuse(&format!("points -n 10 {options} --out p.txt"), message);
    }
}

#[test]
fn class_files_that_are_none() {
    let place = Place::new();
    place.write("bad.toml", "[[class]]\nname = 1\n");
    place.write("empty.toml", "");
    place.write("binary.toml", [0xff, 0xfe]);
    place.write("box.json", r#"{"class": [{"name": "a", "function": {"box": {"from": 0.7, "to": 0.2}}}]}"#);
    place
        .write("picture.toml", "[[class]]\nname = \"a\"\nfunction = \"constant\"\ntarget = { image = \"none.png\" }\n");
    for (name, function, target) in [
        ("target", r#""constant""#, r#"{"image": "a.png", "invert": true}"#),
        ("function", r#"{"tabulated": [1.0], "invert": true}"#, r#""uniform""#),
    ] {
        let text = format!(r#"{{"class": [{{"name": "a", "function": {function}, "target": {target}}}]}}"#);
        place.write(&format!("{name}.json"), text);
    }
    place.write(
        "target.toml",
        "[[class]]\nname = \"a\"\nfunction = \"constant\"\ntarget = { image = \"a.png\", invert = true }\n",
    );
    for (classes, message) in [
        ("target.json", "there are `image` and `invert`, and one key is possible"),
        ("function.json", "there are `invert` and `tabulated`, and one key is possible"),
        ("target.toml", "there are `image` and `invert`, and one key is possible"),
        ("4color", "give 2color, 3color, ramp"),
        ("bad.toml", "bad.toml"),
        ("empty.toml", "empty.toml is empty"),
        ("binary.toml", "not text"),
        ("box.json", "0.7"),
        ("picture.toml", "none.png"),
        ("picture.toml --density none.png", "picture.toml has densities of its own: leave out --density"),
        ("2color --progressive 3", "--progressive"),
    ] {
        place.refuse(&format!("points -n 10 --classes {classes} --out p.txt"), message);
    }
}

#[test]
fn classes_without_points_and_points_without_a_class() {
    let place = Place::new();
    let class = |name: &str, from: f32, to: f32, weight: f32| {
        let function = format!("{{ box = {{ from = {from:?}, to = {to:?} }} }}");
        format!("[[class]]\nname = \"{name}\"\nweight = {weight:?}\nfunction = {function}\n")
    };
    let all = |weight| class("all", 0.0, 1.0, weight);
    let halves = |end, weight| class("a", 0.0, end, weight) + &class("b", 0.5, 1.0, 1.0);
    let narrow = class("narrow", 0.01, 0.02, 1.0);
    for (classes, message) in [
        (halves(0.25, 1.0), "c.toml: no class of a weight above 0 has 4 points of 16, from index 0.2812 on"),
        (halves(0.5, 0.0), "has 8 points of 16, from index 0.0312 on"),
        (halves(0.25, 1.0) + &all(0.0), "4 points of 16"),
        (narrow.clone(), "class \"narrow\" has none of 16 points"),
        (all(1.0) + &narrow, "class \"narrow\" has none of 16 points"),
    ] {
        place.write("c.toml", classes);
        place.refuse("points -n 16 --classes c.toml --out p.txt", message);
    }
    for (classes, count) in
        [(halves(0.5, 1.0), 16), (halves(0.25, 1.0) + &all(1.0), 16), (all(1.0) + &narrow, 100), (all(1.0), 16)]
    {
        place.write("c.toml", classes);
        place.succeed(&format!("points -n {count} --classes c.toml --iterations 2 --out p.txt"));
    }
    // Colours that a few points do not have.
    place.succeed("points -n 1 --classes 3color --iterations 2 --out p.txt");
}

#[test]
fn outputs_that_cannot_be() {
    let place = Place::new();
    place.write("locked.txt", "mine");
    std::fs::create_dir(place.path("folder")).unwrap();
    let mut permissions = std::fs::metadata(place.path("locked.txt")).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(place.path("locked.txt"), permissions).unwrap();
    for (options, message) in [
        ("--out missing/p.txt", "the folder missing does not exist"),
        ("--out folder", "folder is a folder"),
        ("--out new/", "new/ is a folder"),
        ("--out p.txt --checkpoint new/", "new/ is a folder"),
        ("--out - --png -", "twice"),
        ("--out - --png /dev/stdout", "twice"),
        ("--out locked.txt", "locked.txt is read-only"),
        ("--out locked.txt/p.txt", "does not exist"),
        ("--out p.txt --png missing/p.png", "the folder missing does not exist"),
        ("--out p.txt --svg p.txt", "twice"),
        ("--out p.txt --svg ./p.txt", "twice"),
        ("--out p.txt --checkpoint missing/c", "the folder missing does not exist"),
        ("--out p.txt --checkpoint p.txt", "twice"),
        ("--out ..", "is a folder"),
    ] {
        place.refuse(&format!("points -n 10 {options} --iterations 3"), message);
    }
    place.refuse("tile --size 16 --out t.toml --iterations 3", "twice");
    place.write("cfg.toml", "mine = 1");
    place.refuse("tile --size 16 --out cfg.nft --iterations 3", "cfg.toml is no such sidecar, and would be replaced");
    place.refuse("sampler --out cfg.bin --iterations 1", "cfg.toml is no such sidecar");
}

#[test]
fn outputs_that_are_inputs() {
    let place = Place::new();
    for name in ["p.png", "all-0000.png", "all-0001.png"] {
        GrayImage::from_fn(9, 9, |x, _| image::Luma([20 * x as u8])).save(place.path(name)).unwrap();
    }
    place.write("p.txt", "0.1 0.2\n0.7 0.4\n0.3 0.9\n0.6 0.6\n");
    place.write("c.toml", "[[class]]\nname = \"a\"\nfunction = \"constant\"\ntarget = { image = \"p.png\" }\n");
    for (arguments, name) in [
        ("stipple p.png -n 50 -o p.png", "p.png"),
        ("stipple ./p.png -n 50 --checkpoint p.png -o q.png", "p.png"),
        ("points -n 9 --density p.png --png p.png -o q.txt", "p.png"),
        ("points -n 9 --classes c.toml -o c.toml", "c.toml"),
        ("points -n 9 --classes c.toml --png p.png -o q.txt", "p.png"),
        ("place -n 9 --map p.png --png p.png -o q.csv", "p.png"),
        ("stipple --frames all-*.png --window 5 --step 2 -o all.png", "all-0000.png"),
        ("measure p.txt --prefix --plot p.txt", "p.txt"),
        ("spectrum p.txt -o p.txt", "p.txt"),
        ("export p.txt --format raw -o p.txt", "p.txt"),
    ] {
        place.refuse(arguments, &format!("{name} is an input, which would be replaced"));
        let said = error(&place.run(arguments));
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_nothing() {
    let place = Place::new();
    place.refuse("points -n 10 --out /dev/full --iterations 3", "No space left");
    // One that is not open: before the work, whose cost would be said.
    let closed = "points -n 10 --out /dev/fd/97 --iterations 3";
    place.refuse(closed, "/dev/fd/97: ");
    assert_eq!(error(&place.run(closed)).lines().count(), 1);

    // No file may grow beyond 8 blocks, and the signal that would end the program is ignored: writes fail half way.
    place.write("p.txt", "old");
    for arguments in [
        "points -n 4000 --iterations 3 --out p.txt",
        "points -n 50 --iterations 3 --png p.png --out p.txt",
        "tile --size 64 --iterations 1 --integrands 1 --out t.nft",
    ] {
        let names = place.names();
        let script = format!("trap '' XFSZ; ulimit -f 8; exec '{}' {arguments}", env!("CARGO_BIN_EXE_fsot"));
        let output =
            std::process::Command::new("sh").args(["-c", &script]).current_dir(place.path("")).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", error(&output));
        assert!(error(&output).contains("too large"), "{}", error(&output));
        assert_eq!(place.names(), names, "{arguments}");
        assert_eq!(place.read("p.txt"), b"old");
    }
}

#[test]
fn tiles_that_are_none() {
    let place = Place::new();
    place.succeed("tile --size 16 --integrands 1 --iterations 1 --out t.nft --quiet");
    let tile = place.read("t.nft");
    place.write("cut.nft", &tile[..tile.len() - 1]);
    place.write("long.nft", [tile.as_slice(), b"x"].concat());
    let mut flipped = tile.clone();
    flipped[200] ^= 1;
    place.write("flipped.nft", flipped);
    let mut newer = tile;
    newer[8] = 2;
    place.write("newer.nft", newer);
    place.write("text.nft", "hello");
    place.write("empty.nft", "");
    for (name, message) in [
        ("cut.nft", "truncated"),
        ("long.nft", "trailing"),
        ("flipped.nft", "damaged"),
        ("newer.nft", "newer version"),
        ("text.nft", "not a tile file"),
        ("empty.nft", "is empty"),
        ("none.nft", "none.nft"),
    ] {
        place.refuse(&format!("info {name}"), message);
        place.refuse(&format!("export {name} --format raw --out x"), message);
        place.refuse(&format!("measure {name}"), message);
    }
    place.refuse("export t.nft --format bmp --out x", "bmp");
    place.refuse("export t.nft --format png --name foo --out x", "--name is for the arrays");
    place.refuse("export t.nft --format raw --out missing/x", "the folder missing does not exist");
    place.refuse("export t.nft --format raw --out /dev/full", "No space left");
}
