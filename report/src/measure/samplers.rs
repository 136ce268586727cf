//! The samplers that are compared, and the tiles that there are.

use super::renderer::Sampler;

/// A sampler that is compared.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Choice {
    /// The library's own.
    Default,
    Random,
    Sobol,
    /// The tile of so many dimensions that has as many samples as are drawn, or the next fewer.
    Tile(u32),
}

impl Choice {
    /// In headings and tables.
    pub(crate) fn label(self) -> String {
        match self {
            Self::Default => "default".to_owned(),
            Self::Random => "random".to_owned(),
            Self::Sobol => "Owen-Sobol".to_owned(),
            Self::Tile(dims) => format!("tile {dims}D"),
        }
    }

    /// None if there is no such tile.
    pub(crate) fn sampler(self, spp: u32, tiles: &Tiles) -> Option<Sampler<'_>> {
        let find = |name: &str| tiles.find(name).map(Sampler::Tile);
        match self {
            Self::Default => Some(Sampler::Default),
            Self::Random => Some(Sampler::Random),
            Self::Sobol => Some(Sampler::Sobol),
            Self::Tile(dims) => {
                (0..=spp.ilog2()).rev().find_map(|power| find(&format!("128_{}SPP_{dims}D", 1 << power)))
            }
        }
    }
}

/// The names of the library's tiles.
pub(crate) struct Tiles(pub(crate) Vec<String>);

impl Tiles {
    pub(crate) fn find(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|known| *known == name).map(String::as_str)
    }
}
