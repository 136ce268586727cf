//! The path tracer on Embree: `tests/embree`.

use crate::c_tests::output;
use crate::outcome::Outcome;
use crate::path_tracer::{PathTracer, block};
use crate::{library, paths, run, tools};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};

const ASSIMP: tools::Package = tools::Package { name: "libassimp-dev", file: "/usr/include/assimp/Importer.hpp" };
const EMBREE_3: tools::Package = tools::Package { name: "libembree-dev", file: "/usr/include/embree3/rtcore.h" };
/// Not a package of Debian's; the sources prefer it where somebody installed it.
const EMBREE_4: [&str; 2] = ["/usr/include/embree4/rtcore.h", "/usr/local/include/embree4/rtcore.h"];

/// Builds the C library and the harness, and returns the harness's path.
pub fn build() -> Result<PathBuf> {
    if let Some(missing) = packages()? {
        bail!("{missing}");
    }
    let program = paths::output().join("embree_harness");
    compile("main.cpp", &library::build()?, &program)?;
    Ok(program)
}

/// The intersector against the path tracer's own, on random rays and in every scene.
pub fn agreement(archive: &Path) -> Result<Outcome> {
    if let Some(missing) = packages()? {
        return Ok(Outcome::NotRun(missing));
    }
    let program = output("embree_agreement")?;
    compile("agreement.cpp", archive, &program)?;
    print!("{}", run::read(&mut run::command(program))?);
    Ok(Outcome::Passed)
}

/// Every scene that the harness lists, against its reference.
pub fn scenes(archive: &Path) -> Result<Outcome> {
    if let Some(missing) = packages()? {
        return Ok(Outcome::NotRun(missing));
    }
    let tracer = PathTracer { program: output("embree_harness")?, prefix: output("embree_picture")? };
    compile("main.cpp", archive, &tracer.program)?;
    let help = tracer.help()?;
    let scenes = block(&help, "scenes");
    if scenes.len() < 10 {
        bail!("--help lists {} scenes", scenes.len());
    }
    let estimators = ["mc", "robust", "shared"];
    for scene in scenes {
        println!("   {scene}");
        tracer.render(&["--scene", scene, "--spp", "64", "--reference"])?;
        let expected = tracer.brightness("reference")?;
        // Fifteen dimensions at order 2 are 136 terms: more than this short look is for.
        let order = if ["duck", "glass"].contains(&scene) { "1" } else { "2" };
        for sampler in ["random", "sobol", "tile"] {
            let options = ["--scene", scene, "--spp", "8", "--sampler", sampler, "--order", order];
            tracer.render(&[&options[..], &["--estimators", &estimators.join(",")]].concat())?;
            tracer.check(&format!("{scene}, {sampler}"), &estimators, expected)?;
        }
    }
    for scene in ["animation", "dining"] {
        let [first, last] = ["0", "17"].map(|frame| {
            tracer.render(&["--scene", scene, "--spp", "1", "--frame", frame, "--reference"])?;
            tracer.brightness("reference")
        });
        if first? == last? {
            bail!("the animation of {scene} stands still");
        }
    }
    tracer.render(&["--scene", "veach", "--spp", "64", "--reference"])?;
    let expected = tracer.brightness("reference")?;
    tracer.render(&["--scene", "veach", "--spp", "64", "--mis"])?;
    tracer.check("veach, --mis", &["balance", "balance_regression", "optimal", "optimal_regression"], expected)?;
    for options in [["--scene", "nonsense"], ["--sampler", "nonsense"]] {
        if tracer.accepts(&options)? {
            bail!("the harness accepts `{}`", options.join(" "));
        }
    }
    Ok(Outcome::Passed)
}

/// What `check` says of the report that is made with the harness.
pub fn report(check: impl FnOnce() -> Result<()>) -> Result<Outcome> {
    if let Some(missing) = packages()? {
        return Ok(Outcome::NotRun(missing));
    }
    check()?;
    Ok(Outcome::Passed)
}

/// Installs what the harness needs, or says what is missing.
fn packages() -> Result<Option<String>> {
    if has_embree_4() { tools::packages(&[ASSIMP]) } else { tools::packages(&[EMBREE_3, ASSIMP]) }
}

fn has_embree_4() -> bool {
    EMBREE_4.iter().any(|file| Path::new(file).exists())
}

fn compile(source: &str, archive: &Path, program: &Path) -> Result<()> {
    let folder = paths::root().join("tests/embree");
    let mut compiler = run::compiler("CXX", "c++");
    compiler.args(["-std=c++17", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O2", "-Iinclude", "-Iexamples_c"]);
    compiler.arg(format!("-DMESH_FOLDER=\"{}\"", folder.join("meshes").display()));
    compiler.arg(folder.join(source)).arg(archive);
    compiler.args([if has_embree_4() { "-lembree4" } else { "-lembree3" }, "-lassimp", "-pthread", "-o"]).arg(program);
    run::check(&mut compiler)
}
