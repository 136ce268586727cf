//! `examples_c/pathtracer.cpp`, compiled as its reader would, and run: what it lists, what it promises of its options, and what it
//! refuses.

use crate::c_tests::output;
use crate::examples::{STRICT, compile};
use crate::test::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Pixels on a side of the pictures.
const SIZE: usize = 32;

/// pathtracer.cpp: every estimator and every sampler that it lists, in every scene that it lists.
pub(crate) fn check(archive: &Path) -> Result<Outcome> {
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
    check_seeds(&tracer)?;
    let wrong = [
        &["--estimators", "nonsense"][..],
        &["--scene", "nonsense"],
        &["--spp", "0"],
        &["--sampler", "nonsense"],
        &["--filter", "nonsense"],
        &["--basis", "nonsense"],
        &["--seeds", "0"],
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

/// Several seeds in one run are what single runs make, and statistics are those of the pictures.
fn check_seeds(tracer: &PathTracer) -> Result<()> {
    println!("   seeds, statistics");
    let options = ["--scene", "lights", "--spp", "2", "--estimators", "mc,shared", "--seed", "7"];
    for sampler in ["random", "sobol", "tile"] {
        tracer.render(&[&options[..], &["--sampler", sampler, "--seeds", "3"]].concat())?;
        let mut brightness = Vec::new();
        for seed in ["7", "8", "9"] {
            brightness.push(tracer.brightness(&format!("shared.{seed}"))?);
            tracer.render(&[&options[..6], &["--sampler", sampler, "--seed", seed]].concat())?;
            let [one, many] =
                ["shared".to_owned(), format!("shared.{seed}")].map(|name| fs::read(tracer.picture(&name)));
            if one.context("no picture of one seed")? != many.context("no picture of a seed among several")? {
                bail!("{sampler}: seed {seed} alone and among others make different pictures");
            }
        }
        if brightness[0] == brightness[1] {
            bail!("{sampler}: seeds 7 and 8 make the same picture");
        }
        let half = tracer.picture("mc.8").display().to_string();
        tracer.render(
            &[&options[..], &["--sampler", sampler, "--seeds", "3", "--statistics", &format!("{half},{half}")]]
                .concat(),
        )?;
        let (mean, expected) = (tracer.brightness("shared.mean")?, brightness.iter().sum::<f64>() / 3.0);
        if (mean - expected).abs() > 1e-5 * expected {
            bail!("{sampler}: the mean picture's mean is {mean}, that of the three pictures {expected}");
        }
        let pictures = ["7", "8", "9"].map(|seed| tracer.values(&format!("mc.{seed}")));
        let [a, b, c] = pictures;
        let (a, b, c) = (a?, b?, c?);
        let error = |p: &[f64]| p.iter().zip(&b).map(|(p, b)| (p - b) * (p - b)).sum::<f64>() / b.len() as f64;
        let (measured, expected) = (tracer.brightness("mc.mse")?, (error(&a) + error(&c)) / 3.0);
        if (measured - expected).abs() > 1e-4 * expected {
            bail!("{sampler}: the mean squared error is said to be {measured}, and is {expected}");
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
        let values = self.values(name)?;
        Ok(values.iter().sum::<f64>() / values.len() as f64)
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
