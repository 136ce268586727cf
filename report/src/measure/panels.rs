//! Several small plots in one SVG, with one legend: lines, and points of several shapes.

use super::plot::{Axis, COLOURS, FONT, Scale, Series, description, shows};
use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// How a point looks.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    Circle,
    Square,
    Triangle,
    Cross,
    /// Around another point.
    Ring,
}

/// A point.
pub(crate) struct Mark {
    pub(crate) at: (f64, f64),
    pub(crate) shape: Shape,
    /// Index into the colours.
    pub(crate) colour: usize,
    /// Written beside it; may be empty.
    pub(crate) text: String,
}

/// One plot. Of its series, names are not shown: the legend has them.
#[derive(Default)]
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) series: Vec<Series>,
    pub(crate) marks: Vec<Mark>,
}

/// An entry of the legend: a line, or a point.
pub(crate) enum Key {
    Line { name: String, colour: usize, dashed: bool },
    Mark { name: String, colour: usize, shape: Shape },
}

/// All plots share the axes' names, and the ranges if they are given.
pub(crate) struct Panels<'a> {
    pub(crate) title: &'a str,
    pub(crate) x: Axis<'a>,
    pub(crate) y: Axis<'a>,
    pub(crate) columns: usize,
    pub(crate) panels: &'a [Panel],
    pub(crate) legend: &'a [Key],
}

const PANEL: (u32, u32) = (330, 270);
const TITLE: u32 = 34;
/// Height of a row of the legend, and how wide its entries are.
const ROW: u32 = 22;
const ENTRY: u32 = 165;

type DrawingError<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

impl Panels<'_> {
    /// The text of an SVG file.
    pub(crate) fn svg(&self) -> Result<String> {
        let columns = self.columns.clamp(1, self.panels.len().max(1)) as u32;
        let rows = (self.panels.len() as u32).div_ceil(columns);
        let width = (columns * PANEL.0).max(2 * PANEL.0);
        let entries = (width - 20) / ENTRY;
        let legend = (self.legend.len() as u32).div_ceil(entries) * ROW + 8;
        let size = (width, TITLE + rows * PANEL.1 + legend);
        let mut text = String::new();
        let mut draw = || -> Result<(), DrawingError<SVGBackend<'_>>> {
            let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
            root.fill(&WHITE)?;
            let style = (FONT, 18).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Center));
            root.draw(&Text::new(self.title.to_owned(), ((width / 2) as i32, TITLE as i32 / 2), style))?;
            let (_, below) = root.split_vertically(TITLE);
            let (plots, foot) = below.split_vertically(rows * PANEL.1);
            let (plots, _) = plots.split_horizontally(columns * PANEL.0);
            let areas = plots.split_evenly((rows as usize, columns as usize));
            self.panels.iter().zip(&areas).try_for_each(|(panel, area)| self.draw(panel, area))?;
            self.draw_legend(&foot, entries)?;
            root.present()
        };
        draw().map_err(|error| anyhow!("cannot draw `{}`: {error}", self.title))?;
        Ok(text)
    }

    fn draw<B: DrawingBackend>(&self, panel: &Panel, area: &DrawingArea<B, Shift>) -> Result<(), DrawingError<B>> {
        let lines = panel.series.iter().flat_map(|series| series.points.iter().copied());
        let points = || lines.clone().chain(panel.marks.iter().map(|mark| mark.at));
        let shown = |&(x, y): &(f64, f64)| shows(&self.x, x) && shows(&self.y, y);
        let x = Scale::new(&self.x, points().filter(shown).map(|(x, _)| x));
        let y = Scale::new(&self.y, points().filter(shown).map(|(_, y)| y));
        let mut chart = ChartBuilder::on(area)
            .caption(&panel.title, (FONT, 15))
            .margin(6)
            .x_label_area_size(38)
            .y_label_area_size(56)
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .label_style((FONT, 12))
            .axis_desc_style((FONT, 13))
            .x_desc(description(&self.x))
            .y_desc(description(&self.y))
            .x_labels(5)
            .y_labels(6)
            .draw()?;
        let inside = |&(x_value, y_value): &(f64, f64)| (x.clamp(x_value), y.clamp(y_value));
        for (index, series) in panel.series.iter().enumerate() {
            let style = COLOURS[series.colour.unwrap_or(index) % COLOURS.len()].stroke_width(2);
            let line: Vec<_> = series.points.iter().filter(|point| shown(point)).map(inside).collect();
            if series.dashed {
                chart.draw_series(DashedLineSeries::new(line, 10, 6, style))?;
            } else {
                chart.draw_series(LineSeries::new(line, style))?;
            }
        }
        let whole = |&(at_x, at_y): &(f64, f64)| x.clamp(at_x) == at_x && y.clamp(at_y) == at_y;
        for mark in panel.marks.iter().filter(|mark| shown(&mark.at) && whole(&mark.at)) {
            let place = chart.backend_coord(&mark.at);
            // Of the whole drawing; the area has its own origin.
            let (left, top) = area.get_base_pixel();
            let place = (place.0 - left, place.1 - top);
            draw_mark(area, place, mark.shape, mark.colour)?;
            if !mark.text.is_empty() {
                let style = (FONT, 12).into_font().color(&BLACK).pos(Pos::new(HPos::Left, VPos::Bottom));
                area.draw(&Text::new(mark.text.clone(), (place.0 + 5, place.1 - 4), style))?;
            }
        }
        Ok(())
    }

    fn draw_legend<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        entries: u32,
    ) -> Result<(), DrawingError<B>> {
        for (index, key) in (0..).zip(self.legend) {
            let (left, top) = ((20 + index % entries * ENTRY) as i32, (index / entries * ROW + ROW / 2) as i32);
            let (name, colour) = match key {
                Key::Line { name, colour, dashed } => {
                    let pieces: &[(i32, i32)] = if *dashed { &[(0, 7), (11, 18)] } else { &[(0, 18)] };
                    for &(from, to) in pieces {
                        let style = COLOURS[colour % COLOURS.len()].stroke_width(2);
                        area.draw(&PathElement::new(vec![(left + from, top), (left + to, top)], style))?;
                    }
                    (name, *colour)
                }
                Key::Mark { name, colour, shape } => {
                    draw_mark(area, (left + 9, top), *shape, *colour)?;
                    (name, *colour)
                }
            };
            let style = (FONT, 13).into_font().color(&COLOURS[colour % COLOURS.len()]);
            area.draw(&Text::new(name.clone(), (left + 24, top), style.pos(Pos::new(HPos::Left, VPos::Center))))?;
        }
        Ok(())
    }
}

fn draw_mark<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    (x, y): (i32, i32),
    shape: Shape,
    colour: usize,
) -> Result<(), DrawingError<B>> {
    let colour = COLOURS[colour % COLOURS.len()];
    match shape {
        Shape::Circle => area.draw(&Circle::new((x, y), 3, colour.filled())),
        Shape::Square => area.draw(&Rectangle::new([(x - 3, y - 3), (x + 3, y + 3)], colour.stroke_width(1))),
        Shape::Triangle => {
            let corners = vec![(x - 3, y + 3), (x + 3, y + 3), (x, y - 3), (x - 3, y + 3)];
            area.draw(&PathElement::new(corners, colour.stroke_width(1)))
        }
        Shape::Cross => {
            area.draw(&PathElement::new(vec![(x - 3, y - 3), (x + 3, y + 3)], colour.stroke_width(1)))?;
            area.draw(&PathElement::new(vec![(x - 3, y + 3), (x + 3, y - 3)], colour.stroke_width(1)))
        }
        Shape::Ring => area.draw(&Circle::new((x, y), 8, colour.stroke_width(2))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_have_titles_and_the_legend_names_everything() {
        let panel = |title: &str| Panel {
            title: title.to_owned(),
            series: vec![Series { points: vec![(1.0, 1.0), (2.0, f64::NAN), (4.0, 0.25)], ..Series::default() }],
            marks: vec![Mark { at: (2.0, 0.5), shape: Shape::Ring, colour: 1, text: "note".to_owned() }],
        };
        let axis = |label| Axis { label, logarithmic: true, range: None };
        let legend = [
            Key::Line { name: "line".to_owned(), colour: 0, dashed: true },
            Key::Mark { name: "point".to_owned(), colour: 1, shape: Shape::Cross },
        ];
        let panels = [panel("first"), panel("second"), Panel::default()];
        let plots =
            Panels { title: "all", x: axis("across"), y: axis("up"), columns: 2, panels: &panels, legend: &legend };
        let svg = plots.svg().expect("a drawing");
        for word in ["first", "second", "line", "point", "note", "across (logarithmic)"] {
            assert!(svg.contains(word), "{word}");
        }
    }
}
