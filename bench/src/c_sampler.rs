//! `nf_sampler`, called as a C program calls it, from the archive that ships.

/// `nf_sampler`.
#[repr(C)]
#[derive(Clone, Copy)]
struct Sampler {
    domain: u32,
    index: u32,
    x: u16,
    y: u16,
    flags: u32,
}

c_functions! {
    fn nf_sampler_pixel(x: u32, y: u32, frame: u32, index: u32) -> Sampler;
    fn nf_sampler_draw(sampler: Sampler, dims: u32, u: *mut f32);
}

/// The sum of N numbers of the pixel's own domain.
#[inline]
pub fn root<const N: usize>(x: u32, y: u32, index: u32) -> f32 {
    let mut u = [0.0; N];
    // SAFETY: there is room for as many numbers.
    unsafe { nf_sampler_draw(nf_sampler_pixel(x, y, 0, index), N as u32, u.as_mut_ptr()) };
    u.iter().sum()
}
