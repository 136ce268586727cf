//! A small scene rendered by noisefloor's sampler and fits, beside plain Monte Carlo: the module of the page.
#![cfg_attr(target_arch = "wasm32", no_std)]

mod scene;

use noisefloor::control_variate::{Config, Estimate, Image, Samples, estimate_image, image_workspace_len};
use noisefloor::sampler::{Sampler, table};
use scene::{Ball, Hit, NO_BALLS, NOTHING, PHASES, PIXELS, SIDE};

#[cfg(target_arch = "wasm32")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    core::arch::wasm32::unreachable()
}

/// The most samples of a pixel that fits are shared of.
const FITTED: usize = 16;
const WORKSPACE: usize = 1 << 22;

/// All that the page has: one, in memory that a module has anyway.
pub struct Page {
    hits: [Hit; PIXELS],
    surfaces: [u32; PIXELS],
    balls: [Ball; 4],
    references: [[f32; PIXELS]; PHASES],
    /// The sampler's, plain Monte Carlo's.
    images: [[f32; PIXELS]; 2],
    errors: [f32; PIXELS],
    scratch: [f32; PIXELS],
    colours: [u8; 4 * PIXELS],
    u: [f32; 2 * FITTED * PIXELS],
    f: [f32; FITTED * PIXELS],
    workspace: [f32; WORKSPACE],
}

static mut PAGE: Page = Page {
    hits: [NOTHING; PIXELS],
    surfaces: [0; PIXELS],
    balls: NO_BALLS,
    references: [[0.0; PIXELS]; PHASES],
    images: [[0.0; PIXELS]; 2],
    errors: [0.0; PIXELS],
    scratch: [0.0; PIXELS],
    colours: [0; 4 * PIXELS],
    u: [0.0; 2 * FITTED * PIXELS],
    f: [0.0; FITTED * PIXELS],
    workspace: [0.0; WORKSPACE],
};

fn page() -> &'static mut Page {
    // SAFETY: the page and `numbers` have one thread, and no function below calls another that asks again.
    unsafe { &mut *(&raw mut PAGE) }
}

fn hash(mut h: u32) -> u32 {
    h = (h ^ h >> 16).wrapping_mul(0x7feb_352d);
    h = (h ^ h >> 15).wrapping_mul(0x846c_a68b);
    h ^ h >> 16
}

fn unit(value: u32) -> f32 {
    (value >> 8) as f32 / 16_777_216.0
}

/// Burley 2020: nested uniform scrambling by Laine and Karras' hash.
fn owen(value: u32, seed: u32) -> u32 {
    let mut v = value.reverse_bits();
    v ^= v.wrapping_mul(0x3d20_adea);
    v = v.wrapping_add(seed);
    v = v.wrapping_mul(seed >> 16 | 1);
    v ^= v.wrapping_mul(0x0552_6c56);
    v ^= v.wrapping_mul(0x53a2_2864);
    v.reverse_bits()
}

/// Sampler 0: random; 1: Sobol's points, scrambled in each pixel by Owen's scheme; 2: noisefloor's.
fn draw(sampler: u32, pixel: usize, frame: u32, index: u32) -> [f32; 2] {
    let seed = hash(pixel as u32 ^ hash(frame));
    match sampler {
        0 => [0, 1].map(|axis| unit(hash(seed ^ hash(2 * index + axis)))),
        1 => {
            let [a, b] = table::net(index);
            [unit(owen(a, hash(seed ^ 1))), unit(owen(b, hash(seed ^ 2)))]
        }
        _ => Sampler::pixel((pixel % SIDE) as u32, (pixel / SIDE) as u32, frame, index).draw(),
    }
}

/// Moves the balls.
#[unsafe(no_mangle)]
pub extern "C" fn prepare(phase: usize) {
    let page = page();
    page.balls = scene::balls(phase);
    for (pixel, (hit, surface)) in page.hits.iter_mut().zip(&mut page.surfaces).enumerate() {
        *hit = scene::first_hit(pixel, &page.balls);
        *surface = hit.surface;
    }
}

/// The true values of some rows of the prepared phase, by a midpoint rule.
#[unsafe(no_mangle)]
pub extern "C" fn reference(phase: usize, row: usize, rows: usize) {
    const N: usize = 18;
    let page = page();
    let (hits, balls) = (&page.hits, &page.balls);
    for (pixel, out) in page.references[phase % PHASES].iter_mut().enumerate().skip(row * SIDE).take(rows * SIDE) {
        let at = |i: usize| (i as f32 + 0.5) / N as f32;
        let all = (0..N * N).map(|i| scene::radiance(&hits[pixel], balls, [at(i % N), at(i / N)]));
        *out = all.sum::<f32>() / (N * N) as f32;
    }
}

/// Renders the prepared phase into image 0 or 1; with fits (of up to 16 samples) it returns 1 if they were made.
#[unsafe(no_mangle)]
pub extern "C" fn render(which: usize, sampler: u32, samples: usize, frame: u32, fits: bool) -> u32 {
    let page = page();
    let image = &mut page.images[which & 1];
    let is_fitted = fits && samples <= FITTED;
    for (pixel, (hit, out)) in page.hits.iter().zip(image.iter_mut()).enumerate() {
        let mut sum = 0.0;
        for index in 0..samples {
            let u = draw(sampler, pixel, frame, index as u32);
            let f = scene::radiance(hit, &page.balls, u);
            if is_fitted {
                let at = pixel * samples + index;
                page.f[at] = f;
                page.u[2 * at..2 * at + 2].copy_from_slice(&u);
            }
            sum += f;
        }
        *out = sum / samples as f32;
    }
    if !is_fitted {
        return 0;
    }
    let config = Config { stratified: sampler != 0, ..Config::new(2, 2, 1) };
    let shown = Image { surfaces: &page.surfaces, ..Image::new(SIDE, SIDE) };
    let Some(workspace) =
        image_workspace_len(&config, &shown, samples).ok().and_then(|len| page.workspace.get_mut(..len))
    else {
        return 0;
    };
    let given = Samples::new(&page.u[..2 * samples * PIXELS], &page.f[..samples * PIXELS]);
    let mut put = |pixel: usize, estimate: Estimate| image[pixel] = estimate.mean[0];
    let done = estimate_image(&config, &shown, given, workspace, &mut put);
    u32::from(done.is_ok())
}

fn blur(image: &mut [f32; PIXELS], scratch: &mut [f32; PIXELS], sigma: f32) {
    if sigma <= 0.0 {
        return;
    }
    let mut kernel = [0.0; 13];
    let taps = (libm::ceilf(3.0 * sigma) as usize + 1).min(kernel.len());
    let kernel = &mut kernel[..taps];
    let mut sum = 0.0;
    for (k, weight) in kernel.iter_mut().enumerate() {
        *weight = libm::expf(-0.5 * (k as f32 / sigma) * (k as f32 / sigma));
        sum += if k == 0 { *weight } else { 2.0 * *weight };
    }
    for step in [1, SIDE] {
        for (pixel, out) in scratch.iter_mut().enumerate() {
            let at = pixel / step % SIDE;
            let line = pixel - at * step;
            let value = |k: usize| image[line + k.min(SIDE - 1) * step];
            let pairs = (1..kernel.len()).map(|k| kernel[k] * (value(at.saturating_sub(k)) + value(at + k)));
            *out = (kernel[0] * image[pixel] + pairs.sum::<f32>()) / sum;
        }
        image.copy_from_slice(scratch);
    }
}

/// The mean squared error of an image, blurred or not, over the mean square of the reference.
#[unsafe(no_mangle)]
pub extern "C" fn measure(which: usize, phase: usize, sigma: f32) -> f64 {
    let page = page();
    let reference = &page.references[phase % PHASES];
    for ((error, value), exact) in page.errors.iter_mut().zip(&page.images[which & 1]).zip(reference) {
        *error = value - exact;
    }
    blur(&mut page.errors, &mut page.scratch, sigma);
    let square = |values: &[f32; PIXELS]| values.iter().map(|&value| f64::from(value) * f64::from(value)).sum::<f64>();
    square(&page.errors) / square(reference)
}

/// Makes the colours of an image, blurred, or of the errors that were measured last.
#[unsafe(no_mangle)]
pub extern "C" fn paint(which: usize, sigma: f32, errors: bool, gain: f32) -> *const u8 {
    let page = page();
    if !errors {
        page.errors = page.images[which & 1];
        blur(&mut page.errors, &mut page.scratch, sigma);
    }
    for ((colour, hit), &value) in page.colours.chunks_exact_mut(4).zip(&page.hits).zip(&page.errors) {
        let channels = if errors {
            // Too bright is orange, too dark is blue.
            let size = value * gain;
            [0.15 + size, 0.15 + 0.4 * size.abs(), 0.15 - size]
        } else {
            hit.albedo.map(|albedo| libm::sqrtf((albedo * value).max(0.0)))
        };
        let bytes = channels.map(|channel| (255.0 * channel.clamp(0.0, 1.0)) as u8);
        colour.copy_from_slice(&[bytes[0], bytes[1], bytes[2], 255]);
    }
    page.colours.as_ptr()
}
