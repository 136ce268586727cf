//! The page's numbers without a browser: `numbers SAMPLES SAMPLER FITS FRAME SIGMA` prints the sampler's error and
//! plain Monte Carlo's.

use noisefloor_playground::{measure, prepare, reference, render};

fn main() {
    let given: Vec<f32> = std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
    let [samples, sampler, fits, frame, sigma] = given[..] else {
        eprintln!("numbers SAMPLES SAMPLER FITS FRAME SIGMA: five numbers are needed");
        std::process::exit(2);
    };
    prepare(0);
    reference(0, 0, 256);
    let fitted = render(0, sampler as u32, samples as usize, frame as u32, fits != 0.0);
    render(1, 0, samples as usize, frame as u32, false);
    println!("{:?} {:?} {fitted}", measure(0, 0, sigma), measure(1, 0, sigma));
}
