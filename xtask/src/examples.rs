//! The programs of `examples_c`, compiled as their reader would, and run; and the README that shows one of them.

use crate::c_tests::output;
use crate::test::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;
use std::process::Stdio;

const STRICT: [&str; 6] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-O2", "-Iinclude"];
/// Pixels on a side of the pictures that the path tracer makes.
const SIZE: usize = 32;

/// integrate.c: its estimate must be closer than the mean.
pub(crate) fn integrate(archive: &Path) -> Result<Outcome> {
    let program = output("integrate")?;
    let mut compiler = run::compiler("CC", "cc");
    compiler.arg("-std=c99").args(STRICT).arg("examples_c/integrate.c").arg(archive).args(["-lm", "-o"]).arg(&program);
    run::check(&mut compiler)?;
    let text = run::read(&mut run::command(&program))?;
    print!("{text}");
    let error = |name: &str| -> Result<f64> {
        let line = text.lines().find(|line| line.starts_with(name));
        let value = line.and_then(|line| line.split_whitespace().last()).and_then(|word| word.parse().ok());
        value.with_context(|| format!("integrate printed no error of `{name}`"))
    };
    let (mean, ours) = (error("mean")?.abs(), error("noisefloor")?.abs());
    if ours >= mean {
        bail!("the estimate's error {ours} is not below the mean's, {mean}");
    }
    Ok(Outcome::Passed)
}

/// pathtracer.cpp: every estimator that it lists, in every scene that it lists.
pub(crate) fn path_tracer(archive: &Path) -> Result<Outcome> {
    let program = output("pathtracer")?;
    let mut compiler = run::compiler("CXX", "c++");
    compiler.arg("-std=c++17").args(STRICT).arg("examples_c/pathtracer.cpp").arg(archive);
    run::check(compiler.args(["-pthread", "-o"]).arg(&program))?;

    let help = run::read(run::command(&program).arg("--help"))?;
    let scenes = help.lines().find_map(|line| line.strip_prefix("scenes:")).context("--help lists no scenes")?;
    let listed = help.lines().skip_while(|line| !line.starts_with("estimators:")).skip(1);
    let estimators: Vec<_> = listed.filter_map(|line| line.split_whitespace().next()).collect();
    if estimators.len() < 2 {
        bail!("--help lists no estimators");
    }
    let prefix = output("picture")?;
    for scene in scenes.split_whitespace() {
        // What slices need, only that scene has.
        let names: Vec<_> = estimators.iter().copied().filter(|name| *name != "slices" || scene == "lights").collect();
        println!("   {scene}: {}", names.join(", "));
        // Fifteen dimensions at order 2 are 136 terms: more than this short look is for.
        let order = if scene == "global" { "1" } else { "2" };
        let size = SIZE.to_string();
        let mut render = run::command(&program);
        render.args(["--scene", scene, "--width", &size, "--height", &size, "--spp", "8", "--order", order]);
        render.args(["--estimators", &names.join(","), "--output"]).arg(&prefix);
        run::check(render.stdout(Stdio::null()))?;
        let mut reference = run::command(&program);
        reference.args([
            "--scene",
            scene,
            "--width",
            &size,
            "--height",
            &size,
            "--spp",
            "64",
            "--reference",
            "--output",
        ]);
        run::check(reference.arg(&prefix).stdout(Stdio::null()))?;
        let expected = brightness(&prefix.with_extension("reference.pfm"))?;
        for name in names {
            let actual = brightness(&prefix.with_extension(format!("{name}.pfm")))?;
            // 8192 samples, noisy ones: a tenth of the brightness is far outside what they do by chance.
            if (actual - expected).abs() > 0.1 * expected {
                bail!("{scene}, {name}: the picture's mean is {actual}, the reference's {expected}");
            }
        }
    }
    for wrong in [["--estimators", "nonsense"], ["--scene", "nonsense"], ["--spp", "0"]] {
        let mut command = run::command(&program);
        command.args(wrong).arg("--output").arg(&prefix).stdout(Stdio::null()).stderr(Stdio::null());
        if command.status().context("cannot start the path tracer")?.success() {
            bail!("the path tracer accepts `{}`", wrong.join(" "));
        }
    }
    Ok(Outcome::Passed)
}

/// README.md's first block of code is integrate.c, letter by letter, and the two commands that do all the set-up follow.
pub(crate) fn readme() -> Result<Outcome> {
    let read = |name: &str| fs::read_to_string(paths::root().join(name)).with_context(|| format!("cannot read {name}"));
    let (text, program) = (read("README.md")?, read("examples_c/integrate.c")?);
    let block = text.split_once("```c\n").and_then(|(before, rest)| (!before.contains("```")).then_some(rest));
    let block = block.and_then(|rest| rest.split_once("```")).context("README.md does not open with a block of C")?;
    if block.0 != program {
        bail!("README.md's first block of code is not examples_c/integrate.c");
    }
    for command in ["\ncargo xtask demo ", "\ncargo xtask test "] {
        if !block.1.contains(command) {
            bail!("README.md does not say `{}`", command.trim());
        }
    }
    Ok(Outcome::Passed)
}

/// The mean of a picture in PFM, every number of which must be finite.
fn brightness(path: &Path) -> Result<f64> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let header = format!("PF\n{SIZE} {SIZE}\n-1.0\n");
    let pixels = bytes.strip_prefix(header.as_bytes());
    let pixels = pixels.with_context(|| format!("{} is no PFM of {SIZE} x {SIZE} pixels", path.display()))?;
    let (values, []) = pixels.as_chunks::<4>() else { bail!("{} ends early", path.display()) };
    let values: Vec<_> = values.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect();
    if values.len() != 3 * SIZE * SIZE || !values.iter().all(|value| value.is_finite()) {
        bail!("{}: not {SIZE} x {SIZE} finite pixels", path.display());
    }
    Ok(values.iter().sum::<f64>() / values.len() as f64)
}
