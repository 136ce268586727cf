//! Point sets read back as they were written; exports that other programs accept.

use fsot::export::points::{Format, Labels, Table, encode, words};
use fsot::export::tile;
use fsot::points::Points;
use fsot::read;
use noisefloor::tile::{Shape, Tile};
use std::fs;
use std::process::Command;

fn table(dims: usize, classes: bool) -> Table {
    let mut rng = fsot::random::stream(5, dims as u64, 0);
    let coordinates: Vec<f32> =
        (0..20 * dims).map(|_| rng.uniform_f32()).chain(vec![f32::MIN_POSITIVE; dims]).collect();
    let names = (0..21).map(|index| ["red", "blue"][index % 2].to_owned());
    Table { points: Points::new(dims, coordinates), classes: classes.then(|| Labels::from_names(names)) }
}

/// Of size, samples, dimensions, frames and bits.
fn view_of([size, spp, dims, frames, bits]: [usize; 5], payload: &[u8]) -> Tile<'_> {
    let [size, spp, dims, frames, bits] = [size, spp, dims, frames, bits].map(|length| length as u32);
    Tile::new(Shape { size, spp, dims, frames, bits, progressive: false }, payload).unwrap()
}

#[test]
fn points_keep_their_bits() {
    let folder = tempfile::tempdir().unwrap();
    for dims in [1, 2, 5, 8] {
        for classes in [false, true] {
            for name in ["p.txt", "p.csv", "p.json"] {
                let path = folder.path().join(name);
                let table = table(dims, classes);
                fs::write(&path, encode(&table, Format::of(&path)).unwrap()).unwrap();
                assert_eq!(read::points(&path).unwrap(), table, "{name}, {dims} dims");
            }
        }
    }
}

/// Verbatim, but in text, where spaces separate them, and at their ends in CSV.
#[test]
fn classes_keep_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["ink 1", "a,\"b\"\n#c", "", "red"];
    let written = Table { classes: Some(Labels::from_names(names.map(str::to_owned))), ..table(2, false) };
    let written = Table { points: Points::new(2, written.points.coordinates()[..8].to_vec()), ..written };
    for (name, expected) in [("p.csv", names), ("p.json", names), ("p.txt", ["ink_1", "a,\"b\"__c", "_", "red"])] {
        let path = folder.path().join(name);
        fs::write(&path, encode(&written, Format::of(&path)).unwrap()).unwrap();
        assert_eq!(read::points(&path).unwrap().classes.unwrap().names, expected, "{name}");
    }
    let same = Labels::from_names(["a b", "a_b"].map(str::to_owned));
    let same = Table { points: Points::new(1, vec![0.25, 0.5]), classes: Some(same) };
    assert!(encode(&same, Format::Csv).is_ok());
    let error = encode(&same, Format::Text).unwrap_err().to_string();
    assert!(error.contains("classes \"a b\" and \"a_b\" cannot be told apart"), "{error}");
    // Readers of CSV take these for one.
    assert!(words(&["red", "red "].map(str::to_owned)).is_err());
}

#[test]
fn foreign_text_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p");
    let read = |text: &str| {
        fs::write(&path, text).unwrap();
        read::points(&path)
    };
    let expected = Points::new(2, vec![0.25, 0.5, 0.75, 1.0]);
    let texts = [
        "0.25 0.5\n0.75 1\n",
        "# x y\r\n.25\t.5\r\n\r\n7.5e-1 1 # last\r\n",
        "x y\n.25 .5\n.75 1",
        "0.25 0.5 # a, b\n0.75 1\n",
        "a, b\n.25, .5\n.75, 1\n",
        "a #1,a #2\n.25,.5\n.75,1\n",
    ];
    for text in texts {
        assert_eq!(read(text).unwrap().points, expected, "{text}");
    }
    for (text, message) in [
        ("", "empty"),
        ("# nothing\n", "no points"),
        ("1 2\n3\n", "line 2 has 1 column,"),
        ("1 2\n3 nan\n", "line 2: `nan`"),
        ("1,2\n3,x\n", "line 2: `x`"),
        ("1 2 3 4 5 6 7 8 9\n", "9 coordinates"),
        ("{\"dims\": 2, \"points\": [[1]]}", "point 1 has 1 coordinate,"),
        ("{\"dims\": 2", "EOF"),
        ("1 2 5\n# classes: a b\n", "`5` is not the index"),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(message), "{text}: {error}");
    }
    fs::write(&path, [0xff, 0xfe, 0x00]).unwrap();
    assert!(read::points(&path).unwrap_err().to_string().contains("not text"));
    assert!(read::points(folder.path()).unwrap_err().to_string().contains("is a folder"));
    assert!(read::points(&folder.path().join("none")).unwrap_err().to_string().contains("none"));
}

#[test]
fn textures_have_the_documented_layout() {
    let (size, spp, dims, frames) = (2, 2, 5, 3);
    let count = frames * size * size * spp * dims;
    let payload: Vec<u8> = (0..count as u16).flat_map(|v| (v * 7).to_le_bytes()).collect();
    let view = view_of([size, spp, dims, frames, 16], &payload);
    let png = image::load_from_memory(&tile::png(&view).unwrap()).unwrap().into_rgba16();
    let exr = image::load_from_memory(&tile::exr(&view).unwrap()).unwrap().into_rgba32f();
    assert_eq!(png.dimensions(), (2, (2 * frames * spp * 2) as u32));
    for (frame, y, x, sample, dim) in [(0, 0, 0, 0, 0), (2, 1, 0, 1, 4), (1, 0, 1, 1, 3), (2, 1, 1, 0, 2)] {
        let value = (((((frame * size + y) * size + x) * spp + sample) * dims + dim) * 7) as u16;
        let layer = (frame * spp + sample) * 2 + dim / 4;
        let texel = (x as u32, (layer * size + y) as u32);
        assert_eq!(png.get_pixel(texel.0, texel.1).0[dim % 4], value);
        assert_eq!(exr.get_pixel(texel.0, texel.1).0[dim % 4], (f32::from(value) + 0.5) / 65536.0);
    }
}

#[test]
fn textures_of_few_dims_and_bits() {
    for (dims, colour) in [(1, image::ColorType::L8), (2, image::ColorType::Rgb8), (4, image::ColorType::Rgba8)] {
        let payload: Vec<u8> = (0..4 * dims as u8).map(|v| 255 - v).collect();
        let view = view_of([2, 1, dims, 1, 8], &payload);
        let png = image::load_from_memory(&tile::png(&view).unwrap()).unwrap();
        assert_eq!(png.color(), colour);
        let first = png.into_rgba8().get_pixel(1, 0).0[0];
        assert_eq!(first, 255 - dims as u8);
        assert!(tile::exr(&view).is_ok());
    }
}

#[test]
fn source_code_compiles_and_holds_the_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let payload: Vec<u8> = (0..64u16).flat_map(|v| (v * 1000).to_le_bytes()).collect();
    let view = view_of([4, 2, 2, 1, 16], &payload);
    for (name, array) in [("linux", "tile_linux"), ("UINTPTR_T", "tile_uintptr_t"), ("while", "tile_while"), ("t", "t")]
    {
        let text = String::from_utf8(tile::c_header(&view, name)).unwrap();
        assert!(text.contains(&format!("static const uint16_t {array}[64] = {{")), "{text}");
    }
    let run = |command: &mut Command| assert!(command.current_dir(folder.path()).status().unwrap().success());
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();

    write("tile.h", &tile::c_header(&view, "4_2SPP-2D"));
    write(
        "main.c",
        b"#include \"tile.h\"\nint main(void) { return !(TILE_4_2SPP_2D_SIZE == 4 && TILE_4_2SPP_2D_SPP == 2 && \
          sizeof tile_4_2spp_2d == 128 && tile_4_2spp_2d[63] == 63000); }\n",
    );
    for (variable, default, language, standard) in [("CC", "cc", "c", "-std=c99"), ("CXX", "c++", "c++", "-std=c++11")]
    {
        let compiler = std::env::var(variable).ok().filter(|name| !name.is_empty()).unwrap_or(default.to_owned());
        let warnings = ["-Wall", "-Wextra", "-pedantic", "-Werror"];
        run(Command::new(compiler).args(["-x", language, standard]).args(warnings).args(["main.c", "-o", "c"]));
        run(&mut Command::new(folder.path().join("c")));
    }

    write("tile.rs", &tile::rust(&view, "4_2SPP_2D"));
    write(
        "main.rs",
        b"mod tile;\nfn main() { assert_eq!((tile::SIZE, tile::TILE.len(), tile::TILE[63]), (4, 64, 63000)); }\n",
    );
    run(Command::new("rustc").args(["--edition", "2024", "main.rs", "-A", "dead_code", "-o", "rust"]));
    run(&mut Command::new(folder.path().join("rust")));
}
