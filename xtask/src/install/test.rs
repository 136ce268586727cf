//! Projects outside the tree that use an installed noisefloor: by CMake and by pkg-config, in C and C++, shared and
//! static.

use super::{compile, configure, one_kind, subproject};
use crate::outcome::Outcome;
use crate::{abi, library, paths, run, tools};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};

const PACKAGES: [tools::Package; 2] = [
    tools::Package { name: "cmake", file: "/usr/bin/cmake" },
    tools::Package { name: "pkg-config", file: "/usr/bin/pkg-config" },
];

/// Installs into a folder with a space in its name, moves that elsewhere, and builds tests/package against it.
pub fn projects() -> Result<Outcome> {
    if let Some(missing) = tools::packages(&PACKAGES)? {
        return Ok(Outcome::NotRun(missing));
    }
    let prefix = moved_prefix()?;
    let lib = prefix.join("lib");
    exported(&lib.join("libnoisefloor.so"))?;

    let build = folder("a package build")?;
    cmake_project("tests/package", &build, &prefix, &[])?;
    for program in ["c_shared", "c_static", "cpp_shared", "cpp_static"] {
        linked_as_named(&build.join(program))?;
    }

    let programs = folder("pkg-config programs")?;
    fs::create_dir_all(&programs).with_context(|| format!("cannot create {}", programs.display()))?;
    for (name, compiler, source) in
        [("c", "${CC:-cc} -std=c99", "tests/package/app.c"), ("cpp", "${CXX:-c++} -std=c++17", "tests/package/app.cpp")]
    {
        for (kind, options) in [("shared", ("", "")), ("static", ("-Wl,-Bstatic", "-Wl,-Bdynamic"))] {
            let program = programs.join(format!("{name}_{kind}"));
            // pkg-config escapes the spaces of paths for a shell, which `eval` is.
            let flags = "flags=$(pkg-config --cflags --libs noisefloor)";
            let line = format!(
                r#"{flags} && eval "{compiler} -Wall -Wextra -pedantic -Werror {source} {} $flags {} -o \"\$1\"""#,
                options.0, options.1
            );
            let mut shell = run::command("sh");
            shell.args(["-c", &line, "sh"]).arg(&program).env("PKG_CONFIG_PATH", lib.join("pkgconfig"));
            run::check(&mut shell)?;
            linked_as_named(&program)?;
            run::check(run::command(&program).env("LD_LIBRARY_PATH", &lib))?;
        }
    }
    staged()?;
    one_kind::each()?;
    subproject::both()?;
    Ok(Outcome::Passed)
}

/// Builds examples_c as its reader would, outside the tree, and runs those that are quick.
pub fn examples() -> Result<Outcome> {
    if let Some(missing) = tools::packages(&PACKAGES)? {
        return Ok(Outcome::NotRun(missing));
    }
    let build = folder("an examples build")?;
    cmake_project("examples_c", &build, &moved_prefix()?, &[])?;
    Ok(Outcome::Passed)
}

/// An installation that no longer is where it was made for.
fn moved_prefix() -> Result<PathBuf> {
    let made = folder("made here")?;
    let moved = folder("moved here")?;
    let build = paths::output().join("test/install build");
    configure(&build, &made, Some(Path::new("lib")), &[])?;
    compile(&build)?;
    run::read(run::command("cmake").arg("--install").arg(&build))?;
    fs::rename(&made, &moved).with_context(|| format!("cannot move {}", made.display()))?;
    Ok(moved)
}

/// The shared library exports the functions of the header and no more, and its soname has the ABI's version.
fn exported(shared: &Path) -> Result<()> {
    let header = abi::Header::committed()?;
    let symbols = library::names(shared, &["--dynamic", "--defined-only"])?;
    let node = format!("NOISEFLOOR_{}", header.version()?);
    let mut found: Vec<_> = symbols.into_iter().map(|(_, name)| name).filter(|name| *name != node).collect();
    let mut wanted: Vec<_> = header.symbols().map(|name| format!("{name}@@{node}")).collect();
    found.sort();
    wanted.sort();
    if found != wanted {
        let other = |these: &[String], those: &[String]| -> Vec<String> {
            these.iter().filter(|name| !those.contains(name)).cloned().collect()
        };
        bail!(
            "{} exports {:?} beyond the header, and lacks {:?}",
            shared.display(),
            other(&found, &wanted),
            other(&wanted, &found)
        );
    }
    let soname = format!("libnoisefloor.so.{}", header.version()?);
    if !dynamic_section(shared)?.contains(&format!("Library soname: [{soname}]")) {
        bail!("{} has not the soname {soname}", shared.display());
    }
    Ok(())
}

/// What is called static does not need the shared library, what is called shared does.
pub(super) fn linked_as_named(program: &Path) -> Result<()> {
    let shared = dynamic_section(program)?.contains("Shared library: [libnoisefloor.so.");
    if shared != program.to_string_lossy().ends_with("_shared") {
        bail!("{} is linked with the {} library", program.display(), if shared { "shared" } else { "static" });
    }
    Ok(())
}

fn dynamic_section(file: &Path) -> Result<String> {
    run::read(run::command("readelf").args(["--dynamic", "--wide"]).arg(file))
}

/// Debian's way: the prefix is /usr, libraries are in a folder of the architecture, and $DESTDIR stands before all.
fn staged() -> Result<()> {
    let (build, staged) = (paths::output().join("test/install build"), folder("a staged install")?);
    let libdir = Path::new("lib/x86_64-linux-gnu");
    configure(&build, Path::new("/usr"), Some(libdir), &[])?;
    run::read(run::command("cmake").arg("--install").arg(&build).env("DESTDIR", &staged))?;
    let lib = staged.join("usr").join(libdir);
    let mut query = run::command("pkg-config");
    query.args(["--variable=includedir", "noisefloor"]).env("PKG_CONFIG_PATH", lib.join("pkgconfig"));
    // The variable's spaces are escaped, too.
    let include = run::read(&mut query)?.trim().replace('\\', "");
    if !Path::new(&include).join("noisefloor.h").is_file() {
        bail!("noisefloor.pc in {} says that headers are in {include}, where they are not", lib.display());
    }
    for name in ["libnoisefloor.a", "libnoisefloor.so", "cmake/noisefloor/noisefloorConfig.cmake"] {
        if !lib.join(name).is_file() {
            bail!("{} was not installed", lib.join(name).display());
        }
    }
    Ok(())
}

/// Configures a project against the prefix, builds it and runs its tests.
pub(super) fn cmake_project(source: &str, build: &Path, prefix: &Path, options: &[&str]) -> Result<()> {
    let mut configure = run::command("cmake");
    configure.args(["-S", source, "-B"]).arg(build).arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    run::read(configure.args(options))?;
    run::read(run::command("cmake").arg("--build").arg(build).args(["--parallel", "2"]))?;
    let mut test = run::command("ctest");
    run::check(test.arg("--test-dir").arg(build).args(["--output-on-failure", "--no-tests=error"]))
}

/// A folder of the tests that does not exist yet.
pub(super) fn folder(name: &str) -> Result<PathBuf> {
    let folder = paths::output().join("test").join(name);
    match fs::remove_dir_all(&folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", folder.display()))
        }
        _ => Ok(folder),
    }
}
