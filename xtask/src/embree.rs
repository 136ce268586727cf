//! The path tracer on Embree: `tests/embree`.

use crate::c_tests;
use crate::tools::Package;
use anyhow::Result;
use std::path::{Path, PathBuf};

const ASSIMP: Package = Package { name: "libassimp-dev", file: "/usr/include/assimp/Importer.hpp" };
const EMBREE_3: Package = Package { name: "libembree-dev", file: "/usr/include/embree3/rtcore.h" };
/// Not a package of Debian's; tests/CMakeLists.txt prefers it where somebody installed it.
const EMBREE_4: [&str; 2] = ["/usr/include/embree4/rtcore.h", "/usr/local/include/embree4/rtcore.h"];

/// Builds the C library and the harness, and returns the harness's path.
pub fn build() -> Result<PathBuf> {
    c_tests::build("default", "embree_scenes", &packages())?;
    Ok(c_tests::folder("default").join("embree_harness"))
}

/// What the harness needs.
pub fn packages() -> Vec<Package> {
    let has_embree_4 = EMBREE_4.iter().any(|file| Path::new(file).exists());
    if has_embree_4 { vec![ASSIMP] } else { vec![EMBREE_3, ASSIMP] }
}
