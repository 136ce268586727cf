//! An interrupted run, continued, gives the bytes of one that was not.

#![cfg(unix)]

use crate::cli_support::{Place, error};
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The longest that anything here may take on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);

fn signal(name: &str, process: u32) {
    Command::new("sh").args(["-c", &format!("kill -{name} {process}")]).status().unwrap();
}

/// Starts a run, waits for a checkpoint that was not there before, and sends a signal. Returns the exit code (none if
/// killed) and what was printed to standard error.
fn interrupt(place: &Place, command: &str, checkpoint: &str, name: &str) -> (Option<i32>, String) {
    let path = place.path(checkpoint);
    let before = std::fs::read(&path).ok();
    let mut child = place.start(command);
    let start = Instant::now();
    loop {
        let now = std::fs::read(&path).ok();
        if now.is_some() && now != before || child.try_wait().unwrap().is_some() {
            break;
        }
        assert!(start.elapsed() < PATIENCE, "no checkpoint was written: {command}");
        sleep(Duration::from_millis(2));
    }
    signal(name, child.id());
    let output = child.wait_with_output().unwrap();
    (output.status.code(), error(&output))
}

fn interrupted_run_equals_whole(command: &str) {
    let whole = Place::new();
    whole.succeed(&format!("{command} --threads 1"));
    let expected = whole.read("out");

    let place = Place::new();
    let often = format!("{command} --threads 1 --checkpoint-every 0.02");
    for name in ["INT", "TERM"] {
        let (code, message) = interrupt(&place, &often, "out.checkpoint", name);
        assert_eq!(code, Some(130), "{message}");
        assert!(message.contains("Run the same command again") && message.contains("out.checkpoint"), "{message}");
        assert_eq!(place.names(), ["out.checkpoint"]);
    }

    // Killed outright: the last periodic checkpoint counts.
    let (code, message) = interrupt(&place, &often, "out.checkpoint", "KILL");
    assert_eq!(code, None, "{message}");

    // Another problem's, and another command's.
    place.refuse(
        &format!("{command} --seed 9"),
        "seed: 1 there, 9 here). Remove it to start anew, or name another with --checkpoint",
    );
    place.refuse("place -n 9 --out o.csv --checkpoint out.checkpoint", "there, \"place\" here");

    // With other threads than before.
    let output = place.run(&format!("{command} --threads 3"));
    assert!(output.status.success(), "{}", error(&output));
    assert!(error(&output).contains("continuing from out.checkpoint"), "{}", error(&output));
    assert_eq!(place.read("out"), expected, "the continued run gave other bytes");
    assert!(!place.names().contains(&"out.checkpoint".to_owned()), "a finished run removes its checkpoint");
}

#[test]
fn points() {
    interrupted_run_equals_whole("points -n 600 --classes 2color --axis-priority .23 --iterations 6000 --out out");
}

#[test]
fn tile() {
    interrupted_run_equals_whole("tile --size 16 --spp 2 --iterations 3000 --integrands 1 --out out");
}

/// Its last step is the longest part of a run of few: Ctrl-C there is one like any other.
#[test]
fn in_the_last_step() {
    let place = Place::new();
    let command = "points -n 400000 -d 4 --iterations 2 --checkpoint-every 0 --out out";
    place.succeed(&format!("{command} --quiet"));
    let expected = place.read("out");
    std::fs::remove_file(place.path("out")).unwrap();

    let (code, message) = interrupt(&place, command, "out.checkpoint", "KILL");
    assert_eq!(code, None, "{message}");
    let mut child = place.start(command);
    let (mut line, mut said) = (String::new(), BufReader::new(child.stderr.take().unwrap()));
    said.read_line(&mut line).unwrap();
    assert!(line.ends_with("at step 1\n"), "{line}");
    // The step begins after the line, and takes longer than this: a quarter of a second.
    sleep(Duration::from_millis(100));
    signal("INT", child.id());
    said.read_to_string(&mut line).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{line}");
    assert!(line.contains("stopped at step 2 of 2"), "{line}");
    assert_eq!(place.names(), ["out.checkpoint"]);

    place.succeed(&format!("{command} --quiet"));
    assert!(place.read("out") == expected);
    assert_eq!(place.names(), ["out"]);
}

#[test]
fn a_run_that_ends_leaves_the_state_of_others() {
    let place = Place::new();
    let long = "points -n 600 --iterations 1000000 --threads 1 --checkpoint-every 0.02 --checkpoint state --out";
    let (code, message) = interrupt(&place, &format!("{long} p.txt"), "state", "INT");
    assert_eq!(code, Some(130), "{message}");
    let saved = place.read("state");

    // Saved under the same name after the other run began, which waits for whoever reads its output.
    assert!(Command::new("mkfifo").arg(place.path("fifo")).status().unwrap().success());
    let mut other = place.start("points -n 9 --iterations 2 --checkpoint late --out fifo");
    let mut line = String::new();
    let mut said = BufReader::new(other.stderr.take().unwrap());
    said.read_line(&mut line).unwrap();
    assert!(line.starts_with("2 steps"), "{line}");
    place.write("late", &saved);
    let points = std::fs::read_to_string(place.path("fifo")).unwrap();
    assert!(other.wait().unwrap().success());
    assert_eq!(points.lines().count(), 9);
    assert!(place.read("late") == saved);
}

/// As `nohup` has it.
#[test]
fn a_hangup_that_is_ignored_stays_so() {
    let place = Place::new();
    let command = "points -n 600 --iterations 1000000 --checkpoint-every 0.02 --checkpoint state --out p.txt";
    let script = format!("trap '' HUP; exec '{}' {command} 2>log", env!("CARGO_BIN_EXE_fsot"));
    let mut child = Command::new("sh").args(["-c", &script]).current_dir(place.path("")).spawn().unwrap();
    let saves = |child: &mut Child| {
        while !place.path("state").exists() {
            assert!(child.try_wait().unwrap().is_none());
            sleep(Duration::from_millis(2));
        }
    };
    saves(&mut child);
    signal("HUP", child.id());
    std::fs::remove_file(place.path("state")).unwrap();
    saves(&mut child);
    signal("TERM", child.id());
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn runs_to_standard_output_have_states_of_their_own() {
    let place = Place::new();
    let states = || place.names().into_iter().filter(|name| name.ends_with(".checkpoint")).collect::<Vec<_>>();
    let long = "points -n 600 --iterations 1000000 --threads 1 --checkpoint-every 0.02 --out -";
    let mut child = place.start(long);
    while states().is_empty() {
        assert!(child.try_wait().unwrap().is_none());
        sleep(Duration::from_millis(2));
    }
    place.succeed("points -n 9 --iterations 2 --checkpoint-every 0 --out -");
    signal("INT", child.id());
    let said = error(&child.wait_with_output().unwrap());
    assert_eq!(states().len(), 1);
    assert!(said.contains(&states()[0]), "{said}");
    let (_, said) = interrupt(&place, long, &states()[0], "INT");
    assert!(said.contains("continuing from fsot-"), "{said}");
}

#[test]
fn another_number_of_steps_is_named() {
    let place = Place::new();
    let (code, message) = interrupt(
        &place,
        "points -n 600 --iterations 1000000 --checkpoint-every 0.02 --out out",
        "out.checkpoint",
        "INT",
    );
    assert_eq!(code, Some(130), "{message}");
    place.refuse("points -n 600 --iterations 1 --out out", r#"quality: "1000000 steps" there, "1 step" here"#);
    place.refuse("points -n 600 --out out", r#"quality: "1000000 steps" there, "standard" here"#);
}

/// In a folder where nobody can write.
#[cfg(target_os = "linux")]
#[test]
fn standard_output_needs_no_place_for_a_checkpoint() {
    let output = Place::new().command("points -n 9 --iterations 2 --out -").current_dir("/proc").output().unwrap();
    let said = error(&output);
    assert!(output.status.success() && output.stdout.iter().filter(|byte| **byte == b'\n').count() == 9, "{said}");
    assert!(said.contains("warning: no checkpoint can be saved: cannot write fsot-"), "{said}");
    let named = "points -n 9 --iterations 2 --out - --checkpoint /proc/c";
    let output = Place::new().run(named);
    assert_eq!(output.status.code(), Some(2), "{named}");
    assert!(error(&output).starts_with("error: cannot write /proc/c: "), "{}", error(&output));
}

#[cfg(target_os = "linux")]
#[test]
fn a_finished_run_outlives_a_full_disk() {
    let place = Place::new();
    let command = "points -n 64 --iterations 20 --checkpoint-every 0";
    place.succeed(&format!("{command} --out p.txt"));
    let expected = place.read("p.txt");

    let output = place.run(&format!("{command} --out /dev/full --checkpoint state"));
    let said = error(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    let saved = "/dev/full: No space left on device (os error 28). The finished run is saved in state: run the same";
    assert!(said.contains(saved), "{said}");
    std::fs::remove_file(place.path("p.txt")).unwrap();
    let again = place.run(&format!("{command} --out p.txt --checkpoint state"));
    assert!(again.status.success() && error(&again).contains("continuing from state at step 20"), "{}", error(&again));
    assert!(place.read("p.txt") == expected);
    assert_eq!(place.names(), ["p.txt"]);
}

#[test]
fn a_finished_run_outlives_its_folder() {
    let place = Place::new();
    let [folder, temporary] = ["folder", "temporary"].map(|name| {
        std::fs::create_dir(place.path(name)).unwrap();
        place.path(name)
    });
    let command = "points -n 600 --iterations 4000 --checkpoint-every 0.02 --out folder/p.txt";
    let mut child = place.command(command).env("TMPDIR", &temporary).stderr(Stdio::piped()).spawn().unwrap();
    while !folder.join("p.txt.checkpoint").exists() {
        assert!(child.try_wait().unwrap().is_none());
        sleep(Duration::from_millis(2));
    }
    std::fs::remove_dir_all(&folder).unwrap();
    let output = child.wait_with_output().unwrap();
    let said = error(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    let saved: Vec<_> = std::fs::read_dir(&temporary).unwrap().map(|entry| entry.unwrap().path()).collect();
    let [saved] = &saved[..] else { panic!("{saved:?}\n{said}") };
    assert!(said.contains(&format!("run the same command again with --checkpoint {}", saved.display())), "{said}");
    std::fs::create_dir(&folder).unwrap();
    let again = place.run(&format!("{command} --checkpoint {}", saved.display()));
    assert!(again.status.success() && error(&again).contains("at step 4000"), "{}", error(&again));
    assert!(!saved.exists() && folder.join("p.txt").exists());
}
