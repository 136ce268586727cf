//! `cargo xtask povray`: POV-Ray from Debian's source package, with the patch that draws its samples from noisefloor.

use crate::c_tests::PYTHON;
use crate::tools::{self, Package};
use crate::{library, paths, run};
use anyhow::Result;

/// POV-Ray as it is, and what reads its pictures.
pub const PACKAGES: [Package; 3] = [
    PYTHON,
    Package { name: "povray", file: "/usr/bin/povray" },
    Package { name: "povray-includes", file: "/usr/share/povray-3.7/include/woods.inc" },
];
const BUILD: [Package; 3] = [
    Package { name: "dpkg-dev", file: "/usr/bin/dpkg-source" },
    Package { name: "patch", file: "/usr/bin/patch" },
    Package { name: "make", file: "/usr/bin/make" },
];

/// Builds what has changed since it was last called, and checks the program.
pub fn run() -> Result<()> {
    tools::packages(&[PACKAGES, BUILD].concat())?;
    let (folder, archive) = (paths::target().join("povray"), library::build()?);
    run::check(run::command("sh").arg("tests/povray/patched/build.sh").arg(&folder).arg(archive))?;
    run::check(run::command("python3").arg("tests/programs/povray_patched.py").arg(&folder))
}
