//! `cargo xtask demo`: the path tracer with every sampler, with and without fits, as a picture and a table; then the
//! trainers, as the report's chapter of gradients.

use crate::chapters;
use crate::chapters::chapter::Chapter;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::Measurement;
use crate::chapters::template;
use crate::measure::filter::SIGMA;
use crate::measure::metric::Reference;
use crate::measure::output::Output;
use crate::measure::part::Part;
use crate::measure::renderer::{Job, Renderer, View};
use crate::measure::{progress, running, text};
use anyhow::{Context, Result, anyhow};
use clap::Args;
use image::imageops::replace;
use image::{Rgb, Rgb32FImage, RgbImage};
use itertools::{Itertools, iproduct};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use xtask::paths;
use xtask::tools::Missing;

#[derive(Args)]
pub(crate) struct Options {
    /// Small images, few seeds
    #[arg(long)]
    quick: bool,
    /// Where everything goes [default: target/demo]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// A scene of the path tracer: its name, what is integrated, the order of the fits.
const SCENES: [(&str, &str, u32); 5] = [
    ("direct", "the light's surface (2 dims)", 2),
    ("lens", "the lens and the light's surface (4 dims)", 2),
    ("motion", "time and the light's surface (3 dims)", 2),
    ("lights", "six lights' surfaces and their choice (3 dims)", 2),
    ("global", "three bounces (15 dims)", 1),
];
const SPP: [u32; 3] = [1, 4, 16];
const SAMPLERS: [&str; 3] = ["random", "Owen-Sobol", "default"];
const ESTIMATORS: [&str; 3] = ["mc", "robust", "shared"];

/// What was rendered of one scene.
struct Rendered {
    spp: u32,
    sampler: &'static str,
    estimator: &'static str,
    image: Rgb32FImage,
    /// Raw, and filtered.
    errors: [f64; 2],
    nanoseconds: f64,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let folder = options.out.clone().unwrap_or_else(|| paths::target().join("demo"));
    let folder = std::path::absolute(&folder).with_context(|| format!("{} is no folder", folder.display()))?;
    println!("building the library and the path tracer");
    // The library and the page's module are compiled for the most part by one thread each.
    let (page, program) = thread::scope(|scope| {
        let page = scope.spawn(xtask::playground::build);
        let program = running::example("pathtracer.cpp", &["-O2"]);
        (page.join(), program)
    });
    let renderer = Renderer::new(program?)?;
    let output = Output::new(&folder)?;
    println!("rendering");
    scenes(options, &renderer, &output)?;
    // The page may be built where it is shown.
    let page = page.unwrap_or_else(|_| Err(anyhow!("the page's build was lost")));
    let is_there = |file: &str| file == PAGE && page.as_ref().is_ok_and(|page| *page == folder.join(PAGE));
    let shown = SHOWN.iter().map(|(file, _)| *file).filter(|file| !is_there(file)).map(str::to_owned);
    output.commit(&shown.collect::<Vec<_>>())?;
    match page {
        Ok(page) if page != folder.join(PAGE) => {
            fs::copy(&page, folder.join(PAGE)).with_context(|| format!("cannot copy {}", page.display()))?;
        }
        Err(why) if why.is::<Missing>() => println!("without the page to play with: {why}"),
        result => drop(result?),
    }
    index(&folder)?;
    println!("{}\n", folder.join("shared.png").display());
    chapters::run(&chapters::Options::gradients(options.quick, &folder))?;
    index(&folder)?;
    println!("pictures and tables: {}", folder.join("index.html").display());
    Ok(())
}

fn scenes(options: &Options, renderer: &Renderer, output: &Output) -> Result<()> {
    let (size, reference) = if options.quick { (128, 30) } else { (256, 100) };
    let bar = progress::bar((SCENES.len() * SPP.len() * SAMPLERS.len()) as u64)?;
    let measurement = Measurement::new(renderer, &bar)?;
    let mut chapter = Chapter::new("Samplers and fits in a path tracer");
    let mut rows = Vec::new();
    for (scene, domain, order) in SCENES {
        let view = View { scene, size, frame: 0, reference };
        let mut all = Vec::new();
        for (spp, name) in iproduct!(SPP, SAMPLERS) {
            let sampler = renderer.sampler(name, spp).with_context(|| format!("the path tracer has no {name}"))?;
            let job = Job { sampler, order, ..Job::new(view, spp, &ESTIMATORS) };
            let outcome = measurement.run(&[job])?.pop().context("a rendering was lost")?;
            for estimator in ESTIMATORS {
                let of = outcome.of(estimator)?;
                let image = of.images.first().context("no image")?.clone();
                let errors = outcome.reference.errors(&image);
                let nanoseconds = of.timings.first().context("the path tracer printed no times")?.frame();
                all.push(Rendered { spp, sampler: name, estimator, image, errors, nanoseconds });
            }
            bar.inc(1);
        }
        for one in &all {
            let [raw, filtered] = ratios(one, &all).map(|ratio| Figure::exact(ratio, Unit::Ratio));
            let (spp, time) = (one.spp.to_string(), Figure::exact(one.nanoseconds, Unit::Nanoseconds));
            rows.push(json!([scene, domain, spp, one.sampler, one.estimator, raw, filtered, time]));
        }
        if scene == SCENES[0].0 {
            output.write_picture("shared.png", &draw(&all, &*measurement.reference(view)?))?;
        }
    }
    bar.finish_and_clear();
    let columns = "scene | integral over | spp | sampler | estimator | error over random's | filtered | ns per \
                   sample";
    chapter.table("demo", columns, 2, rows);
    let table = template::chapter("demo", &chapter.json(), &|_| true)?;
    output.write_text("demo.md", &table)?;
    println!("{table}");
    Ok(())
}

/// What `index.html` shows, if it is there already; none of it is left of an earlier run.
const SHOWN: [(&str, &str); 6] = [
    ("shared.png", "Samplers and shared fits at equal samples: each image with its error below"),
    ("gradients-digits-time.svg", "Test error of small digits against seconds of training"),
    ("gradients-mnist-time.svg", "Test error of MNIST against seconds of training"),
    ("demo.md", "The table of samplers and fits"),
    ("gradients.md", "The tables of trainers"),
    (PAGE, "A page to play with"),
];
const PAGE: &str = "playground.html";

fn index(folder: &Path) -> Result<()> {
    let show = |(file, words): (&str, &str)| match file.ends_with('g') {
        true => format!("<figure><figcaption>{words}</figcaption><img src=\"{file}\" alt=\"{words}\"></figure>\n"),
        false => format!("<p><a href=\"{file}\">{words}</a></p>\n"),
    };
    let mut shown = SHOWN.into_iter().filter(|(file, _)| folder.join(file).exists()).map(show);
    let head = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>noisefloor: demo</title>\n\
        <meta name=\"viewport\" content=\"width=device-width\"><style>img { max-width: 100% }</style>\n\
        <main><h1>noisefloor: demo</h1>\n";
    fs::write(folder.join("index.html"), head.to_owned() + &shown.join("") + "</main>\n")
        .context("cannot write index.html")
}

/// Raw and filtered errors over those of the plain mean of as many random samples.
fn ratios(one: &Rendered, all: &[Rendered]) -> [f64; 2] {
    let is_plain = |of: &&Rendered| (of.spp, of.sampler, of.estimator) == (one.spp, SAMPLERS[0], ESTIMATORS[0]);
    let plain = all.iter().find(is_plain).map_or([f64::NAN; 2], |plain| plain.errors);
    [one.errors[0] / plain[0], one.errors[1] / plain[1]]
}

const GAP: u32 = 8;
const BACKGROUND: Rgb<u8> = Rgb([24, 24, 28]);
/// Of the image: the part's size in pixels, its corner, how much it is enlarged.
const PART: [u32; 2] = [108, 80];
const CORNER: [f64; 2] = [0.17, 0.49];
const ZOOM: u32 = 2;
const COLUMNS: [(&str, &str, &str); 4] = [
    (SAMPLERS[0], ESTIMATORS[0], "random"),
    (SAMPLERS[1], ESTIMATORS[0], "Owen-scrambled Sobol"),
    (SAMPLERS[2], ESTIMATORS[0], "noisefloor"),
    (SAMPLERS[2], ESTIMATORS[2], "noisefloor, shared fits"),
];

/// Parts of a scene's images, each above its errors.
fn draw(all: &[Rendered], reference: &Reference) -> RgbImage {
    let part = Part::new(CORNER, PART, ZOOM, reference);
    let [width, height] = PART.map(|size| size * ZOOM);
    let row_height = text::LINE + 2 * (height + GAP / 2) + text::LINE + GAP;
    let top = GAP + 2 * text::LINE;
    let size = [GAP + (width + GAP) * COLUMNS.len() as u32, top + row_height * SPP.len() as u32];
    let mut picture = RgbImage::from_pixel(size[0], size[1], BACKGROUND);
    let title = format!(
        "Squared errors over those of as many random samples: raw, and as seen through a Gaussian of {SIGMA} pixels"
    );
    text::draw(&mut picture, GAP, GAP / 2, &title);
    let left = |index: usize| GAP + (width + GAP) * index as u32;
    for (index, (_, _, name)) in COLUMNS.iter().enumerate() {
        text::draw(&mut picture, left(index), GAP / 2 + text::LINE, name);
    }
    for (spp, y) in SPP.into_iter().zip((top..).step_by(row_height as usize)) {
        let find = |(sampler, estimator, _): (&str, &str, &str)| {
            all.iter().find(|one| (one.spp, one.sampler, one.estimator) == (spp, sampler, estimator))
        };
        let cells = COLUMNS.map(find);
        let scale = cells[0].map_or(1.0, |one| part.error_scale(&one.image));
        let samples = if spp == 1 { "sample" } else { "samples" };
        let words = format!("{spp} {samples} per pixel; below, errors from -{scale:.2} to {scale:.2}");
        text::draw(&mut picture, GAP, y, &words);
        let [images, errors] = [y + text::LINE, y + text::LINE + height + GAP / 2];
        for (index, one) in cells.into_iter().enumerate() {
            let Some(one) = one else { continue };
            let x = left(index);
            replace(&mut picture, &part.image(&one.image), x.into(), images.into());
            replace(&mut picture, &part.errors(&one.image, scale), x.into(), errors.into());
            let [raw, filtered] = ratios(one, all);
            text::draw(&mut picture, x, errors + height + 1, &format!("raw {raw:.2} filtered {filtered:.2}"));
        }
    }
    picture
}
