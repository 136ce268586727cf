//! Nested-net tiles: their nets, marginals and determinism.

use crate::cli_support::Place;
use fsot::run::Optimization;
use fsot::sampler::{SamplerOptimizer, SamplerProblem, SamplerTable, sidecar, table};
use std::path::Path;

fn small() -> SamplerProblem {
    SamplerProblem { candidates: 6, iterations: 3, ..SamplerProblem::default() }
}

fn made(problem: SamplerProblem) -> SamplerTable {
    let mut optimizer = SamplerOptimizer::new(problem).unwrap();
    optimizer.run();
    optimizer.table()
}

fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Every elementary interval of 2^m cells has one of the first 2^m points, and of every further 2^m.
fn assert_nets(table: &SamplerTable, pixels: impl Iterator<Item = usize>) {
    for pixel in pixels {
        for m in 0..=8u32 {
            for block in 0..(if m < 5 { 4 } else { 1 }) {
                for along_x in 0..=m {
                    let mut seen = vec![false; 1 << m];
                    for i in 0..1 << m {
                        let [x, y] = table.point(pixel, block << m | i).map(u64::from);
                        let cell = (x >> (32 - along_x) << (m - along_x)) | y >> (32 - (m - along_x));
                        assert!(!std::mem::replace(&mut seen[cell as usize], true), "pixel {pixel}, 2^{m}, {along_x}");
                    }
                }
            }
        }
    }
}

#[test]
fn every_prefix_of_every_pixel_is_a_net_whatever_the_offsets() {
    // All points move for the first octave or the last: with those between it takes twelve times as long.
    let weights = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let table = made(SamplerProblem { candidates: 2, iterations: 1, bits: 4, weights, ..small() });
    assert_nets(&table, (0..32 * 32).step_by(31));
    let start = SamplerOptimizer::new(SamplerProblem { bits: 1, size: 64, ..small() }).unwrap().table();
    assert_nets(&start, (0..64 * 64).step_by(31));
}

/// The same points as those of the matrices, column by column.
#[test]
fn the_net_is_sobols() {
    for i in [0u32, 1, 2, 3, 5, 77, 1023, 0x1234_5678, u32::MAX] {
        let (mut column, mut second) = (1u32 << 31, 0);
        for bit in 0..32 {
            second ^= if i >> bit & 1 == 1 { column } else { 0 };
            column ^= column >> 1;
        }
        assert_eq!(table::net(i), [i.reverse_bits(), second]);
    }
}

#[test]
fn threads_and_interruptions_do_not_show() {
    // Of four octaves: with all of them it takes twice as long.
    let weights = [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
    let problem = SamplerProblem { weights, iterations: 2, ..small() };
    let new = |seed: u64| SamplerOptimizer::new(SamplerProblem { seed, ..problem.clone() }).unwrap();
    let [mut whole, mut threads, mut resumed, mut other] = [1, 1, 1, 2].map(new);
    on(1, || whole.step());
    on(2, || threads.step());
    assert_eq!(threads.table(), whole.table());
    other.step();
    assert_ne!(other.table(), whole.table());
    // Within a step the state is that before it.
    let before = whole.work()[0];
    assert!(whole.advance().is_none() && whole.work()[0] > before);
    assert!(resumed.restore(whole.iteration(), whole.coordinates()));
    // Whoever looks changes nothing.
    whole.measure();
    on(1, || whole.step());
    on(2, || resumed.step());
    assert_eq!((resumed.iteration(), resumed.iterations()), (2, 2));
    assert_eq!(resumed.table(), whole.table());
}

#[test]
fn a_state_of_another_problem_is_refused() {
    let mut optimizer = SamplerOptimizer::new(small()).unwrap();
    let state = optimizer.coordinates().to_vec();
    let before = optimizer.table();
    let mut wrong = state.clone();
    wrong[0] = 0.5;
    assert!(!optimizer.restore(1, &wrong) && !optimizer.restore(1, &state[1..]) && !optimizer.restore(7, &state));
    assert_eq!(optimizer.table(), before);
}

/// Steps of 3, 5, 7 and 7 octaves, of 4, 16, 64 and 64 points and what a step takes beside.
#[test]
fn steps_cost_by_their_points() {
    let optimizer = SamplerOptimizer::new(SamplerProblem { iterations: 4, ..small() }).unwrap();
    assert_eq!(optimizer.work(), [0.0, 8.0 + 20.0 + 68.0 + 68.0]);
}

/// The command has no option for it: it checks all others.
#[test]
fn no_candidates_are_refused() {
    assert!(SamplerOptimizer::new(SamplerProblem { candidates: 0, ..small() }).is_err());
}

#[test]
fn the_energies_fall() {
    let mut optimizer = SamplerOptimizer::new(SamplerProblem { candidates: 12, ..small() }).unwrap();
    let before = optimizer.measure();
    optimizer.run();
    let after = optimizer.measure();
    for (before, after) in before.filtered.iter().zip(&after.filtered) {
        assert!(*after < 0.97 * before, "{after} of {before}");
    }
}

/// The density of each axis within 1/64 of each border, over the tile, after `count` samples.
fn borders(table: &SamplerTable, count: u32) -> [f64; 4] {
    let pixels = table.size * table.size;
    let mut near = [0.0; 4];
    for pixel in 0..pixels {
        for i in 0..count {
            for (axis, value) in table.point(pixel, i).into_iter().enumerate() {
                near[2 * axis] += f64::from(value >> 26 == 0);
                near[2 * axis + 1] += f64::from(value >> 26 == 63);
            }
        }
    }
    near.map(|sum| sum * 64.0 / (pixels as f64 * f64::from(count)))
}

#[test]
fn the_shipped_sampler_is_nets_of_uniform_marginals() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/tiles/nested_32.bin");
    let table = sidecar::read(&path).unwrap();
    assert_nets(&table, (0..table.size * table.size).step_by(17));
    for count in [1, 4, 16] {
        let near = borders(&table, count);
        assert!(near.iter().all(|density| (0.9..=1.1).contains(density)), "{count} samples: {near:?}");
    }
}

#[test]
fn the_command_writes_a_table_and_its_sidecar() {
    let place = Place::new();
    // Of two octaves: of all it is three minutes.
    let text = place.succeed("sampler --iterations 1 --bits 1 --weights 1,1,0,0,0,0,0 --out s.bin");
    assert!(text.contains("border") && text.contains("1 step"), "{text}");
    let table = sidecar::read(&place.path("s.bin")).unwrap();
    assert_eq!((table.size, table.bits, table.offsets.len()), (32, 1, 2048));
    assert_eq!(table.bytes(), place.read("s.bin"));
    assert_eq!(place.names(), ["s.bin", "s.toml"]);
    let sidecar = String::from_utf8(place.read("s.toml")).unwrap();
    assert!(sidecar.contains("command = \"fsot sampler --size 32 --bits 1 "), "{sidecar}");
    place.refuse("sampler --weights 1,2 --out t.bin", "'--weights <WEIGHTS>': give 7 numbers, not 2");
    let help = place.succeed("sampler --help");
    assert!(help.contains("[default: 3,2,2.8,1.7,2.8,0.3,0.7]"), "{help}");
    for (options, message) in [
        ("--size 48", "size is 48; use 32, 64 or 128 pixels"),
        ("--bits 0", "bits is 0; use 1 to 6"),
        ("--bits 7", "bits is 7;"),
        ("--exponent 3", "exponent is 3; use 0.1 to 1.5"),
        ("--exponent -1", "exponent is -1;"),
        ("--border -1", "border is -1; use 0 to 100"),
        ("--border nan", "border is NaN;"),
        ("--weights 0,1,1,1,1,1,1", "the first weight is 0; use more than 0"),
        ("--weights 1,1,1,1,1,1,2000", "a weight is 2000; use 0 to 1000"),
        ("--iterations 9999999999999", "iterations is 9999999999999; use at most 2^40"),
    ] {
        place.refuse(&format!("sampler {options} --out t.bin"), message);
    }
    place.refuse("measure --scenes . s.bin", "no tables of scenes");
    place.write("t.toml", sidecar.replace("size = 32", "size = 48"));
    place.refuse("measure --scenes . t.bin", "t.toml: size is 48;");
    std::fs::remove_file(place.path("t.toml")).unwrap();
    place.write("s.bin", [0; 8]);
    place.refuse("measure --scenes . s.bin", "its sha256 differs");
}

/// A small scene is read and measured; one that is cut short, or has what is no number, is refused.
#[test]
fn scenes_are_measured() {
    let place = Place::new();
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/tiles/nested_32.bin");
    let command = format!("measure --scenes . {}", table.display());
    let mut bytes = b"noisefloor-scene 8 8 4\n".to_vec();
    bytes.extend((0..8 * 8 * 16).flat_map(|i| ((i % 16) as f32).to_le_bytes()));
    place.write("ramp.table", &bytes);
    let text = place.succeed(&command);
    assert!(text.contains("Owen") && text.contains("ramp") && text.contains("sigma 2.1"), "{text}");
    place.write("cut.table", &bytes[..bytes.len() - 1]);
    place.refuse(&command, "cut.table is no table of a scene");
    std::fs::remove_file(place.path("cut.table")).unwrap();

    let points = |value: f32| {
        let values = (0..2 * 64).map(|i| if i == 5 { value } else { 0.25 });
        let mut bytes = b"noisefloor-points 1 1 64 2\n".to_vec();
        bytes.extend(values.flat_map(f32::to_le_bytes));
        bytes
    };
    place.write("p", points(0.75));
    place.succeed("measure --scenes . p");
    for (value, name) in [(f32::NAN, "NaN"), (7.0, "7"), (1.0, "1"), (-0.5, "-0.5")] {
        place.write("p", points(value));
        place.refuse("measure --scenes . p", &format!("p: point 3 has {name} as coordinate 2: "));
    }
    for (value, name) in [(f32::NAN, "NaN"), (f32::NEG_INFINITY, "-inf"), (2e30, "2000000")] {
        let end = bytes.len() - 4;
        bytes[end..].copy_from_slice(&value.to_le_bytes());
        place.write("ramp.table", &bytes);
        place.refuse(&command, &format!("ramp.table: value 1024 is {name}"));
    }
}
