//! Readers of the program's output that have gone: no panic, and no run is lost.

#![cfg(unix)]

use crate::cli_support::{Place, error};
use std::fs::File;
use std::process::{Command, Output, Stdio};

const GONE: Option<i32> = Some(141);

/// A pipe that nobody reads.
fn unread() -> Stdio {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    writer.into()
}

fn output(mut command: Command) -> Output {
    let output = command.output().unwrap();
    assert!(!error(&output).contains("panicked"), "{command:?}: {}", error(&output));
    output
}

/// Runs with standard output, and then with standard error, unread, and returns the exit codes.
fn codes(place: &Place, arguments: &str) -> [Option<i32>; 2] {
    let mut first = place.command(arguments);
    first.stdout(unread());
    let mut second = place.command(arguments);
    second.stderr(unread());
    [first, second].map(|command| output(command).status.code())
}

#[test]
fn a_run_that_nobody_listens_to_stops_and_can_be_continued() {
    for (command, out) in [
        ("points -n 600 --iterations 3000", "p.txt"),
        ("tile --size 16 --spp 2 --iterations 1500 --integrands 1", "t.nft"),
    ] {
        let whole = Place::new();
        whole.succeed(&format!("{command} --out {out}"));

        let place = Place::new();
        let command = format!("{command} --out {out}");
        let checkpoint = format!("{out}.checkpoint");
        let mut unheard = place.command(&command);
        unheard.stderr(unread());
        assert_eq!(output(unheard).status.code(), GONE);
        assert_eq!(place.names(), [&checkpoint[..]]);

        let again = place.run(&command);
        assert!(error(&again).contains("continuing from"), "{}", error(&again));
        assert_eq!(place.read(out), whole.read(out));
        assert!(!place.names().contains(&checkpoint), "a finished run removes its checkpoint");
    }
}

#[test]
fn reports_that_nobody_reads() {
    let place = Place::new();
    let points = "points -n 10 --iterations 2";
    assert_eq!(codes(&place, &format!("{points} --out p.txt"))[0], GONE);
    assert_eq!(place.read("p.txt").iter().filter(|byte| **byte == b'\n').count(), 10);
    assert_eq!(codes(&place, &format!("{points} --out -")), [GONE, GONE]);
    let saved = place.names().into_iter().find(|name| name.starts_with("fsot-")).unwrap();
    std::fs::remove_file(place.path(&saved)).unwrap();
    place.succeed("tile --size 16 --iterations 1 --integrands 1 --quiet --out t.nft");
    place.succeed("tile --size 16 --iterations 2 --integrands 1 --quiet --out u.nft");
    for arguments in ["info", "info t.nft", "measure p.txt", "measure t.nft --json", "--help", "points --help", "-V"] {
        assert_eq!(codes(&place, arguments), [GONE, Some(0)], "{arguments}");
    }
    // A warning that nobody reads.
    place.write("u.toml", place.read("t.toml"));
    assert_eq!(codes(&place, "info u.nft"), [GONE, GONE]);
}

#[test]
fn errors_that_nobody_reads_keep_their_exit_code() {
    let place = Place::new();
    for arguments in ["", "blow", "points -n 0 --out p.txt", "points -n 5 --out missing/p.txt", "info none.nft"] {
        assert_eq!(codes(&place, arguments), [Some(2), Some(2)], "{arguments}");
    }
    assert!(place.names().is_empty());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_below_the_messages_stops_no_run() {
    let place = Place::new();
    let full = || File::options().write(true).open("/dev/full").unwrap();
    let mut command = place.command("points -n 10 --iterations 2 --out p.txt");
    command.stderr(full());
    assert_eq!(output(command).status.code(), Some(0));
    for arguments in ["points -n 10 --iterations 2 --out p.txt", "--version", "tile --help"] {
        let mut command = place.command(arguments);
        command.stdout(full());
        let output = output(command);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(error(&output).contains("standard output: No space left"), "{}", error(&output));
    }
    assert_eq!(place.names(), ["p.txt"]);
}
