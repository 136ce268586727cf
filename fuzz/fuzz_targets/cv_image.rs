//! Any configuration, any image and any samples through the shared fits: an error or finite numbers, never a panic.
#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use libfuzzer_sys::fuzz_target;
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{
    Color, Config, Estimator, Image, NonFinite, Rectangle, Ridge, Samples, estimate_image, image_workspace_len,
};

/// Workspaces beyond this many numbers are not allocated.
const MOST: usize = 1 << 22;

#[derive(Debug)]
struct Input {
    config: Config,
    shape: [usize; 5],
    parts: [usize; 8],
    unordered: bool,
    samples: usize,
    surfaces: Vec<u32>,
    factors: Vec<f32>,
    known: Vec<f32>,
    integrals: Vec<f32>,
    u: Vec<f32>,
    f: Vec<f32>,
    controls: Vec<f32>,
    control_integrals: Vec<f32>,
}

fn small(bytes: &mut Unstructured<'_>, most: u8) -> arbitrary::Result<usize> {
    // Now and then far out of range.
    Ok(match u8::arbitrary(bytes)? {
        255 => usize::arbitrary(bytes)?,
        byte => usize::from(byte % (most + 1)),
    })
}

/// As many as there are bytes for, then more of the last.
fn list<'a, T: Copy>(
    bytes: &mut Unstructured<'a>,
    len: usize,
    mut item: impl FnMut(&mut Unstructured<'a>) -> arbitrary::Result<T>,
) -> arbitrary::Result<Vec<T>> {
    let mut out = Vec::new();
    while out.len() < len {
        match out.last() {
            Some(&last) if bytes.is_empty() => out.resize(len, last),
            _ => out.push(item(bytes)?),
        }
    }
    Ok(out)
}

impl<'a> Arbitrary<'a> for Input {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let rarely = |bytes: &mut Unstructured<'a>| Ok::<_, arbitrary::Error>(u8::arbitrary(bytes)? > 240);
        let config = Config {
            dims: small(bytes, 5)?,
            order: small(bytes, 7)?,
            channels: small(bytes, 4)?,
            estimator: *bytes.choose(&[
                Estimator::Robust,
                Estimator::Robust,
                Estimator::LeaveOneOut,
                Estimator::KFold,
                Estimator::LeastSquares,
            ])?,
            basis: *bytes.choose(&Family::ALL)?,
            stratified: bool::arbitrary(bytes)?,
            slices: small(bytes, 8)?.saturating_sub(3),
            edges: small(bytes, 6)?.saturating_sub(3),
            controls: usize::from(rarely(bytes)?),
            stride: small(bytes, 18)?.saturating_sub(10),
            non_finite: if rarely(bytes)? { NonFinite::Skip } else { NonFinite::Error },
            color: if rarely(bytes)? { Color::LuminanceRatio } else { Color::PerChannel },
            ridge: match u8::arbitrary(bytes)? % 4 {
                0 => Ridge::Auto,
                1 => Ridge::Fixed(f32::arbitrary(bytes)?),
                _ => Ridge::Default,
            },
            ..Config::new(1, 1, 1)
        };
        let shape =
            [small(bytes, 12)?, small(bytes, 12)?, small(bytes, 3)?.max(1), small(bytes, 12)?, small(bytes, 8)?];
        let [width, height, frames, ..] = shape;
        // Mostly none, else a part of the image, what it needs or anything.
        let mut parts = [0; 8];
        if bool::arbitrary(bytes)? {
            for part in &mut parts {
                *part = small(bytes, 12)?;
            }
            if bool::arbitrary(bytes)? {
                let [x, y, width, height, ..] = parts;
                let wanted = Rectangle::new(x, y, width, height);
                let [across, down, frames, window, stride] = shape;
                let needed = Image { wanted, frames, window, stride, ..Image::new(across, down) }.needed();
                let given = needed.unwrap_or_default();
                parts[4..].copy_from_slice(&[given.x, given.y, given.width, given.height]);
            }
        }
        let [.., part_width, part_height] = parts;
        let (columns, rows) = if parts[4..] == [0; 4] { (width, height) } else { (part_width, part_height) };
        let pixels = columns.saturating_mul(rows).saturating_mul(frames).min(512);
        let n = usize::from(u8::arbitrary(bytes)? % 6);
        let slack = usize::from(u8::arbitrary(bytes)? / 250);
        let step = if config.stride == 0 { config.dims } else { config.stride };
        let len = |width: usize| (pixels * n).saturating_mul(width).min(1 << 15) + slack;
        let surfaces = if bool::arbitrary(bytes)? { pixels + slack } else { 0 };
        let surfaces = list(bytes, surfaces, |bytes| Ok(u32::from(u8::arbitrary(bytes)? % 4)))?;
        let factors_len = pixels * config.channels.min(4) + slack;
        let factors = if bool::arbitrary(bytes)? { factors_len } else { 0 };
        let finite = !rarely(bytes)?;
        let value = |bytes: &mut Unstructured<'a>| {
            let value = f32::arbitrary(bytes)?;
            Ok(if finite && !value.is_finite() { 1.0 } else { value })
        };
        let factors = list(bytes, factors, |bytes| value(bytes).map(|value| if finite { value.abs() } else { value }))?;
        let has_known = bool::arbitrary(bytes)?;
        let (known, integrals) = if has_known { (len(config.channels), factors_len) } else { (0, 0) };
        let integrals =
            list(bytes, integrals, |bytes| value(bytes).map(|value| if finite { value.abs() } else { value }))?;
        Ok(Self {
            config,
            shape,
            parts,
            unordered: rarely(bytes)?,
            samples: if rarely(bytes)? { usize::from(u8::arbitrary(bytes)? % 4) } else { 0 },
            surfaces,
            factors,
            known: list(bytes, known, value)?,
            integrals,
            u: list(bytes, len(step), |bytes| {
                Ok(if finite { f32::from(u16::arbitrary(bytes)?) / 65535.0 } else { f32::arbitrary(bytes)? })
            })?,
            f: list(bytes, len(config.channels), value)?,
            controls: list(bytes, len(config.controls), value)?,
            control_integrals: list(bytes, config.controls.min(8), value)?,
        })
    }
}

fn run(input: &Input) {
    let Input { config, shape: [width, height, frames, window, stride], unordered, .. } = *input;
    let (surfaces, factors) = (&input.surfaces[..], &input.factors[..]);
    let (known, integrals) = (&input.known[..], &input.integrals[..]);
    let [x, y, columns, rows, given_x, given_y, given_columns, given_rows] = input.parts;
    let image = Image {
        frames,
        window,
        stride,
        unordered,
        samples: input.samples,
        surfaces,
        factors,
        known,
        known_integrals: integrals,
        wanted: Rectangle::new(x, y, columns, rows),
        given: Rectangle::new(given_x, given_y, given_columns, given_rows),
        ..Image::new(width, height)
    };
    let samples =
        Samples { u: &input.u, f: &input.f, controls: &input.controls, control_integrals: &input.control_integrals };
    let all = Rectangle::new(0, 0, width, height);
    let or = |part: Rectangle, all| if part == Rectangle::default() { all } else { part };
    let (given, wanted) = (or(image.given, all), or(image.wanted, or(image.given, all)));
    let count = |of: Rectangle| of.width.saturating_mul(of.height).saturating_mul(frames);
    let (pixels, estimates) = (count(given), count(wanted));
    let n = input.f.len().checked_div(config.channels).and_then(|total| total.checked_div(pixels)).unwrap_or(0);
    let nan = f32::NAN;
    let len = match image_workspace_len(&config, &image, n) {
        Ok(len) if len <= MOST => len,
        Ok(_) => return,
        Err(_) => {
            let never = &mut |_, _| panic!("called on an error");
            assert!(estimate_image(&config, &image, samples, &mut [nan; 256], never).is_err());
            return;
        }
    };
    let mut workspace = vec![nan; len];
    for part in [len, len / 2] {
        let (mut count, mut sum) = (0, 0);
        let result = estimate_image(&config, &image, samples, &mut workspace[..part], &mut |index, estimate| {
            count += 1;
            sum += index;
            assert!(estimate.mean.iter().all(|mean| mean.is_finite()), "{estimate:?}");
            assert!(estimate.std_error.iter().all(|&error| error >= 0.0), "{estimate:?}");
            assert!(!estimate.gain.is_nan(), "{estimate:?}");
        });
        // Each pixel once, or none.
        let expected = if result.is_ok() { estimates } else { 0 };
        assert_eq!((count, sum), (expected, expected * expected.saturating_sub(1) / 2));
        assert!(part < len || result != Err(Error::Memory));
    }
}

fuzz_target!(|input: Input| run(&input));
