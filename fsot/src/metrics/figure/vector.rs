//! A sheet as SVG; its pictures are PNG files within.

use super::sheet::{Anchor, Element, Sheet};
use crate::error::{Error, Result};
use crate::picture::hex;
use base64::Engine;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use svg::Document;
use svg::node::element::{Image, Polyline, Rectangle, Text};

impl Sheet {
    /// The sheet as an SVG file.
    pub fn svg(&self) -> Result<String> {
        let mut document = Document::new()
            .set("viewBox", (0, 0, self.width, self.height))
            .set("width", self.width)
            .set("height", self.height)
            .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"));
        for element in &self.elements {
            document = match element {
                Element::Line { points, colour, width } => {
                    let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
                    let line = Polyline::new().set("points", points.join(" ")).set("fill", "none");
                    document.add(line.set("stroke", hex(*colour)).set("stroke-width", *width))
                }
                Element::Text { at, anchor, text, colour } => {
                    let anchor = match anchor {
                        Anchor::Start => "start",
                        Anchor::Middle => "middle",
                        Anchor::End => "end",
                    };
                    let words = Text::new(text.as_str()).set("x", at[0]).set("y", at[1]).set("text-anchor", anchor);
                    document.add(words.set("font-family", "sans-serif").set("font-size", 15).set("fill", hex(*colour)))
                }
                Element::Picture { at, size, side, grey } => {
                    let place = Image::new().set("x", at[0]).set("y", at[1]).set("width", *size).set("height", *size);
                    document.add(place.set("image-rendering", "pixelated").set("href", data(*side, grey)?))
                }
            };
        }
        Ok(document.to_string())
    }
}

fn data(side: usize, grey: &[u8]) -> Result<String> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(grey, side as u32, side as u32, ExtendedColorType::L8)
        .map_err(|error| Error::Input(format!("cannot encode a picture: {error}")))?;
    Ok(format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes)))
}
