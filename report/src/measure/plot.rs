//! Lines against an axis, as SVG: named series.

use anyhow::{Result, anyhow};
use plotters::coord::combinators::BindKeyPoints;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// One line of a plot.
#[derive(Clone, Default)]
pub(crate) struct Series {
    pub(crate) name: String,
    /// (x, y) in the order in which they are joined; what a logarithmic axis cannot show is left out.
    pub(crate) points: Vec<(f64, f64)>,
    /// (x, low, high): a confidence interval, shaded. May be empty.
    pub(crate) band: Vec<(f64, f64, f64)>,
    pub(crate) dashed: bool,
    /// Index into the colours; None: the series' place in the plot. To draw two lines alike but for the dashes.
    pub(crate) colour: Option<usize>,
}

/// One plot: labels of its axes, the horizontal one linear, the vertical one logarithmic if what it shows spans enough.
pub(crate) struct Plot<'a> {
    pub(crate) title: &'a str,
    pub(crate) x: &'a str,
    pub(crate) y: &'a str,
    pub(crate) series: &'a [Series],
}

const SIZE: (u32, u32) = (900, 560);
/// Pixels to the right of the axes, for the series' names, and from one name to the next.
const LABELS: u32 = 230;
const LABEL_HEIGHT: i32 = 20;
const FONT: &str = "sans-serif";
/// Told apart by colour-blind readers too (Okabe and Ito 2008), the yellow darkened.
const COLOURS: [RGBColor; 8] = [
    RGBColor(40, 40, 40),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(200, 170, 0),
    RGBColor(140, 90, 40),
];

impl Plot<'_> {
    /// The text of an SVG file.
    pub(crate) fn svg(&self) -> Result<String> {
        let points = || self.series.iter().flat_map(|series| self.shown(series));
        let bands = self.series.iter().flat_map(|series| &series.band).flat_map(|&(_, low, high)| [low, high]);
        let x = range(points().map(|(x, _)| x));
        let y = range(points().map(|(_, y)| y).chain(bands.filter(|&y| self.shows(y))));
        let mut text = String::new();
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        // A logarithmic axis of less than half a decade would have hardly a label.
        let drawn = if y.end > 3.0 * y.start {
            let axis = (y.start..y.end).log_scale().with_key_points(ticks(&y));
            self.draw(&root, x, axis, " (logarithmic)")
        } else {
            self.draw(&root, x, y, "")
        };
        drawn.map_err(|error| anyhow!("cannot draw `{}`: {error}", self.title))?;
        drop(root);
        Ok(text)
    }

    fn shows(&self, y: f64) -> bool {
        y.is_finite() && y > 0.0
    }

    fn shown(&self, series: &Series) -> Vec<(f64, f64)> {
        series.points.iter().copied().filter(|&(_, y)| self.shows(y)).collect()
    }

    fn draw<B: DrawingBackend, Y: AsRangedCoord<Value = f64>>(
        &self,
        root: &DrawingArea<B, plotters::coord::Shift>,
        x: Range<f64>,
        y: Y,
        scale: &str,
    ) -> Result<(), DrawingError<B>>
    where
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(root)
            .caption(self.title, (FONT, 18))
            .margin(12)
            .margin_right(LABELS)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .label_style((FONT, 14))
            .axis_desc_style((FONT, 15))
            .x_desc(self.x)
            .y_desc(format!("{}{scale}", self.y))
            .x_labels(10)
            .y_labels(10)
            .draw()?;

        let left = (SIZE.0 - LABELS + 10) as i32;
        for (index, series) in self.series.iter().enumerate() {
            let colour = COLOURS[series.colour.unwrap_or(index) % COLOURS.len()];
            let band = || series.band.iter().filter(|band| self.shows(band.1));
            if band().next().is_some() {
                let low = band().map(|&(at, low, _)| (at, low));
                let outline: Vec<_> = low.chain(band().rev().map(|&(at, _, high)| (at, high))).collect();
                chart.draw_series([Polygon::new(outline, colour.mix(0.15).filled())])?;
            }
            let (line, style) = (self.shown(series), colour.stroke_width(2));
            if series.dashed {
                chart.draw_series(DashedLineSeries::new(line, 6, 4, style))?;
            } else {
                chart.draw_series(LineSeries::new(line, style))?;
            }
            let height = 60 + LABEL_HEIGHT * index as i32;
            let sample: &[[i32; 2]] = if series.dashed { &[[0, 6], [10, 16]] } else { &[[0, 16]] };
            for [from, to] in sample {
                root.draw(&PathElement::new(vec![(left + from, height), (left + to, height)], style))?;
            }
            let words = (FONT, 14).into_font().color(&colour).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(series.name.clone(), (left + 24, height), words))?;
        }
        root.present()
    }
}

type DrawingError<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

/// What an axis must show, and a little more; what starts at nought stays there.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    if low < high { low * 0.97..high * 1.03 } else { 1.0..2.0 }
}

/// Labels of a logarithmic axis: the fewest round numbers that are four at least.
fn ticks(range: &Range<f64>) -> Vec<f64> {
    let decades = || range.start.log10().floor() as i32..=range.end.log10() as i32 + 1;
    // Divided, 7 tenths are .7; multiplied by .1 they have a label of 18 digits.
    let tick = |digit: f64, decade: i32| digit * 10_f64.powi(decade.max(0)) / 10_f64.powi((-decade).max(0));
    let of = |digits: &[f64]| -> Vec<f64> {
        let all = decades().flat_map(|decade| digits.iter().map(move |&digit| tick(digit, decade)));
        all.filter(|tick| range.contains(tick)).collect()
    };
    let digits: [&[f64]; 3] = [&[1.0], &[1.0, 2.0, 5.0], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]];
    let choices = digits.map(of);
    choices.iter().find(|ticks| ticks.len() >= 4).unwrap_or(&choices[2]).clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithmic_axes_have_labels() {
        assert_eq!(ticks(&(2.2..6.9)), [3.0, 4.0, 5.0, 6.0]);
        assert_eq!(ticks(&(0.09..1.05)), [0.1, 0.2, 0.5, 1.0]);
        assert_eq!(ticks(&(0.025..0.075)), [0.03, 0.04, 0.05, 0.06, 0.07]);
        assert_eq!(ticks(&(0.5..2e4)), [1.0, 10.0, 100.0, 1000.0, 10000.0]);
        assert_eq!(ticks(&(2.1..6.31)).len(), 4);
    }

    #[test]
    fn every_series_is_named_and_bad_values_do_no_harm() {
        let series = [
            Series {
                name: "one".to_owned(),
                points: vec![(1.0, 0.5), (2.0, f64::NAN), (3.0, 0.0)],
                ..Series::default()
            },
            Series { name: "two".to_owned(), points: vec![(1.0, 0.1)], dashed: true, ..Series::default() },
        ];
        for (low, is_logarithmic) in [(0.1, true), (0.4, false)] {
            let (x, y, mut series) = ("n", "what", series.clone());
            series[1].points[0].1 = low;
            let text = Plot { title: "plot", x, y, series: &series }.svg().expect("a drawing");
            assert_eq!(text.contains("what (logarithmic)"), is_logarithmic);
            assert!(text.starts_with("<svg") && text.contains("one") && text.contains("two"));
            assert!(Plot { title: "empty", x, y, series: &[] }.svg().is_ok());
        }
    }
}
