//! Installations of which only the static or only the shared library is there.

use super::test::{cmake_project, folder, linked_as_named};
use super::{compile, configure};
use crate::{paths, run};
use anyhow::{Result, bail};
use std::path::Path;

/// What each has installed, and what a project finds there: nothing of the other kind, and under the common name its
/// own.
pub(super) fn each() -> Result<()> {
    for (kind, off) in [("static", "NOISEFLOOR_SHARED"), ("shared", "NOISEFLOOR_STATIC")] {
        let prefix = folder(&format!("only {kind}"))?;
        let build = paths::output().join("test").join(format!("only {kind} build"));
        configure(&build, &prefix, Some(Path::new("lib")), &[&format!("-D{off}=OFF")])?;
        compile(&build)?;
        run::read(run::command("cmake").arg("--install").arg(&build))?;
        for (file, of) in [("libnoisefloor.a", "static"), ("libnoisefloor.so", "shared")] {
            if prefix.join("lib").join(file).exists() != (kind == of) {
                bail!(
                    "an installation of the {kind} library alone: {file} should be there if it is {of}, and only then"
                );
            }
        }
        let project = folder(&format!("only {kind} project"))?;
        cmake_project("tests/package/one_kind", &project, &prefix, &[&format!("-DKIND={kind}")])?;
        linked_as_named(&project.join(format!("app_{kind}")))?;
        // The file is the same for both, and the linker takes what there is.
        let program = project.join(format!("pkg_config_{kind}"));
        let mut shell = run::command("sh");
        let flags = "flags=$(pkg-config --cflags --libs noisefloor)";
        let line = format!(r#"{flags} && eval "${{CC:-cc}} tests/package/app.c $flags -o \"\$1\"""#);
        let lib = prefix.join("lib");
        run::check(shell.args(["-c", &line, "sh"]).arg(&program).env("PKG_CONFIG_PATH", lib.join("pkgconfig")))?;
        linked_as_named(&program)?;
        run::check(run::command(&program).env("LD_LIBRARY_PATH", &lib))?;
    }
    Ok(())
}
