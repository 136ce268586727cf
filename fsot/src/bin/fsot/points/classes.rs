//! To which class each point belongs.

use fsot::class::ClassFunction;
use fsot::export::points::Labels;
use fsot::optimize::Problem;

/// The class functions' values at every point.
pub(super) struct Classes {
    names: Vec<String>,
    /// Of each class, at each point.
    values: Vec<Vec<f32>>,
    /// Whether each class follows the uniform distribution.
    uniform: Vec<bool>,
    /// The points of a progressive set that are uniform: the first of them, by number.
    prefixes: Vec<usize>,
}

impl Classes {
    pub(super) fn of(problem: &Problem) -> Classes {
        let values = |function| -> Vec<f32> {
            (0..problem.points).map(|i| problem.class_coordinates.value(function, i, problem.points)).collect()
        };
        let prefixes = match problem.classes.as_slice() {
            [class] if class.target.is_uniform() && !matches!(class.function, ClassFunction::Constant) => {
                prefixes(&values(&class.function))
            }
            _ => Vec::new(),
        };
        Classes {
            names: problem.classes.iter().map(|class| class.name.clone()).collect(),
            values: problem.classes.iter().map(|class| values(&class.function)).collect(),
            uniform: problem.classes.iter().map(|class| class.target.is_uniform()).collect(),
            prefixes,
        }
    }

    /// The class in which a point counts most, of those the one with the fewest points; none if all points share one.
    pub(super) fn labels(&self) -> Option<Labels> {
        let sizes: Vec<f64> = self.values.iter().map(|values| values.iter().copied().map(f64::from).sum()).collect();
        let points = self.values.first().map_or(0, Vec::len);
        let best = |point: usize| -> usize {
            let order = |a: &usize, b: &usize| {
                self.values[*a][point]
                    .total_cmp(&self.values[*b][point])
                    .then(sizes[*b].total_cmp(&sizes[*a]))
                    .then(b.cmp(a))
            };
            (0..self.values.len()).max_by(order).unwrap_or(0)
        };
        let labels = Labels::from_names((0..points).map(|point| word(&self.names[best(point)])));
        (labels.names.len() > 1).then_some(labels)
    }

    /// Whether all points together shall be uniform: every class that holds them all, or every class if none does.
    pub(super) fn all_uniform(&self) -> bool {
        let all = |values: &Vec<f32>| values.iter().all(|value| *value > 0.0);
        let whole = self.values.iter().any(all);
        self.values.iter().zip(&self.uniform).all(|(values, uniform)| *uniform || (whole && !all(values)))
    }

    /// Uniform classes that hold some points but not all: name, and whether each point belongs.
    pub(super) fn parts(&self) -> impl Iterator<Item = (&str, &[f32])> {
        let part = |values: &[f32]| values.iter().any(|value| *value > 0.0) && values.iter().any(|value| *value <= 0.0);
        self.names
            .iter()
            .zip(&self.values)
            .zip(&self.uniform)
            .filter(move |((_, values), uniform)| **uniform && part(values))
            .map(|((name, values), _)| (&name[..], &values[..]))
    }

    /// Numbers of points, ascending, whose first points are a subclass.
    pub(super) fn prefixes(&self) -> &[usize] {
        &self.prefixes
    }
}

/// Where a falling function falls; none if it rises somewhere.
fn prefixes(values: &[f32]) -> Vec<usize> {
    if values.windows(2).any(|pair| pair[0] < pair[1]) {
        return Vec::new();
    }
    let falls = values.windows(2).zip(1..).filter(|(pair, _)| pair[0] > pair[1]).map(|(_, end)| end);
    falls.chain(values.last().filter(|value| **value > 0.0).map(|_| values.len())).collect()
}

/// A class's name in a file of points.
fn word(name: &str) -> String {
    let name: String =
        name.chars().map(|c| if c.is_whitespace() || c.is_control() || c == '#' { '_' } else { c }).collect();
    if name.is_empty() { "_".to_owned() } else { name }
}
