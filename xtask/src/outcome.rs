//! What became of a step of the tests.

/// What a step that did not fail says.
pub enum Outcome {
    Passed,
    /// Why it could not run.
    NotRun(String),
}

/// The exit status of a program that is a step and cannot run here.
pub const NOT_RUN: u8 = 77;
