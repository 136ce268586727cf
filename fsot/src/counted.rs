//! Numbers of things, as a sentence has them.

use std::fmt::Display;

/// "1 step", "2 steps", "0 classes": a number and what it counts, given in the singular.
pub fn counted(number: impl Display, noun: &str) -> String {
    let number = number.to_string();
    let ending = match number.as_str() {
        "1" => "",
        _ if noun.ends_with('s') => "es",
        _ => "s",
    };
    format!("{number} {noun}{ending}")
}

/// "2 frames of 16x16 pixels with 1 sample of 2 dimensions".
pub(crate) fn tile(size: usize, spp: usize, dims: usize, frames: usize) -> String {
    let [frames, samples, dims] =
        [(frames, "frame"), (spp, "sample"), (dims, "dimension")].map(|(n, of)| counted(n, of));
    format!("{frames} of {size}x{size} pixels with {samples} of {dims}")
}

#[cfg(test)]
mod tests {
    use super::{counted, tile};

    #[test]
    fn one_is_singular_and_nothing_else() {
        assert_eq!(counted(1, "step"), "1 step");
        assert_eq!(counted(1_u64, "class"), "1 class");
        for number in ["0", "2", "11", "0.5", "1.5"] {
            assert_eq!(counted(number, "step"), format!("{number} steps"));
        }
        assert_eq!(counted(7, "class"), "7 classes");
        assert_eq!(counted(1.0_f32, "pixel"), "1 pixel");
        assert_eq!(tile(8, 1, 1, 1), "1 frame of 8x8 pixels with 1 sample of 1 dimension");
        assert_eq!(tile(8, 4, 2, 3), "3 frames of 8x8 pixels with 4 samples of 2 dimensions");
    }
}
