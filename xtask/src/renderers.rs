//! Renderers that others wrote, as tests and report use them: Embree, POV-Ray and Mitsuba 3.

use crate::c_tests::PYTHON;
use crate::tools::{self, Package};
use crate::{c_tests, library, paths, python, run};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const ASSIMP: Package = Package { name: "libassimp-dev", file: "/usr/include/assimp/Importer.hpp" };
const EMBREE_3: Package = Package { name: "libembree-dev", file: "/usr/include/embree3/rtcore.h" };
/// Not a package of Debian's; tests/CMakeLists.txt prefers it where somebody installed it.
const EMBREE_4: [&str; 2] = ["/usr/include/embree4/rtcore.h", "/usr/local/include/embree4/rtcore.h"];

/// POV-Ray as it is, and what reads its pictures.
pub const POVRAY: [Package; 3] = [
    PYTHON,
    Package { name: "povray", file: "povray" },
    Package { name: "povray-includes", file: "/usr/share/povray-3.7/include/woods.inc" },
];
const POVRAY_BUILD: [Package; 3] = [
    Package { name: "dpkg-dev", file: "dpkg-source" },
    Package { name: "patch", file: "patch" },
    Package { name: "make", file: "make" },
];

/// Mitsuba's Dr.Jit compiles with it.
const LLVM: Package = Package { name: "libllvm19", file: "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1" };
const MITSUBA: &str = "integrations/mitsuba/requirements.txt";

/// What the path tracer on Embree, `tests/embree`, needs.
pub fn embree_packages() -> Vec<Package> {
    let has_embree_4 = EMBREE_4.iter().any(|file| Path::new(file).exists());
    if has_embree_4 { vec![ASSIMP] } else { vec![EMBREE_3, ASSIMP] }
}

/// Builds the C library and the path tracer, and returns its path.
pub fn embree() -> Result<PathBuf> {
    c_tests::build("default", "embree_scenes", &embree_packages())?;
    Ok(c_tests::folder("default").join("embree_harness"))
}

/// POV-Ray from Debian's source package, with the patch that draws its samples from noisefloor: builds what has changed
/// since it was last called, and checks the program.
pub fn povray() -> Result<()> {
    tools::packages(&[POVRAY, POVRAY_BUILD].concat())?;
    let (folder, archive) = (paths::target().join("povray"), library::build()?);
    run::check(run::command("sh").arg("tests/povray/patched/build.sh").arg(&folder).arg(archive))?;
    run::check(run::command("python3").arg("tests/programs/povray_patched.py").arg(&folder))
}

/// A Python that has Mitsuba 3 as the package index has it and noisefloor from a new wheel, to be given a program.
pub fn mitsuba() -> Result<Command> {
    tools::packages(&[&[LLVM], &python::BUILD[..]].concat())?;
    python::build()?;
    let folder = paths::target().join("mitsuba");
    let (interpreter, installed) = (folder.join("bin/python"), folder.join("requirements.txt"));
    let wanted = paths::read(MITSUBA)?;
    if fs::read_to_string(&installed).ok().as_deref() != Some(&wanted) {
        println!("   installing Mitsuba into {}", folder.display());
        python::create(&folder, &["--clear"])?;
        python::fetch(&interpreter, &["--requirement", MITSUBA])?;
        fs::write(&installed, wanted).with_context(|| format!("cannot write {}", installed.display()))?;
    }
    python::install(&interpreter)?;
    let mut command = run::command(interpreter);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("DRJIT_LIBLLVM_PATH", LLVM.file);
    Ok(command)
}
