//! An animation that is averaged over time, as displays of games do and eyes (section 5.8, figure 5.23).

use super::measure::Measurement;
use super::plan::{Scene, TEMPORAL};
use crate::measure::markdown;
use crate::measure::metric::Reference;
use crate::measure::output::Output;
use crate::measure::renderer::Sampler;
use crate::measure::samplers::Choice;
use crate::measure::score::Score;
use crate::measure::spectrum_sheet as sheet;
use anyhow::Result;
use image::Rgb32FImage;

/// Weight of the newest frame in the exponential moving average (Yang et al. 2020 use .05 to .2).
pub(crate) const ALPHA: f32 = 0.1;

/// Frames that are averaged before the first is looked at, and frames that are looked at.
pub(crate) const FRAMES: u32 = 16;

const HEADINGS: [&str; 7] = [
    "sampler",
    "one frame: relMSE, filtered",
    "ratio",
    "average: relMSE",
    "ratio",
    "average: relMSE, filtered",
    "ratio",
];

const COLUMNS: [&str; 7] = [
    "sampler",
    "frame_filtered_rel_mse",
    "frame_filtered_ratio",
    "average_rel_mse",
    "average_ratio",
    "average_filtered_rel_mse",
    "average_filtered_ratio",
];

struct Measured {
    label: String,
    frame: Score,
    average: Score,
    /// The average after the last frame.
    image: Rgb32FImage,
}

/// Renders one sample per pixel and frame; writes a sheet and a table, and returns the table.
pub(crate) fn run(measurement: &Measurement, scene: &Scene, reference: &Reference, output: &Output) -> Result<String> {
    let tiles = measurement.tiles;
    let spatial = Choice::Tile(2).sampler(1, tiles);
    let temporal = tiles.find(TEMPORAL).map(Sampler::Tile);
    let samplers = [
        ("random", Some(Sampler::Random)),
        ("Owen-Sobol", Some(Sampler::Sobol)),
        ("shifted tile", spatial),
        ("temporal tile", temporal),
    ];
    let mut all = Vec::new();
    for (label, sampler) in samplers {
        if let Some(sampler) = sampler {
            measurement.runs.say(format!("{}: animation, {label}", scene.name));
            all.push(measure(measurement, scene, reference, label, sampler)?);
        }
    }

    let row = |one: &Measured| {
        let base = &all[0];
        let number = |of: fn(&Measured) -> f64| [format!("{:.3e}", of(one)), format!("{:.3}", of(one) / of(base))];
        let [frame, frame_ratio] = number(|one| one.frame.filtered);
        let [raw, raw_ratio] = number(|one| one.average.raw);
        let [filtered, filtered_ratio] = number(|one| one.average.filtered);
        [one.label.clone(), frame, frame_ratio, raw, raw_ratio, filtered, filtered_ratio]
    };
    let cells = all.iter().map(|one| {
        let caption =
            format!("filtered {:.2e} ({:.2}x)", one.average.filtered, one.average.filtered / all[0].average.filtered);
        Some(sheet::Cell { image: &one.image, caption })
    });
    let rows = [sheet::Row { name: "1 sample per pixel".to_owned(), cells: cells.collect() }];
    let columns: Vec<String> = all.iter().map(|one| one.label.clone()).collect();
    let title = format!("{}: moving average of {} frames, new frames weigh {ALPHA}", scene.name, 2 * FRAMES);
    output.write_picture("tiles-animation.png", &sheet::draw(&title, &columns, &rows, scene.crop, reference))?;
    output.write_text("tiles-animation.csv", &markdown::csv(&COLUMNS, all.iter().map(row)))?;
    Ok(markdown::table(&HEADINGS, &[0], all.iter().map(row)))
}

fn measure(
    measurement: &Measurement,
    scene: &Scene,
    reference: &Reference,
    label: &str,
    sampler: Sampler,
) -> Result<Measured> {
    let mut image = measurement.frame(scene, sampler, 1, 0)?;
    let (mut frames, mut averages) = (Vec::new(), Vec::new());
    for frame in 1..2 * FRAMES {
        let new = measurement.frame(scene, sampler, 1, frame)?;
        for (old, new) in image.iter_mut().zip(new.iter()) {
            *old += ALPHA * (new - *old);
        }
        if frame >= FRAMES {
            frames.push(Score::new(&new, reference));
            averages.push(Score::new(&image, reference));
        }
    }
    Ok(Measured { label: label.to_owned(), frame: Score::mean(&frames), average: Score::mean(&averages), image })
}
