//! From Debian's source package to a program that links our library.

use super::apt::Apt;
use super::{folder, ours, patch};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask::{library, paths, run, tools};

const PACKAGE: &str = "povray";
/// The source that the patch was written for: as debian/changelog begins.
const VERSION: &str = "povray (1:3.7.0.10-";

/// Builds what has changed since it was last called, and returns the program.
pub(crate) fn build() -> Result<PathBuf> {
    let packages = [
        tools::Package { name: "povray", file: "/usr/bin/povray" },
        tools::Package { name: "povray-includes", file: "/usr/share/povray-3.7/include/colors.inc" },
        tools::Package { name: "dpkg-dev", file: "/usr/bin/dpkg-source" },
        tools::Package { name: "patch", file: "/usr/bin/patch" },
        tools::Package { name: "make", file: "/usr/bin/make" },
    ];
    if let Some(missing) = tools::packages(&packages)? {
        bail!(missing);
    }
    println!("building the C library");
    let archive = library::build()?;
    let source = folder().join("source");
    if !source.exists() {
        fetch(&source)?;
    }
    patch::apply(&source)?;
    if !source.join("unix/Makefile").exists() {
        configure(&source)?;
    }
    let bridge = bridge()?;
    let program = source.join("unix/povray");
    // make does not know of our objects, and would leave it as it is.
    if program.exists() {
        fs::remove_file(&program).with_context(|| format!("cannot replace {}", program.display()))?;
    }
    make(&source, &bridge, &archive)?;
    Ok(program)
}

fn fetch(source: &Path) -> Result<()> {
    println!("fetching POV-Ray's source (53 MB)");
    let apt = Apt::new(&folder().join("apt"))?;
    apt.build_dependencies(PACKAGE)?;
    let scratch = tempfile::tempdir_in(folder()).context("cannot create a temporary folder")?;
    let unpacked = apt.source(PACKAGE, scratch.path())?;
    let changelog = fs::read_to_string(unpacked.join("debian/changelog")).unwrap_or_default();
    if !changelog.starts_with(VERSION) {
        let found = changelog.lines().next().unwrap_or("nothing that is known");
        bail!("the patch is for Debian 12's source package, `{VERSION}...`; apt-get source brought `{found}`");
    }
    fs::rename(&unpacked, source).with_context(|| format!("cannot move the source to {}", source.display()))
}

/// As debian/rules does, so that the same compiler options make the same pictures.
fn configure(source: &Path) -> Result<()> {
    println!("configuring POV-Ray");
    let bundled = source.join("libraries");
    if bundled.exists() {
        fs::rename(&bundled, source.join("libraries.donotuse")).context("cannot set the bundled libraries aside")?;
    }
    let quiet = |command: &mut Command| run::read(command).map(drop);
    quiet(run::command("sh").arg("prebuild.sh").current_dir(source.join("unix")))?;
    let flags = |name: &str| -> Result<String> {
        let mut command = run::command("dpkg-buildflags");
        command.current_dir(source).env("DEB_BUILD_MAINT_OPTIONS", "hardening=+all").args(["--get", name]);
        Ok(run::read(&mut command)?.trim().to_owned())
    };
    let (cxx, cpp, link) = (flags("CXXFLAGS")?, flags("CPPFLAGS")?, flags("LDFLAGS")?);
    let mut configure = run::command(source.join("configure"));
    configure.current_dir(source).args(["--quiet", "--prefix=/usr", "--sysconfdir=/etc"]);
    configure.args(["--disable-optimiz", "--disable-strip", "--with-boost-thread=boost_thread"]);
    configure.arg("COMPILED_BY=noisefloor, with changes, not for distribution <nobody@localhost>");
    configure.arg(format!("CXXFLAGS={cxx} -O3 -g0")).arg(format!("LDFLAGS={link}"));
    quiet(configure.arg(format!("CPPFLAGS={cpp} -I{}", ours().display()))).context(
        "POV-Ray's configure failed; config.log in target/povray/source says why, and removing that folder starts anew",
    )
}

/// Our side, compiled as strictly as everything else of ours.
pub(crate) fn bridge() -> Result<PathBuf> {
    let object = paths::output().join("povray_bridge.o");
    fs::create_dir_all(paths::output()).with_context(|| format!("cannot create {}", paths::output().display()))?;
    let mut compiler = run::compiler("CXX", "c++");
    compiler.args(["-std=c++17", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fPIE"]);
    compiler.args(["-Iinclude", "-Iexamples_c/pathtracer", "-c", "tests/povray/patched/bridge.cpp", "-o"]);
    run::check(compiler.arg(&object))?;
    Ok(object)
}

fn make(source: &Path, bridge: &Path, archive: &Path) -> Result<()> {
    let jobs = std::thread::available_parallelism().map_or(1, |n| n.get());
    println!("building POV-Ray ({jobs} jobs; the first time takes minutes)");
    let log = folder().join("make.log");
    let file = fs::File::create(&log).with_context(|| format!("cannot write {}", log.display()))?;
    let mut make = run::command("nice");
    make.args(["-n", "10", "make", &format!("-j{jobs}")]).current_dir(source);
    make.arg(format!("NOISEFLOOR={} {}", bridge.display(), archive.display()));
    make.stdout(file.try_clone().context("cannot write make.log")?).stderr(file);
    run::check(&mut make).with_context(|| format!("POV-Ray did not compile; {} says why", log.display()))
}
