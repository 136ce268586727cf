//! Curves in a frame with ticks.

use super::sheet::{Anchor, BLACK, Colour, GREY, Sheet};

/// The range of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    from: f64,
    to: f64,
    logarithmic: bool,
}

pub(super) struct Curve {
    /// Places that are not finite interrupt it.
    pub(super) points: Vec<[f64; 2]>,
    pub(super) colour: Colour,
}

pub(super) struct Plot {
    pub(super) title: String,
    /// Of the horizontal axis.
    pub(super) label: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) curves: Vec<Curve>,
    /// Horizontal lines to compare with.
    pub(super) levels: Vec<f64>,
}

impl Axis {
    pub(super) fn linear(from: f64, to: f64) -> Axis {
        Axis { from, to: if to > from { to } else { from + 1.0 }, logarithmic: false }
    }

    /// Both ends above 0.
    pub(super) fn logarithmic(from: f64, to: f64) -> Axis {
        Axis { from, to: if to > from { to } else { 2.0 * from }, logarithmic: true }
    }

    /// Where a value is along the axis: 0 to 1 within it.
    fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            libm::log(value / self.from) / libm::log(self.to / self.from)
        } else {
            (value - self.from) / (self.to - self.from)
        }
    }

    /// Values to mark: multiples of 1, 2 or 5 times a power of ten, or powers of ten.
    fn ticks(&self) -> Vec<(f64, String)> {
        let power = |exponent: f64| libm::pow(10.0, exponent);
        if self.logarithmic {
            let (first, last) = (libm::log10(self.from).ceil() as i32, (libm::log10(self.to) + 1e-9).floor() as i32);
            let every = (last - first) / 8 + 1;
            let name =
                |e: i32| if (-3..=4).contains(&e) { format!("{}", power(f64::from(e))) } else { format!("1e{e}") };
            return (first..=last).filter(|e| e % every == 0).map(|e| (power(f64::from(e)), name(e))).collect();
        }
        let rough = (self.to - self.from) / 5.0;
        let scale = power(libm::log10(rough).floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * scale).into_iter().find(|s| *s >= rough).unwrap_or(10.0 * scale);
        let digits = (-libm::log10(step).floor()).max(0.0) as usize;
        let (first, last) = ((self.from / step - 1e-9).ceil() as i64, (self.to / step + 1e-9).floor() as i64);
        (first..=last).map(|i| (i as f64 * step, format!("{:.digits$}", i as f64 * step))).collect()
    }
}

impl Plot {
    /// Draws it into the frame `[left, top, right, bottom]`; title above, ticks left and below.
    pub(super) fn draw(&self, sheet: &mut Sheet, [left, top, right, bottom]: [f64; 4]) {
        let x = |value: f64| left + self.x.place(value) * (right - left);
        let y = |value: f64| (bottom - self.y.place(value) * (bottom - top)).clamp(top, bottom);
        for (value, name) in self.x.ticks() {
            sheet.line(vec![[x(value), bottom], [x(value), bottom + 5.0]], BLACK, 1.0);
            sheet.text([x(value), bottom + 22.0], Anchor::Middle, name, BLACK);
        }
        for (value, name) in self.y.ticks() {
            sheet.line(vec![[left - 5.0, y(value)], [left, y(value)]], BLACK, 1.0);
            sheet.text([left - 8.0, y(value) + 6.0], Anchor::End, name, BLACK);
        }
        for &level in &self.levels {
            sheet.line(vec![[left, y(level)], [right, y(level)]], GREY, 1.0);
        }
        for curve in &self.curves {
            for part in curve.points.split(|p| !self.y.place(p[1]).is_finite() || !self.x.place(p[0]).is_finite()) {
                let points: Vec<[f64; 2]> = part.iter().map(|p| [x(p[0]), y(p[1])]).collect();
                if !points.is_empty() {
                    sheet.line(points, curve.colour, 1.6);
                }
            }
        }
        let frame = vec![[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
        sheet.line(frame, BLACK, 1.0);
        sheet.text([left, top - 8.0], Anchor::Start, self.title.as_str(), BLACK);
        sheet.text([(left + right) / 2.0, bottom + 40.0], Anchor::Middle, self.label.as_str(), BLACK);
    }
}
