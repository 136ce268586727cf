//! The sRGB encoding (IEC 61966-2-1) and luminance.

/// From an encoded value in [0, 1] to linear light.
pub fn decode(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}

/// From linear light in [0, 1] to an encoded value.
pub fn encode(light: f32) -> f32 {
    if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * libm::powf(light, 1.0 / 2.4) - 0.055 }
}

/// The weighted mean of red, green and blue with the weights of Rec. 709: luminance if they are linear light, luma if
/// not.
pub fn luminance(rgb: [f32; 3]) -> f32 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoding_is_the_inverse() {
        for step in 0..=255 {
            let value = step as f32 / 255.0;
            assert!((encode(decode(value)) - value).abs() < 1e-6);
        }
        assert!((decode(0.5) - 0.214_041).abs() < 1e-6);
        assert!((luminance([1.0; 3]) - 1.0).abs() < 1e-6);
    }
}
