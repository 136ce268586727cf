//! Fits shared by pixels: on tiles' samples, where they cannot help, and how biased they are.

use noisefloor::control_variate::{Config, Estimator};
use noisefloor::tile::Builtin;
use noisefloor_bench::Extent;
use noisefloor_tests::shared_bias::{self, Bias, independent, of_tile};
use noisefloor_tests::shared_hard::{self, COUNTS, SCENES};
use noisefloor_tests::shared_tiles::{Method, Motion, quadruples, scores};
use rayon::prelude::*;
use std::fmt::Write;

/// Order, window and stride of images; order of blocks.
const METHODS: [(&str, Method); 5] = [
    ("plain mean", Method::Plain),
    ("8 x 8, order 4", Method::Image(4, 8, 4)),
    ("16 x 16, order 4", Method::Image(4, 16, 8)),
    ("8 x 8, order 3", Method::Image(3, 8, 4)),
    ("8 x 8 side by side, order 3", Method::Blocks(3)),
];

/// Scores on the tiles, raw and blurred.
pub(crate) fn tiles(size: Extent) -> String {
    let settings: Vec<(Motion, usize)> =
        [Motion::None, Motion::Steep].into_iter().flat_map(|motion| [1, 4, 16].map(|spp| (motion, spp))).collect();
    let rows: Vec<String> = settings
        .into_par_iter()
        .map(|(motion, spp)| {
            let quadruples = size.of(quadruples(spp));
            let all = scores(spp, motion, METHODS.map(|(_, method)| method), quadruples);
            let moving = if motion == Motion::None { "the same everywhere" } else { "moving and scaling" };
            METHODS.iter().zip(all).fold(String::new(), |mut text, ((method, _), [planes, bumps])| {
                let _ = writeln!(
                    text,
                    "{spp};{moving};{method};{};{};{};{};{}",
                    4 * quadruples,
                    planes.raw,
                    bumps.raw,
                    planes.blurred,
                    bumps.blurred
                );
                text
            })
        })
        .collect();
    format!("samples;integrands;method;count;half_planes;bumps;half_planes_blurred;bumps_blurred\n{}", rows.concat())
}

/// RMSE ratios to the mean in scenes that fits should leave alone.
pub(crate) fn hard(size: Extent) -> String {
    let cells: Vec<_> = SCENES
        .into_iter()
        .flat_map(|scene| COUNTS.map(|n| (scene, n)))
        .flat_map(|(scene, n)| [("image", scene, n), ("block", scene, n)])
        .collect();
    let rows: Vec<String> = cells
        .into_par_iter()
        .map(|(of, (name, make), n)| {
            let (images, ratio) = match of {
                "image" => shared_hard::measure(make, n, size.of(160), 100, shared_hard::as_image),
                _ => shared_hard::measure(make, n, size.of(160), 200, shared_hard::as_block),
            };
            format!("{of};{name};{n};{};{};{images}\n", ratio.value, ratio.half_width)
        })
        .collect();
    format!("of;scene;n;ratio;half_width;repetitions\n{}", rows.concat())
}

/// Bias over the RMSE.
pub(crate) fn bias(size: Extent) -> String {
    let mut text = "samples;n;estimator;window;typical;largest;chance\n".to_owned();
    let mut row = |samples: &str, n: usize, estimator: &str, window: usize, bias: &Bias| {
        let Bias { typical, largest, chance } = bias;
        let _ = writeln!(text, "{samples};{n};{estimator};{window} x {window};{typical};{largest};{chance}");
    };
    for (side, repetitions) in [(4, 3000), (8, 800), (16, 200)] {
        let bias = shared_bias::bias(&Config::new(2, 3, 1), side, 1, size.of(repetitions), independent(side * side));
        row("independent", 1, "robust", side, &bias);
    }
    let bias = shared_bias::bias_of_pixels(&Config::new(2, 3, 1), 1, size.of(2500));
    row("independent, scenes", 1, "robust", 8, &bias);
    for (builtin, n) in [(Builtin::Size128Spp1Dims2, 1), (Builtin::Size128Spp4Dims2, 4)] {
        for (name, estimator) in
            [("robust", Estimator::Robust), ("leave-one-out", Estimator::LeaveOneOut), ("K-fold", Estimator::KFold)]
        {
            let config = Config { estimator, ..Config::new(2, 3, 1) };
            row("tile, shifted", n, name, 8, &shared_bias::bias(&config, 8, n, size.of(600 / n), of_tile(builtin)));
        }
    }
    text
}
