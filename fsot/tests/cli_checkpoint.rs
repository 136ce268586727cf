//! Checkpoints: the same bits after an interruption, and a sentence for every file that is none.

use fsot::checkpoint::{Problem, remove, resume, save};
use fsot::run::Optimization;
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};

/// Each step depends on the number of the step and on every bit of the state.
struct Walk {
    iteration: u64,
    coordinates: Vec<f32>,
}

const STEPS: u64 = 40;

impl Walk {
    fn new() -> Walk {
        Walk { iteration: 0, coordinates: vec![0.5; 7] }
    }
}

impl Optimization for Walk {
    fn iterations(&self) -> u64 {
        STEPS
    }

    fn iteration(&self) -> u64 {
        self.iteration
    }

    fn step(&mut self) -> f64 {
        let mut rng = fsot::random::stream(1, self.iteration, 0);
        self.coordinates.iter_mut().for_each(|x| *x = *x * 0.9 + rng.uniform_f32() * 0.1);
        self.iteration += 1;
        1.0 / self.iteration as f64
    }

    fn coordinates(&self) -> &[f32] {
        &self.coordinates
    }

    fn restore(&mut self, iteration: u64, coordinates: &[f32]) -> bool {
        if iteration > STEPS || coordinates.len() != self.coordinates.len() {
            return false;
        }
        self.iteration = iteration;
        self.coordinates.copy_from_slice(coordinates);
        true
    }
}

fn run(walk: &mut Walk, steps: u64) {
    for _ in 0..steps {
        walk.step();
    }
}

fn problem(points: u32) -> Problem {
    Problem::new(&json!({"command": "walk", "points": points, "options": {"seed": 1, "toroidal": false}})).unwrap()
}

/// The checkpoint of a walk that begins, and its bytes.
fn saved(folder: &Path) -> (PathBuf, Vec<u8>) {
    let path = folder.join("run.checkpoint");
    save(&path, &problem(7), &Walk::new()).unwrap();
    let bytes = fs::read(&path).unwrap();
    (path, bytes)
}

#[test]
fn resumes_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    let mut whole = Walk::new();
    run(&mut whole, STEPS);
    for stop in [0, 1, 17, STEPS] {
        let mut first = Walk::new();
        run(&mut first, stop);
        save(&path, &problem(7), &first).unwrap();
        let mut second = Walk::new();
        assert!(resume(&path, &problem(7), &mut second).unwrap());
        assert_eq!(second.iteration, stop);
        run(&mut second, STEPS - stop);
        assert_eq!(second.coordinates, whole.coordinates);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "only the checkpoint itself remains");
}

#[test]
fn a_missing_checkpoint_is_a_new_start() {
    let folder = tempfile::tempdir().unwrap();
    assert!(!resume(&folder.path().join("none"), &problem(7), &mut Walk::new()).unwrap());
}

#[test]
fn every_truncation_and_every_flipped_byte_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (path, good) = saved(folder.path());
    let refused = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let mut walk = Walk::new();
        let error = resume(&path, &problem(7), &mut walk).unwrap_err().to_string();
        assert_eq!((walk.iteration, walk.coordinates), (0, vec![0.5; 7]));
        assert!(error.contains("run.checkpoint: "), "{error}");
        error
    };
    for length in 0..good.len() {
        let error = refused(&good[..length]);
        let what = ["truncated", "damaged", "empty", "not a checkpoint"];
        assert!(what.iter().any(|what| error.contains(what)), "{length} bytes: {error}");
    }
    for index in 0..good.len() {
        let mut bytes = good.clone();
        bytes[index] ^= 1;
        refused(&bytes);
    }
    let longer = [good.as_slice(), b"x"].concat();
    assert!(refused(&longer).contains("damaged"));
    assert!(refused(b"\x89PNG\r\n and more").contains("not a checkpoint"));
}

#[test]
fn a_foreign_checkpoint_is_refused_with_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    save(&path, &problem(8), &Walk::new()).unwrap();
    let error = resume(&path, &problem(7), &mut Walk::new()).unwrap_err().to_string();
    assert!(error.contains("points: 8 there, 7 here"), "{error}");
    assert!(!error.contains("seed"), "{error}");

    // The same description, but a state of another shape.
    let mut other = Walk::new();
    other.coordinates.push(0.0);
    save(&path, &problem(7), &other).unwrap();
    let error = resume(&path, &problem(7), &mut Walk::new()).unwrap_err().to_string();
    assert!(error.contains("state"), "{error}");

    // What has no names.
    let [there, here] = [1, 2].map(|seed| Problem::new(&("walk", seed)).unwrap());
    save(&path, &there, &Walk::new()).unwrap();
    let error = resume(&path, &here, &mut Walk::new()).unwrap_err().to_string();
    assert!(error.ends_with(r#"it is of another problem (["walk",1] there, ["walk",2] here)"#), "{error}");
}

#[test]
fn what_could_not_be_continued_is_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    let (path, before) = saved(folder.path());
    let mut walk = Walk::new();
    run(&mut walk, STEPS + 1);
    let error = save(&path, &problem(7), &walk).unwrap_err().to_string();
    assert!(error.contains("step 41 of 40"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), before);
}

/// What other arithmetic began would end as bits that no program makes in one run.
#[test]
fn a_checkpoint_of_another_build_is_refused_and_stays() {
    let folder = tempfile::tempdir().unwrap();
    let (path, whole) = saved(folder.path());
    let (key, mut bytes) = (b"\"program\":\"", whole[..whole.len() - 32].to_vec());
    let at = bytes.windows(key.len()).position(|part| part == key).unwrap() + key.len();
    bytes[at] = if bytes[at] == b'0' { b'1' } else { b'0' };
    let checksum = fsot::digest::digest(&bytes);
    bytes.extend((0..32).map(|byte| u8::from_str_radix(&checksum[2 * byte..2 * byte + 2], 16).unwrap()));
    fs::write(&path, &bytes).unwrap();
    let error = resume(&path, &problem(7), &mut Walk::new()).unwrap_err().to_string();
    assert!(error.contains("another build"), "{error}");
    remove(&path, &problem(7));
    assert!(path.exists());
    fs::write(&path, &whole).unwrap();
    assert!(resume(&path, &problem(7), &mut Walk::new()).unwrap());
}

/// Single precision has many digits in double, which most readers of JSON miss by one.
#[test]
fn fractions_are_what_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    for hundredth in 1..100_u16 {
        let problem = Problem::new(&json!({"axis-priority": f32::from(hundredth) / 100.0})).unwrap();
        save(&path, &problem, &Walk::new()).unwrap();
        assert!(resume(&path, &problem, &mut Walk::new()).unwrap(), "{hundredth}");
        remove(&path, &problem);
        assert!(!path.exists(), "{hundredth}");
    }
}

#[test]
fn only_a_checkpoint_of_the_problem_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    remove(&path, &problem(7));
    fs::write(&path, "mine").unwrap();
    remove(&path, &problem(7));
    assert_eq!(fs::read(&path).unwrap(), b"mine");
    save(&path, &problem(8), &Walk::new()).unwrap();
    remove(&path, &problem(7));
    assert!(path.exists());
    remove(&path, &problem(8));
    assert!(!path.exists());
}

#[test]
fn the_fingerprint_does_not_depend_on_the_order_of_fields() {
    #[derive(serde::Serialize)]
    struct One {
        a: u32,
        b: f32,
    }
    #[derive(serde::Serialize)]
    struct Other {
        b: f32,
        a: u32,
    }
    let one = Problem::new(&One { a: 1, b: 0.5 }).unwrap();
    assert_eq!(one.fingerprint(), Problem::new(&Other { b: 0.5, a: 1 }).unwrap().fingerprint());
    assert_ne!(one.fingerprint(), Problem::new(&One { a: 2, b: 0.5 }).unwrap().fingerprint());
    assert_eq!(one.fingerprint().len(), 64);
}
