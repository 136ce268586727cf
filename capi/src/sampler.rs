//! The default sampler, by value.

use crate::status::*;
use crate::{convert, fill};
use noisefloor_core::sampler::{Sampler, table};

/// One sample of one pixel, of the default sampler: passed and copied by value, unchanged by drawing, made by
/// nf_sampler_pixel.
///
/// It stands for a point of a cube of any dimensions. Each decision of a path (lens, light, bounce, ...) has a domain,
/// a child of the sampler by a key of its own, whose numbers depend on nothing but pixel, frame, index and the keys
/// that led to it: any sample can be drawn in any order, on any thread.
#[repr(C)]
#[allow(non_camel_case_types)]
#[derive(Clone, Copy)]
pub struct nf_sampler {
    /// The domain: 0 is the root.
    pub domain: u32,
    /// The sample of the pixel.
    pub index: u32,
    /// The pixel's column, its last 16 bits.
    pub x: u16,
    /// The pixel's row, likewise.
    pub y: u16,
    /// Whether it is scrambled, or white.
    pub flags: u32,
}

/// Sample `index` of pixel (x, y) in `frame`, any values of each. The samples of a pixel are one sequence, best at
/// powers of two. Where frames are averaged, count it on in frame 0; of what moves sample k is k % 16 of frame k / 16.
///
/// At indices 0 and 1 the numbers of all domains repeat every 32 pixels: an image has 1,024 different vectors. Seeds of
/// further numbers need the pixel, too.
#[unsafe(no_mangle)]
pub extern "C" fn nf_sampler_pixel(x: u32, y: u32, frame: u32, index: u32) -> nf_sampler {
    of(Sampler::pixel(x, y, frame, index))
}

/// As nf_sampler_pixel(), but the error is white over the image: for denoisers that were made for white noise. At
/// indices 0 and 1 a pixel has one of 1,024 vectors at random.
#[unsafe(no_mangle)]
pub extern "C" fn nf_sampler_white(x: u32, y: u32, frame: u32, index: u32) -> nf_sampler {
    of(Sampler::white(x, y, frame, index))
}

/// The child domain of a key, any value. Children of different keys are unrelated to each other and to their parent, at
/// indices 0 and 1 as far as nf_sampler_pixel() says; keys mean something only among the children of one parent.
#[unsafe(no_mangle)]
pub extern "C" fn nf_sampler_domain(sampler: nf_sampler, key: u32) -> nf_sampler {
    of(to(&sampler).domain(key))
}

/// An independent version of the sampler, and of its children, for each seed but 0, which changes nothing. All values
/// of a dimension are exclusive-or a hash of seed and domain: uniform over random seeds, for unbiased estimates. Nets
/// stay nets; neighbours' errors vanish less through a filter. For good images take another frame instead.
#[unsafe(no_mangle)]
pub extern "C" fn nf_sampler_scramble(sampler: nf_sampler, seed: u32) -> nf_sampler {
    of(to(&sampler).scramble(seed))
}

/// Writes `dims` numbers, 1..4, to u[dims]: each in [0, 1), a multiple of 2^-24; nothing if dims is out of range or u
/// NULL. The first two are optimised together, across pixels too; all four are stratified together.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_sampler_draw(sampler: nf_sampler, dims: u32, u: *mut f32) {
    // What is drawn most often, apart from all else, so that it needs few registers.
    if dims != 2 {
        // SAFETY: passed on to the caller.
        return unsafe { others(sampler, dims, u) };
    }
    // SAFETY: as above.
    let Ok(u) = (unsafe { convert::rooms(u, 2) }) else { return };
    // A pixel's own numbers, and a domain's, without looking at domain and flags again.
    match (sampler.flags, sampler.domain) {
        (0, 0) => write::<2>(&nf_sampler { domain: 0, flags: 0, ..sampler }, u),
        (0, _) => write::<2>(&nf_sampler { flags: 0, ..sampler }, u),
        _ => write::<2>(&sampler, u),
    }
}

/// # Safety
/// `u` must be NULL or have room for `dims` numbers, if that is 1 to 4.
#[inline(never)]
unsafe fn others(sampler: nf_sampler, dims: u32, u: *mut f32) {
    if !(1..=4).contains(&dims) {
        return;
    }
    // SAFETY: passed on to the caller.
    let Ok(u) = (unsafe { convert::rooms(u, dims as usize) }) else { return };
    match dims {
        1 => write::<1>(&sampler, u),
        3 => write::<3>(&sampler, u),
        _ => write::<4>(&sampler, u),
    }
}

#[inline(always)]
fn write<const N: usize>(sampler: &nf_sampler, u: &mut [convert::Room<f32>]) {
    for (u, number) in u.iter_mut().zip(to(sampler).draw::<N>()) {
        u.write(number);
    }
}

/// The table that all draws look into, 65,536 numbers, for copies on other devices: see noisefloor_sampler.h.
#[unsafe(no_mangle)]
pub extern "C" fn nf_sampler_table() -> *const u32 {
    table::TABLE.as_ptr()
}

/// Draws for many pixels and samples at once, with the bits of single draws.
///
/// samplers[domains]: all at the first pixel and sample. dims[domains]: how many numbers of each, 1..4. width, height:
/// pixels to the right and down. samples: of each pixel, by ascending index. u[height][width][samples][sum of dims], of
/// which `len` numbers, or more than needed, are there.
///
/// NF_ERR_RANGE: dims, or sizes that memory cannot have; NF_ERR_MEMORY: len.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_sampler_fill(
    samplers: *const nf_sampler,
    dims: *const u32,
    domains: usize,
    width: u32,
    height: u32,
    samples: u32,
    u: *mut f32,
    len: usize,
) -> nf_status {
    // SAFETY: the caller's arrays, of the lengths that are stated.
    unsafe { fill::fill((samplers, dims, domains), [width, height, samples], (u, len), |_| Ok(()), to) }
}

fn to(&nf_sampler { domain, index, x, y, flags }: &nf_sampler) -> Sampler {
    Sampler { domain, index, x, y, flags }
}

fn of(Sampler { domain, index, x, y, flags }: Sampler) -> nf_sampler {
    nf_sampler { domain, index, x, y, flags }
}
