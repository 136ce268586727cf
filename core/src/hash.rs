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

/// The domain that `key` leads to from `domain`; never the root, 0. For either argument fixed, a bijection of the other
/// but for that exception.
#[inline]
pub(crate) const fn child(domain: u32, key: u32) -> u32 {
    // Keys are small numbers: but for the factor, domains that differ in low bits alone would share their children.
    let h = mix(key.wrapping_add(1).wrapping_mul(GOLDEN) ^ domain);
    h + (h == 0) as u32
}
