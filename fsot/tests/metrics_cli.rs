//! `fsot measure` and `fsot spectrum` as programs.

use crate::metrics_common::random;
use fsot::points::Points;
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};
use tempfile::TempDir;

fn fsot(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fsot")).args(arguments).output().unwrap()
}

fn file(folder: &TempDir, name: &str, content: &str) -> String {
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    path.to_str().unwrap().to_owned()
}

fn text(points: &Points, class: impl Fn(usize) -> Option<usize>) -> String {
    let mut text = String::new();
    for (i, point) in points.iter().enumerate() {
        let row: Vec<String> = point.iter().map(f32::to_string).chain(class(i).map(|c| c.to_string())).collect();
        writeln!(text, "{}", row.join(" ")).unwrap();
    }
    text
}

fn names(folder: &Path) -> Vec<PathBuf> {
    let mut names: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    names.sort();
    names
}

fn succeed(arguments: &[&str]) -> String {
    let output = fsot(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Asserts exit code 2, a sentence with these words, and that nothing was written.
fn fail(folder: &TempDir, arguments: &[&str], words: &[&str]) {
    let before = names(folder.path());
    let output = fsot(arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(words.iter().all(|word| said.contains(word)), "{arguments:?}: {words:?} in {said}");
    assert!(output.stdout.is_empty() && !said.contains("panicked"), "{said}");
    assert_eq!(before, names(folder.path()));
}

#[test]
fn measures_points_classes_and_tiles() {
    let folder = TempDir::new().unwrap();
    let points = random(64, 2, 1);
    let plain = file(&folder, "plain.txt", &text(&points, |_| None));
    let classes = file(&folder, "classes.txt", &(text(&points, |i| Some(i % 2)) + "# classes: red blue\n"));
    let said = succeed(&["measure", &plain, &classes]);
    assert!(said.contains("plain.txt\n") && said.contains("classes.txt, class red\n"), "{said}");
    let json: Value = serde_json::from_str(&succeed(&["measure", "--json", &plain, &classes])).unwrap();
    let report = &json["files"][0]["points"];
    assert_eq!((report["points"].as_u64(), report["dims"].as_u64()), (Some(64), Some(2)));
    for path in
        ["/spectra/0/low", "/neighbours/mean", "/discrepancy/l2_star", "/transport/sliced_w2", "/integration/gaussians"]
    {
        assert!(report.pointer(path).is_some_and(Value::is_f64), "{path} in {report}");
    }
    assert_eq!(report["spectra"][0]["axes"], serde_json::json!([1, 2]));
    assert_eq!(json["files"][1]["classes"][1]["class"], "blue");
    assert_eq!(json["files"][1]["classes"][1]["report"]["points"], 32);
    let quick: Value = serde_json::from_str(&succeed(&["measure", "--json", "--quick", &plain])).unwrap();
    assert!(quick["files"][0]["points"]["integration"].is_null());

    let tile: Value = serde_json::from_str(&succeed(&[
        "measure",
        "--json",
        "--size",
        "4",
        "--spp",
        "2",
        "--integrands",
        "8",
        "--ema",
        "0.5",
        &plain,
    ]))
    .unwrap();
    let tile = &tile["files"][0]["tile"];
    assert_eq!((tile["frames"].as_u64(), tile["prefixes"][1]["spp"].as_u64()), (Some(2), Some(2)));
    assert!(tile["prefixes"][0]["energies"]["half_spaces"]["G2.1"].is_f64(), "{tile}");
    assert_eq!(tile["temporal"][0]["alpha"], 0.5);
}

/// As many classes as points: in seconds, and a report that ends.
#[test]
fn classes_without_end_are_left_out() {
    let folder = TempDir::new().unwrap();
    let rows: String = (0..100_000).map(|i| format!("{0},{0},{i}\n", i as f32 / 100_000.0)).collect();
    let path = file(&folder, "p.csv", &("x,y,class\n".to_owned() + &rows));
    let start = Instant::now();
    let classes = fsot::read::points(Path::new(&path)).unwrap().classes.unwrap();
    assert_eq!((classes.names.len(), classes.index[99_999], &classes.names[99_999][..]), (100_000, 99_999, "99999"));
    assert!(start.elapsed() < Duration::from_secs(5));
    let rows: String = (0..300).map(|i| format!("{0},{0},{i}\n", i as f32 / 300.0)).collect();
    let path = file(&folder, "q.csv", &("x,y,class\n".to_owned() + &rows));
    let said = succeed(&["measure", "--quick", &path]);
    assert!(said.contains("class 255\n") && said.ends_with("q.csv: 44 more classes are left out\n"), "{said}");
}

#[test]
fn prints_and_draws_errors_of_prefixes() {
    let folder = TempDir::new().unwrap();
    let files = [1, 2].map(|seed| file(&folder, &format!("{seed}.txt"), &text(&random(40, 2, seed), |_| None)));
    let plot = folder.path().join("plot.svg");
    let said = succeed(&["measure", "--prefix", "--plot", plot.to_str().unwrap(), &files[0], &files[1]]);
    assert!(
        said.contains("averaged over 2 sets") && said.lines().last().unwrap().trim_start().starts_with("40 "),
        "{said}"
    );
    assert!(std::fs::read_to_string(plot).unwrap().contains("<polyline"));
}

#[test]
fn scenes_without_an_error_are_refused() {
    let folder = TempDir::new().unwrap();
    for values in [[0.0; 16], [0.1; 16], std::array::from_fn(|i| if i % 2 == 0 { 1.0 } else { -1.0_f32 })] {
        let table = [b"noisefloor-scene 2 2 2\n".to_vec(), values.map(f32::to_le_bytes).concat()].concat();
        let path = folder.path().join("flat.table");
        std::fs::write(&path, table).unwrap();
        let error = fsot::metrics::scenes::SceneTable::read(&path).err().unwrap().to_string();
        assert!(error.contains("flat.table") && error.contains("leave it out"), "{error}");
    }
}

#[test]
fn draws_spectra() {
    let folder = TempDir::new().unwrap();
    let files = [1, 2].map(|seed| file(&folder, &format!("{seed}.txt"), &text(&random(64, 3, seed), |_| None)));
    let out = folder.path().join("spectrum.png");
    let vector = folder.path().join("spectrum.svg");
    for out in [&out, &vector] {
        succeed(&["spectrum", "--axes", "3", "1", "--out", out.to_str().unwrap(), &files[0], &files[1]]);
    }
    let picture = image::open(&out).unwrap().to_rgb8();
    assert!(
        picture.width() > 1000 && picture.pixels().any(|p| p.0 == [255; 3]) && picture.pixels().any(|p| p.0[0] < 60)
    );
    let svg = std::fs::read_to_string(vector).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("data:image/png;base64,") && svg.contains("anisotropy"));
    let tile = folder.path().join("tile.png");
    succeed(&["spectrum", "--size", "8", "--integrands", "4", "--out", tile.to_str().unwrap(), &files[0]]);
    assert!(image::open(&tile).is_ok());
}

#[test]
fn bad_input_is_refused_and_nothing_written() {
    let folder = TempDir::new().unwrap();
    let good = file(&folder, "good.txt", &text(&random(64, 2, 1), |_| None));
    let more = file(&folder, "more.txt", &text(&random(65, 2, 1), |_| None));
    let outside = file(&folder, "outside.txt", "0.1 0.2\n0.3 1.25\n");
    let nan = file(&folder, "nan.txt", "0.1 0.2\nNaN 0.5\n");
    let word = file(&folder, "word.txt", "0.1 0.2\n0.3 zero\n");
    let ragged = file(&folder, "ragged.txt", "0.1 0.2\n0.3\n");
    let ragged_csv = file(&folder, "ragged.csv", "0.1,0.2\n0.3\n");
    let semicolons = file(&folder, "semicolons.csv", "0.1;0.2\n");
    let table = file(&folder, "table.bin", "no table");
    let empty = file(&folder, "empty.txt", "");
    let tile = file(&folder, "tile.nft", "not a tile");
    let out = folder.path().join("out.png");
    let out = out.to_str().unwrap();
    fail(&folder, &["measure"], &["FILE"]);
    fail(&folder, &["measure", "/nowhere/points.txt"], &["/nowhere/points.txt"]);
    fail(&folder, &["measure", &good, &outside], &["outside.txt", "point 2 has 1.25 as coordinate 2"]);
    fail(&folder, &["measure", &nan], &["nan.txt", "line 2", "NaN"]);
    fail(&folder, &["measure", &word], &["word.txt", "line 2", "zero"]);
    fail(&folder, &["measure", &ragged], &["ragged.txt", "line 2"]);
    fail(&folder, &["measure", &ragged_csv], &["ragged.csv", "line 2 has 1 column"]);
    fail(&folder, &["measure", "--scenes", "/nowhere", &table], &["table.bin", "table.toml", "fsot sampler"]);
    fail(&folder, &["measure", "--scenes", "/nowhere", "--integrands", "3"], &["--integrands"]);
    fail(&folder, &["measure", "--scenes", "/nowhere", "--ema", "7"], &["--ema"]);
    fail(&folder, &["measure", &good, "--ema", "0.5", "--quick"], &["for tiles, and there is none"]);
    let still = &["measure", "--size", "8", "--ema", "0.3", &good];
    fail(&folder, still, &["--ema is for tiles of several frames, and there is none"]);
    fail(&folder, &["measure", &good, "--integrands", "9"], &["--integrands is for --prefix and tiles"]);
    fail(&folder, &["measure", &good, "--size", "8", "--quick"], &["--quick is for point sets, and there is none"]);
    fail(&folder, &["measure", &good, "--prefix", "--quick"], &["--quick"]);
    fail(&folder, &["measure", &semicolons], &["semicolons.csv holds no points: give rows of numbers"]);
    fail(&folder, &["measure", &empty], &["empty.txt"]);
    fail(&folder, &["measure", &tile], &["tile.nft"]);
    fail(&folder, &["measure", "--size", "7", &good], &["64 points", "7x7"]);
    fail(&folder, &["measure", "--size", "0", &good], &["0x0"]);
    fail(&folder, &["measure", "--size", "8", "--ema", "2", &good], &["alpha is 2; use 1e-6 to 1"]);
    fail(&folder, &["measure", "--size", "8", "--ema", "-1", &good], &["alpha is -1;"]);
    fail(&folder, &["measure", "--size", "8", "--ema", "1e-7", &good], &["alpha is 0.0000001; use 1e-6 to 1"]);
    fail(&folder, &["measure", "--prefix", &good, &more], &["different sizes"]);
    fail(&folder, &["measure", "--prefix", "--plot", "/nowhere/plot.png", &good], &["/nowhere"]);
    fail(&folder, &["spectrum", "--out", out, &good, &more], &["as many points"]);
    fail(&folder, &["spectrum", "--out", out, "--axes", "1", "3", &good], &["1 and 3 of 2"]);
    fail(&folder, &["spectrum", "--out", out, "--axes", "2", "2", &good], &["different coordinates"]);
    fail(&folder, &["spectrum", "--out", out, "--integrands", "9", &good], &["--integrands is for tiles"]);
    fail(&folder, &["spectrum", "--out", out, "--size", "8", "--axes", "1", "2", &good], &["--axes is for point sets"]);
    fail(&folder, &["spectrum", "--out", "/nowhere/out.png", &good], &["/nowhere"]);
    fail(&folder, &["spectrum", "--out", out, &nan], &["nan.txt"]);
}
