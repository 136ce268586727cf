//! `examples_c/pathtracer.cpp`, compiled as its reader would, and run: what it lists, what it promises of its options,
//! and what it refuses.

mod options;

use crate::c_tests::output;
use crate::examples::{STRICT, compile};
use crate::outcome::Outcome;
use crate::run;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Pixels on a side of the pictures.
const SIZE: usize = 32;

/// pathtracer.cpp: every estimator and every sampler that it lists, in every scene that it lists.
pub fn check(archive: &Path) -> Result<Outcome> {
    let program = output("pathtracer")?;
    compile("pathtracer.cpp", &[&STRICT[..], &["-pthread"]].concat(), archive, &program)?;

    let tracer = PathTracer { program, prefix: output("picture")? };
    let help = tracer.help()?;
    let list = |name: &str| -> Result<Vec<&str>> {
        let line = help.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
        Ok(line.with_context(|| format!("--help lists no {name}"))?.split_whitespace().collect())
    };
    let (samplers, tiles, filters) = (list("samplers")?, list("tiles")?, list("filters")?);
    let (scenes, estimators) = (block(&help, "scenes"), block(&help, "estimators"));
    if scenes.len() < 5 || estimators.len() < 2 || samplers.len() < 3 || tiles.is_empty() || filters.len() < 3 {
        bail!("--help lists too few scenes, estimators, samplers, tiles or filters");
    }
    let table = options::write_table()?;
    for scene in scenes {
        // What slices need, a choice of lights, only those scenes have.
        let chooses = ["lights", "global"].contains(&scene);
        let names: Vec<_> = estimators.iter().copied().filter(|name| *name != "slices" || chooses).collect();
        println!("   {scene}: {}; {}", names.join(", "), samplers.join(", "));
        tracer.render(&["--scene", scene, "--spp", "64", "--reference"])?;
        let expected = tracer.brightness("reference")?;
        let check = |what: &str, names: &[&str]| tracer.check(&format!("{scene}, {what}"), names, expected);
        // Fifteen dimensions at order 2 are 136 terms: more than this short look is for.
        let order = if scene == "global" { "1" } else { "2" };
        tracer.render(&["--scene", scene, "--spp", "8", "--order", order, "--estimators", &names.join(",")])?;
        check("random", &names)?;
        for sampler in &samplers {
            let estimators = ["--order", order, "--estimators", "mc,shared,robust"];
            let options = ["--scene", scene, "--spp", "8", "--frame", "3", "--sampler", sampler, "--table", &table];
            tracer.render(&[&options[..], &estimators].concat())?;
            check(sampler, &["mc", "shared", "robust"])?;
        }
    }
    for filter in filters {
        println!("   filter {filter}");
        tracer.render(&["--scene", "direct", "--spp", "64", "--filter", filter, "--reference"])?;
        let expected = tracer.brightness("reference")?;
        tracer.render(&["--scene", "direct", "--spp", "8", "--filter", filter, "--estimators", "mc,robust,shared"])?;
        tracer.check(&format!("filter {filter}"), &["mc", "robust", "shared"], expected)?;
    }
    options::check_tiles(&tracer, &tiles)?;
    options::check_seeds(&tracer)?;
    options::check_table(&tracer, &table)?;
    options::check_accumulation(&tracer)?;
    options::check_two_techniques(&tracer)?;
    let wrong = [
        &["--estimators", "nonsense"][..],
        &["--scene", "nonsense"],
        &["--spp", "0"],
        &["--sampler", "nonsense"],
        &["--filter", "nonsense"],
        &["--basis", "nonsense"],
        &["--seeds", "0"],
        &["--sampler", "table"],
        &["--sampler", "table", "--table", "README.md"],
        &["--sampler", "table", "--table", &table, "--spp", "17"],
        &["--accumulate", "6"],
        &["--accumulate", "8", "--estimators", "shared"],
        &["--accumulate", "8", "--estimators", "leave_one_out"],
        &["--mis", "--spp", "7"],
        &["--mis", "--scene", "lens"],
        &["--mis", "--estimators", "robust"],
        &["--mis", "--bounces", "2"],
        &["--mis", "--regressed", "2"],
        &["--regressed", "17"],
        &["--statistics", "README.md"],
        &["--statistics", "README.md,README.md"],
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

/// The programs of `tests/pathtracer`: the path tracer's parts, one by one.
pub fn parts(archive: &Path) -> Result<Outcome> {
    for name in ["intersection", "lights", "surfaces", "image_plane", "paths", "mis", "program"] {
        println!("   {name}");
        let program = output(&format!("pathtracer_{name}"))?;
        let mut compiler = run::compiler("CXX", "c++");
        compiler.arg("-std=c++17").args(STRICT).arg(format!("tests/pathtracer/{name}.cpp"));
        run::check(compiler.arg(archive).args(["-pthread", "-o"]).arg(&program))?;
        run::check(&mut run::command(&program))?;
    }
    Ok(Outcome::Passed)
}

/// The names in a program's help that are listed, with descriptions, indented under a heading.
pub fn block<'a>(help: &'a str, heading: &str) -> Vec<&'a str> {
    let lines = help.lines().skip_while(|line| line.strip_suffix(':') != Some(heading)).skip(1);
    lines.take_while(|line| line.starts_with(' ')).filter_map(|line| line.split_whitespace().next()).collect()
}

/// A compiled program with the path tracer's command line, and where its pictures go.
pub struct PathTracer {
    pub program: PathBuf,
    pub prefix: PathBuf,
}

impl PathTracer {
    fn command(&self, options: &[&str]) -> Command {
        let mut command = run::command(&self.program);
        let size = SIZE.to_string();
        command.args(["--width", &size, "--height", &size]).args(options).arg("--output").arg(&self.prefix);
        command.stdout(Stdio::null());
        command
    }

    pub fn help(&self) -> Result<String> {
        run::read(run::command(&self.program).arg("--help"))
    }

    pub fn render(&self, options: &[&str]) -> Result<()> {
        run::check(&mut self.command(options))
    }

    pub fn accepts(&self, options: &[&str]) -> Result<bool> {
        let status = self.command(options).stderr(Stdio::null()).status();
        Ok(status.context("cannot start the path tracer")?.success())
    }

    pub fn brightness(&self, name: &str) -> Result<f64> {
        let values = self.values(name)?;
        Ok(values.iter().sum::<f64>() / values.len() as f64)
    }

    /// Fails unless the pictures of all these estimators are as bright as they should be.
    pub fn check(&self, what: &str, names: &[&str], expected: f64) -> Result<()> {
        for name in names {
            let actual = self.brightness(name)?;
            // 8192 samples, noisy ones: a tenth of the brightness is far outside what they do by chance.
            if (actual - expected).abs() > 0.1 * expected {
                bail!("{what}, {name}: the picture's mean is {actual}, the reference's {expected}");
            }
        }
        Ok(())
    }

    fn picture(&self, name: &str) -> PathBuf {
        self.prefix.with_extension(format!("{name}.pfm"))
    }

    fn values(&self, name: &str) -> Result<Vec<f64>> {
        read(&self.picture(name))
    }
}

/// The numbers of a picture in PFM, which must be finite.
fn read(path: &Path) -> Result<Vec<f64>> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let header = format!("PF\n{SIZE} {SIZE}\n-1.0\n");
    let pixels = bytes.strip_prefix(header.as_bytes());
    let pixels = pixels.with_context(|| format!("{} is no PFM of {SIZE} x {SIZE} pixels", path.display()))?;
    let (values, []) = pixels.as_chunks::<4>() else { bail!("{} ends early", path.display()) };
    let values: Vec<_> = values.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect();
    if values.len() != 3 * SIZE * SIZE || !values.iter().all(|value| value.is_finite()) {
        bail!("{}: not {SIZE} x {SIZE} finite pixels", path.display());
    }
    Ok(values)
}
