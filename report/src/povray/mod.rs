//! POV-Ray as an oracle: scenes in which it computes what one sample sees, cell by cell of a grid over the unit cube,
//! so that every estimator and sampler can be compared with the exact mean.

pub(crate) mod bias;
mod frames;
pub(crate) mod oracle;
mod ppm;
pub(crate) mod scenes;
mod stack;
pub(crate) mod startup;
pub(crate) mod test;

use xtask::tools::Package;

/// What renders the scenes.
pub(crate) const PACKAGES: [Package; 2] = [
    Package { name: "povray", file: "/usr/bin/povray" },
    Package { name: "povray-includes", file: "/usr/share/povray-3.7/include/woods.inc" },
];
