//! To which class each point belongs.

use fsot::class::{Class, ClassFunction};
use fsot::counted::counted;
use fsot::error::{Error, Result};
use fsot::export::points::Labels;
use fsot::optimize::Problem;

/// The class functions at every point: evaluated when they are asked for, since all values of many classes may take
/// more memory than the optimisation.
pub(super) struct Classes {
    problem: Problem,
    /// The sum of each class's values.
    sums: Vec<f64>,
    /// How many points each class holds.
    members: Vec<usize>,
    /// The points of a progressive set that are uniform: the first of them, by number.
    prefixes: Vec<usize>,
}

impl Classes {
    pub(super) fn of(problem: &Problem) -> Classes {
        let mut classes =
            Classes { problem: problem.clone(), sums: Vec::new(), members: Vec::new(), prefixes: Vec::new() };
        for class in &problem.classes {
            let (mut sum, mut members) = (0.0, 0);
            for value in classes.values(class) {
                sum += f64::from(value);
                members += usize::from(value > 0.0);
            }
            classes.sums.push(sum);
            classes.members.push(members);
        }
        if let [class] = problem.classes.as_slice()
            && class.target.is_uniform()
            && !matches!(class.function, ClassFunction::Constant)
        {
            classes.prefixes = prefixes(classes.values(class));
        }
        classes
    }

    fn value(&self, class: &Class, point: usize) -> f32 {
        self.problem.class_coordinates.value(&class.function, point, self.problem.points)
    }

    fn values(&self, class: &Class) -> impl Iterator<Item = f32> {
        (0..self.problem.points).map(move |point| self.value(class, point))
    }

    /// Whether a class, by its index, holds a point.
    pub(super) fn holds(&self, class: usize, point: usize) -> bool {
        self.value(&self.problem.classes[class], point) > 0.0
    }

    /// Fails if a class has no point, or a point no class that moves it: who wrote the classes meant others.
    pub(super) fn check(&self) -> Result<()> {
        let points = self.problem.points;
        let classes = &self.problem.classes;
        if let Some((class, _)) = classes.iter().zip(&self.members).find(|(_, members)| **members == 0) {
            return Err(Error::Input(format!(
                "class {:?} has none of {}: give it a longer part of the index, or ask for more points",
                class.name,
                counted(points, "point")
            )));
        }
        let is_free = |point: &usize| {
            let mut moving = classes.iter().filter(|class| class.weight > 0.0);
            moving.all(|class| self.value(class, *point) <= 0.0)
        };
        let mut free = (0..points).filter(is_free);
        let Some(first) = free.next() else { return Ok(()) };
        Err(Error::Input(format!(
            "no class of a weight above 0 has {} of {points}, from index {:.4} on: what no class has is never moved",
            counted(1 + free.count(), "point"),
            (first as f64 + 0.5) / points as f64
        )))
    }

    /// The class in which a point counts most, of those the one with the fewest points; none if all points share one.
    pub(super) fn labels(&self) -> Option<Labels> {
        let classes = &self.problem.classes;
        let order = |(a, a_value): &(usize, f32), (b, b_value): &(usize, f32)| {
            a_value.total_cmp(b_value).then(self.sums[*b].total_cmp(&self.sums[*a])).then(b.cmp(a))
        };
        let best = |point: usize| {
            let values = classes.iter().map(|class| self.value(class, point)).enumerate();
            values.max_by(order).map_or(0, |(class, _)| class)
        };
        let labels = Labels::from_names((0..self.problem.points).map(|point| classes[best(point)].name.clone()));
        (labels.names.len() > 1).then_some(labels)
    }

    /// Whether all points together shall be uniform: every class that holds them all, or every class if none does.
    pub(super) fn all_uniform(&self) -> bool {
        let all = |members: usize| members == self.problem.points;
        let whole = self.members.iter().any(|members| all(*members));
        let mut classes = self.problem.classes.iter().zip(&self.members);
        classes.all(|(class, members)| class.target.is_uniform() || (whole && !all(*members)))
    }

    /// Uniform classes that hold some points but not all: name, and index.
    pub(super) fn parts(&self) -> impl Iterator<Item = (&str, usize)> {
        let part = |members: usize| members > 0 && members < self.problem.points;
        let classes = self.problem.classes.iter().zip(&self.members).enumerate();
        classes
            .filter(move |(_, (class, members))| class.target.is_uniform() && part(**members))
            .map(|(number, (class, _))| (&class.name[..], number))
    }

    /// Numbers of points, ascending, whose first points are a subclass.
    pub(super) fn prefixes(&self) -> &[usize] {
        &self.prefixes
    }
}

/// Where a falling function falls; none if it rises somewhere.
fn prefixes(values: impl Iterator<Item = f32>) -> Vec<usize> {
    let (mut falls, mut last, mut count) = (Vec::new(), f32::INFINITY, 0);
    for value in values {
        if value > last {
            return Vec::new();
        }
        if value < last && count > 0 {
            falls.push(count);
        }
        (last, count) = (value, count + 1);
    }
    if last > 0.0 {
        falls.push(count);
    }
    falls
}
