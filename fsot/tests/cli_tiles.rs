//! The tiles that come with the library are what their sidecars say, and the smallest is made anew.

mod cli_support;

use cli_support::Place;
use fsot::export::nft::TileFile;
use fsot::export::sidecar::Sidecar;
use std::fs;
use std::path::{Path, PathBuf};

fn tiles() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/tiles");
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut tiles: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|ending| ending == "nft")).collect();
    tiles.sort();
    // One that was not optimised for anything says so: it stands in until it is made.
    tiles.retain(|path| !TileFile::read(path).unwrap().header().kernel().starts_with("none"));
    tiles
}

#[test]
fn sidecars_describe_their_tiles() {
    for path in tiles() {
        let file = TileFile::read(&path).unwrap();
        let sidecar = Sidecar::read(&path).unwrap().unwrap_or_else(|| panic!("{} has no sidecar", path.display()));
        assert!(sidecar.describes(file.bytes()), "{}", path.display());
        assert_eq!(sidecar.kernel, file.header().kernel(), "{}", path.display());
        assert_eq!(sidecar.seed, file.header().seed(), "{}", path.display());
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(sidecar.command.starts_with(&format!("fsot tile --preset {name} ")), "{}", sidecar.command);
    }
}

#[test]
fn the_smallest_tile_is_made_again_with_the_same_bytes() {
    let Some(path) = tiles().into_iter().find(|path| path.ends_with("64_1SPP_2D.nft")) else { return };
    let sidecar = Sidecar::read(&path).unwrap().unwrap();
    let place = Place::new();
    place.succeed(sidecar.command.strip_prefix("fsot ").unwrap());
    assert!(place.read("64_1SPP_2D.nft") == fs::read(&path).unwrap(), "other bytes: run cargo xtask tiles and say why");
    assert_eq!(place.read("64_1SPP_2D.toml"), fs::read(Sidecar::path(&path)).unwrap());
}
