//! Drawing to SVG.

use super::drawing::{BLACK, Blend, Colour, Drawing, Mark, Shape};
use svg::Document;
use svg::node::element::{Circle, Group, Polygon, Rectangle};

/// The content of an SVG file, `scale` pixels per unit wide when shown at its natural size.
pub fn svg(drawing: &Drawing, scale: f32) -> String {
    let [width, height] = drawing.size.map(|side| number(side * scale));
    let paper = Rectangle::new().set("width", "100%").set("height", "100%").set("fill", hex(drawing.paper));
    let mut document = Document::new()
        .set("width", width.as_str())
        .set("height", height.as_str())
        .set("viewBox", format!("0 0 {width} {height}"))
        .add(paper);
    // Black over anything is black.
    let blends = drawing.blend == Blend::Multiply && drawing.marks.iter().any(|mark| mark.colour != BLACK);
    for marks in drawing.marks.chunk_by(|a, b| a.colour == b.colour) {
        let mut group = Group::new().set("fill", hex(marks[0].colour));
        if blends {
            group = group.set("style", "mix-blend-mode:multiply");
        }
        for mark in marks {
            group = add(group, mark, scale);
        }
        document = document.add(group);
    }
    document.to_string()
}

fn add(group: Group, mark: &Mark, scale: f32) -> Group {
    match &mark.shape {
        Shape::Disc { centre: [x, y], radius } => group.add(
            Circle::new().set("cx", number(x * scale)).set("cy", number(y * scale)).set("r", number(radius * scale)),
        ),
        Shape::Polygon(corners) => {
            let corners: Vec<String> =
                corners.iter().map(|[x, y]| format!("{},{}", number(x * scale), number(y * scale))).collect();
            group.add(Polygon::new().set("points", corners.join(" ")))
        }
    }
}

/// Thousandths of a pixel are enough for any printer.
fn number(value: f32) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A colour as `#rrggbb`.
pub fn hex([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_a_colour_make_a_group() {
        let mut drawing = Drawing { blend: Blend::Multiply, ..Drawing::new([1.0, 0.5]) };
        drawing.dots([&[0.25, 0.125][..], &[0.5, 0.5]], 0.01, [0, 255, 255]);
        drawing.marks.push(Mark { shape: Shape::Polygon(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 0.5]]), colour: [1, 2, 3] });
        let text = svg(&drawing, 100.0);
        assert_eq!(text.matches("<g ").count(), 2);
        assert!(text.contains("viewBox=\"0 0 100 50\"") && text.contains("mix-blend-mode:multiply"));
        assert!(text.contains("cx=\"25\"") && text.contains("cy=\"12.5\"") && text.contains("r=\"1\""), "{text}");
        assert!(text.contains("points=\"0,0 100,0 0,50\"") && text.contains("#010203"));

        drawing.marks.iter_mut().for_each(|mark| mark.colour = BLACK);
        assert!(!svg(&drawing, 100.0).contains("blend"));
    }
}
