//! `fsot measure` and `fsot spectrum` as programs.

use crate::cli_support::Place;
use crate::metrics_common::random;
use fsot::points::Points;
use serde_json::Value;
use std::fmt::Write;
use std::time::{Duration, Instant};

fn text(points: &Points, class: impl Fn(usize) -> Option<usize>) -> String {
    let mut text = String::new();
    for (i, point) in points.iter().enumerate() {
        let row: Vec<String> = point.iter().map(f32::to_string).chain(class(i).map(|c| c.to_string())).collect();
        writeln!(text, "{}", row.join(" ")).unwrap();
    }
    text
}

#[test]
fn measures_points_classes_and_tiles() {
    let place = Place::new();
    let points = random(64, 2, 1);
    place.write("plain.txt", text(&points, |_| None));
    place.write("classes.txt", text(&points, |i| Some(i % 2)) + "# classes: red blue\n");
    let said = place.succeed("measure plain.txt classes.txt");
    assert!(said.contains("plain.txt\n") && said.contains("classes.txt, class red\n"), "{said}");
    let json = |options: &str| -> Value {
        serde_json::from_str(&place.succeed(&format!("measure --json {options}"))).unwrap()
    };
    let both = json("plain.txt classes.txt");
    let report = &both["files"][0]["points"];
    assert_eq!((report["points"].as_u64(), report["dims"].as_u64()), (Some(64), Some(2)));
    for path in
        ["/spectra/0/low", "/neighbours/mean", "/discrepancy/l2_star", "/transport/sliced_w2", "/integration/gaussians"]
    {
        assert!(report.pointer(path).is_some_and(Value::is_f64), "{path} in {report}");
    }
    assert_eq!(report["spectra"][0]["axes"], serde_json::json!([1, 2]));
    assert_eq!(both["files"][1]["classes"][1]["class"], "blue");
    assert_eq!(both["files"][1]["classes"][1]["report"]["points"], 32);
    assert!(json("--quick plain.txt")["files"][0]["points"]["integration"].is_null());

    let tile = &json("--size 4 --spp 2 --integrands 8 --ema 0.5 plain.txt")["files"][0]["tile"];
    assert_eq!((tile["frames"].as_u64(), tile["prefixes"][1]["spp"].as_u64()), (Some(2), Some(2)));
    assert!(tile["prefixes"][0]["energies"]["half_spaces"]["G2.1"].is_f64(), "{tile}");
    assert_eq!(tile["temporal"][0]["alpha"], 0.5);
}

/// Colours are classes; a size is no coordinate.
#[test]
fn measures_what_place_wrote() {
    let place = Place::new();
    for (colours, name) in [(1, "o.csv"), (1, "o.json"), (3, "o.csv"), (3, "o.json")] {
        place.succeed(&format!("place -n 60 --colors {colours} --sizes --iterations 9 --quiet --out {name}"));
        let report: Value = serde_json::from_str(&place.succeed(&format!("measure --quick --json {name}"))).unwrap();
        let report = &report["files"][0];
        assert_eq!((&report["points"]["points"], &report["points"]["dims"]), (&60.into(), &2.into()), "{name}");
        let classes = report["classes"].as_array().map_or(&[][..], Vec::as_slice);
        assert_eq!(classes.len(), if colours > 1 { colours } else { 0 }, "{name}");
        assert!(classes.iter().all(|class| class["report"]["points"] == 60 / colours), "{name}");
        place.succeed(&format!("spectrum {name} --out s.png"));
    }
}

/// As many classes as points: in seconds, and a report that ends.
#[test]
fn classes_without_end_are_left_out() {
    let place = Place::new();
    let rows: String = (0..100_000).map(|i| format!("{0},{0},{i}\n", i as f32 / 100_000.0)).collect();
    place.write("p.csv", "x,y,class\n".to_owned() + &rows);
    let start = Instant::now();
    let classes = fsot::read::points(&place.path("p.csv")).unwrap().classes.unwrap();
    assert_eq!((classes.names.len(), classes.index[99_999], &classes.names[99_999][..]), (100_000, 99_999, "99999"));
    assert!(start.elapsed() < Duration::from_secs(5));
    let rows: String = (0..300).map(|i| format!("{0},{0},{i}\n", i as f32 / 300.0)).collect();
    place.write("q.csv", "x,y,class\n".to_owned() + &rows);
    let said = place.succeed("measure --quick q.csv");
    assert!(said.contains("class 255\n") && said.ends_with("q.csv: 44 more classes are left out\n"), "{said}");
}

#[test]
fn prints_and_draws_errors_of_prefixes() {
    let place = Place::new();
    for seed in [1, 2] {
        place.write(&format!("{seed}.txt"), text(&random(40, 2, seed), |_| None));
    }
    let said = place.succeed("measure --prefix --plot plot.svg 1.txt 2.txt");
    assert!(
        said.contains("averaged over 2 sets") && said.lines().last().unwrap().trim_start().starts_with("40 "),
        "{said}"
    );
    assert!(String::from_utf8(place.read("plot.svg")).unwrap().contains("<polyline"));
}

#[test]
fn scenes_without_an_error_are_refused() {
    let place = Place::new();
    for values in [[0.0; 16], [0.1; 16], std::array::from_fn(|i| if i % 2 == 0 { 1.0 } else { -1.0_f32 })] {
        let table = [b"noisefloor-scene 2 2 2\n".to_vec(), values.map(f32::to_le_bytes).concat()].concat();
        place.write("flat.table", table);
        let error = fsot::metrics::scenes::SceneTable::read(&place.path("flat.table")).err().unwrap().to_string();
        assert!(error.contains("flat.table") && error.contains("leave it out"), "{error}");
    }
}

#[test]
fn draws_spectra() {
    let place = Place::new();
    for seed in [1, 2] {
        place.write(&format!("{seed}.txt"), text(&random(64, 3, seed), |_| None));
    }
    place.succeed("spectrum --axes 3 1 --out spectrum.png 1.txt 2.txt");
    place.succeed("spectrum --axes 3 1 --out spectrum.svg 1.txt 2.txt");
    let picture = image::open(place.path("spectrum.png")).unwrap().to_rgb8();
    assert!(
        picture.width() > 1000 && picture.pixels().any(|p| p.0 == [255; 3]) && picture.pixels().any(|p| p.0[0] < 60)
    );
    let svg = String::from_utf8(place.read("spectrum.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("data:image/png;base64,") && svg.contains("anisotropy"));
    place.succeed("spectrum --size 8 --integrands 4 --out tile.png 1.txt");
    assert!(image::open(place.path("tile.png")).is_ok());
}

#[test]
fn bad_input_is_refused_and_nothing_written() {
    let place = Place::new();
    place.write("good.txt", text(&random(64, 2, 1), |_| None));
    place.write("more.txt", text(&random(65, 2, 1), |_| None));
    place.write("outside.txt", "0.1 0.2\n0.3 1.25\n");
    place.write("nan.txt", "0.1 0.2\nNaN 0.5\n");
    place.write("table.bin", "no table");
    place.write("tile.nft", "not a tile");
    for (arguments, message) in [
        ("measure", "FILE"),
        ("measure /nowhere/points.txt", "/nowhere/points.txt"),
        ("measure good.txt outside.txt", "outside.txt: point 2 has 1.25 as coordinate 2"),
        ("measure --scenes /nowhere table.bin", "table.bin needs its sidecar table.toml, which `fsot sampler` writes"),
        ("measure --scenes /nowhere --integrands 3", "--integrands"),
        ("measure --scenes /nowhere --ema 7", "--ema"),
        ("measure good.txt --ema 0.5 --quick", "for tiles, and there is none"),
        ("measure --size 8 --ema 0.3 good.txt", "--ema is for tiles of several frames, and there is none"),
        ("measure good.txt --integrands 9", "--integrands is for --prefix and tiles"),
        ("measure good.txt --size 8 --quick", "--quick is for point sets, and there is none"),
        ("measure good.txt --prefix --quick", "--quick"),
        ("measure tile.nft", "tile.nft"),
        ("measure --size 7 good.txt", "good.txt: 64 points cannot make whole frames of 7x7 pixels"),
        ("measure --size 0 good.txt", "0x0"),
        ("measure --size 8 --ema 2 good.txt", "alpha is 2; use 1e-6 to 1"),
        ("measure --size 8 --ema 1e-7 good.txt", "alpha is 0.0000001; use 1e-6 to 1"),
        ("measure --size 8 --ema -1 good.txt", "alpha is -1; use"),
        ("measure --prefix good.txt more.txt", "different sizes"),
        ("measure --prefix --plot /nowhere/plot.png good.txt", "/nowhere"),
        ("spectrum --out out.png good.txt more.txt", "as many points"),
        ("spectrum --out out.png --axes 1 3 good.txt", "1 and 3 of 2"),
        ("spectrum --out out.png --axes 2 2 good.txt", "different coordinates"),
        ("spectrum --out out.png --integrands 9 good.txt", "--integrands is for tiles"),
        ("spectrum --out out.png --size 8 --axes 1 2 good.txt", "--axes is for point sets"),
        ("spectrum --out /nowhere/out.png good.txt", "/nowhere"),
        ("spectrum --out out.png nan.txt", "nan.txt: line 2: `NaN`"),
    ] {
        place.refuse(arguments, message);
    }
}
