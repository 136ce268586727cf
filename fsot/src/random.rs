//! Random numbers: a stream for every (seed, iteration, slice), so that no result depends on the number of threads.

use noisefloor::rng::Rng;

/// A generator of its own for each combination of numbers, unrelated to that of every other.
pub fn stream(seed: u64, iteration: u64, slice: u64) -> Rng {
    Rng::new(mix(seed, iteration, slice, 1), mix(seed, iteration, slice, 2))
}

/// Puts things in an order at random (Fisher and Yates).
pub(crate) fn shuffle<T>(things: &mut [T], rng: &mut Rng) {
    for last in (1..things.len()).rev() {
        things.swap(last, rng.below(last as u32 + 1) as usize);
    }
}

/// A unit vector, uniform on the sphere.
pub(crate) fn direction(dims: usize, rng: &mut Rng) -> Vec<f64> {
    loop {
        let normal: Vec<f64> = (0..dims).map(|_| gaussian(rng)).collect();
        let length = normal.iter().map(|a| a * a).sum::<f64>().sqrt();
        if length > 1e-9 {
            return normal.iter().map(|a| a / length).collect();
        }
    }
}

/// A standard normal number (Box and Muller 1958).
fn gaussian(rng: &mut Rng) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - rng.uniform_f64())).sqrt();
    radius * libm::cos(std::f64::consts::TAU * rng.uniform_f64())
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014) over a chain of numbers.
fn mix(seed: u64, iteration: u64, slice: u64, salt: u64) -> u64 {
    [seed, iteration, slice].into_iter().fold(salt.wrapping_mul(0x9e37_79b9_7f4a_7c15), |state, value| {
        let mut z = (state ^ value).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}
