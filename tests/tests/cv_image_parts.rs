//! Parts of an image that are estimated on their own have the bits of the whole.

use crate::cv_support::points;
use noisefloor::Error;
use noisefloor::control_variate::{Config, Estimate, Estimator, Image, Rectangle, Samples, image_workspace_len};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared;

/// The arrays of some pixels of an image.
struct Arrays {
    u: Vec<f32>,
    f: Vec<f32>,
    surfaces: Vec<u32>,
    factors: Vec<f32>,
    known: Vec<f32>,
    integrals: Vec<f32>,
}

struct Picture {
    width: usize,
    height: usize,
    frames: usize,
    n: usize,
    has_known: bool,
    arrays: Arrays,
}

impl Picture {
    fn new([width, height, frames]: [usize; 3], n: usize, has_known: bool, rng: &mut SplitMix64) -> Self {
        let pixels = width * height * frames;
        let u = points(pixels * n, 2, rng);
        let mut f = vec![];
        for (i, u) in u.chunks(2).enumerate() {
            let at = (i / n % width) as f32 + 0.5 * (i / n / width) as f32;
            f.push(if u[0] + u[1] < 0.1 * at { 1.0 + u[1] } else { 0.0 });
            f.push(u[0] * u[0] * at + if rng.below(97) == 0 { 900.0 } else { 0.0 });
        }
        let known = u.chunks(2).flat_map(|u| [1.0 + u[1], u[0]]).collect();
        let arrays = Arrays {
            u,
            f,
            surfaces: (0..pixels).map(|pixel| (pixel % width / 5 + rng.below(2)) as u32).collect(),
            factors: (0..2 * pixels).map(|_| 0.5 + rng.uniform_f32()).collect(),
            known,
            integrals: (0..pixels).flat_map(|_| [1.5, 0.5]).collect(),
        };
        Self { width, height, frames, n, has_known, arrays }
    }

    /// The numbers of a part's pixels.
    fn pixels(&self, of: &Rectangle) -> Vec<usize> {
        let mut pixels = vec![];
        for frame in 0..self.frames {
            for y in of.y..of.y + of.height {
                pixels.extend((of.x..of.x + of.width).map(|x| (frame * self.height + y) * self.width + x));
            }
        }
        pixels
    }

    /// The whole arrays, in which a part alone has numbers.
    fn fill(&self, of: &Rectangle) -> Arrays {
        let pixels = self.pixels(of);
        let all = &self.arrays;
        let each = |values: &[f32], width: usize| -> Vec<f32> {
            let is_there = |index: usize| pixels.binary_search(&(index / width)).is_ok();
            values.iter().enumerate().map(|(i, &value)| if is_there(i) { value } else { f32::NAN }).collect()
        };
        Arrays {
            u: each(&all.u, 2 * self.n),
            f: each(&all.f, 2 * self.n),
            surfaces: all.surfaces.clone(),
            factors: each(&all.factors, 2),
            known: each(&all.known, 2 * self.n),
            integrals: each(&all.integrals, 2),
        }
    }

    /// The arrays of a part.
    fn cut(&self, of: &Rectangle) -> Arrays {
        let pixels = self.pixels(of);
        let all = &self.arrays;
        let each = |values: &[f32], width: usize| -> Vec<f32> {
            pixels.iter().flat_map(|&pixel| values[pixel * width..(pixel + 1) * width].iter().copied()).collect()
        };
        Arrays {
            u: each(&all.u, 2 * self.n),
            f: each(&all.f, 2 * self.n),
            surfaces: pixels.iter().map(|&pixel| all.surfaces[pixel]).collect(),
            factors: each(&all.factors, 2),
            known: each(&all.known, 2 * self.n),
            integrals: each(&all.integrals, 2),
        }
    }

    fn image<'a>(&self, arrays: &'a Arrays, base: &Image<'a>) -> Image<'a> {
        let known = |values: &'a [f32]| if self.has_known { values } else { &[] };
        Image {
            width: self.width,
            height: self.height,
            frames: self.frames,
            surfaces: &arrays.surfaces,
            factors: &arrays.factors,
            known: known(&arrays.known),
            known_integrals: known(&arrays.integrals),
            ..*base
        }
    }
}

fn estimates(config: &Config, image: &Image<'_>, arrays: &Arrays) -> Result<Vec<Estimate>, Error> {
    shared::image(config, image, Samples::new(&arrays.u, &arrays.f))
}

fn same(a: &Estimate, b: &Estimate) -> bool {
    let bits = |e: &Estimate| [e.mean, e.std_error, [e.gain; 4]].map(|values| values.map(f32::to_bits));
    bits(a) == bits(b) && a.samples == b.samples
}

/// Rectangles at random, of arrays that hold no more than is needed, and of all in which nothing else is a number.
#[test]
fn parts_have_the_bits_of_the_whole() {
    let mut rng = SplitMix64::new(1);
    let windows = [(0, 0), (8, 8), (5, 3), (7, 1), (4, 3), (16, 9)];
    for (case, shape) in [[37, 29, 1], [9, 40, 1], [16, 16, 2], [6, 5, 1]].into_iter().enumerate() {
        for (window, stride) in windows {
            for n in [1, 3, 4] {
                let picture = Picture::new(shape, n, case % 2 == 0, &mut rng);
                let estimator = if case == 3 { Estimator::KFold } else { Estimator::Robust };
                let config = Config { estimator, edges: n / 4, ..Config::new(2, 2, 2) };
                // So many slices that whether they have slopes depends on the size of a group.
                let sliced = Config { slices: 40, edges: 0, ..Config::new(2, 1, 2) };
                let config = if window == stride { sliced } else { config };
                let base = Image { window, stride, ..Image::new(shape[0], shape[1]) };
                let whole = picture.image(&picture.arrays, &base);
                let expected = estimates(&config, &whole, &picture.arrays).unwrap();
                for _ in 0..6 {
                    let [x, y] = [rng.below(shape[0]), rng.below(shape[1])];
                    let wanted = Rectangle::new(x, y, 1 + rng.below(shape[0] - x), 1 + rng.below(shape[1] - y));
                    let given = Image { wanted, ..whole }.needed().unwrap();
                    let filled = picture.fill(&given);
                    let of = Image { wanted, ..picture.image(&filled, &base) };
                    let from_all = estimates(&config, &of, &filled).unwrap();
                    let arrays = picture.cut(&given);
                    let alone = Image { given, wanted, ..picture.image(&arrays, &base) };
                    let from_needed = estimates(&config, &alone, &arrays).unwrap();
                    assert_eq!(from_all.len(), wanted.width * wanted.height * shape[2]);
                    assert_eq!(from_needed.len(), from_all.len());
                    for (i, (a, b)) in from_all.iter().zip(&from_needed).enumerate() {
                        let [column, row] = [i % wanted.width, i / wanted.width];
                        let [row, frame] = [row % wanted.height, row / wanted.height];
                        let pixel = (frame * shape[1] + wanted.y + row) * shape[0] + wanted.x + column;
                        assert!(same(a, &expected[pixel]), "{shape:?} {window} {stride} {n} {wanted:?} {i}");
                        assert!(same(b, &expected[pixel]), "{shape:?} {window} {stride} {n} {given:?} {i}");
                    }
                }
            }
        }
    }
}

/// Arrays with room for samples that are still to come, which are no numbers yet: the bits of arrays without.
#[test]
fn samples_to_come_are_not_read() {
    let mut rng = SplitMix64::new(2);
    for (n, room) in [(1, 1), (1, 7), (2, 2), (4, 4), (5, 3)] {
        for (config, unordered) in [
            (Config { edges: 1, ..Config::new(2, 2, 2) }, false),
            (Config { slices: 3, ..Config::new(2, 1, 2) }, false),
            (Config { estimator: Estimator::LeaveOneOut, stratified: true, ..Config::new(2, 2, 2) }, true),
        ] {
            let picture = Picture::new([13, 9, 2], n, true, &mut rng);
            let with_room = |values: &[f32]| -> Vec<f32> {
                let more = vec![f32::NAN; 2 * room];
                values.chunks(2 * n).flat_map(|of_pixel| [of_pixel, &more].concat()).collect()
            };
            let all = &picture.arrays;
            let roomy = Arrays {
                u: with_room(&all.u),
                f: with_room(&all.f),
                known: with_room(&all.known),
                surfaces: all.surfaces.clone(),
                factors: all.factors.clone(),
                integrals: all.integrals.clone(),
            };
            let base = Image { unordered, ..Image::new(13, 9) };
            let expected = estimates(&config, &picture.image(all, &base), all).unwrap();
            let of = Image { samples: n, ..picture.image(&roomy, &base) };
            assert_eq!(
                image_workspace_len(&config, &of, n + room),
                image_workspace_len(&config, &picture.image(all, &base), n)
            );
            let found = estimates(&config, &of, &roomy).unwrap();
            assert!(expected.iter().zip(&found).all(|(a, b)| same(a, b)), "{n} {room} {config:?}");
            let refused = |samples| estimates(&config, &Image { samples, ..of }, &roomy).unwrap_err();
            assert_eq!([0, n + 1, n + room].map(refused), [Error::NotFinite; 3]);
            assert_eq!([n + room + 1, usize::MAX].map(refused), [Error::Range; 2]);
            // More samples than 32 bits count are refused, also where few of them count.
            let huge = Image { samples: n, ..Image::new(1 << 10, 1 << 10) };
            assert_eq!(image_workspace_len(&config, &huge, 1 << 12), Err(Error::Range));
        }
    }
}

/// One column or row less than is needed is refused, as is what lies beyond the image.
#[test]
fn no_less_than_needed() {
    let config = Config::new(2, 2, 1);
    let base = Image { width: 64, height: 48, ..Image::new(64, 48) };
    let fails = |image: &Image<'_>| image_workspace_len(&config, image, 1) == Err(Error::Range);
    let wanted = Rectangle::new(18, 17, 10, 9);
    let of = Image { wanted, ..base };
    // Windows of 8 begin at every fourth pixel: from 12 to before 32.
    let needed = of.needed().unwrap();
    assert_eq!(needed, Rectangle::new(12, 12, 20, 20));
    assert!(!fails(&Image { given: needed, ..of }));
    let Rectangle { x, y, width, height } = needed;
    for given in [
        Rectangle::new(x + 1, y, width - 1, height),
        Rectangle::new(x, y + 1, width, height - 1),
        Rectangle::new(x, y, width - 1, height),
        Rectangle::new(x, y, width, height - 1),
        Rectangle::new(x, y, 65 - x, height),
        Rectangle::new(x, y, width, usize::MAX),
        Rectangle::new(usize::MAX, y, width, height),
        Rectangle::new(x, y, 0, height),
    ] {
        assert!(fails(&Image { given, ..of }), "{given:?}");
    }
    for wanted in [
        Rectangle::new(60, 0, 5, 5),
        Rectangle::new(0, 48, 5, 1),
        Rectangle::new(0, 0, usize::MAX, 1),
        Rectangle::new(0, 0, 1, 0),
    ] {
        assert!(fails(&Image { wanted, ..base }), "{wanted:?}");
        assert!(Image { wanted, ..base }.needed().is_err(), "{wanted:?}");
    }
    // Pixels without places have no parts.
    let block = Image::unordered(100);
    assert!(fails(&Image { wanted, ..block }));
    assert!(!fails(&Image { given: block.needed().unwrap(), ..block }));
}

/// Two windows side by side, in lanes of one register. All pixels of the first are far from the others in a channel,
/// and so in no fit of the second pass; what is chosen for the other window must not depend on that.
#[test]
fn a_window_without_pixels_inside_changes_no_other() {
    for seed in 0..64 {
        let mut rng = SplitMix64::new(seed);
        let u = points(32, 2, &mut rng);
        let mut f: Vec<f32> = (0..32 * 4).map(|_| 1.0 + 0.1 * rng.uniform_f32()).collect();
        for pixel in 0..8 {
            let far = if pixel % 2 == 0 { 1e4 } else { -1e4 };
            (0..2).for_each(|sample| f[(2 * pixel + sample) * 4 + pixel / 2] = far);
        }
        f[2 * 11 * 4] = 300.0;
        let config = Config::new(2, 2, 4);
        let whole = Image { window: 8, stride: 8, ..Image::new(16, 1) };
        let part = Rectangle::new(8, 0, 8, 1);
        let expected = shared::image(&config, &whole, Samples::new(&u, &f)).unwrap();
        let alone = Image { given: part, wanted: part, ..whole };
        let alone = shared::image(&config, &alone, Samples::new(&u[32..], &f[64..])).unwrap();
        for (pixel, (a, b)) in expected[8..].iter().zip(&alone).enumerate() {
            assert!(same(a, b), "seed {seed}, pixel {pixel}: {a:?} {b:?}");
        }
    }
}
