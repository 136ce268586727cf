//! Shared fits to the samples of the built-in tiles: what they gain, raw and as the eye sees it.
//!
//! 24 half-planes and 24 Gaussian bumps (12 at 16 samples); what a score is: `noisefloor_tests::shared_tiles`. The
//! report's chapter `analytic` has more settings.

use noisefloor_tests::shared_tiles::{self, Method, Motion, Score, Scores, quadruples};

/// Printed, for who runs a test alone.
fn scores<const N: usize>(spp: usize, motion: Motion, methods: [Method; N]) -> [Scores; N] {
    let out = shared_tiles::scores(spp, motion, methods, quadruples(spp));
    for (method, [half_planes, bumps]) in methods.iter().zip(&out) {
        println!(
            "{spp:2} spp, motion {motion:?}, {method:?}: raw {:.4} / {:.4}, blurred {:.4} / {:.5}",
            half_planes.raw, bumps.raw, half_planes.blurred, bumps.blurred
        );
    }
    out
}

fn is_within(score: Score, raw: f64, blurred: f64) -> bool {
    score.raw <= raw && score.blurred <= blurred
}

const ORDER_3: Method = Method::Image(3, 8, 4);
const ORDER_4: Method = Method::Image(4, 8, 4);
const WIDE: Method = Method::Image(4, 16, 8);

/// One sample, raw and blurred: half-planes .25 and .13, bumps .17 and .055, already by order 3. Measured .233 and
/// .096, .167 and .024 by order 3, .225 and .098, .116 and .020 by order 4, .188 and .090, .084 and .015 by order 4 in
/// windows of 16.
#[test]
fn one_sample() {
    for [half_planes, bumps] in scores(1, Motion::None, [ORDER_3, ORDER_4, WIDE, Method::Blocks(3), Method::Blocks(4)])
    {
        assert!(is_within(half_planes, 0.25, 0.13) && is_within(bumps, 0.17, 0.055));
    }
}

/// One sample of integrands that move and scale, raw: half-planes .37, bumps .29. Measured .255 and .169 by order 3.
#[test]
fn one_sample_of_what_moves() {
    for motion in [Motion::Slow, Motion::Steep] {
        for [half_planes, bumps] in scores(1, motion, [ORDER_3, ORDER_4, Method::Blocks(3)]) {
            assert!(is_within(half_planes, 0.37, 0.13) && is_within(bumps, 0.29, 0.055));
        }
    }
}

/// Four samples, raw and blurred: half-planes .22 and .048, bumps .16 and .009. Measured .189 and .043, .129 and .0024
/// by order 3; .179 and .043, .087 and .0019 by order 4. The plain mean has .277 and .042, .270 and .0019.
#[test]
fn four_samples() {
    for [half_planes, bumps] in scores(4, Motion::None, [ORDER_3, ORDER_4, Method::Blocks(4)]) {
        assert!(is_within(half_planes, 0.22, 0.048) && is_within(bumps, 0.16, 0.009));
    }
}

/// Sixteen samples, of which the tile leaves little to gain: order 4 is at most 1.03 of the plain mean, raw and
/// blurred. Measured .96 and 1.00 for half-planes, .70 and .93 for bumps. Order 3 side by side is not: bumps blurred
/// 1.8.
#[test]
fn sixteen_samples_do_no_harm() {
    for motion in [Motion::None, Motion::Steep] {
        let [plain, shared] = scores(16, motion, [Method::Plain, ORDER_4]);
        for (plain, shared) in plain.iter().zip(&shared) {
            assert!(is_within(*shared, 1.03 * plain.raw, 1.03 * plain.blurred), "{plain:?} {shared:?}");
        }
    }
}
