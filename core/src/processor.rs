//! Long computations in steps, each compiled for the vector registers that a processor has.

/// A step: a function of its own, as compilers take more than twice as long for twice the code in one.
pub trait Step {
    /// What it returns.
    type Output;

    /// Runs it. Always inlined, and so compiled for the registers that its caller has.
    fn run(self) -> Self::Output;
}

/// Which registers steps are compiled for.
pub trait Processor {
    /// Runs a step in a function that is compiled for them.
    fn run<S: Step>(step: S) -> S::Output;
}

/// Every processor of the target: plain Rust.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

impl Processor for Portable {
    #[inline(never)]
    fn run<S: Step>(step: S) -> S::Output {
        step.run()
    }
}
