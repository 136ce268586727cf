//! What a program needs to drive an optimisation: steps, energy, a state to save.

/// An optimisation that runs step by step.
///
/// Its whole state is the number of steps done and what [`coordinates`](Optimization::coordinates) has: an optimisation
/// made from the same problem, given both by [`restore`](Optimization::restore), continues with the same bits.
pub trait Optimization {
    /// The steps that it will take in all.
    fn iterations(&self) -> u64;

    /// The steps that it has taken.
    fn iteration(&self) -> u64;

    /// Takes one step, on the threads of the current rayon pool. Returns what is being minimised, before the step.
    /// After the last one there is nothing to gain, and no [checkpoint](crate::checkpoint::save).
    fn step(&mut self) -> f64;

    /// Takes all steps that remain.
    fn run(&mut self) {
        while self.iteration() < self.iterations() {
            self.step();
        }
    }

    /// Takes a step, or a part of one where steps take long; returns what [`step`](Optimization::step) does if the step
    /// ends with it. Until then the state is that before the step: what is saved meanwhile continues there.
    fn advance(&mut self) -> Option<f64> {
        Some(self.step())
    }

    /// The work that is done, and all of it, in any unit: by default steps, if these take alike long.
    fn work(&self) -> [f64; 2] {
        [self.iteration(), self.iterations()].map(|steps| steps as f64)
    }

    /// The state: coordinates, and what else a sampler remembers.
    fn coordinates(&self) -> &[f32];

    /// Continues from a saved state. Returns false, and changes nothing, if the state is not one of this problem's
    /// (wrong number of coordinates, not finite, beyond the last step).
    fn restore(&mut self, iteration: u64, coordinates: &[f32]) -> bool;
}
