//! The example scenes that come with POV-Ray, and the few words that are changed so that stock POV-Ray takes so many
//! samples.

use super::folder;
use anyhow::{Context, Result, bail};
use std::fs;

pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) description: &'static str,
    /// Below distribution/scenes.
    file: &'static str,
    includes: &'static [&'static str],
    pub(crate) kind: Kind,
    /// What the contact sheet enlarges: where it begins, as parts of the picture.
    pub(crate) crop: [f64; 2],
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Focal blur: points of the pixel and of the lens.
    Lens,
    /// Area lights, seen through the pixel's centre.
    AreaLight,
}

pub(crate) const SCENES: [Scene; 3] = [
    Scene {
        name: "focalblur",
        description: "camera/focalblur.pov: focal blur",
        file: "camera/focalblur.pov",
        includes: &["camera/camera-context.inc"],
        kind: Kind::Lens,
        crop: [0.42, 0.05],
    },
    Scene {
        name: "soft",
        description: "lights/soft.pov: an area light as a spotlight behind letters",
        file: "lights/soft.pov",
        includes: &[],
        kind: Kind::AreaLight,
        crop: [0.28, 0.45],
    },
    Scene {
        name: "arealit2",
        description: "lights/arealit2.pov: area lights of three sizes, and a point light",
        file: "lights/arealit2.pov",
        includes: &[],
        kind: Kind::AreaLight,
        crop: [0.5, 0.3],
    },
];

/// One more of which the picture must not change while noisefloor is off: it has radiosity.
pub(crate) const UNCHANGED: &str = "radiosity/cornell.pov";

fn read(file: &str) -> Result<String> {
    let path = folder().join("source/distribution/scenes").join(file);
    // Names in comments are in Latin 1.
    let bytes = fs::read(&path).with_context(|| format!("cannot read POV-Ray's example {}", path.display()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

pub(crate) fn example(file: &str) -> Result<String> {
    read(file)
}

impl Scene {
    pub(crate) fn original(&self) -> Result<String> {
        read(self.file)
    }

    /// With exactly `spp` samples of each pixel, or of each light in each pixel.
    pub(crate) fn stock(&self, spp: u32) -> Result<String> {
        let side = side(spp).with_context(|| format!("{spp} is no square number"))?;
        let text = self.original()?;
        let mut edits = 0;
        let lines: Result<Vec<String>> = text
            .lines()
            .map(|line| {
                let edited = match self.kind {
                    Kind::Lens => blur(line, spp),
                    Kind::AreaLight => grid(line, side)?,
                };
                edits += usize::from(edited.is_some());
                Ok(edited.unwrap_or_else(|| line.to_owned()))
            })
            .collect();
        let lines = lines.with_context(|| self.file.to_owned())?;
        if edits == 0 {
            bail!("{} is not the example that was expected: nothing in it sets a number of samples", self.file);
        }
        Ok(lines.join("\n") + "\n")
    }

    /// Files that the scene includes: name, text.
    pub(crate) fn includes(&self) -> Result<Vec<(&'static str, String)>> {
        let name = |file: &'static str| file.rsplit('/').next().unwrap_or(file);
        self.includes.iter().map(|file| Ok((name(file), read(file)?))).collect()
    }
}

/// The side of a square grid, of 2 to 32, with so many points.
pub(crate) fn side(spp: u32) -> Option<u32> {
    (2..=32).find(|side| side * side == spp)
}

/// All samples, however alike they are: `variance 0` never ends early.
fn blur(line: &str, spp: u32) -> Option<String> {
    let rest = line.trim_start().strip_prefix("blur_samples ")?;
    let rest = rest.trim_start_matches(|c: char| c.is_ascii_digit());
    Some(format!("blur_samples {spp} variance 0 {rest}"))
}

/// A full grid, its points jittered within their cells, over just the light: POV-Ray's own spans the light from corner
/// to corner, so that jittered points lie outside, by half a cell, and the light's size depends on the number of
/// points.
fn grid(line: &str, side: u32) -> Result<Option<String>> {
    let line = line.trim_start();
    if line.starts_with("adaptive ") {
        return Ok(Some("adaptive 9".to_owned())); // never fewer points
    }
    let Some(rest) = line.strip_prefix("area_light ") else { return Ok(None) };
    let mut axes = rest.split('>').map(|axis| axis.trim_start_matches(',').trim());
    let (Some(first), Some(second)) = (axes.next(), axes.next()) else {
        bail!("`{line}` is no area light as the examples write them");
    };
    if !first.starts_with('<') || !second.starts_with('<') {
        bail!("`{line}` is no area light as the examples write them");
    }
    let scale = format!("{}/{side}", side - 1);
    Ok(Some(format!("area_light {first}>*{scale}, {second}>*{scale}, {side}, {side}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_edited() {
        assert_eq!(blur("   blur_samples 120 //more", 16).as_deref(), Some("blur_samples 16 variance 0  //more"));
        assert_eq!(blur("camera {", 16), None);
        let light = grid("   area_light <6, 0, 0>, <0, 6, 0>, 9, 9", 4).expect("an area light");
        assert_eq!(light.as_deref(), Some("area_light <6, 0, 0>*3/4, <0, 6, 0>*3/4, 4, 4"));
        assert!(grid("area_light x*1.5,z*1.5,4,4", 4).is_err());
        assert_eq!(grid("adaptive 0", 4).expect("a setting").as_deref(), Some("adaptive 9"));
        assert_eq!(side(64), Some(8));
        assert_eq!((side(1), side(60)), (None, None));
    }
}
