//! Drawings: marks on paper.

/// A red, green and blue value, 0 to 255 each, in the sRGB encoding.
pub type Colour = [u8; 3];

/// White paper.
pub const WHITE: Colour = [255; 3];
/// Black ink.
pub const BLACK: Colour = [0; 3];

/// A filled shape: x to the right, y downwards, in the units of its drawing.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A disc.
    Disc {
        /// Its centre.
        centre: [f32; 2],
        /// Its radius.
        radius: f32,
    },
    /// A convex polygon, by its corners in order.
    Polygon(Vec<[f32; 2]>),
}

/// A shape and its colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// What is drawn.
    pub shape: Shape,
    /// With what.
    pub colour: Colour,
}

/// How a mark changes what it covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Blend {
    /// It hides it.
    #[default]
    Over,
    /// Their values, 0 to 1, are multiplied: transparent inks.
    Multiply,
}

/// Marks on a rectangle of paper, drawn one after the other.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Width and height.
    pub size: [f32; 2],
    /// The paper.
    pub paper: Colour,
    /// What marks do to what is below them.
    pub blend: Blend,
    /// Whether a partly covered pixel is the mean of light, rather than of encoded values as other programs compute it.
    pub linear: bool,
    /// In the order in which they are drawn.
    pub marks: Vec<Mark>,
}

impl Drawing {
    /// White paper without marks.
    pub fn new(size: [f32; 2]) -> Drawing {
        Drawing { size, paper: WHITE, blend: Blend::Over, linear: false, marks: Vec::new() }
    }

    /// Draws a disc for each of the points, which have two coordinates (more are not looked at).
    pub fn dots<'a>(&mut self, points: impl IntoIterator<Item = &'a [f32]>, radius: f32, colour: Colour) {
        let centres = points.into_iter().filter_map(|point| point.first_chunk());
        self.marks.extend(centres.map(|&centre| Mark { shape: Shape::Disc { centre, radius }, colour }));
    }
}
