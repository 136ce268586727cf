//! Random directions.

use crate::target::MAX_DIMS;
use noisefloor::rng::Rng;

/// A unit vector: with probability `axis_priority` along an axis (section 5.5.1), else uniform on the sphere.
pub(crate) fn direction(dims: usize, rng: &mut Rng, axis_priority: f32) -> Vec<f32> {
    let axis = rng.uniform_f32() < axis_priority;
    if axis || dims == 1 {
        let mut direction = vec![0.0; dims];
        // Either way along it: points at one place are sorted by number, which must not prefer a side.
        direction[rng.below(dims as u32) as usize] = if rng.next_u32() & 1 == 0 { 1.0 } else { -1.0 };
        return direction;
    }
    if dims == 2 {
        let (sin, cos) = libm::sincos(rng.uniform_f64() * std::f64::consts::TAU);
        return vec![cos as f32, sin as f32];
    }
    loop {
        // Normal variables, two by two (Box and Muller 1958).
        let mut normal = [0.0f64; MAX_DIMS];
        for pair in normal.chunks_exact_mut(2) {
            let radius = (-2.0 * libm::log(1.0 - rng.uniform_f64())).sqrt();
            let (sin, cos) = libm::sincos(rng.uniform_f64() * std::f64::consts::TAU);
            (pair[0], pair[1]) = (radius * cos, radius * sin);
        }
        let length = normal[..dims].iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 1e-6 {
            return normal[..dims].iter().map(|x| (x / length) as f32).collect();
        }
    }
}
