//! How much is measured.

/// How much is measured.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Size {
    Quick,
    Default,
    Full,
}

impl Size {
    /// `count` in a default run.
    pub(crate) fn of(self, count: usize) -> usize {
        match self {
            Self::Quick => (count / 40).max(1),
            Self::Default => count,
            Self::Full => 4 * count,
        }
    }
}
