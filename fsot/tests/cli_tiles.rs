//! The tiles that come with the library are what their sidecars say, and the smallest is made anew.

use crate::cli_support::Place;
use fsot::export::nft::TileFile;
use fsot::export::sidecar::{self, Quality, Row, Sidecar};
use fsot::tile::preset;
use noisefloor::tile::Builtin;
use std::fs;
use std::path::{Path, PathBuf};

/// What a measured energy may differ by: the last digits depend on the Fourier transform.
const TOLERANCE: f64 = 0.02;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/tiles")
}

/// The names of the shipped files with this ending.
fn names(ending: &str) -> Vec<String> {
    let paths = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let mut names: Vec<String> = paths
        .filter(|path| path.extension().is_some_and(|found| found == ending))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    names.sort();
    names
}

fn tile(name: &str) -> PathBuf {
    folder().join(format!("{name}.nft"))
}

fn assert_close(made: &Quality, shipped: &Quality) {
    assert_eq!(made.integrands, shipped.integrands);
    let rows = |quality: &Quality| -> Vec<Row> {
        quality.energy.iter().chain(&quality.marginal).chain(&quality.temporal).cloned().collect()
    };
    let (made, shipped) = (rows(made), rows(shipped));
    assert_eq!(made.len(), shipped.len());
    for (made, shipped) in made.iter().zip(&shipped) {
        assert_eq!((made.spp, made.axes, made.alpha), (shipped.spp, shipped.axes, shipped.alpha));
        let pairs = [(made.filtered, shipped.filtered), (made.perceptual, shipped.perceptual), (made.raw, shipped.raw)];
        for (made, shipped) in pairs.iter().flat_map(|(made, shipped)| made.iter().zip(shipped)) {
            assert!((made - shipped).abs() <= TOLERANCE * shipped, "{made} is not {shipped}");
        }
    }
}

#[test]
fn every_preset_is_shipped_and_nothing_else() {
    let mut presets = Builtin::ALL.map(Builtin::name).to_vec();
    presets.sort();
    assert_eq!(names("nft"), presets);
    presets.push("nested_32");
    presets.sort();
    assert_eq!(names("toml"), presets);
}

#[test]
fn sidecars_describe_their_tiles() {
    for builtin in Builtin::ALL {
        let name = builtin.name();
        let path = tile(name);
        let file = TileFile::read(&path).unwrap();
        let sidecar = sidecar::read::<Sidecar>(&path).unwrap().unwrap_or_else(|| panic!("{name} has no sidecar"));
        assert!(sidecar.describes(file.bytes()), "{name}");
        assert_eq!(sidecar.kernel, file.header().kernel(), "{name}");
        assert_eq!(sidecar.seed, file.header().seed(), "{name}");
        let problem = preset(builtin);
        assert_eq!((sidecar.seed, sidecar.iterations), (problem.seed, problem.iterations), "{name}");
        assert!(sidecar.command.starts_with(&format!("fsot tile --preset {name} ")), "{}", sidecar.command);
        assert!(sidecar.command.ends_with(&format!(" --out {name}.nft")), "{}", sidecar.command);
    }
}

#[test]
fn the_smallest_tile_is_made_again_with_the_same_bytes() {
    let path = tile("64_1SPP_2D");
    let shipped = sidecar::read::<Sidecar>(&path).unwrap().unwrap();
    let place = Place::new();
    place.succeed(shipped.command.strip_prefix("fsot ").unwrap());
    assert!(place.read("64_1SPP_2D.nft") == fs::read(&path).unwrap(), "other bytes: run cargo xtask tiles and say why");
    let made = sidecar::read::<Sidecar>(&place.path("64_1SPP_2D.nft")).unwrap().unwrap();
    assert_eq!(made.command, shipped.command);
    assert_eq!((made.seed, made.iterations), (shipped.seed, shipped.iterations));
    assert_eq!(made.kernel, shipped.kernel);
    assert_eq!(made.sha256, shipped.sha256);
    assert_close(&made.quality, &shipped.quality);
}
