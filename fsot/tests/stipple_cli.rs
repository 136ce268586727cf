//! `fsot stipple`: its files, and bad pictures.

use crate::cli_support::Place;
use image::{ColorType, Rgb, RgbImage};

/// A picture with colours, light and dark.
fn picture() -> RgbImage {
    RgbImage::from_fn(60, 40, |x, y| Rgb([(x * 4) as u8, (y * 6) as u8, 255 - (x * 4) as u8]))
}

/// A folder with a picture in.png.
fn with_picture() -> Place {
    let place = Place::new();
    picture().save(place.path("in.png")).unwrap();
    place
}

#[test]
fn a_picture_becomes_png_svg_and_points() {
    let place = with_picture();
    let said = place.succeed("stipple in.png -n 800 --cmyk --iterations 30 -o out.png --svg out.svg --points out.csv");
    assert!(said.contains("blurred PSNR") && said.contains("sigma"), "{said}");
    let drawn = image::open(place.path("out.png")).unwrap();
    assert_eq!((drawn.width(), drawn.height()), (1024, 683));
    assert_eq!(drawn.color(), ColorType::Rgb8);
    let text = String::from_utf8(place.read("out.svg")).unwrap();
    assert_eq!(text.matches("<circle").count(), 800);
    assert!(text.contains("multiply"));
    let table = fsot::read::points(&place.path("out.csv")).unwrap();
    assert_eq!(table.points.len(), 800);
    assert!(table.classes.is_some_and(|labels| labels.names.iter().all(|name| "cmyk".contains(name.as_str()))));
    assert_eq!(place.names(), ["in.png", "out.csv", "out.png", "out.svg"]);
    place.succeed("stipple in.png -n 80 --iterations 3 -o out.png --svg out.svg");
    assert_eq!(image::open(place.path("out.png")).unwrap().color(), ColorType::L8);
    assert!(!String::from_utf8(place.read("out.svg")).unwrap().contains("blend"));
}

#[test]
fn threads_do_not_change_a_byte() {
    let place = with_picture();
    let on = |threads: usize| {
        let options = "--cmyk --iterations 20 -o out.png --points out.txt";
        place.succeed(&format!("stipple in.png -n 500 {options} --threads {threads}"));
        (place.read("out.png"), place.read("out.txt"))
    };
    assert!(on(1) == on(3));
}

#[test]
fn bad_pictures_are_named_and_nothing_is_written() {
    let place = with_picture();
    place.write("text.png", "not a picture");
    place.write("empty.png", "");
    RgbImage::from_pixel(9, 9, Rgb([0; 3])).save(place.path("black.png")).unwrap();
    RgbImage::from_pixel(9, 9, Rgb([255; 3])).save(place.path("white.png")).unwrap();
    let whole = place.read("in.png");
    place.write("cut.png", &whole[..whole.len() / 2]);
    for (name, expected) in [
        ("missing.png", "missing.png"),
        ("text.png", "text.png is not a picture"),
        ("empty.png", "empty"),
        ("black.png", "black all over"),
        ("white.png", "white all over"),
        ("cut.png", "cut.png"),
    ] {
        place.refuse(&format!("stipple {name} -n 100 -o out.png"), expected);
        place.refuse(&format!("stipple {name} -n 100 --cmyk -o out.png"), expected);
    }
}

#[test]
fn one_pixel_and_long_lines_are_pictures() {
    let place = Place::new();
    RgbImage::from_pixel(1, 1, Rgb([90, 120, 200])).save(place.path("one.png")).unwrap();
    RgbImage::from_fn(3000, 1, |x, _| Rgb([(x / 12) as u8; 3])).save(place.path("line.png")).unwrap();
    for name in ["one.png", "line.png"] {
        place.succeed(&format!("stipple {name} -n 60 --cmyk --iterations 5 -o out.png"));
    }
}

#[test]
fn arguments_that_make_no_sense() {
    let place = with_picture();
    for (arguments, expected) in [
        ("in.png -n 0 -o out.png", "0"),
        ("in.png -o out.png", "-n"),
        ("-n 5 -o out.png", "IMAGE"),
        ("in.png -n 5 -o out.txt", ".png or .svg"),
        ("in.png -n 5 --black 1.5 -o out.png", "0 to 1"),
        ("in.png -n 5 --black -1 -o out.png", "0 to 1"),
        ("in.png -n 5 --black nan -o out.png", "0 to 1"),
        ("in.png -n 5 --black 0.5 -o out.png", "--cmyk"),
        ("in.png -n 5 --cmyk --invert -o out.png", "--invert"),
        ("in.png -n 5 --window 3 -o out.png", "--frames"),
        ("in.png -n 5 -o nowhere/out.png", "nowhere"),
        ("--frames in.png --window 9 --step 10 -o out.png", "step of 10"),
        ("--frames none*.png --window 9 --step 3 -o out.png", "no file matches"),
        ("--frames in.png --window 9 --step 3 -o -", "every frame is a file"),
        ("--frames [ --window 9 --step 3 -o out.png", "pattern"),
        ("--frames in.png --window 9 --step 3 -n 10 -o out.png", "have 9 points"),
    ] {
        place.refuse(&format!("stipple {arguments}"), expected);
    }
}

#[test]
fn an_animation_is_a_picture_per_frame() {
    let place = Place::new();
    for frame in 0..4_u32 {
        let image = RgbImage::from_fn(40, 30, |x, _| Rgb([if x / 10 == frame { 20 } else { 250 }; 3]));
        image.save(place.path(&format!("f{frame}.png"))).unwrap();
    }
    let options = "--window 100 --step 25 --iterations 20 --size 200 -o all.png --points all.csv";
    let command = format!("stipple --frames f*.png {options}");
    place.succeed(&command);
    for frame in 0..4 {
        let drawn = image::open(place.path(&format!("all-{frame:04}.png"))).unwrap();
        assert_eq!((drawn.width(), drawn.height()), (200, 150));
    }
    assert_eq!(fsot::read::points(&place.path("all.csv")).unwrap().points.len(), 175);
    RgbImage::from_pixel(41, 30, Rgb([9; 3])).save(place.path("f4.png")).unwrap();
    place.refuse(&command, "frame 4 has 41 x 30 pixels");
}
