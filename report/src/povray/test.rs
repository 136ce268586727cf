//! The step of `cargo xtask test` that runs the oracle at small size.

use super::PACKAGES;
use super::bias::{self, Bias};
use super::oracle::{Model, Oracle, Request, View};
use super::scenes::{SCENES, Scene};
use crate::chapters::statistics::Estimate;
use crate::measure::renderer::Sampler;
use crate::measure::score::Score;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use xtask::outcome::Outcome;
use xtask::{paths, tools};

/// Pixels on a side.
const SIZE: u32 = 32;
/// Seeds of the test of biases, and its chance to fail although nothing is biased.
const BIAS_SEEDS: u32 = 128;
const SIGNIFICANCE: f64 = 1e-3;
/// What is exactly unbiased from independent samples.
const UNBIASED: [&str; 4] = ["mc", "leave_one_out", "k_fold", "incremental"];
/// Seeds of the comparison of estimators, and of samplers: a small picture has few independent filtered errors.
const SEEDS: u32 = 16;
const TILE_SEEDS: u32 = 64;
/// The default's relMSE over the plain mean's: the upper end of the 95 % confidence interval of the median.
const LIMIT: f64 = 1.01;
const ORDER: u32 = 2;

pub(crate) fn run(archive: &Path) -> Result<Outcome> {
    if let Some(missing) = tools::packages(&PACKAGES)? {
        return Ok(Outcome::NotRun(missing));
    }
    let oracle = Oracle::build(archive, Arc::default())?;
    let views = SCENES.iter().map(|scene| oracle.view(scene, scene.small, SIZE)).collect::<Result<Vec<_>>>()?;
    damaged_stacks(&oracle, &views[0])?;
    for (scene, view) in SCENES.iter().zip(&views) {
        println!("   {}: {}", scene.name, scene.shows);
        unbiased(&oracle, scene, view)?;
        everything(&oracle, scene, view)?;
        default_is_no_worse(&oracle, scene, view)?;
        tile_is_blue(&oracle, scene, view)?;
    }
    Ok(Outcome::Passed)
}

/// Each kind of damage is refused, with words that say what it is.
fn damaged_stacks(oracle: &Oracle, view: &View) -> Result<()> {
    let whole = fs::read(view.path()).with_context(|| format!("cannot read {}", view.path().display()))?;
    let mut flipped = whole.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    let longer = [&whole[..], b"\0"].concat();
    let cases = [
        (flipped, "checksum"),
        (whole[..whole.len() - 1].to_vec(), "ends early"),
        (longer, "more after"),
        (whole[..30].to_vec(), "header ends early"),
        (b"P6\n32 32\n65535\n".to_vec(), "no stack of this version"),
        (Vec::new(), "header ends early"),
        (replace(&whole, b"axis light", b"axis taste"), "an axis `taste`"),
        (replace(&whole, b"size 32", b"size 00"), "impossible size"),
    ];
    for (bytes, words) in cases {
        let path = oracle.scratch().join("damaged.stack");
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
        expect(&oracle.refusal(&path)?, words)?;
    }
    expect(&oracle.refusal(&paths::root().join("no.stack"))?, "cannot read")
}

fn expect(message: &str, words: &str) -> Result<()> {
    if !message.contains(words) {
        bail!("the oracle's message does not say `{words}`: {message}");
    }
    Ok(())
}

/// With the first `old` replaced by `new`.
fn replace(bytes: &[u8], old: &[u8], new: &[u8]) -> Vec<u8> {
    let at = bytes.windows(old.len()).position(|window| window == old).unwrap_or(0);
    [&bytes[..at], new, &bytes[at + old.len()..]].concat()
}

/// Exactly unbiased estimators, and both models of what lies between cells, against the exact mean.
fn unbiased(oracle: &Oracle, scene: &Scene, view: &View) -> Result<()> {
    let request = |model, estimators| Request {
        model,
        spp: 16,
        order: ORDER,
        sampler: Sampler::Random,
        estimators,
        seeds: BIAS_SEEDS,
    };
    let mut cases = Vec::new();
    for (model, names) in [(Model::Cells, &UNBIASED[..]), (Model::Linear, &["mc"])] {
        let renderings = oracle.render(view, &request(model, names))?;
        cases.extend(names.iter().zip(renderings).map(|(name, one)| (*name, model, one)));
    }
    // The chance is shared by everything that is tested.
    let tests = SCENES.len() * cases.len() * bias::TESTS;
    for (name, model, renderings) in cases {
        let Bias { deviations, place } = bias::largest(&renderings.images, &view.reference);
        let limit = bias::limit(SIGNIFICANCE, tests);
        let summary = format!("{name} ({}): {deviations:.2} standard errors from the exact mean {place}", model.name());
        if deviations > limit {
            bail!("{}: {summary}; beyond {limit:.2}, which has a chance of {SIGNIFICANCE} over all tests", scene.name);
        }
        println!("      {summary}; limit {limit:.2}");
    }
    Ok(())
}

/// Every estimator with every sampler: pictures of the exact mean's brightness.
fn everything(oracle: &Oracle, scene: &Scene, view: &View) -> Result<()> {
    let names = [scene.estimators(), vec!["luminance", "robust_luminance"]].concat();
    for (sampler, sampler_name) in [(Sampler::Random, "random"), (Sampler::Sobol, "sobol"), (Sampler::Tile(""), "tile")]
    {
        for model in [Model::Cells, Model::Linear] {
            let request = Request { model, spp: 8, order: ORDER, sampler, estimators: &names, seeds: 1 };
            let renderings = oracle.render(view, &request)?;
            for (name, one) in names.iter().zip(renderings) {
                // Least squares follows noise if it has fewer samples than terms.
                let limit = if ["least_squares", "gradient_descent", "luminance"].contains(name) { 0.5 } else { 0.05 };
                let error = bias::brightness(&one.images, &view.reference);
                if error.abs() > limit {
                    bail!(
                        "{}, {sampler_name}, {name}: the picture's brightness is off by {:.1} %, more than {:.0} %",
                        scene.name,
                        100.0 * error,
                        100.0 * limit
                    );
                }
            }
        }
    }
    Ok(())
}

fn default_is_no_worse(oracle: &Oracle, scene: &Scene, view: &View) -> Result<()> {
    for spp in [16, 64] {
        let estimators = &["mc", "robust"];
        let (model, sampler) = (Model::Cells, Sampler::Random);
        let request = Request { model, spp, order: ORDER, sampler, estimators, seeds: SEEDS };
        let renderings = oracle.render(view, &request)?;
        let errors: Vec<Vec<f64>> = renderings
            .iter()
            .map(|one| one.images.iter().map(|image| view.reference.rel_mse(image)).collect())
            .collect();
        let Estimate { value, low, high, seeds } = Estimate::ratio(&errors[1], &errors[0]);
        println!(
            "      {spp} spp: relMSE of the default over the mean's {value:.3} [{low:.3}, {high:.3}], {seeds} seeds"
        );
        if high > LIMIT {
            bail!(
                "{}, {spp} spp: the default is worse than the plain mean: {value:.3} [{low:.3}, {high:.3}] > {LIMIT}",
                scene.name
            );
        }
    }
    Ok(())
}

fn tile_is_blue(oracle: &Oracle, scene: &Scene, view: &View) -> Result<()> {
    for spp in [1, 4, 16] {
        let filtered = |sampler| -> Result<Vec<f64>> {
            let request =
                Request { model: Model::Cells, spp, order: ORDER, sampler, estimators: &["mc"], seeds: TILE_SEEDS };
            let renderings = oracle.render(view, &request)?;
            let images = renderings.iter().flat_map(|one| &one.images);
            Ok(images.map(|image| Score::new(image, &view.reference).filtered).collect())
        };
        let Estimate { value, low, high, seeds } =
            Estimate::ratio(&filtered(Sampler::Tile(scene.tile(spp)))?, &filtered(Sampler::Random)?);
        println!(
            "      {spp} spp: filtered error of the tile over random's {value:.3} [{low:.3}, {high:.3}], {seeds} seeds"
        );
        if high >= 1.0 {
            bail!(
                "{}, {spp} spp: the tile's filtered error is not below random's: {value:.3} [{low:.3}, {high:.3}]",
                scene.name
            );
        }
    }
    Ok(())
}
