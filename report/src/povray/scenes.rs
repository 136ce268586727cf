//! The scenes of tests/povray/scenes, and the grids over their samples.

/// What a coordinate of the sample vector decides.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Decision {
    /// Where on the lens.
    Lens,
    /// Where on the light.
    Light,
    /// Which light.
    Choice,
    /// When, while the shutter is open.
    Time,
}

impl Decision {
    /// As stacks name it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Lens => "lens",
            Self::Light => "light",
            Self::Choice => "choice",
            Self::Time => "time",
        }
    }
}

/// A scene, named as its file is.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) shows: &'static str,
    pub(crate) axes: &'static [Decision],
    /// Cells along each axis.
    pub(crate) small: &'static [u32],
}

impl Scene {
    /// Every estimator that suits the scene, by the names of the path tracer.
    pub(crate) fn estimators(&self) -> Vec<&'static str> {
        let all =
            ["mc", "robust", "least_squares", "leave_one_out", "k_fold", "gradient_descent", "incremental", "shared"];
        let slices = self.axes.contains(&Choice).then_some("slices");
        all.into_iter().chain(slices).collect()
    }

    /// The built-in tile that suits its dimensions: what depends on each other is best drawn together, from one tile.
    /// Empty: the path tracer's own choice among those of two dimensions.
    pub(crate) fn tile(&self, spp: u32) -> &'static str {
        match (self.axes.len(), spp) {
            (..=2, _) | (_, 5..) => "",
            (_, ..4) => "128_1SPP_4D",
            (_, 4) => "128_4SPP_4D",
        }
    }
}

use Decision::{Choice, Lens, Light, Time};

pub(crate) const SCENES: [Scene; 5] = [
    Scene {
        name: "area",
        shows: "chessmen under a window; the light (2 dims)",
        axes: &[Light, Light],
        small: &[16, 16],
    },
    Scene {
        name: "focus",
        shows: "marbles through a wide lens; the lens (2 dims)",
        axes: &[Lens, Lens],
        small: &[16, 16],
    },
    Scene {
        name: "focus_area",
        shows: "fruit through a lens, under a panel; the lens and the light (4 dims)",
        axes: &[Lens, Lens, Light, Light],
        small: &[4, 4, 4, 4],
    },
    Scene {
        name: "lights",
        shows: "a hall with eight panels; the light and which (3 dims)",
        axes: &[Light, Light, Choice],
        small: &[6, 6, 8],
    },
    Scene {
        name: "motion",
        shows: "a windmill and a ball; time and the light (3 dims)",
        axes: &[Time, Light, Light],
        small: &[6, 6, 6],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_have_the_axes_of_their_scenes() {
        for scene in SCENES {
            // stack.inc knows four.
            assert!(scene.axes.len() <= 4);
            assert_eq!(scene.axes.len(), scene.small.len());
        }
    }
}
