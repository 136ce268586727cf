//! The tests of the library as one program: linking each file on its own took longer than running it.
//! `cargo test -p noisefloor-tests --test noisefloor cv_hard::` runs those of one file. A new file needs a line here.

use proptest::test_runner::{Config, RngSeed};
use std::path::Path;

mod cv_basis;
mod cv_block;
mod cv_hard;
mod cv_image;
mod cv_image_bright;
mod cv_image_edges;
mod cv_image_known;
mod cv_image_mixture;
mod cv_image_never_worse;
mod cv_image_oracle;
mod cv_image_parts;
mod cv_image_texture;
mod cv_image_tiles;
mod cv_image_unbiased;
mod cv_large;
mod cv_never_worse;
mod cv_oracle;
mod cv_ordered;
mod cv_properties;
mod cv_slices;
mod cv_streams;
mod cv_support;
mod cv_unbiased;
mod minibatch_importance;
mod minibatch_omis;
mod minibatch_shuffle;
mod minibatch_statistics;
mod minibatch_table;
mod minibatch_table_damage;
mod minibatch_table_draws;
mod minibatch_table_properties;
mod minibatch_table_unbiased;
mod minibatch_table_vectors;
mod mis_control_variate;
mod mis_heuristics;
mod mis_optimal;
mod mis_statistics;
mod mis_support;
mod mis_weight;
mod recommend;
mod rng;
mod sampler;
mod table_support;
mod tile_continued;
mod tile_format;
mod tile_further_dimensions;
mod tile_sampler;
mod tile_statistics;
mod tile_vectors;
mod vectors;
mod warp;

/// So many cases of a property, the same at every run.
fn cases(cases: u32, seed: u64) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..Config::default() }
}

/// A file that is not named above would not run.
#[test]
fn every_file_is_part_of_the_program() {
    let named = include_str!("main.rs");
    for entry in Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").read_dir().unwrap() {
        let path = entry.unwrap().path();
        let line = format!("mod {};", path.file_stem().unwrap().display());
        assert!(
            path.ends_with("main.rs") || named.lines().any(|other| other == line),
            "tests/main.rs has no line `{line}`"
        );
    }
}
