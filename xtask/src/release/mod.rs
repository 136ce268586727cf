//! What must hold before a version is published: docs/releases.md.

pub mod licences;
pub mod package;
pub mod versions;

/// The packages that are published, in the order in which they must be.
const PUBLISHED: [&str; 3] = ["noisefloor", "noisefloor-capi", "noisefloor-fsot"];
