//! What the path tracer promises of its options.

use super::PathTracer;
use crate::c_tests::output;
use crate::paths;
use anyhow::{Context, Result, bail};
use std::fs;

/// Every tile by its name, and by its file if it is there: the same picture.
pub(super) fn check_tiles(tracer: &PathTracer, tiles: &[&str]) -> Result<()> {
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

/// A file of points for the sampler `table`: in each of 2 x 3 pixels the midpoints of a grid of 4 x 4 cells, in another
/// order.
pub(super) fn write_table() -> Result<String> {
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
pub(super) fn check_table(tracer: &PathTracer, table: &str) -> Result<()> {
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
            "the squared error of a grid of points is {error}, that of random points {other}: the table is \
             not used as it is"
        );
    }
    Ok(())
}

/// However many threads accumulate passes, of however many samples, the picture is the same; the plain mean's is that
/// of a run without.
pub(super) fn check_accumulation(tracer: &PathTracer) -> Result<()> {
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
pub(super) fn check_two_techniques(tracer: &PathTracer) -> Result<()> {
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
pub(super) fn check_seeds(tracer: &PathTracer) -> Result<()> {
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
