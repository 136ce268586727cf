//! Hashes of 32 bits.

/// 32 well-mixed bits: the finaliser of MurmurHash3 (A. Appleby, 2011), a bijection that keeps 0.
#[inline]
pub(crate) const fn mix(mut h: u32) -> u32 {
    h ^= h >> 16;
    h = h.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// The fractional part of the golden ratio, odd: multiples of it differ in many bits.
pub(crate) const GOLDEN: u32 = 0x9e37_79b9;

/// Keep domains of frames and of scrambles apart from those of keys.
pub(crate) const FRAMES: u32 = 0x6672_616d;
pub(crate) const SCRAMBLE: u32 = 0x7363_7261;

/// What scrambles a domain's numbers of a dimension, counted from 1. A bijection of the domain: over all of them each
/// value occurs once.
#[inline]
pub(crate) const fn scrambling(domain: u32, dim: u32) -> u32 {
    mix(domain.wrapping_add(dim.wrapping_mul(GOLDEN)))
}

/// The domain that `key` leads to from `domain`; never the root, 0. For either argument fixed, a bijection of the other
/// but for that exception. Keys are multiplied: those of one parent would lead where those of another do, as both count
/// from 0.
#[inline]
pub(crate) const fn child(domain: u32, key: u32) -> u32 {
    let h = mix(key.wrapping_mul(GOLDEN) ^ domain);
    if h == 0 { 0x2c92_77b5 } else { h }
}
