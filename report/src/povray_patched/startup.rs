//! On a busy machine POV-Ray may give up before it begins, because its threads did not start in time. It is then run
//! again.

use anyhow::Result;
use std::process::ExitStatus;

/// How many times more.
const RETRIES: u32 = 3;
/// As POV-Ray says it on its standard error.
const TIMED_OUT: &str = "Timed out waiting for worker thread startup";

/// The first outcome of `run`, an exit status and the standard error, that is not POV-Ray's giving up; or its last one.
pub(crate) fn retry(what: &str, mut run: impl FnMut() -> Result<(ExitStatus, String)>) -> Result<(ExitStatus, String)> {
    for again in 1..=RETRIES {
        let (status, messages) = run()?;
        if status.success() || !messages.contains(TIMED_OUT) {
            return Ok((status, messages));
        }
        println!(
            "   {what}: POV-Ray's threads did not start in time: is the machine busy? Again, {again} of {RETRIES}"
        );
    }
    run()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::process::ExitStatusExt;

    /// How often POV-Ray runs if it says this first, and then nothing; and whether that is a success.
    fn runs(messages: &[&str]) -> (usize, bool) {
        let mut count = 0;
        let (status, _) = retry("scene", || {
            count += 1;
            let message = messages.get(count - 1).copied().unwrap_or_default();
            Ok((ExitStatus::from_raw(i32::from(!message.is_empty()) << 8), message.to_owned()))
        })
        .expect("nothing fails here");
        (count, status.success())
    }

    #[test]
    fn only_late_threads_are_waited_for_again() {
        let late = "povray: cannot start\nTimed out waiting for worker thread startup\n";
        assert_eq!(runs(&[]), (1, true));
        assert_eq!(runs(&["Parse Error"]), (1, false));
        assert_eq!(runs(&[late]), (2, true));
        assert_eq!(runs(&[late, "Parse Error"]), (2, false));
        assert_eq!(runs(&[late, late, late]), (4, true));
        assert_eq!(runs(&[late, late, late, late, late]), (4, false));
    }
}
