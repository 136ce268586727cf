//! `nf_tile` and `nf_tile_sampler`, called as a C program calls them, from the archive that ships.

use std::ffi::c_void;

/// `nf_tile`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Tile {
    values: *const c_void,
    bytes: usize,
    size: u32,
    spp: u32,
    dims: u32,
    frames: u32,
    bits: u32,
    progressive: u32,
}

/// `nf_tile_sampler`.
#[repr(C)]
#[derive(Clone, Copy)]
struct Sampler {
    tile: *const Tile,
    domain: u32,
    index: u32,
    x: u16,
    y: u16,
    frame: u16,
    scrambled: u16,
}

c_functions! {
    fn nf_tile_from_bytes(bytes: *const c_void, len: usize, out: *mut Tile) -> i32;
    fn nf_tile_sampler_pixel(tile: *const Tile, x: u32, y: u32, frame: u32, index: u32) -> Sampler;
    fn nf_tile_sampler_domain(sampler: Sampler, key: u32) -> Sampler;
    fn nf_tile_sampler_draw(sampler: Sampler, dims: u32, u: *mut f32);
    fn nf_tile_sampler_fill(
        samplers: *const Sampler,
        dims: *const u32,
        domains: usize,
        width: u32,
        height: u32,
        samples: u32,
        u: *mut f32,
        len: usize,
    ) -> i32;
}

impl Tile {
    /// A tile of bytes that live for the whole program.
    pub fn new(bytes: &'static [u8]) -> Self {
        let mut out = std::mem::MaybeUninit::uninit();
        // SAFETY: the bytes live on; on success the tile is written.
        unsafe {
            assert_eq!(nf_tile_from_bytes(bytes.as_ptr().cast(), bytes.len(), out.as_mut_ptr()), 0);
            out.assume_init()
        }
    }

    /// The sum of two numbers of the pixel's own domain. (To return both, Rust would load them as one, and wait for
    /// the two stores.)
    #[inline]
    pub fn root(&self, x: u32, y: u32, index: u32) -> f32 {
        let mut u = [0.0; 2];
        // SAFETY: the tile lives, and there is room for two numbers.
        unsafe { nf_tile_sampler_draw(nf_tile_sampler_pixel(self, x, y, 0, index), 2, u.as_mut_ptr()) };
        u[0] + u[1]
    }

    /// The sum of four numbers of the pixel's own domain.
    #[inline]
    pub fn root4(&self, x: u32, y: u32, index: u32) -> f32 {
        let mut u = [0.0; 4];
        // SAFETY: the tile lives, and there is room for four numbers.
        unsafe { nf_tile_sampler_draw(nf_tile_sampler_pixel(self, x, y, 0, index), 4, u.as_mut_ptr()) };
        (u[0] + u[1]) + (u[2] + u[3])
    }

    /// Numbers of a sample.
    pub fn dims(&self) -> u32 {
        self.dims
    }

    /// The sum of four numbers, two of each of two child domains.
    #[inline]
    pub fn children(&self, x: u32, y: u32, index: u32) -> f32 {
        let mut u = [0.0; 4];
        let (first, second) = u.split_at_mut(2);
        // SAFETY: as above.
        unsafe {
            let pixel = nf_tile_sampler_pixel(self, x, y, 0, index);
            nf_tile_sampler_draw(nf_tile_sampler_domain(pixel, 0), 2, first.as_mut_ptr());
            nf_tile_sampler_draw(nf_tile_sampler_domain(pixel, 1), 2, second.as_mut_ptr());
        }
        (u[0] + u[1]) + (u[2] + u[3])
    }

    /// The samples of a pixel in one call, and the sum of the last two numbers: `dims` numbers of the root, or two
    /// of each of two child domains.
    #[inline]
    pub fn samples(&self, x: u32, y: u32, samples: u32, dims: u32, u: &mut [f32]) -> f32 {
        // SAFETY: as above; the length is that of `u`.
        let status = unsafe {
            let pixel = nf_tile_sampler_pixel(self, x, y, 0, 0);
            if dims <= self.dims {
                nf_tile_sampler_fill(&pixel, &dims, 1, 1, 1, samples, u.as_mut_ptr(), u.len())
            } else {
                let both = [nf_tile_sampler_domain(pixel, 0), nf_tile_sampler_domain(pixel, 1)];
                nf_tile_sampler_fill(both.as_ptr(), [2, 2].as_ptr(), 2, 1, 1, samples, u.as_mut_ptr(), u.len())
            }
        };
        assert_eq!(status, 0);
        u.last_chunk().map_or(0.0, |[a, b]: &[f32; 2]| a + b)
    }
}
