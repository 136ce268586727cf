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
    let table = write_table()?;
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
    check_tiles(&tracer, &tiles)?;
    check_seeds(&tracer)?;
    check_table(&tracer, &table)?;
    check_accumulation(&tracer)?;
    check_two_techniques(&tracer)?;
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
pub(crate) fn parts(archive: &Path) -> Result<Outcome> {
    for name in ["lights", "surfaces", "image_plane", "paths", "mis"] {
        println!("   {name}");
        let program = output(&format!("pathtracer_{name}"))?;
        let mut compiler = run::compiler("CXX", "c++");
        compiler.arg("-std=c++17").args(STRICT).arg(format!("tests/pathtracer/{name}.cpp"));
        run::check(compiler.arg(archive).args(["-pthread", "-o"]).arg(&program))?;
        run::check(&mut run::command(&program))?;
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

/// A file of points for the sampler `table`: in each of 2 x 3 pixels the midpoints of a grid of 4 x 4 cells, in another order.
fn write_table() -> Result<String> {
    let mut bytes = b"noisefloor-points 2 3 16 2\n".to_vec();
    for pixel in 0..6u8 {
        for sample in 0..16u8 {
            let cell = (sample * 5 + pixel) % 16;
            for coordinate in [cell % 4, cell / 4] {
                bytes.extend(((f32::from(coordinate) + 0.5) / 4.0).to_le_bytes());
            }
        }
    }
    let path = output("table.points")?;
    fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
    Ok(path.display().to_string())
}

/// A picture from all points of a grid is that of the midpoint rule, the same in each pixel whatever the order.
fn check_table(tracer: &PathTracer, table: &str) -> Result<()> {
    println!("   table");
    let options = ["--scene", "direct", "--sampler", "table", "--spp", "16", "--estimators", "mc", "--table", table];
    tracer.render(&options)?;
    let grid = tracer.values("mc")?;
    tracer.render(&["--scene", "direct", "--spp", "256", "--reference"])?;
    let reference = tracer.values("reference")?;
    let error = grid.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / grid.len() as f64;
    tracer.render(&["--scene", "direct", "--spp", "16", "--estimators", "mc"])?;
    let random = tracer.values("mc")?;
    let other = random.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / grid.len() as f64;
    if error > 0.3 * other {
        bail!(
            "the squared error of a grid of points is {error}, that of random points {other}: the table is not used as it is"
        );
    }
    Ok(())
}

/// However many threads accumulate passes, and in whatever order, the picture is the same; the plain mean's is that of a run without.
fn check_accumulation(tracer: &PathTracer) -> Result<()> {
    println!("   accumulation");
    let names = ["mc", "robust", "least_squares", "k_fold"];
    for sampler in ["random", "sobol", "tile"] {
        let options = [
            "--scene",
            "lights",
            "--spp",
            "36",
            "--sampler",
            sampler,
            "--estimators",
            "mc,robust,least_squares,k_fold",
        ];
        let pictures = |more: &[&str]| -> Result<Vec<Vec<f64>>> {
            tracer.render(&[&options[..], more].concat())?;
            names.iter().map(|name| tracer.values(name)).collect()
        };
        let one = pictures(&["--accumulate", "8", "--threads", "1"])?;
        let three = pictures(&["--accumulate", "8", "--threads", "3"])?;
        let whole = pictures(&["--accumulate", "36", "--threads", "2"])?;
        let pixels = pictures(&[])?;
        let far = |a: &[f64], b: &[f64]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-5 * (1.0 + a.abs()));
        for (i, name) in names.iter().enumerate() {
            if far(&one[i], &three[i]) || far(&one[i], &whole[i]) {
                bail!("{sampler}, {name}: the picture depends on the threads or on the passes");
            }
        }
        if far(&one[0], &pixels[0]) {
            bail!("{sampler}: the plain mean of passes is not that of whole pixels");
        }
    }
    Ok(())
}

/// Every estimator of --mis makes the picture that the other ones make.
fn check_two_techniques(tracer: &PathTracer) -> Result<()> {
    println!("   two techniques");
    for scene in ["direct", "lights"] {
        tracer.render(&["--scene", scene, "--spp", "64", "--reference"])?;
        let expected = tracer.brightness("reference")?;
        tracer.render(&["--scene", scene, "--mis", "--spp", "32"])?;
        for name in ["balance", "balance_regression", "optimal", "optimal_regression"] {
            let actual = tracer.brightness(name)?;
            if (actual - expected).abs() > 0.05 * expected {
                bail!("{scene}, {name}: the picture's mean is {actual}, the reference's {expected}");
            }
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

/// The names in a program's help that are listed, with descriptions, indented under a heading.
pub(crate) fn block<'a>(help: &'a str, heading: &str) -> Vec<&'a str> {
    let lines = help.lines().skip_while(|line| line.strip_suffix(':') != Some(heading)).skip(1);
    lines.take_while(|line| line.starts_with(' ')).filter_map(|line| line.split_whitespace().next()).collect()
}

/// A compiled program with the path tracer's command line, and where its pictures go.
pub(crate) struct PathTracer {
    pub(crate) program: PathBuf,
    pub(crate) prefix: PathBuf,
}

impl PathTracer {
    fn command(&self, options: &[&str]) -> Command {
        let mut command = run::command(&self.program);
        let size = SIZE.to_string();
        command.args(["--width", &size, "--height", &size]).args(options).arg("--output").arg(&self.prefix);
        command.stdout(Stdio::null());
        command
    }

    pub(crate) fn help(&self) -> Result<String> {
        run::read(run::command(&self.program).arg("--help"))
    }

    pub(crate) fn render(&self, options: &[&str]) -> Result<()> {
        run::check(&mut self.command(options))
    }

    pub(crate) fn accepts(&self, options: &[&str]) -> Result<bool> {
        let status = self.command(options).stderr(Stdio::null()).status();
        Ok(status.context("cannot start the path tracer")?.success())
    }

    pub(crate) fn brightness(&self, name: &str) -> Result<f64> {
        let values = self.values(name)?;
        Ok(values.iter().sum::<f64>() / values.len() as f64)
    }

    /// Fails unless the pictures of all these estimators are as bright as they should be.
    pub(crate) fn check(&self, what: &str, names: &[&str], expected: f64) -> Result<()> {
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
