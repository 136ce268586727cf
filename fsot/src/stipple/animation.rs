//! Animated stippling: frames that share points (figure 5.13).

use super::options::{Options, effort, inks, paper, spacing};
use super::separation::radius;
use crate::class::{Class, ClassFunction, Step};
use crate::counted::counted;
use crate::error::{Error, Result};
use crate::optimize::Problem;
use crate::picture::{BLACK, Drawing, Photo, WHITE};
use crate::points::Points;
use crate::random::stream;
use crate::target::image::{ImageTarget, spread};
use std::ops::Range;
use std::sync::Arc;

/// Which points each frame shows: `window` of them, `step` further on with every frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Windows {
    /// The number of frames.
    pub frames: usize,
    /// Points per frame.
    pub window: usize,
    /// Points that the next frame replaces.
    pub step: usize,
    /// Whether the first frame follows the last one: every point then takes part in `window / step` frames. If not,
    /// those of the first and the last frames take part in fewer.
    pub cyclic: bool,
}

/// "2 frames of 1 point".
fn frames_of(frames: usize, window: usize) -> String {
    format!("{} of {}", counted(frames, "frame"), counted(window, "point"))
}

impl Windows {
    /// # Errors
    ///
    /// [`Error::Input`] if a number is 0, the step is longer than the window (points between would never be seen), or
    /// a cyclic animation has a frame that shows a point twice.
    pub fn check(&self) -> Result<()> {
        let Windows { frames, window, step, cyclic } = *self;
        if frames == 0 || window == 0 || step == 0 {
            return Err(Error::Input(format!(
                "{}, {step} of them new in each: give at least 1 of each",
                frames_of(frames, window)
            )));
        }
        if step > window {
            return Err(Error::Input(format!(
                "a step of {step} points passes over some that no window of {window} shows: \
                 give a step of at most the window"
            )));
        }
        if cyclic && frames.saturating_mul(step) < window {
            return Err(Error::Input(format!(
                "{}, {step} of them new in each, have {} in a cycle, fewer than the window: give more frames or a \
                 larger step",
                frames_of(frames, window),
                counted(frames * step, "point")
            )));
        }
        let points = self.checked_points().ok_or_else(|| {
            Error::Input(format!("{}, {step} of them new in each, are too many points", frames_of(frames, window)))
        })?;
        super::check_points(points)
    }

    /// Points of all frames: `(frames - 1) * step + window`; `frames * step` if cyclic. `usize::MAX` if there are more,
    /// which [`check`](Self::check) refuses.
    pub fn points(&self) -> usize {
        self.checked_points().unwrap_or(usize::MAX)
    }

    fn checked_points(&self) -> Option<usize> {
        if self.cyclic {
            self.frames.checked_mul(self.step)
        } else {
            self.frames.saturating_sub(1).checked_mul(self.step)?.checked_add(self.window)
        }
    }

    /// The points of a frame: a range, and the rest of it if it reaches beyond the last point of a cycle; ascending,
    /// one may be empty.
    pub fn of_frame(&self, frame: usize) -> [Range<usize>; 2] {
        let (begin, points) = (frame * self.step, self.points());
        let end = begin + self.window;
        if end <= points { [begin..end, end..end] } else { [0..end - points, begin..points] }
    }
}

/// An animation about to be stippled.
#[derive(Debug)]
pub struct Animation {
    /// What to optimise: a class per frame. Points lie as those of [`Stipple`](super::Stipple).
    pub problem: Problem,
    /// Which points each frame shows.
    pub windows: Windows,
    /// The radius of each frame's dots, in units of the picture's longer side.
    pub radii: Vec<f32>,
    blank: Drawing,
}

impl Animation {
    /// Frames of the same size, each the target of its window; `options.points` is not looked at.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] as [`Windows::check`]; there are not as many pictures as frames, or of different sizes; one
    /// has one tone only; the options want colour.
    pub fn new(photos: &[Photo], windows: Windows, options: &Options) -> Result<Animation> {
        windows.check()?;
        if options.cmyk {
            return Err(Error::input("an animation is drawn with one ink: leave out --cmyk or --frames"));
        }
        if photos.len() != windows.frames {
            return Err(Error::Input(format!(
                "{} for {}: give each frame one",
                counted(photos.len(), "picture"),
                counted(windows.frames, "frame")
            )));
        }
        let points = windows.points();
        let first = &photos[0];
        let mut classes = Vec::new();
        let mut radii = Vec::new();
        let mut targets = Vec::new();
        for (frame, photo) in photos.iter().enumerate() {
            let at = |error: Error| Error::Input(format!("frame {frame}: {error}"));
            if (photo.width, photo.height) != (first.width, first.height) {
                return Err(Error::Input(format!(
                    "frame {frame} has {} x {} pixels, the first one {} x {}: all must have the same",
                    photo.width, photo.height, first.width, first.height
                )));
            }
            let ink = inks(photo, options, windows.window).map_err(at)?.remove(0);
            let target = ImageTarget::new(photo.width, photo.height, &ink.density, windows.window).map_err(at)?;
            let target = Arc::new(target);
            let area = ink.density.iter().map(|d| f64::from(*d)).sum::<f64>() / ink.density.len() as f64;
            let [width, height] = photo.extent().map(f64::from);
            radii.push(radius(area * width * height, windows.window));
            classes.push(Class {
                function: shown(&windows.of_frame(frame), points),
                target: Arc::clone(&target) as Arc<dyn crate::target::Target>,
                weight: 1.0,
                name: format!("frame {frame}"),
            });
            targets.push(target);
        }
        let initial = starting(&targets, windows, options.seed);
        let problem = Problem {
            classes,
            seed: options.seed,
            quality: effort(options.quality, points as f64 / windows.window as f64),
            initial: Some(initial),
            ..Problem::new(points, 2)
        };
        Ok(Animation { problem, windows, radii, blank: paper(first.extent(), options) })
    }

    /// The points of a frame, in units of the picture's longer side.
    pub fn frame(&self, points: &Points, frame: usize) -> Drawing {
        self.draw(points, &self.windows.of_frame(frame), self.radii[frame])
    }

    /// All points at once, each so much smaller as there are more of them.
    pub fn all(&self, points: &Points) -> Drawing {
        let mean = self.radii.iter().sum::<f32>() / self.radii.len().max(1) as f32;
        let more = (self.windows.window as f32 / points.len().max(1) as f32).sqrt();
        self.draw(points, &[0..points.len(), 0..0], mean * more)
    }

    fn draw(&self, points: &Points, ranges: &[Range<usize>; 2], radius: f32) -> Drawing {
        let mut drawing = self.blank.clone();
        let colour = if drawing.paper == BLACK { WHITE } else { BLACK };
        let all: Vec<&[f32]> = points.iter().collect();
        for range in ranges {
            drawing.dots(all.get(range.clone()).unwrap_or_default().iter().copied(), radius, colour);
        }
        drawing
    }

    /// The mean distance between the dots of a frame, in units of the picture's longer side.
    pub fn spacing(&self) -> f32 {
        spacing(&self.blank, self.windows.window)
    }
}

/// 1 for the points of some ascending ranges, else 0.
fn shown(ranges: &[Range<usize>; 2], points: usize) -> ClassFunction {
    let mut steps = Vec::new();
    let to = |end: usize| (end as f64 / points as f64) as f32;
    let mut behind = 0;
    for range in ranges.iter().filter(|range| !range.is_empty()) {
        if range.start > behind {
            steps.push(Step { to: to(range.start), value: 0.0 });
        }
        steps.push(Step { to: to(range.end), value: 1.0 });
        behind = range.end;
    }
    ClassFunction::Staircase(steps)
}

/// Points begin where a frame that shows them has density: the first one, or the last one of a cycle.
fn starting(targets: &[Arc<ImageTarget>], windows: Windows, seed: u64) -> Points {
    let mut coordinates = Vec::with_capacity(2 * windows.points());
    for (frame, target) in targets.iter().enumerate() {
        let new = match frame {
            0 if !windows.cyclic => windows.window,
            _ => windows.step,
        };
        let mut rng = stream(seed, super::STARTING, frame as u64);
        coordinates.extend(spread(&[target], &[new], &mut rng));
    }
    Points::new(2, coordinates)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn windows(frames: usize, window: usize, step: usize, cyclic: bool) -> Windows {
        Windows { frames, window, step, cyclic }
    }

    #[test]
    fn windows_move_by_the_step() {
        // Figure 5.13's 18 frames and 1,000 points, 250 of them new in each frame; its 5,500 points would be 19 frames.
        let all = windows(18, 1000, 250, false);
        assert_eq!(all.points(), 5250);
        assert_eq!(all.of_frame(0), [0..1000, 1000..1000]);
        assert_eq!(all.of_frame(17), [4250..5250, 5250..5250]);
    }

    #[test]
    fn in_a_cycle_every_point_is_in_as_many_frames() {
        for (frames, window, step) in [(18, 1000, 250), (4, 7, 3), (5, 2, 1), (1, 3, 3)] {
            let cycle = windows(frames, window, step, true);
            cycle.check().unwrap();
            let mut seen = vec![0; cycle.points()];
            for frame in 0..frames {
                let ranges = cycle.of_frame(frame);
                assert_eq!(ranges.iter().map(Range::len).sum::<usize>(), window);
                ranges.into_iter().flatten().for_each(|point| seen[point] += 1);
            }
            assert_eq!(seen.iter().sum::<usize>(), frames * window);
            if window % step == 0 {
                assert!(seen.iter().all(|count| *count == window / step), "{seen:?}");
            }
        }
    }

    #[test]
    fn windows_that_make_no_sense_are_refused() {
        for (frames, window, step, cyclic) in
            [(0, 1, 1, false), (1, 0, 1, false), (1, 1, 0, false), (3, 10, 11, false), (3, 10, 3, true)]
        {
            assert!(matches!(windows(frames, window, step, cyclic).check(), Err(Error::Input(_))));
        }
        // Products and sums that a usize cannot hold.
        const HUGE: usize = usize::MAX / 2 + 1;
        for (frames, window, step) in [(4, HUGE, HUGE), (2, usize::MAX, 1), (HUGE, 2, 2), (HUGE + 1, 2, 2)] {
            for cyclic in [false, true] {
                let error = windows(frames, window, step, cyclic).check().unwrap_err();
                assert!(matches!(error, Error::Input(_)), "{error}");
            }
        }
        assert!(windows(1, 1, 1, false).check().is_ok());
    }

    #[test]
    fn functions_select_the_windows() {
        let cycle = windows(18, 1000, 250, true);
        for frame in 0..18 {
            let function = shown(&cycle.of_frame(frame), cycle.points());
            for point in 0..cycle.points() {
                let value = function.value(&[((point as f64 + 0.5) / cycle.points() as f64) as f32]);
                let inside = cycle.of_frame(frame).iter().any(|range| range.contains(&point));
                assert_eq!(value > 0.0, inside, "point {point} of frame {frame}");
            }
        }
    }
}
