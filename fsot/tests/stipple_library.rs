//! Stippling through the library: inks, classes, tones, animation.

use fsot::Error;
use fsot::class::ClassCoordinates;
use fsot::optimize::{Quality, optimize};
use fsot::picture::{Photo, blurred_psnr, rasterise};
use fsot::stipple::{Animation, Options, Stipple, Windows};

/// A ramp from black to white with a lighter disc on it.
fn gradient() -> Photo {
    Photo::from_fn(96, 64, |x, y| {
        let value = (x as f32 + 0.5) / 96.0;
        let inside = (x as f32 - 30.0).powi(2) + (y as f32 - 32.0).powi(2) < 200.0;
        [if inside { 0.85 } else { value }; 3]
    })
}

/// Red, green, blue and grey fields.
fn colours() -> Photo {
    Photo::from_fn(64, 64, |x, y| match (x < 32, y < 32) {
        (true, true) => [0.9, 0.3, 0.2],
        (false, true) => [0.3, 0.8, 0.3],
        (true, false) => [0.2, 0.3, 0.9],
        (false, false) => [0.6, 0.6, 0.6],
    })
}

fn options(points: usize, iterations: u64) -> Options {
    Options { quality: Quality::Iterations(iterations), ..Options::new(points) }
}

fn psnr(photo: &Photo, options: &Options) -> f64 {
    let stipple = Stipple::new(photo, options).unwrap();
    let points = optimize(stipple.problem.clone()).unwrap();
    let drawn = rasterise(&stipple.drawing(&points), 400.0).unwrap();
    blurred_psnr(&drawn, photo, 1.5 * stipple.spacing() * 400.0, false, !options.cmyk)
}

#[test]
fn tones_and_colours_are_reproduced() {
    let mono = psnr(&gradient(), &options(3000, 300));
    let inverted = psnr(&gradient(), &Options { invert: true, ..options(3000, 300) });
    let colour = psnr(&colours(), &Options { cmyk: true, ..options(3000, 300) });
    // 37.4, 36.6 and 32.0 dB when this was written.
    assert!(mono > 36.0, "{mono}");
    assert!(inverted > 35.0, "{inverted}");
    assert!(colour > 30.5, "{colour}");
}

/// Dots that cannot show the pixels of a picture show its tone: those of black squares are among white ones, and
/// overlap as seldom as on grey.
#[test]
fn detail_finer_than_dots_keeps_its_tone() {
    let photo = Photo::from_fn(100, 100, |x, y| [if (x + y) % 2 == 0 { 0.0 } else { 1.0 }; 3]);
    for options in [options(600, 300), Options { invert: true, ..options(600, 300) }] {
        let stipple = Stipple::new(&photo, &options).unwrap();
        let drawn = rasterise(&stipple.drawing(&optimize(stipple.problem.clone()).unwrap()), 400.0).unwrap();
        let mean = drawn.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / (400.0 * 400.0 * 255.0);
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
    }
}

#[test]
fn four_inks_make_fifteen_classes_of_the_right_points() {
    let photo = colours();
    let stipple = Stipple::new(&photo, &Options { cmyk: true, grey_component: 0.8, ..options(2003, 1) }).unwrap();
    let names: Vec<&str> = stipple.inks.iter().map(|dots| dots.name).collect();
    assert_eq!(names, ["c", "m", "y", "k"]);
    assert_eq!(stipple.inks.last().unwrap().range.end, 2003);
    let problem = &stipple.problem;
    assert_eq!(problem.classes.len(), 15);
    for class in &problem.classes {
        for dots in &stipple.inks {
            let member = class.name.contains(dots.name);
            for point in dots.range.clone() {
                let value = ClassCoordinates::Index.value(&class.function, point, 2003);
                assert_eq!(value, if member { 1.0 } else { 0.0 }, "point {point} in class {}", class.name);
            }
        }
    }
    let labels = stipple.labels();
    assert_eq!(labels.index.len(), 2003);
    assert_eq!(labels.index.iter().filter(|ink| **ink == 3).count(), stipple.inks[3].range.len());
}

/// A class's target is the sum of its inks' densities in proportion to their points: the mean of a coordinate shows it.
#[test]
fn unions_have_the_weighted_mean_of_the_densities() {
    let stipple = Stipple::new(&colours(), &Options { cmyk: true, ..options(5000, 1) }).unwrap();
    let mean = |name: &str| {
        let class = stipple.problem.classes.iter().find(|class| class.name == name).unwrap();
        let (mut means, mut density) = (vec![0.0; 1000], vec![0.0; 1000]);
        class.target.bins(&[0.6, 0.8], &mut means, &mut density, &mut Vec::new());
        means.iter().map(|mean| f64::from(*mean)).sum::<f64>() / 1000.0
    };
    let all = stipple.inks.iter().map(|dots| mean(dots.name) * dots.range.len() as f64).sum::<f64>() / 5000.0;
    assert!((mean("cmyk") - all).abs() < 1e-4, "{} {all}", mean("cmyk"));
}

#[test]
fn inks_that_are_not_needed_have_no_class() {
    let red = Photo::from_fn(20, 10, |x, _| [1.0, x as f32 / 40.0, 0.2]);
    let stipple = Stipple::new(&red, &Options { cmyk: true, ..options(500, 1) }).unwrap();
    let names: Vec<&str> = stipple.inks.iter().map(|dots| dots.name).collect();
    assert_eq!(names, ["m", "y"]);
    assert_eq!(stipple.problem.classes.len(), 3);
}

#[test]
fn points_stay_in_the_picture_and_one_point_is_enough() {
    let photo = gradient();
    for points in [1, 2, 700] {
        let stipple = Stipple::new(&photo, &options(points, 60)).unwrap();
        let points = optimize(stipple.problem.clone()).unwrap();
        assert!(points.iter().all(|p| p[0] >= 0.0 && p[0] < 1.0 && p[1] >= 0.0 && p[1] <= 0.67), "{points:?}");
    }
}

#[test]
fn one_tone_has_nothing_to_show() {
    for (value, name) in [(0.0, "black"), (1.0, "white")] {
        for cmyk in [false, true] {
            let photo = Photo::from_fn(5, 4, |_, _| [value; 3]);
            let error = Stipple::new(&photo, &Options { cmyk, ..options(10, 1) }).err().unwrap();
            assert!(matches!(error, Error::Input(_)) && error.to_string().contains(name), "{error}");
        }
    }
    assert!(matches!(Stipple::new(&gradient(), &options(0, 1)), Err(Error::Input(_))));
    let both = Options { cmyk: true, invert: true, ..options(10, 1) };
    assert!(matches!(Stipple::new(&gradient(), &both), Err(Error::Input(_))));
}

/// A bar that turns.
fn frame(turn: f32) -> Photo {
    let (sin, cos) = turn.sin_cos();
    Photo::from_fn(80, 80, |x, y| {
        let (x, y) = (x as f32 - 39.5, y as f32 - 39.5);
        let (along, across) = (x * cos + y * sin, y * cos - x * sin);
        [if along.abs() < 32.0 && across.abs() < 9.0 { 0.0 } else { 1.0 }; 3]
    })
}

#[test]
fn every_frame_shows_its_picture() {
    let photos: Vec<Photo> = (0..9).map(|k| frame(k as f32 * std::f32::consts::PI / 9.0)).collect();
    for cyclic in [false, true] {
        let windows = Windows { frames: 9, window: 400, step: 100, cyclic };
        let animation = Animation::new(&photos, windows, &options(0, 400)).unwrap();
        assert_eq!(animation.problem.points, if cyclic { 900 } else { 1200 });
        assert_eq!(animation.problem.classes.len(), 9);
        let points = optimize(animation.problem.clone()).unwrap();
        for (number, photo) in photos.iter().enumerate() {
            let drawing = animation.frame(&points, number);
            assert_eq!(drawing.marks.len(), 400);
            let drawn = rasterise(&drawing, 300.0).unwrap();
            let own = blurred_psnr(&drawn, photo, 12.0, false, true);
            let other = blurred_psnr(&drawn, &photos[(number + 4) % 9], 12.0, false, true);
            assert!(own > 15.5 && own > other + 6.0, "frame {number}: {own}, as another {other}");
        }
    }
}

#[test]
fn longer_animations_take_more_steps() {
    let photos: Vec<Photo> = (0..9).map(|k| frame(k as f32)).collect();
    let steps = |frames: usize, cyclic: bool, quality: Quality| {
        let windows = Windows { frames, window: 400, step: 100, cyclic };
        let options = Options { quality, ..Options::new(0) };
        Animation::new(&photos[..frames], windows, &options).unwrap().problem.quality
    };
    assert_eq!(steps(1, false, Quality::Standard), Quality::Iterations(4000));
    assert_eq!(steps(9, false, Quality::Standard), Quality::Iterations(12_000));
    assert_eq!(steps(8, true, Quality::Draft), Quality::Iterations(800));
    assert_eq!(steps(9, false, Quality::Iterations(7)), Quality::Iterations(7));
}

#[test]
fn animations_that_cannot_be_are_refused() {
    let photos = [frame(0.0), frame(1.0)];
    let windows = Windows { frames: 2, window: 40, step: 10, cyclic: false };
    let refused = |photos: &[Photo], windows, options: &Options| {
        let error = Animation::new(photos, windows, options).err().unwrap();
        assert!(matches!(error, Error::Input(_)));
        error.to_string()
    };
    let plain = options(0, 1);
    assert!(refused(&photos, Windows { cyclic: true, ..windows }, &plain).contains("window"));
    assert!(refused(&photos[..1], windows, &plain).contains("1 picture for 2 frames"));
    assert!(refused(&photos, windows, &Options { cmyk: true, ..plain }).contains("one ink"));
    let other = [frame(0.0), Photo::from_fn(3, 3, |x, _| [x as f32 / 2.0; 3])];
    assert!(refused(&other, windows, &plain).contains("3 x 3"));
    let blank = [frame(0.0), Photo::from_fn(80, 80, |_, _| [1.0; 3])];
    assert!(refused(&blank, windows, &plain).contains("frame 1: the picture is white"));
}
