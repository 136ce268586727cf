//! Lines against an axis, as SVG: named series, linear or logarithmic axes, each line labelled at its end.

use anyhow::{Result, anyhow};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// One line of a plot.
#[derive(Default)]
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

/// What an axis shows.
pub(crate) struct Axis<'a> {
    pub(crate) label: &'a str,
    pub(crate) logarithmic: bool,
    /// None: what the points need.
    pub(crate) range: Option<(f64, f64)>,
}

/// One plot.
pub(crate) struct Plot<'a> {
    pub(crate) title: &'a str,
    pub(crate) x: Axis<'a>,
    pub(crate) y: Axis<'a>,
    pub(crate) series: &'a [Series],
}

const SIZE: (u32, u32) = (900, 560);
/// Pixels to the right of the axes, for the labels, and between two labels.
const LABELS: u32 = 210;
const LABEL_HEIGHT: f64 = 17.0;
pub(super) const FONT: &str = "sans-serif";
/// Told apart by colour-blind readers too (Okabe and Ito 2008), the yellow darkened.
pub(super) const COLOURS: [RGBColor; 8] = [
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
        let mut text = String::new();
        self.draw(&SVGBackend::with_string(&mut text, SIZE).into_drawing_area())
            .map_err(|error| anyhow!("cannot draw `{}`: {error}", self.title))?;
        Ok(text)
    }

    fn draw<B: DrawingBackend>(&self, root: &DrawingArea<B, plotters::coord::Shift>) -> Result<(), DrawingError<B>> {
        root.fill(&WHITE)?;
        let shown = |&(x, y): &(f64, f64)| shows(&self.x, x) && shows(&self.y, y);
        let points = || self.series.iter().flat_map(|series| series.points.iter().copied()).filter(shown);
        let x = Scale::new(&self.x, points().map(|(x, _)| x));
        let bands = self.series.iter().flat_map(|series| &series.band).flat_map(|&(_, low, high)| [low, high]);
        let y = Scale::new(&self.y, points().map(|(_, y)| y).chain(bands.filter(|&y| shows(&self.y, y))));

        let mut chart = ChartBuilder::on(root)
            .caption(self.title, (FONT, 18))
            .margin(12)
            .margin_right(LABELS)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .label_style((FONT, 14))
            .axis_desc_style((FONT, 15))
            .x_desc(description(&self.x))
            .y_desc(description(&self.y))
            .x_labels(10)
            .y_labels(10)
            .draw()?;

        let mut labels = Vec::new();
        for (index, series) in self.series.iter().enumerate() {
            let colour = COLOURS[series.colour.unwrap_or(index) % COLOURS.len()];
            let band: Vec<_> = series.band.iter().copied().filter(|&(at, ..)| shows(&self.x, at)).collect();
            if !band.is_empty() {
                let low = band.iter().map(|&(at, low, _)| (at, y.clamp(low)));
                let outline: Vec<_> = low.chain(band.iter().rev().map(|&(at, _, high)| (at, y.clamp(high)))).collect();
                chart.draw_series([Polygon::new(outline, colour.mix(0.15).filled())])?;
            }
            let inside = |&(x_value, y_value): &(f64, f64)| (x.clamp(x_value), y.clamp(y_value));
            let line: Vec<_> = series.points.iter().filter(|point| shown(point)).map(inside).collect();
            let style = colour.stroke_width(2);
            if series.dashed {
                chart.draw_series(DashedLineSeries::new(line.iter().copied(), 6, 4, style))?;
            } else {
                chart.draw_series(LineSeries::new(line.iter().copied(), style))?;
            }
            if let Some(end) = line.last() {
                labels.push((f64::from(chart.backend_coord(end).1), series.name.as_str(), colour, series.dashed));
            }
        }
        let left = (SIZE.0 - LABELS + 10) as i32;
        labels.sort_by(|a, b| a.0.total_cmp(&b.0));
        let wanted: Vec<_> = labels.iter().map(|label| label.0).collect();
        for (height, (_, name, colour, dashed)) in spread(&wanted).into_iter().zip(labels) {
            let height = height as i32;
            let dashes: &[(i32, i32)] = if dashed { &[(0, 8), (13, 21)] } else { &[(0, 21)] };
            for &(from, to) in dashes {
                let stroke = vec![(left + from, height), (left + to, height)];
                root.draw(&PathElement::new(stroke, colour.stroke_width(2)))?;
            }
            let style = (FONT, 14).into_font().color(&colour).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(name.to_owned(), (left + 27, height), style))?;
        }
        root.present()
    }
}

type DrawingError<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

/// Heights from the top for labels that want to be at `wanted` (ascending), none above another's text.
fn spread(wanted: &[f64]) -> Vec<f64> {
    let mut heights = wanted.to_vec();
    let (top, bottom) = (50.0, f64::from(SIZE.1) - 30.0);
    let mut free = top;
    for height in &mut heights {
        *height = height.max(free);
        free = *height + LABEL_HEIGHT;
    }
    let mut free = bottom;
    for height in heights.iter_mut().rev() {
        *height = height.min(free);
        free = *height - LABEL_HEIGHT;
    }
    heights
}

/// A logarithmic axis says so.
pub(super) fn description(axis: &Axis) -> String {
    let scale = if axis.logarithmic { " (logarithmic)" } else { "" };
    format!("{}{scale}", axis.label)
}

pub(super) fn shows(axis: &Axis, value: f64) -> bool {
    value.is_finite() && (!axis.logarithmic || value > 0.0)
}

/// An axis' mapping to pixels, its ticks and their text.
#[derive(Clone)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl Scale {
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = axis.range.unwrap_or_else(|| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
        });
        if low > high {
            (low, high) = (1.0, 2.0);
        }
        let logarithmic = axis.logarithmic && low > 0.0;
        if axis.range.is_none() && logarithmic {
            (low, high) = (low / 1.08, high * 1.08);
        } else if axis.range.is_none() || low >= high {
            let margin = if low < high { 0.03 * (high - low) } else { low.abs().max(1.0) };
            // What starts at nought stays there: half an epoch before the first one says nothing.
            (low, high) = (if low == 0.0 { 0.0 } else { low - margin }, high + margin);
        }
        Self { low, high, logarithmic }
    }

    pub(super) fn clamp(&self, value: f64) -> f64 {
        value.clamp(self.low, self.high)
    }

    /// At most about `count` of them.
    fn ticks(&self, count: usize) -> Vec<f64> {
        let inside = |tick: &f64| *tick >= self.low * (1.0 - 1e-9) && *tick <= self.high * (1.0 + 1e-9);
        if self.logarithmic {
            let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
            let choices: [&[f64]; 3] = [&[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0], &[1.0, 2.0, 5.0], &[1.0]];
            let all = choices.map(|steps| -> Vec<f64> {
                let ticks = decades.clone().flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
                ticks.filter(inside).collect()
            });
            let fits = all.iter().find(|ticks| ticks.len() <= count + 2);
            return fits.or(all.last()).cloned().unwrap_or_default();
        }
        let rough = (self.high - self.low) / count.max(1) as f64;
        let decade = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade).into_iter().find(|&step| step >= rough);
        let step = step.unwrap_or(rough);
        let first = (self.low / step).ceil() as i64;
        let ticks = (first..).map(|index| index as f64 * step);
        ticks.take_while(|tick| *tick <= self.high + 1e-9 * step).take(100).collect()
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let part = if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        limit.0 + (part * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        self.ticks(hint.bold_points())
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Scale {
    fn format(value: &f64) -> String {
        if *value != 0.0 && !(1e-4..1e5).contains(&value.abs()) {
            return format!("{value:.0e}");
        }
        // Enough digits for every tick, and no trailing noughts.
        let text = format!("{value:.6}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" { "0".to_owned() } else { text.to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(logarithmic: bool, range: Option<(f64, f64)>) -> Axis<'static> {
        Axis { label: "what", logarithmic, range }
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let ticks = Scale::new(&axis(false, Some((0.0, 10.0))), [].into_iter()).ticks(10);
        assert_eq!(ticks, (0..=10).map(f64::from).collect::<Vec<_>>());
        let ticks = Scale::new(&axis(true, Some((0.01, 10.0))), [].into_iter()).ticks(10);
        assert_eq!(ticks.len(), 10);
        assert!(ticks.iter().all(|tick| (0.0099..10.1).contains(tick)));
        assert_eq!(Scale::format(&0.02), "0.02");
        assert_eq!(Scale::format(&-0.0), "0");
    }

    #[test]
    fn labels_keep_their_distance() {
        let heights = spread(&[100.0, 101.0, 102.0, 600.0]);
        assert!(heights.windows(2).all(|pair| pair[1] - pair[0] >= LABEL_HEIGHT));
        assert!(heights.iter().all(|&height| height <= f64::from(SIZE.1)));
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
        for logarithmic in [false, true] {
            let (x, y) = (axis(logarithmic, None), axis(logarithmic, None));
            let text = Plot { title: "plot", x, y, series: &series }.svg().expect("a drawing");
            assert_eq!(text.contains("what (logarithmic)"), logarithmic);
            assert!(text.starts_with("<svg") && text.contains("one") && text.contains("two") && text.contains("what"));
        }
        let empty = Plot { title: "empty", x: axis(true, None), y: axis(false, None), series: &[] };
        assert!(empty.svg().is_ok());
    }
}
