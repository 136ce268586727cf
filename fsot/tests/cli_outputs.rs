//! Outputs beside killed runs, other runs at the same time, and links.

#![cfg(unix)]

use crate::cli_support::{Place, error};
use fsot::export::nft::TileFile;
use fsot::export::sidecar::{self, Sidecar};
use fsot::output::Outputs;
use std::fs;
use std::os::unix::fs::symlink;
use std::sync::Barrier;
use std::time::Duration;

/// Names of temporary files.
fn temporary(place: &Place) -> Vec<String> {
    place.names().into_iter().filter(|name| name.starts_with(".fsot-")).collect()
}

/// Kills runs in the middle of a write, until one leaves a temporary file.
fn kill_until_one_is_left(place: &Place, command: &str) -> String {
    for _ in 0..200 {
        let mut child = place.start(command);
        while temporary(place).is_empty() && child.try_wait().unwrap().is_none() {}
        child.kill().unwrap();
        child.wait().unwrap();
        if let Some(name) = temporary(place).pop() {
            return name;
        }
    }
    panic!("no kill left a temporary file: {command}");
}

#[test]
fn what_a_killed_run_leaves_is_removed_by_the_next() {
    for (command, small, out) in [
        ("points -n 20000 --iterations 90000 --checkpoint-every 0", "points -n 9 --iterations 2", "p.txt"),
        (
            "tile --size 64 --spp 16 --iterations 90000 --checkpoint-every 0",
            "tile --size 16 --iterations 1 --integrands 1",
            "t.nft",
        ),
    ] {
        let place = Place::new();
        let left = kill_until_one_is_left(&place, &format!("{command} --quiet --out {out}"));
        // Not of this output, not of fsot, and no files.
        let alike = |letters: &str| format!("{}{letters}", &left[..left.len() - letters.len()]);
        let others = [".fsot-", ".fsot-4APIMD", ".fsot-0123456789abcdef-Ab1Cd2", &format!("{left}x"), &left[..20]];
        others.iter().for_each(|name| place.write(name, "mine"));
        fs::create_dir(place.path(&alike("folder"))).unwrap();
        place.write("mine", "mine");
        symlink("mine", place.path(&alike("a_link"))).unwrap();

        fs::remove_file(place.path(&format!("{out}.checkpoint"))).ok();
        place.succeed(&format!("{small} --quiet --out other-{out}"));
        assert!(place.names().contains(&left), "another output's run removed it");
        place.succeed(&format!("{small} --quiet --out {out}"));
        assert!(!place.names().contains(&left), "{:?}", place.names());
        for name in others.iter().chain(&["mine"]) {
            assert_eq!(place.read(name), b"mine", "{name}");
        }
        assert!(place.path(&alike("folder")).is_dir() && place.path(&alike("a_link")).is_symlink());
    }
}

#[test]
fn temporary_files_of_a_run_that_lives_stay() {
    let place = Place::new();
    let mut outputs = Outputs::new();
    outputs.add(&place.path("p.txt"), b"whole").unwrap();
    let names = temporary(&place);
    assert_eq!(names.len(), 1);
    place.succeed("points -n 9 --iterations 2 --out p.txt");
    assert_eq!(temporary(&place), names);
    outputs.commit().unwrap();
    assert_eq!(place.read("p.txt"), b"whole");
    assert_eq!(place.names(), ["p.txt"]);
}

#[test]
fn a_name_as_long_as_there_can_be() {
    let place = Place::new();
    let out = format!("{}.txt", "n".repeat(240));
    place.succeed(&format!("points -n 9 --iterations 2 --checkpoint c --out {out}"));
    assert_eq!(place.names(), [out]);
}

#[test]
fn runs_with_the_same_outputs_do_not_mix() {
    let place = Place::new();
    let barrier = Barrier::new(2);
    for _ in 0..60 {
        std::thread::scope(|scope| {
            for content in [b"first", b"other"] {
                let (place, barrier) = (&place, &barrier);
                scope.spawn(move || {
                    let mut outputs = Outputs::new();
                    ["a", "b", "c", "d"].iter().for_each(|name| outputs.add(&place.path(name), content).unwrap());
                    barrier.wait();
                    outputs.commit().unwrap();
                });
            }
        });
        assert!(["b", "c", "d"].iter().all(|name| place.read(name) == place.read("a")));
    }
    assert_eq!(place.names(), ["a", "b", "c", "d"]);
}

#[test]
fn tiles_made_at_once_under_one_name_are_one_of_them() {
    let place = Place::new();
    for _ in 0..3 {
        let start = |seed| {
            place.start(&format!("tile --size 16 --iterations 2 --integrands 1 --quiet --seed {seed} --out t.nft"))
        };
        for child in [1, 2, 3, 4].map(start) {
            let output = child.wait_with_output().unwrap();
            assert!(output.status.success(), "{}", error(&output));
        }
        let tile = TileFile::read(&place.path("t.nft")).unwrap();
        assert!(sidecar::read::<Sidecar>(&place.path("t.nft")).unwrap().unwrap().describes(tile.bytes()));
        assert_eq!(place.names(), ["t.nft", "t.toml"]);
    }
}

#[test]
fn a_link_to_what_does_not_exist_is_followed() {
    let place = Place::new();
    fs::create_dir(place.path("folder")).unwrap();
    let points = "points -n 9 --iterations 2 --quiet --out";
    symlink("folder/p.txt", place.path("link")).unwrap();
    symlink("../link", place.path("folder/second")).unwrap();
    place.succeed(&format!("{points} folder/second"));
    assert_eq!(place.read("folder/p.txt").iter().filter(|byte| **byte == b'\n').count(), 9);
    assert!(place.path("link").is_symlink() && place.path("folder/second").is_symlink());

    symlink("missing/p.txt", place.path("lost")).unwrap();
    place.refuse(&format!("{points} lost"), "cannot write lost: the folder missing does not exist");
    symlink("b", place.path("a")).unwrap();
    symlink("a", place.path("b")).unwrap();
    place.refuse(&format!("{points} a"), "cannot write a: it is a link that leads nowhere; remove it");
    assert!(["lost", "a", "b"].iter().all(|name| place.path(name).is_symlink()));

    // An input by another name.
    image::GrayImage::from_pixel(9, 9, image::Luma([90])).save(place.path("in.png")).unwrap();
    symlink("in.png", place.path("same.png")).unwrap();
    place.refuse("stipple in.png -n 9 -o same.png", "same.png is an input");
    place.refuse("stipple same.png -n 9 -o in.png", "in.png is an input");

    // One file by two names.
    symlink("same.txt", place.path("name")).unwrap();
    place.refuse(&format!("{points} same.txt --svg name"), "twice");
    // The state of a run is a file like any other.
    symlink("state", place.path("p.checkpoint")).unwrap();
    place.succeed(&format!("{points} p"));
    assert!(place.path("p.checkpoint").is_symlink() && !place.path("state").exists());
}

/// A report may take more memory than there is, and long: the points are there before.
#[test]
fn points_are_in_place_before_their_report() {
    let place = Place::new();
    let mut child = place.start("points -n 400000 --iterations 1 --out p.txt");
    while !place.path("p.txt").exists() {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(100));
    child.kill().unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
}

/// Of a large drawing, how alike the picture is takes the more of both.
#[test]
fn drawings_are_in_place_before_their_report() {
    let place = Place::new();
    image::GrayImage::from_fn(9, 9, |x, _| image::Luma([20 * x as u8])).save(place.path("in.png")).unwrap();
    for (input, out) in [("in.png -n 50", "s.png"), ("--frames in.png --window 50 --step 5", "f.png")] {
        let mut child = place.start(&format!("stipple {input} --iterations 1 --size 3000 --threads 1 --out {out}"));
        while !place.path(out).exists() {
            assert!(child.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(5));
        }
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}
