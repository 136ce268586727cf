//! Objects as trees.

use super::object::Object;
use crate::picture::{Colour, Drawing, Mark, Shape};

/// What trees stand on.
const GROUND: Colour = [232, 236, 214];
const TRUNK: Colour = [92, 66, 44];
/// From red to green.
const AUTUMN: [Colour; 4] = [[178, 34, 34], [228, 120, 28], [222, 190, 50], [48, 128, 60]];

/// The colour of number `color` of `colours`, from red to green.
pub fn colour_of(color: usize, colours: usize) -> Colour {
    shade(if colours < 2 { 1.0 } else { color as f32 / (colours - 1) as f32 })
}

fn shade(at: f32) -> Colour {
    let position = at.clamp(0.0, 1.0) * (AUTUMN.len() - 1) as f32;
    let left = (position as usize).min(AUTUMN.len() - 2);
    mix(AUTUMN[left], AUTUMN[left + 1], position - left as f32)
}

fn mix(a: Colour, b: Colour, part: f32) -> Colour {
    std::array::from_fn(|k| (f32::from(a[k]) + part * (f32::from(b[k]) - f32::from(a[k])) + 0.5) as u8)
}

/// A tree for every object, the nearer ones, further down, in front of the others; its trunk ends at the object's
/// place. A single colour shows the size: small trees are red, large ones green.
pub fn drawing(objects: &[Object], colours: usize, extent: [f32; 2]) -> Drawing {
    let spacing = (extent[0] * extent[1] / objects.len().max(1) as f32).sqrt();
    let tallest = 2.0 * spacing;
    let sized = objects.iter().any(|object| object.size != 0.5);
    let margin = 0.5 * spacing;
    let mut drawing = Drawing::new([extent[0] + 2.0 * margin, extent[1] + tallest + margin]);
    drawing.paper = GROUND;
    let mut order: Vec<&Object> = objects.iter().collect();
    order.sort_by(|a, b| a.y.total_cmp(&b.y));
    for object in order {
        let colour = if colours < 2 && sized { shade(object.size) } else { colour_of(object.color, colours) };
        let height = if sized { (0.5 + 1.5 * object.size) * spacing } else { 1.4 * spacing };
        let (x, y) = (object.x + margin, object.y + tallest);
        let mut add = |colour, corners: [[f32; 2]; 3]| {
            let corners = corners.map(|[across, up]| [x + across * height, y - up * height]);
            drawing.marks.push(Mark { shape: Shape::Polygon(corners.to_vec()), colour });
        };
        add(TRUNK, [[-0.05, 0.0], [0.05, 0.0], [0.0, 0.6]]);
        // Lit from the left.
        add(colour, [[-0.27, 0.15], [0.0, 0.12], [0.0, 1.0]]);
        add(mix(colour, [0; 3], 0.25), [[0.0, 0.12], [0.27, 0.15], [0.0, 1.0]]);
    }
    drawing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearer_trees_are_drawn_later_and_taller_ones_taller() {
        let object = |y, size| Object { x: 0.5, y, color: 0, size };
        let drawing = drawing(&[object(0.9, 0.9), object(0.1, 0.1)], 1, [1.0, 1.0]);
        let height = |marks: &[Mark]| {
            let corners = marks
                .iter()
                .flat_map(|mark| if let Shape::Polygon(corners) = &mark.shape { &corners[..] } else { &[] });
            let (low, high) = corners.fold((f32::MAX, f32::MIN), |(low, high), [_, y]| (low.min(*y), high.max(*y)));
            (high - low, high)
        };
        let (first, second) = (height(&drawing.marks[..3]), height(&drawing.marks[3..]));
        assert!(first.0 < second.0 && first.1 < second.1);
        assert_ne!(drawing.marks[1].colour, drawing.marks[4].colour);
    }

    #[test]
    fn colours_go_from_red_to_green() {
        assert_eq!(colour_of(0, 7), AUTUMN[0]);
        assert_eq!(colour_of(6, 7), AUTUMN[3]);
        assert_eq!(colour_of(2, 7), AUTUMN[1]);
    }
}
