//! Object placement: things of several colours and sizes, spread evenly whichever of them one looks at (section 5.5.1,
//! figure 5.15).

mod draw;
mod object;

pub use draw::{colour_of, drawing};
pub use object::Object;

use crate::class::{Class, ClassCoordinates, ClassFunction, middle};
use crate::counted::counted;
use crate::error::{Error, Result};
use crate::optimize::{Problem, Quality};
use crate::points::Points;
use crate::random::{shuffle, stream};
use crate::target::image::{ImageTarget, spread};
use crate::target::{Target, Uniform};
use std::sync::Arc;

/// The most colours: each is a class.
pub const MAX_COLOURS: usize = 256;

/// What to place.
#[derive(Clone, Debug)]
pub struct Options {
    /// How many objects.
    pub points: usize,
    /// How many colours, 1 to [`MAX_COLOURS`], each with about as many objects as the others.
    pub colours: usize,
    /// Whether objects have sizes, evenly spread over [0, 1], so that the larger and the smaller ones of every size
    /// are spread evenly.
    pub sizes: bool,
    /// Where objects are wanted; the unit square if not given.
    pub map: Option<ImageTarget>,
    /// Chooses all random numbers.
    pub seed: u64,
    /// How long to optimise.
    pub quality: Quality,
}

/// Objects about to be placed.
#[derive(Debug)]
pub struct Placement {
    /// What to optimise.
    pub problem: Problem,
    /// Colour and size of each point.
    kinds: Vec<(usize, f32)>,
    extent: [f32; 2],
}

impl Placement {
    /// With colours, each colour is a class and all objects are one; with sizes, a falling and a rising ramp over the
    /// size are two.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] if there are no objects, fewer objects than colours, no colours or too many.
    pub fn new(options: &Options) -> Result<Placement> {
        let (points, colours) = (options.points, options.colours);
        if colours == 0 || colours > MAX_COLOURS {
            return Err(Error::Input(format!("{colours} colours: give 1 to {MAX_COLOURS}")));
        }
        if points < colours {
            return Err(Error::Input(format!(
                "{} cannot have {colours} colours: give at least one for each",
                counted(points, "object")
            )));
        }
        let mut kinds = Vec::with_capacity(points);
        let mut places = Vec::with_capacity(points);
        for colour in 0..colours {
            let count = points / colours + usize::from(colour < points % colours);
            for index in 0..count {
                let size = middle(index, count);
                kinds.push((colour, if options.sizes { size } else { 0.5 }));
                places.push([size, (colour as f32 + 0.5) / colours as f32]);
            }
        }
        let target: Arc<dyn Target> = match &options.map {
            Some(map) => Arc::new(map.clone()),
            None => Arc::new(Uniform::new(2)),
        };
        let initial = options.map.as_ref().map(|map| {
            let mut coordinates = spread(&[map], &[points], &mut stream(options.seed, u64::MAX - 1, 0));
            // The spread follows a curve: neighbours would otherwise be of one colour and size.
            shuffle(coordinates.as_chunks_mut::<2>().0, &mut stream(options.seed, u64::MAX - 1, 1));
            Points::new(2, coordinates)
        });
        let problem = Problem {
            classes: classes(options, &target),
            class_coordinates: ClassCoordinates::Plane(places),
            seed: options.seed,
            quality: options.quality,
            initial,
            ..Problem::new(points, 2)
        };
        let extent = options.map.as_ref().map_or([1.0; 2], ImageTarget::extent);
        Ok(Placement { problem, kinds, extent })
    }

    /// The objects at the points.
    pub fn objects(&self, points: &Points) -> Vec<Object> {
        let place = |(point, (color, size)): (&[f32], &(usize, f32))| Object {
            x: point[0],
            y: point[1],
            color: *color,
            size: *size,
        };
        points.iter().zip(&self.kinds).map(place).collect()
    }

    /// The rectangle from the origin that holds all objects.
    pub fn extent(&self) -> [f32; 2] {
        self.extent
    }
}

fn classes(options: &Options, target: &Arc<dyn Target>) -> Vec<Class> {
    let class = |name: String, weight, function| Class { function, target: Arc::clone(target), weight, name };
    let mut classes = Vec::new();
    if options.colours > 1 {
        let end = |colour: usize| colour as f32 / options.colours as f32;
        for colour in 0..options.colours {
            let function = ClassFunction::Rectangle { from: [0.0, end(colour)], to: [1.0, end(colour + 1)] };
            classes.push(class(format!("colour {colour}"), 1.0, function));
        }
    }
    if options.colours > 1 || !options.sizes {
        // One class against many: with equal weights all together would be far less even than each colour.
        classes.push(class("all".into(), (options.colours as f32).sqrt(), ClassFunction::Constant));
    }
    if options.sizes {
        classes.push(class("small".into(), 1.0, ClassFunction::Ramp { rising: false }));
        classes.push(class("large".into(), 1.0, ClassFunction::Ramp { rising: true }));
    }
    classes
}
