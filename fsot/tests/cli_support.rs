//! Runs the program in a folder of its own.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use tempfile::TempDir;

/// A folder to run `fsot` in.
pub(crate) struct Place {
    folder: TempDir,
}

impl Place {
    pub(crate) fn new() -> Place {
        Place { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `fsot` with arguments separated by spaces.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fsot"));
        command.current_dir(self.folder.path()).args(arguments.split_whitespace()).stdin(Stdio::null());
        command
    }

    pub(crate) fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }

    pub(crate) fn start(&self, arguments: &str) -> Child {
        self.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    /// Runs, succeeds, and returns what was printed to standard output.
    pub(crate) fn succeed(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "fsot {arguments}\n{}", error(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs and fails with exit code 2, a sentence that contains `message`, no change of the folder and nothing on
    /// standard output.
    pub(crate) fn refuse(&self, arguments: &str, message: &str) {
        let before = self.state();
        let output = self.run(arguments);
        let error = error(&output);
        assert_eq!(output.status.code(), Some(2), "fsot {arguments}\n{error}");
        assert!(
            error.contains("error:") && error.contains(message),
            "fsot {arguments}\nexpected `{message}` in: {error}"
        );
        assert!(!error.contains("panicked"), "{error}");
        assert!(output.stdout.is_empty(), "fsot {arguments}");
        assert_eq!(self.state(), before, "fsot {arguments} left something");
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    /// The names of all files.
    pub(crate) fn names(&self) -> Vec<String> {
        self.state().into_iter().map(|(name, _)| name).collect()
    }

    /// All files, by name, with their content.
    fn state(&self) -> Vec<(String, Vec<u8>)> {
        let entries = fs::read_dir(self.folder.path()).unwrap().map(|entry| entry.unwrap());
        let mut files: Vec<_> = entries
            .map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap_or_default()))
            .collect();
        files.sort();
        files
    }
}

/// What was printed to standard error.
pub(crate) fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
