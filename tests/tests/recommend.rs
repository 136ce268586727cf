//! What is recommended: valid everywhere, and consistent with itself.

use noisefloor::Error;
use noisefloor::control_variate::Config;
use noisefloor::recommend::{Method, Sampling, recommend};
use noisefloor_tests::tile::crc;

const BOTH: [Sampling; 2] = [Sampling::Independent, Sampling::Stratified];

#[test]
fn every_recommendation_is_valid() {
    for dims in 1..=64 {
        for samples in 1..=4096 {
            for (sampling, share) in BOTH.into_iter().flat_map(|sampling| [(sampling, false), (sampling, true)]) {
                let of = recommend(dims, samples, sampling, share, f32::INFINITY).unwrap();
                let terms = of.config.terms().unwrap();
                assert_eq!(terms == 1, of.method == Method::PlainMean);
                assert_eq!(of.pays_from.is_infinite(), of.method == Method::PlainMean, "{dims} {samples} {sampling:?}");
                assert!(of.config.dims <= dims);
                assert_eq!((of.config.stride, of.config.channels), (dims, 1));
                assert_eq!(of.config.stratified, sampling == Sampling::Stratified);
                assert!(share || of.method != Method::Shared);
                assert!((1..=samples).contains(&of.tile_samples) && [2, 4].contains(&of.tile_dims));
                assert!([4, 8].contains(&of.image_stride));
                assert!(of.error > 0.0 && of.error <= 1.05 && of.filtered_error > 0.0);
            }
        }
    }
    for samples in [1, usize::MAX] {
        assert!(
            recommend(usize::MAX, samples, Sampling::Independent, true, f32::INFINITY).unwrap().config.terms().is_ok()
        );
    }
}

#[test]
fn nothing_to_recommend() {
    let none = |dims, samples, cost| recommend(dims, samples, Sampling::Stratified, true, cost).unwrap_err();
    assert_eq!([none(0, 1, 1.0), none(2, 0, 1.0), none(2, 1, 0.0), none(2, 1, -1.0)], [Error::Range; 4]);
    assert_eq!(none(2, 1, f32::NAN), Error::NotFinite);
}

/// More information is never of less use, by error alone.
#[test]
fn neighbours_and_strata_lower_the_error() {
    for dims in [1, 2, 4, 5, 8, 15] {
        for samples in [4, 16, 64, 256] {
            let error = |sampling, share| {
                let of = recommend(dims, samples, sampling, share, f32::INFINITY).unwrap();
                (of.error * of.filtered_error).sqrt()
            };
            for sampling in BOTH {
                assert!(error(sampling, true) <= error(sampling, false), "{dims} {samples} {sampling:?}");
            }
            // In 1 dim a fit of order 7 to 64 independent samples leaves less than their strata would.
            for share in [false, true].into_iter().filter(|_| dims > 1 || samples != 64) {
                assert!(error(Sampling::Stratified, share) < error(Sampling::Independent, share), "{dims} {samples}");
            }
        }
    }
}

/// Below that cost the mean, from it on the fit.
#[test]
fn dear_samples_pay() {
    for dims in [1, 2, 4, 5, 8, 15] {
        for samples in [1, 4, 16, 64, 256] {
            for (sampling, share) in BOTH.into_iter().flat_map(|sampling| [(sampling, false), (sampling, true)]) {
                let of = |cost| recommend(dims, samples, sampling, share, cost).unwrap();
                let best = of(f32::INFINITY);
                if best.method == Method::PlainMean {
                    assert_eq!((best.cost, best.pays_from, of(1.0)), (0.0, f32::INFINITY, best));
                    continue;
                }
                let from = best.pays_from;
                assert!(best.cost > 0.0 && from > best.cost, "{dims} {samples}");
                assert_eq!(of(from), best);
                let mean = of(from.min(1e9) * 0.99);
                assert_eq!((mean.method, mean.config.order, mean.cost), (Method::PlainMean, 0, 0.0));
                assert_eq!(mean.pays_from, from);
                assert!(mean.error >= best.error);
            }
        }
    }
}

#[test]
fn examples() {
    // A fit to a pixel's own samples spoils their stratification.
    for samples in 1..=4096 {
        let of = recommend(2, samples, Sampling::Stratified, false, f32::INFINITY).unwrap();
        assert_eq!(of.method, Method::PlainMean);
    }
    // One sample has nothing to be fitted to, but neighbours have.
    assert_eq!(recommend(4, 1, Sampling::Independent, false, f32::INFINITY).unwrap().method, Method::PlainMean);
    assert_eq!(recommend(4, 1, Sampling::Independent, true, f32::INFINITY).unwrap().method, Method::Shared);
    assert_eq!(recommend(2, 64, Sampling::Independent, false, f32::INFINITY).unwrap().method, Method::PerPixel);
    assert_eq!(recommend(2, 4, Sampling::Stratified, true, f32::INFINITY).unwrap().method, Method::Shared);
    let filtered = |sampling| recommend(2, 16, sampling, true, f32::INFINITY).unwrap().filtered_error;
    assert!(filtered(Sampling::Stratified) < filtered(Sampling::Independent));
    // Windows that overlap pay later than those side by side, of which 46,900 ns was measured.
    let overlapping = recommend(2, 16, Sampling::Stratified, true, 60_000.0).unwrap();
    assert_eq!((overlapping.method, overlapping.pays_from), (Method::PlainMean, 93_800.0));
    // Many samples bear more terms; in many dims there are too many of a high order.
    let order =
        |dims, samples| recommend(dims, samples, Sampling::Independent, false, f32::INFINITY).unwrap().config.order;
    assert_eq!([1, 2, 4, 5, 6].map(|dims| order(dims, 16)), [5, 3, 3, 2, 2]);
    assert_eq!([1, 2, 3, 4, 5, 6].map(|dims| order(dims, 64)), [7, 5, 3, 3, 2, 2]);
    assert_eq!([1, 2, 3, 4, 5, 6].map(|dims| order(dims, 256)), [7, 5, 3, 3, 3, 2]);
    // Tiles of as many samples; beyond 16, a sequence.
    let tile = |samples| recommend(2, samples, Sampling::Stratified, true, f32::INFINITY).unwrap().tile_samples;
    assert_eq!([1, 3, 4, 15, 16, 63, 64, 4096].map(tile), [1, 1, 4, 4, 16, 16, 1, 1]);
}

/// The tables, number by number: after a new measurement the sum here is another.
#[test]
fn pinned() {
    let mut bytes = Vec::new();
    for (dims, samples) in [1, 2, 4, 5, 8, 15].into_iter().flat_map(|dims| [1, 4, 16, 64, 256].map(|n| (dims, n))) {
        for (sampling, share) in BOTH.into_iter().flat_map(|sampling| [(sampling, false), (sampling, true)]) {
            let of = recommend(dims, samples, sampling, share, f32::INFINITY).unwrap();
            let counts = [of.method as usize, of.config.order, of.image_stride, of.tile_samples, of.tile_dims];
            bytes.extend(counts.map(|count| count as u8));
            bytes.extend([of.error, of.filtered_error, of.cost, of.pays_from].map(f32::to_le_bytes).as_flattened());
        }
    }
    assert_eq!(crc(bytes), 0x6b99_a5a9);
}

/// Dims are rounded up, samples down, to what was measured.
#[test]
fn rounded() {
    for (dims, samples) in (1..=15).flat_map(|dims| (1..3000).map(move |samples| (dims, samples))) {
        let measured = [1, 2, 4, 5, 8, 15].into_iter().find(|&measured| measured >= dims).unwrap();
        let fewer = [256, 64, 16, 4, 1].into_iter().find(|&fewer| fewer <= samples).unwrap();
        for (sampling, share) in BOTH.into_iter().flat_map(|sampling| [(sampling, false), (sampling, true)]) {
            let of = |dims, samples| recommend(dims, samples, sampling, share, f32::INFINITY).unwrap();
            let (here, mut there) = (of(dims, samples), of(measured, fewer));
            assert_eq!(here.config.dims, dims);
            there.config = Config { dims, stride: here.config.stride, ..there.config };
            if let 2 | 3 = samples {
                (there.cost, there.pays_from) = (here.cost, here.pays_from);
            }
            // In many dims fits of 4 samples do not pay, and so none of 2 or 3.
            if here.method == there.method || ![2, 3].contains(&samples) {
                assert_eq!(here, there);
            } else {
                assert_eq!((here.method, of(dims, 4).method), (Method::PlainMean, Method::PlainMean));
            }
        }
    }
}

/// Four samples of a pixel are worked on at once: of two or three a pixel takes as long.
#[test]
fn a_pixel_of_two_samples_takes_as_long_as_of_four() {
    for (dims, sampling) in [1, 2, 4, 5, 8].into_iter().flat_map(|dims| BOTH.map(|sampling| (dims, sampling))) {
        let of = |samples| recommend(dims, samples, sampling, true, f32::INFINITY).unwrap();
        // Where windows overlap, another.
        for samples in [2, 3].into_iter().filter(|_| of(2).image_stride == of(4).image_stride) {
            assert!((of(samples).cost * samples as f32 / (of(4).cost * 4.0) - 1.0).abs() < 1e-6, "{dims} {samples}");
        }
        assert!(of(2).cost > of(1).cost && of(2).pays_from > of(1).pays_from);
    }
}
