//! The page's numbers without a browser: `numbers SAMPLES SAMPLER FITS FRAME SIGMA` prints the sampler's error and
//! plain Monte Carlo's.

use noisefloor_playground::{measure, prepare, reference, render};

fn main() {
    let given: Result<Vec<f32>, _> = std::env::args().skip(1).map(|word| word.parse()).collect();
    let [samples, sampler, fits, frame, sigma] = given.unwrap_or_default()[..] else {
        eprintln!("numbers SAMPLES SAMPLER FITS FRAME SIGMA: five numbers are needed");
        std::process::exit(2);
    };
    prepare(0);
    reference(0, 0, 256);
    let fitted = render(0, sampler as u32, samples as usize, frame as u32, fits != 0.0);
    render(1, 0, samples as usize, frame as u32, false);
    println!("{:?} {:?} {fitted}", measure(0, 0, sigma), measure(1, 0, sigma));
}
