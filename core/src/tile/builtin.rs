//! The tiles that come with the library, each with a feature of its own.

use super::format::{HEADER_BYTES, shape};
use super::view::Tile;
use crate::Error;

/// Makes [`Builtin`] from the table below. A row: name, the feature that compiles it in, which Cargo.toml has too, and
/// its file in `core/tiles`, without the extension.
macro_rules! tiles {
    ($($(#[$doc:meta])* $name:ident $feature:literal $file:literal;)*) => {
        /// A tile that comes with the library. `docs/tiles.md` says what each is good for.
        ///
        /// ```
        /// use noisefloor::tile::Builtin;
        ///
        /// if let Ok(tile) = Builtin::Size128Spp4Dims2.tile() { // if its feature is on
        ///     assert_eq!(tile.shape().spp, 4);
        /// }
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Builtin {
            $($(#[$doc])* $name,)*
        }

        impl Builtin {
            /// Every one, compiled in or not.
            pub const ALL: [Builtin; [$($file),*].len()] = [$(Builtin::$name),*];

            /// The name of its file in `core/tiles`, without the extension.
            pub const fn name(self) -> &'static str {
                match self { $(Builtin::$name => $file,)* }
            }

            /// The bytes of its file; `None` if its feature is off.
            pub const fn bytes(self) -> Option<&'static [u8]> {
                match self {
                    $(#[cfg(feature = $feature)]
                    Builtin::$name => Some(include_bytes!(concat!("../../tiles/", $file, ".nft"))),)*
                    // Not reached where all are compiled in.
                    #[allow(unreachable_patterns)]
                    _ => None,
                }
            }
        }
    };
}

tiles! {
    /// 128 x 128 pixels, 1 sample, 2 dims.
    Size128Spp1Dims2 "tile-128-1spp-2d" "128_1SPP_2D";
    /// 128 x 128 pixels, 4 samples, 2 dims.
    Size128Spp4Dims2 "tile-128-4spp-2d" "128_4SPP_2D";
    /// 128 x 128 pixels, 16 samples, 2 dims.
    Size128Spp16Dims2 "tile-128-16spp-2d" "128_16SPP_2D";
    /// 128 x 128 pixels, 16 samples, 2 dims, progressive.
    Size128Spp16Dims2Progressive "tile-128-16spp-2d-progressive" "128_16SPP_2D_PROGRESSIVE";
    /// 128 x 128 pixels, 1 sample, 4 dims.
    Size128Spp1Dims4 "tile-128-1spp-4d" "128_1SPP_4D";
    /// 128 x 128 pixels, 4 samples, 4 dims.
    Size128Spp4Dims4 "tile-128-4spp-4d" "128_4SPP_4D";
    /// 128 x 128 pixels, 1 sample, 2 dims, for films that splat samples by a Gaussian filter.
    Size128Spp1Dims2Gaussian "tile-128-1spp-2d-gaussian" "128_1SPP_2D_GAUSSIAN";
    /// 128 x 128 pixels, 4 samples, 2 dims, for films that splat samples by a Gaussian filter.
    Size128Spp4Dims2Gaussian "tile-128-4spp-2d-gaussian" "128_4SPP_2D_GAUSSIAN";
    /// 128 x 128 pixels, 1 sample, 2 dims, 16 frames.
    Size128Spp1Dims2Temporal "tile-128-1spp-2d-temporal" "128_1SPP_2D_TEMPORAL";
    /// 64 x 64 pixels, 1 sample, 2 dims.
    Size64Spp1Dims2 "tile-64-1spp-2d" "64_1SPP_2D";
    /// 64 x 64 pixels, 4 samples, 2 dims.
    Size64Spp4Dims2 "tile-64-4spp-2d" "64_4SPP_2D";
    /// 64 x 64 pixels, 4 samples, 2 dims, 16 frames.
    Size64Spp4Dims2Temporal "tile-64-4spp-2d-temporal" "64_4SPP_2D_TEMPORAL";
}

impl Builtin {
    /// The tile. Its checksum is not computed again: a test of the library has done so.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if its feature is off.
    pub const fn tile(self) -> Result<Tile<'static>, Error> {
        let Some(bytes) = self.bytes() else { return Err(Error::Unsupported) };
        let Some((head, payload)) = bytes.split_first_chunk::<HEADER_BYTES>() else { return Err(Error::Length) };
        Tile::new(shape(head), payload)
    }
}
