//! All tests of the library and the program, as one program: linking each file on its own took longer than running it.
//! `cargo test -p noisefloor-fsot --test fsot cli_formats::` runs those of one file. A new file needs a line here.

mod class_files;
mod cli_checkpoint;
mod cli_commands;
mod cli_edges;
mod cli_errors;
mod cli_formats;
mod cli_inputs;
mod cli_jpeg;
mod cli_names;
mod cli_outputs;
mod cli_pipes;
mod cli_resume;
mod cli_sentences;
mod cli_support;
mod cli_tiles;
mod documents;
mod image_target;
mod metrics_cli;
mod metrics_common;
mod metrics_integration;
mod metrics_points;
mod metrics_report;
mod metrics_spectrum;
mod metrics_tile;
mod place_objects;
mod points_edge;
mod points_invariance;
mod points_quality;
mod points_targets;
mod sampler;
mod stipple_cli;
mod stipple_library;
mod tile_kernels;
mod tile_optimizer;
mod tile_quality;
