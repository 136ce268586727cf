//! The optimiser's files: any bytes as a checkpoint or a class file are an error or a result, never a panic.
//!
//! Few random bytes have the right checksum, so checkpoints are also read with theirs put right.
#![no_main]

use fsot::checkpoint::{Problem, resume};
use fsot::class::ClassFile;
use fsot::digest::digest;
use fsot::run::Optimization;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

/// Takes any state.
struct Any(Vec<f32>);

impl Optimization for Any {
    fn iterations(&self) -> u64 {
        8
    }

    fn iteration(&self) -> u64 {
        0
    }

    fn step(&mut self) -> f64 {
        0.0
    }

    fn coordinates(&self) -> &[f32] {
        &self.0
    }

    fn restore(&mut self, iteration: u64, coordinates: &[f32]) -> bool {
        self.0 = coordinates.to_vec();
        iteration <= self.iterations()
    }
}

/// The SHA-256 as bytes.
fn checksum(bytes: &[u8]) -> Vec<u8> {
    let text = digest(bytes);
    (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect()
}

fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint");
    let problem = Problem::new(&1).unwrap();
    std::fs::write(&path, bytes).unwrap();
    let mut state = Any(vec![0.0]);
    if resume(&path, &problem, &mut state).is_err() {
        assert_eq!(state.0, [0.0], "a refused checkpoint was taken over");
    }
    let sealed = [bytes, &checksum(bytes)].concat();
    std::fs::write(&path, sealed).unwrap();
    resume(&path, &problem, &mut state).ok();
    if let Ok(text) = std::str::from_utf8(bytes) {
        ClassFile::parse(Path::new("classes.toml"), text).ok();
    }
});
