//! The shipped tiles' dimensions of several domains, those beyond the tile's own among them: uniform, and jointly
//! independent.
//!
//! All randomness is in the seeds of the scramble, which are fixed. Each seed is another place of the tile and another
//! shift, so that one sample of one pixel is an independent draw for each, and needs no pixels that may resemble each
//! other.

use noisefloor::tile::{Builtin, Sampler, Tile};
use noisefloor_tests::statistics::chi_square;

const SEEDS: u32 = 16_384;
/// Numbers that each domain draws: as many as there can be.
const DIMS: usize = 4;
/// Parts of a number's range whose counts are compared.
const PARTS: usize = 8;
/// Of all deviates of this file together, 2e-4 (two-sided): about 3,100 deviates, each at 6e-8 (Bonferroni).
const Z_LIMIT: f64 = 5.42;

/// Domains whose numbers are compared: the scrambled root, children of near keys, and their children.
fn domains<'a>(root: Sampler<'a>) -> [Sampler<'a>; 5] {
    [root, root.domain(0), root.domain(1), root.domain(0).domain(1), root.domain(1).domain(0)]
}

/// Every tile that is shipped.
fn tiles() -> Vec<(&'static str, Tile<'static>)> {
    let bytes = Builtin::ALL.iter().filter_map(|builtin| Some((builtin.name(), builtin.bytes()?)));
    bytes.map(|(name, bytes)| (name, Tile::from_bytes(bytes).expect("shipped tiles are valid"))).collect()
}

/// Sample `index` of the pixel: a row for each seed, of all numbers of all domains, those of one domain together.
fn draws(tile: &Tile<'_>, index: u32) -> Vec<[f32; 5 * DIMS]> {
    let one = |seed| {
        let root = Sampler::pixel(tile, 5, 11, 0, index).scramble(seed);
        let mut row = [0.0; 5 * DIMS];
        for (numbers, domain) in row.chunks_exact_mut(DIMS).zip(domains(root)) {
            numbers.copy_from_slice(&domain.draw::<DIMS>());
        }
        row
    };
    (1..=SEEDS).map(one).collect()
}

/// The first sample, and the last of the tile's own: in between lie others of the same kind.
fn indices(tile: &Tile<'_>) -> Vec<u32> {
    let spp = tile.shape().spp;
    if spp > 1 { vec![0, spp - 1] } else { vec![0] }
}

fn part(number: f32) -> usize {
    (number * PARTS as f32) as usize
}

/// The deviate of a chi-square of equally likely cells.
fn deviate(counts: &[f64]) -> f64 {
    let expected = vec![f64::from(SEEDS) / counts.len() as f64; counts.len()];
    chi_square(counts, &expected).1
}

/// Each number of each domain, in eight parts.
#[test]
fn every_number_is_uniform_over_the_shifts() {
    for (name, tile) in tiles() {
        for index in indices(&tile) {
            let rows = draws(&tile, index);
            for column in 0..5 * DIMS {
                let mut counts = [0.0; PARTS];
                rows.iter().for_each(|row| counts[part(row[column])] += 1.0);
                let z = deviate(&counts);
                assert!(z.abs() < Z_LIMIT, "{name}, sample {index}, number {column}: {z}");
            }
        }
    }
}

/// Each pair of numbers of different domains, in eight by eight cells: dependence of any kind shows, correlation among
/// it.
#[test]
fn numbers_of_different_domains_are_independent_in_pairs() {
    for (name, tile) in tiles() {
        for index in indices(&tile) {
            let rows = draws(&tile, index);
            for a in 0..5 * DIMS {
                for b in 0..a / DIMS * DIMS {
                    let mut counts = [0.0; PARTS * PARTS];
                    rows.iter().for_each(|row| counts[part(row[a]) * PARTS + part(row[b])] += 1.0);
                    let z = deviate(&counts);
                    assert!(z.abs() < Z_LIMIT, "{name}, sample {index}, numbers {a} and {b}: {z}");
                }
            }
        }
    }
}

/// The further numbers, the third and the fourth, of three domains at once, in halves: 64 cells. Pairs may be
/// independent where all together are not.
#[test]
fn further_numbers_of_three_domains_are_independent_jointly() {
    for (name, tile) in tiles() {
        for index in indices(&tile) {
            let rows = draws(&tile, index);
            for [a, b, c] in [[0, 1, 2], [1, 2, 3], [1, 3, 4], [0, 3, 4], [2, 3, 4]] {
                let columns = [a, b, c].into_iter().flat_map(|domain| [domain * DIMS + 2, domain * DIMS + 3]);
                let columns: Vec<usize> = columns.collect();
                let mut counts = [0.0; 64];
                for row in &rows {
                    counts[columns.iter().fold(0, |cell, &column| 2 * cell + usize::from(row[column] >= 0.5))] += 1.0;
                }
                let z = deviate(&counts);
                assert!(z.abs() < Z_LIMIT, "{name}, sample {index}, domains {a}, {b}, {c}: {z}");
            }
        }
    }
}

/// The tests see what they are for: the same domain twice is not independent of itself.
#[test]
fn a_domain_depends_on_itself() {
    let (_, tile) = tiles().into_iter().next().expect("tiles are shipped");
    let mut counts = [0.0; PARTS * PARTS];
    draws(&tile, 0).iter().for_each(|row| counts[part(row[2]) * PARTS + part(row[2])] += 1.0);
    assert!(deviate(&counts) > 100.0);
}
