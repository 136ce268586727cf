//! The tiles that come with the library, each with a feature of its own.

use super::format::{HEADER_BYTES, Header};
use super::view::Tile;
use crate::Error;

/// A tile that comes with the library. The numbers never change; `docs/tiles.md` says what each is good for.
///
/// ```
/// use noisefloor::tile::Builtin;
///
/// assert_eq!(Builtin::from_id(2), Some(Builtin::Size128Spp4Dims2));
/// if let Ok(tile) = Builtin::Size128Spp4Dims2.tile() { // if its feature is on
///     assert_eq!(tile.shape().spp, 4);
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Builtin {
    /// 128 x 128 pixels, 1 sample, 2 dims.
    Size128Spp1Dims2 = 1,
    /// 128 x 128 pixels, 4 samples, 2 dims.
    Size128Spp4Dims2 = 2,
    /// 128 x 128 pixels, 16 samples, 2 dims.
    Size128Spp16Dims2 = 3,
    /// 128 x 128 pixels, 16 samples, 2 dims, progressive.
    Size128Spp16Dims2Progressive = 4,
    /// 128 x 128 pixels, 1 sample, 4 dims.
    Size128Spp1Dims4 = 5,
    /// 128 x 128 pixels, 4 samples, 4 dims.
    Size128Spp4Dims4 = 6,
    /// 128 x 128 pixels, 1 sample, 2 dims, for images reconstructed with a Gaussian filter.
    Size128Spp1Dims2Gaussian = 7,
    /// 128 x 128 pixels, 4 samples, 2 dims, for images reconstructed with a Gaussian filter.
    Size128Spp4Dims2Gaussian = 8,
    /// 128 x 128 pixels, 1 sample, 2 dims, 16 frames.
    Size128Spp1Dims2Temporal = 9,
    /// 64 x 64 pixels, 1 sample, 2 dims.
    Size64Spp1Dims2 = 10,
    /// 64 x 64 pixels, 4 samples, 2 dims.
    Size64Spp4Dims2 = 11,
    /// 64 x 64 pixels, 4 samples, 2 dims, 16 frames.
    Size64Spp4Dims2Temporal = 12,
}

impl Builtin {
    /// Every one, compiled in or not.
    pub const ALL: [Builtin; 12] = [
        Builtin::Size128Spp1Dims2,
        Builtin::Size128Spp4Dims2,
        Builtin::Size128Spp16Dims2,
        Builtin::Size128Spp16Dims2Progressive,
        Builtin::Size128Spp1Dims4,
        Builtin::Size128Spp4Dims4,
        Builtin::Size128Spp1Dims2Gaussian,
        Builtin::Size128Spp4Dims2Gaussian,
        Builtin::Size128Spp1Dims2Temporal,
        Builtin::Size64Spp1Dims2,
        Builtin::Size64Spp4Dims2,
        Builtin::Size64Spp4Dims2Temporal,
    ];

    /// The tile of a number, `None` for a number of no tile.
    pub fn from_id(id: u32) -> Option<Builtin> {
        Builtin::ALL.into_iter().find(|&tile| tile as u32 == id)
    }

    /// The name of its file in `core/tiles`, without the extension.
    pub const fn name(self) -> &'static str {
        match self {
            Builtin::Size128Spp1Dims2 => "128_1SPP_2D",
            Builtin::Size128Spp4Dims2 => "128_4SPP_2D",
            Builtin::Size128Spp16Dims2 => "128_16SPP_2D",
            Builtin::Size128Spp16Dims2Progressive => "128_16SPP_2D_PROGRESSIVE",
            Builtin::Size128Spp1Dims4 => "128_1SPP_4D",
            Builtin::Size128Spp4Dims4 => "128_4SPP_4D",
            Builtin::Size128Spp1Dims2Gaussian => "128_1SPP_2D_GAUSSIAN",
            Builtin::Size128Spp4Dims2Gaussian => "128_4SPP_2D_GAUSSIAN",
            Builtin::Size128Spp1Dims2Temporal => "128_1SPP_2D_TEMPORAL",
            Builtin::Size64Spp1Dims2 => "64_1SPP_2D",
            Builtin::Size64Spp4Dims2 => "64_4SPP_2D",
            Builtin::Size64Spp4Dims2Temporal => "64_4SPP_2D_TEMPORAL",
        }
    }

    /// The bytes of its file; `None` if its feature is off. A new tile needs a line here and one in Cargo.toml.
    pub const fn bytes(self) -> Option<&'static [u8]> {
        match self {
            #[cfg(feature = "tile-128-1spp-2d")]
            Builtin::Size128Spp1Dims2 => Some(include_bytes!("../../tiles/128_1SPP_2D.nft")),
            #[cfg(feature = "tile-128-4spp-2d")]
            Builtin::Size128Spp4Dims2 => Some(include_bytes!("../../tiles/128_4SPP_2D.nft")),
            #[cfg(feature = "tile-128-16spp-2d")]
            Builtin::Size128Spp16Dims2 => Some(include_bytes!("../../tiles/128_16SPP_2D.nft")),
            #[cfg(feature = "tile-128-16spp-2d-progressive")]
            Builtin::Size128Spp16Dims2Progressive => Some(include_bytes!("../../tiles/128_16SPP_2D_PROGRESSIVE.nft")),
            #[cfg(feature = "tile-128-1spp-4d")]
            Builtin::Size128Spp1Dims4 => Some(include_bytes!("../../tiles/128_1SPP_4D.nft")),
            #[cfg(feature = "tile-128-4spp-4d")]
            Builtin::Size128Spp4Dims4 => Some(include_bytes!("../../tiles/128_4SPP_4D.nft")),
            #[cfg(feature = "tile-128-1spp-2d-gaussian")]
            Builtin::Size128Spp1Dims2Gaussian => Some(include_bytes!("../../tiles/128_1SPP_2D_GAUSSIAN.nft")),
            #[cfg(feature = "tile-128-4spp-2d-gaussian")]
            Builtin::Size128Spp4Dims2Gaussian => Some(include_bytes!("../../tiles/128_4SPP_2D_GAUSSIAN.nft")),
            #[cfg(feature = "tile-128-1spp-2d-temporal")]
            Builtin::Size128Spp1Dims2Temporal => Some(include_bytes!("../../tiles/128_1SPP_2D_TEMPORAL.nft")),
            #[cfg(feature = "tile-64-1spp-2d")]
            Builtin::Size64Spp1Dims2 => Some(include_bytes!("../../tiles/64_1SPP_2D.nft")),
            #[cfg(feature = "tile-64-4spp-2d")]
            Builtin::Size64Spp4Dims2 => Some(include_bytes!("../../tiles/64_4SPP_2D.nft")),
            #[cfg(feature = "tile-64-4spp-2d-temporal")]
            Builtin::Size64Spp4Dims2Temporal => Some(include_bytes!("../../tiles/64_4SPP_2D_TEMPORAL.nft")),
            // Not reached where all are compiled in.
            #[allow(unreachable_patterns)]
            _ => None,
        }
    }

    /// The tile. Its checksum is not computed again: a test of the library has done so.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if its feature is off.
    pub const fn tile(self) -> Result<Tile<'static>, Error> {
        let Some(bytes) = self.bytes() else { return Err(Error::Unsupported) };
        let Some((head, payload)) = bytes.split_first_chunk::<HEADER_BYTES>() else { return Err(Error::Length) };
        match Header::parse(head) {
            Ok(header) => Tile::new(header.shape(), payload),
            Err(error) => Err(error),
        }
    }
}
