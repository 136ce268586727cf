//! A drawing: lines, words and grey pictures.

pub(super) use crate::picture::{BLACK, Colour};

pub(super) const GREY: Colour = [170, 170, 170];

/// A drawing, in pixels from the upper left.
#[derive(Clone, Debug)]
pub struct Sheet {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) elements: Vec<Element>,
}

#[derive(Clone, Debug)]
pub(super) enum Element {
    /// A polyline.
    Line { points: Vec<[f64; 2]>, colour: Colour, width: f64 },
    /// A word whose given point is the left end, the middle or the right end of its base line.
    Text { at: [f64; 2], anchor: Anchor, text: String, colour: Colour },
    /// A square grey picture.
    Picture { at: [f64; 2], size: f64, side: usize, grey: Vec<u8> },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Sheet {
    pub(super) fn new(width: u32, height: u32) -> Sheet {
        Sheet { width, height, elements: Vec::new() }
    }

    pub(super) fn line(&mut self, points: Vec<[f64; 2]>, colour: Colour, width: f64) {
        self.elements.push(Element::Line { points, colour, width });
    }

    pub(super) fn text(&mut self, at: [f64; 2], anchor: Anchor, text: impl Into<String>, colour: Colour) {
        self.elements.push(Element::Text { at, anchor, text: text.into(), colour });
    }
}
