//! The programs of `examples_c`, compiled as their reader would, and run; and the README that shows one of them.

use crate::c_tests::output;
use crate::test::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const STRICT: [&str; 6] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-O2", "-Iinclude"];
/// Pixels on a side of the pictures that the path tracer makes.
const SIZE: usize = 32;

/// Compiles `examples_c/SOURCE` with the library, as C99 or C++17 by its extension.
pub(crate) fn compile(source: &str, options: &[&str], archive: &Path, program: &Path) -> Result<()> {
    let (mut compiler, standard) = match source.ends_with(".c") {
        true => (run::compiler("CC", "cc"), "-std=c99"),
        false => (run::compiler("CXX", "c++"), "-std=c++17"),
    };
    let source = Path::new("examples_c").join(source);
    compiler.arg(standard).args(options).arg(source).arg(archive).args(["-lm", "-o"]).arg(program);
    run::check(&mut compiler)
}

/// integrate.c: its estimate must be closer than the mean.
pub(crate) fn integrate(archive: &Path, name: &str) -> Result<Outcome> {
    let program = output(name)?;
    compile(&format!("{name}.c"), &STRICT, archive, &program)?;
    let text = run::read(&mut run::command(&program))?;
    print!("{text}");
    let error = |name: &str| -> Result<f64> {
        let line = text.lines().find(|line| line.starts_with(name));
        let value = line.and_then(|line| line.split_whitespace().last()).and_then(|word| word.parse().ok());
        value.with_context(|| format!("the example printed no error of `{name}`"))
    };
    let (mean, ours) = (error("mean")?.abs(), error("noisefloor")?.abs());
    if ours >= mean {
        bail!("the estimate's error {ours} is not below the mean's, {mean}");
    }
    Ok(Outcome::Passed)
}

/// shards.c: its processes check their estimates themselves.
pub(crate) fn shards(archive: &Path) -> Result<Outcome> {
    if !cfg!(unix) {
        return Ok(Outcome::NotRun("the example uses fork and pipe, which POSIX systems have".to_owned()));
    }
    let program = output("shards")?;
    compile("shards.c", &STRICT, archive, &program)?;
    run::check(&mut run::command(&program))?;
    Ok(Outcome::Passed)
}

/// pathtracer.cpp: every estimator and every sampler that it lists, in every scene that it lists.
pub(crate) fn path_tracer(archive: &Path) -> Result<Outcome> {
    let program = output("pathtracer")?;
    compile("pathtracer.cpp", &[&STRICT[..], &["-pthread"]].concat(), archive, &program)?;

    let tracer = PathTracer { program, prefix: output("picture")? };
    let help = run::read(run::command(&tracer.program).arg("--help"))?;
    let list = |name: &str| -> Result<Vec<&str>> {
        let line = help.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
        Ok(line.with_context(|| format!("--help lists no {name}"))?.split_whitespace().collect())
    };
    // Names with descriptions, indented under a heading.
    let block = |name: &str| -> Vec<&str> {
        let lines = help.lines().skip_while(|line| line.strip_suffix(':') != Some(name)).skip(1);
        lines.take_while(|line| line.starts_with(' ')).filter_map(|line| line.split_whitespace().next()).collect()
    };
    let (samplers, tiles, filters) = (list("samplers")?, list("tiles")?, list("filters")?);
    let (scenes, estimators) = (block("scenes"), block("estimators"));
    if scenes.len() < 5 || estimators.len() < 2 || samplers.len() < 3 || tiles.is_empty() || filters.len() < 3 {
        bail!("--help lists too few scenes, estimators, samplers, tiles or filters");
    }
    for scene in scenes {
        // What slices need, a choice of lights, only those scenes have.
        let chooses = ["lights", "global"].contains(&scene);
        let names: Vec<_> = estimators.iter().copied().filter(|name| *name != "slices" || chooses).collect();
        println!("   {scene}: {}; {}", names.join(", "), samplers.join(", "));
        tracer.render(&["--scene", scene, "--spp", "64", "--reference"])?;
        let expected = tracer.brightness("reference")?;
        let check = |what: &str, names: &[&str]| -> Result<()> {
            for name in names {
                let actual = tracer.brightness(name)?;
                // 8192 samples, noisy ones: a tenth of the brightness is far outside what they do by chance.
                if (actual - expected).abs() > 0.1 * expected {
                    bail!("{scene}, {what}, {name}: the picture's mean is {actual}, the reference's {expected}");
                }
            }
            Ok(())
        };
        // Fifteen dimensions at order 2 are 136 terms: more than this short look is for.
        let order = if scene == "global" { "1" } else { "2" };
        tracer.render(&["--scene", scene, "--spp", "8", "--order", order, "--estimators", &names.join(",")])?;
        check("random", &names)?;
        for sampler in &samplers {
            let estimators = ["--order", order, "--estimators", "mc,shared,robust"];
            let options = ["--scene", scene, "--spp", "8", "--frame", "3", "--sampler", sampler];
            tracer.render(&[&options[..], &estimators].concat())?;
            check(sampler, &["mc", "shared", "robust"])?;
        }
    }
    for filter in filters {
        println!("   filter {filter}");
        tracer.render(&["--scene", "direct", "--spp", "64", "--filter", filter, "--reference"])?;
        let expected = tracer.brightness("reference")?;
        tracer.render(&["--scene", "direct", "--spp", "8", "--filter", filter, "--estimators", "mc,robust,shared"])?;
        for name in ["mc", "robust", "shared"] {
            let actual = tracer.brightness(name)?;
            if (actual - expected).abs() > 0.1 * expected {
                bail!("filter {filter}, {name}: the picture's mean is {actual}, the reference's {expected}");
            }
        }
    }
    check_tiles(&tracer, &tiles)?;
    let wrong = [
        &["--estimators", "nonsense"][..],
        &["--scene", "nonsense"],
        &["--spp", "0"],
        &["--sampler", "nonsense"],
        &["--filter", "nonsense"],
        &["--scene", "direct", "--estimators", "slices"],
        &["--sampler", "tile", "--tile", "nonsense"],
        &["--sampler", "tile", "--tile", "README.md"],
    ];
    for options in wrong {
        if tracer.accepts(options)? {
            bail!("the path tracer accepts `{}`", options.join(" "));
        }
    }
    Ok(Outcome::Passed)
}

/// Every tile by its name, and by its file if it is there: the same picture.
fn check_tiles(tracer: &PathTracer, tiles: &[&str]) -> Result<()> {
    println!("   tiles: {}", tiles.join(", "));
    for tile in tiles {
        let options = ["--scene", "lens", "--spp", "2", "--estimators", "mc", "--sampler", "tile", "--tile"];
        tracer.render(&[&options[..], &[tile]].concat())?;
        let expected = tracer.brightness("mc")?;
        let file = paths::root().join(format!("core/tiles/{tile}.nft"));
        let name = file.to_str().with_context(|| format!("{} is not Unicode", file.display()))?;
        if !file.exists() {
            bail!("the library carries {tile}, but there is no {name}");
        }
        tracer.render(&[&options[..], &[name]].concat())?;
        if tracer.brightness("mc")? != expected {
            bail!("{tile} and {name} draw different samples");
        }
    }
    Ok(())
}

/// The compiled program, and where its pictures go.
struct PathTracer {
    program: PathBuf,
    prefix: PathBuf,
}

impl PathTracer {
    fn command(&self, options: &[&str]) -> Command {
        let mut command = run::command(&self.program);
        let size = SIZE.to_string();
        command.args(["--width", &size, "--height", &size]).args(options).arg("--output").arg(&self.prefix);
        command.stdout(Stdio::null());
        command
    }

    fn render(&self, options: &[&str]) -> Result<()> {
        run::check(&mut self.command(options))
    }

    fn accepts(&self, options: &[&str]) -> Result<bool> {
        let status = self.command(options).stderr(Stdio::null()).status();
        Ok(status.context("cannot start the path tracer")?.success())
    }

    fn brightness(&self, name: &str) -> Result<f64> {
        brightness(&self.prefix.with_extension(format!("{name}.pfm")))
    }
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
