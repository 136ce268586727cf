//! The samplers that are compared, and the tiles that there are.

use super::renderer::Sampler;
use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;
use std::path::Path;

/// A sampler that is compared.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Choice {
    Random,
    Sobol,
    /// The tile of so many dimensions that has as many samples as are drawn, or the next fewer.
    Tile(u32),
    /// One tile for every number of samples.
    Progressive,
}

impl Choice {
    /// In headings and tables.
    pub(crate) fn label(self) -> String {
        match self {
            Self::Random => "random".to_owned(),
            Self::Sobol => "Owen-Sobol".to_owned(),
            Self::Tile(dims) => format!("tile {dims}D"),
            Self::Progressive => "progressive tile".to_owned(),
        }
    }

    /// None if there is no such tile.
    pub(crate) fn sampler(self, spp: u32, tiles: &Tiles) -> Option<Sampler<'_>> {
        let find = |name: &str| tiles.find(name).map(Sampler::Tile);
        match self {
            Self::Random => Some(Sampler::Random),
            Self::Sobol => Some(Sampler::Sobol),
            Self::Tile(dims) => {
                (0..=spp.ilog2()).rev().find_map(|power| find(&format!("128_{}SPP_{dims}D", 1 << power)))
            }
            Self::Progressive => find("128_16SPP_2D_PROGRESSIVE"),
        }
    }
}

/// The tiles that there are: their names, and what the path tracer calls them.
pub(crate) struct Tiles(BTreeMap<String, String>);

impl Tiles {
    /// The library's, and the files NAME.nft of a folder, which come before tiles of the same name.
    pub(crate) fn new(library: Vec<String>, folder: Option<&Path>) -> Result<Self> {
        let mut tiles: BTreeMap<_, _> = library.into_iter().map(|name| (name.clone(), name)).collect();
        if let Some(folder) = folder {
            let before = tiles.len();
            let entries = folder.read_dir().with_context(|| format!("cannot read {}", folder.display()))?;
            for entry in entries {
                let path = std::path::absolute(entry?.path())?;
                let name = path.file_name().and_then(|name| name.to_str()).and_then(|name| name.strip_suffix(".nft"));
                if let (Some(name), Some(argument)) = (name, path.to_str()) {
                    tiles.insert(name.to_owned(), argument.to_owned());
                }
            }
            if tiles.len() == before && !tiles.values().any(|tile| tile.ends_with(".nft")) {
                bail!("{} holds no files NAME.nft", folder.display());
            }
        }
        Ok(Self(tiles))
    }

    pub(crate) fn find(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_has_no_more_samples_than_are_drawn() {
        let names = ["128_1SPP_2D", "128_4SPP_2D", "128_1SPP_4D"].map(str::to_owned);
        let tiles = Tiles::new(names.to_vec(), None).expect("no folder");
        let name = |choice: Choice, spp| match choice.sampler(spp, &tiles) {
            Some(Sampler::Tile(name)) => name.to_owned(),
            _ => "none".to_owned(),
        };
        assert_eq!(name(Choice::Tile(2), 1), "128_1SPP_2D");
        assert_eq!(name(Choice::Tile(2), 16), "128_4SPP_2D");
        assert_eq!(name(Choice::Tile(4), 4), "128_1SPP_4D");
        assert_eq!(name(Choice::Progressive, 4), "none");
    }
}
