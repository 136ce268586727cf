//! Frames of one sample each, averaged over time.

use super::{Energies, Frames, Plane, SceneTable, places};
use crate::error::Result;
use rayon::prelude::*;

/// How much of an average is the newest frame.
const NEWEST: f64 = 0.1;
/// The frames that are looked at; before the first of them an average has settled.
const SHOWN: [usize; 4] = [40, 47, 54, 61];

impl SceneTable {
    /// The errors of averages of frames, each of one sample: sample t in frame t. Energies are relative to those of
    /// independent samples, of clamped averages to those of independent samples that are not clamped.
    ///
    /// # Errors
    /// A pixel of the plane has fewer than 62 samples.
    pub fn frames(&self, plane: &Plane, way: Frames) -> Result<Energies> {
        plane.check(SHOWN[3] + 1)?;
        let scale = self.scale();
        let averages: Vec<Vec<Vec<f64>>> =
            places(plane).into_par_iter().map(|place| self.averages(plane, place, way)).collect();
        let error = |(pixel, average): (usize, &f64)| self.error(pixel, *average, &scale);
        let images: Vec<Vec<f64>> =
            averages.iter().flatten().map(|average| average.iter().enumerate().map(error).collect()).collect();
        // Of weights a, a (1 - a), a (1 - a)^2, ... the squares' sum.
        Ok(self.energies(&images, &scale, |_| NEWEST / (2.0 - NEWEST)))
    }

    /// The averages at the frames that are looked at.
    fn averages(&self, plane: &Plane, (dx, dy): (usize, usize), way: Frames) -> Vec<Vec<f64>> {
        let mut average = Vec::new();
        let mut shown = Vec::new();
        for t in 0..=SHOWN[3] {
            let moved = if way == Frames::Moving { t } else { 0 };
            let sample = |pixel| plane.pixel(self.moved(pixel, (dx + moved, dy)), t + 1)[t];
            let new: Vec<f64> =
                (0..self.width * self.height).map(|pixel| f64::from(self.at(pixel, sample(pixel)))).collect();
            if t == 0 {
                average.clone_from(&new);
            }
            for (pixel, average) in average.iter_mut().enumerate() {
                let (least, most) =
                    if way == Frames::Clamped { self.around(&new, pixel) } else { (f64::NEG_INFINITY, f64::INFINITY) };
                *average = average.clamp(least, most) * (1.0 - NEWEST) + new[pixel] * NEWEST;
            }
            if SHOWN.contains(&t) {
                shown.push(average.clone());
            }
        }
        shown
    }

    /// The least and the most of the 3 x 3 pixels around.
    fn around(&self, image: &[f64], pixel: usize) -> (f64, f64) {
        let (x, y) = (pixel % self.width, pixel / self.width);
        let near = |middle: usize, side: usize| middle.saturating_sub(1)..(middle + 2).min(side);
        let values = near(y, self.height).flat_map(|row| &image[row * self.width..][near(x, self.width)]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (value.min(least), value.max(most)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{tests::ramp, white};
    use super::*;

    /// Independent samples, pixels alike: averages have the error that their weights say; clamping only adds to it.
    #[test]
    fn averages_of_independent_samples() {
        let table = ramp();
        let plane = white(128, 64);
        for way in [Frames::Still, Frames::Moving] {
            let energies = table.frames(&plane, way).unwrap();
            assert!((energies.raw - 1.0).abs() < 0.1 && (energies.wide - 1.0).abs() < 0.5, "{energies:?}");
        }
        assert!(table.frames(&plane, Frames::Clamped).unwrap().raw < 2.0);
        assert!(table.frames(&white(16, 61), Frames::Still).is_err());
    }
}
