//! Classes that want the same points to follow different targets, as the two of figure 5.5b want all of them to.

use crate::class::{Class, Filter};
use crate::random::{direction, stream};
use crate::target::Target;
use std::sync::Arc;

/// For each class, whether another one begins with the same points (threshold 0) and has another target. Classes
/// without weight do not count.
///
/// Slices of such classes go without the offset correction. It is there for points that come close to the means of
/// their bins: then it makes the mean force isotropic. Points between two targets never do, and the correction is the
/// larger the denser a target is where a point's bin lies, whatever weights the classes have.
pub(super) fn contested(classes: &[Class], filters: &[Filter], weights: &[f64]) -> Vec<bool> {
    let mut contested = vec![false; classes.len()];
    // Classes by the points that they begin with.
    let mut sets: Vec<Vec<usize>> = Vec::new();
    let (mut own, mut other) = (Vec::new(), Vec::new());
    for class in (0..classes.len()).filter(|&class| weights.get(class).is_some_and(|&weight| weight > 0.0)) {
        filters[class].select(0.0, &mut own);
        let found = sets.iter().position(|set| {
            filters[set[0]].members() == filters[class].members() && {
                filters[set[0]].select(0.0, &mut other);
                other == own
            }
        });
        match found {
            Some(set) => sets[set].push(class),
            None => sets.push(vec![class]),
        }
    }
    for set in sets {
        let first = &classes[set[0]].target;
        if set[1..].iter().any(|&class| differ(first, &classes[class].target, filters[class].members())) {
            set.into_iter().for_each(|class| contested[class] = true);
        }
    }
    contested
}

/// Whether the targets of so many points are further apart than a tenth of the distance between points. The same
/// density given twice, or at two resolutions, is one.
fn differ(a: &Arc<dyn Target>, b: &Arc<dyn Target>, points: usize) -> bool {
    const BINS: usize = 32;
    const DIRECTIONS: usize = 8;
    if Arc::ptr_eq(a, b) || (a.is_uniform() && b.is_uniform()) {
        return false;
    }
    let dims = a.dims();
    let mut rng = stream(0, 0, 0);
    let (mut density, mut scratch) = ([0.0; BINS], Vec::new());
    let mut squares = 0.0;
    for _ in 0..DIRECTIONS {
        let along: Vec<f32> = direction(dims, &mut rng).into_iter().map(|x| x as f32).collect();
        let (mut means, mut others) = ([0.0; BINS], [0.0; BINS]);
        a.bins(&along, &mut means, &mut density, &mut scratch);
        b.bins(&along, &mut others, &mut density, &mut scratch);
        squares += means.iter().zip(&others).map(|(a, b)| f64::from(a - b) * f64::from(a - b)).sum::<f64>();
    }
    // A direction shows one of so many parts of a squared distance.
    let apart = (squares * dims as f64 / (BINS * DIRECTIONS) as f64).sqrt();
    apart > 0.1 * libm::pow(points as f64, -1.0 / dims as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::class::{ClassCoordinates, ClassFunction, Step, ramp, three_colors, two_colors};
    use crate::optimize::{Optimizer, Problem, Quality};
    use crate::picture::Photo;
    use crate::run::Optimization;
    use crate::stipple::{Options, Stipple};
    use crate::target::{Function, uniform_bins};
    use noisefloor::rng::Rng;

    /// A uniform square in the middle of the domain.
    #[derive(Debug)]
    struct Square {
        side: f32,
        /// Whether offsets are corrected.
        corrects: bool,
    }

    impl Target for Square {
        fn dims(&self) -> usize {
            2
        }

        fn bins(&self, direction: &[f32], means: &mut [f32], density: &mut [f32], _: &mut Vec<f32>) {
            let mut extents = [0, 1].map(|k| self.side * direction[k].abs());
            let range = 4.0 / std::f32::consts::PI;
            uniform_bins(0.5 * (direction[0] + direction[1]), &mut extents, range, means, density);
            if !self.corrects {
                density.fill(1.0);
            }
        }

        fn sample(&self, rng: &mut Rng, point: &mut [f32]) {
            point.fill_with(|| 0.5 + self.side * (rng.uniform_f32() - 0.5));
        }
    }

    /// Figure 5.5b: one value for the points of a half, a third of it for the others.
    fn halves(targets: [Arc<dyn Target>; 2]) -> Vec<Class> {
        let class = |(half, target): (usize, Arc<dyn Target>)| {
            let value = |other: usize| if other == half { 1.0 } else { 1.0 / 3.0 };
            let steps = vec![Step { to: 0.5, value: value(0) }, Step { to: 1.0, value: value(1) }];
            Class { function: ClassFunction::Staircase(steps), target, weight: 1.0, name: half.to_string() }
        };
        targets.into_iter().enumerate().map(class).collect()
    }

    fn of(classes: &[Class], points: usize) -> Vec<bool> {
        let filter = |class: &Class| Filter::new(&class.function, &ClassCoordinates::Index, points);
        let filters: Vec<Filter> = classes.iter().map(filter).collect();
        let weights: Vec<f64> = classes.iter().map(|class| f64::from(class.weight)).collect();
        contested(classes, &filters, &weights)
    }

    #[test]
    fn the_same_points_and_different_targets() {
        for classes in [two_colors(2), three_colors(2), ramp(2)] {
            assert!(!of(&classes, 90).contains(&true));
        }
        // The same density twice, at two resolutions.
        let hill = |points| Arc::new(Function::new(2, points, |x| x[0] + 0.1).unwrap()) as Arc<dyn Target>;
        assert_eq!(of(&halves([hill(100), hill(4000)]), 1000), [false; 2]);
        let square = |side| Arc::new(Square { side, corrects: true }) as Arc<dyn Target>;
        assert_eq!(of(&halves([hill(100), square(0.3)]), 1000), [true; 2]);
        let mut three = halves([square(0.2), square(0.3)]);
        three.extend(two_colors(2).into_iter().take(1));
        assert_eq!(of(&three, 1000), [true, true, false]);
        three[0].weight = 0.0;
        assert_eq!(of(&three, 1000), [false; 3]);
    }

    /// All inks share points, but every set of them has one target.
    #[test]
    fn stippling_contests_nothing() {
        let photo = Photo::from_fn(16, 16, |x, y| [x as f32 / 16.0, y as f32 / 16.0, 0.3]);
        let stipple = Stipple::new(&photo, &Options { cmyk: true, ..Options::new(500) }).unwrap();
        assert!(stipple.problem.classes.len() > 3 && !of(&stipple.problem.classes, 500).contains(&true));
    }

    /// What (5.17) is near the end: the squared distances to the means of the bins.
    fn objective(seed: u64, corrects: bool) -> f64 {
        let square = |side| Arc::new(Square { side, corrects }) as Arc<dyn Target>;
        let classes = halves([square(0.1), square(0.8)]);
        let quality = Quality::Iterations(1500);
        let mut optimizer = Optimizer::new(Problem { classes, seed, quality, ..Problem::new(200, 2) }).unwrap();
        let energies: Vec<f64> = (0..1500).map(|_| optimizer.step()).collect();
        energies[1200..].iter().sum::<f64>() / 300.0
    }

    /// To the bit; with the correction, the objective ends at 2.3 times that without.
    #[test]
    fn no_target_outweighs_another() {
        for seed in 0..3 {
            let [own, plain] = [true, false].map(|corrects| objective(seed, corrects));
            assert_eq!(own, plain);
        }
    }
}
