//! Kernels: what they are, how they are written, what is refused.

use fsot::tile::{Kernel, TemporalKernel, TileProblem, preset};
use noisefloor::tile::Builtin;

#[test]
fn the_perceptual_kernel_is_a_disc_of_radius_6() {
    let taps = Kernel::Perceptual.taps().unwrap();
    assert_eq!(taps.len(), 113);
    for tap in &taps {
        let square = (tap.dx * tap.dx + tap.dy * tap.dy) as f32;
        assert!(square <= 36.0);
        assert!((tap.weight - (-square / (2.0 * 2.1 * 2.1)).exp()).abs() < 1e-6);
    }
}

#[test]
fn the_convolution_of_gaussians_is_nearly_the_gaussian_of_their_summed_variance() {
    let taps = "gaussian:1.5*gaussian:2".parse::<Kernel>().unwrap().taps().unwrap();
    for tap in taps {
        let square = (tap.dx * tap.dx + tap.dy * tap.dy) as f32;
        let expected = (-square / (2.0 * 2.5 * 2.5)).exp();
        assert!((tap.weight - expected).abs() < 0.01, "{tap:?}, not {expected}");
    }
}

#[test]
fn convolutions_have_two_factors_and_a_largest_radius() {
    for factors in [3, 1000] {
        let error = vec!["perceptual"; factors].join("*").parse::<Kernel>().unwrap_err().to_string();
        assert!(error.contains(&format!("not of {factors}")), "{error}");
    }
    let nested = Kernel::Convolution(Box::new("box*box".parse().unwrap()), Box::new(Kernel::Box));
    assert!(nested.taps().is_err());
    // Radii, tails included: 68 and 68, 68 and 2, 48 and 48.
    let error = "gaussian:16*gaussian:16".parse::<Kernel>().unwrap_err().to_string();
    assert!(error.contains("at most 96"), "{error}");
    for good in ["gaussian:16*gaussian:0.5", "gaussian:11.2*gaussian:11.2", "perceptual*perceptual"] {
        good.parse::<Kernel>().unwrap();
    }
    let wide = Kernel::Tabulated(vec![vec![1.0; 301]; 301]);
    assert!(Kernel::Convolution(Box::new(wide), Box::new(Kernel::Box)).taps().is_err());
}

/// At half the tile's size, pixels on either side would be one.
#[test]
fn a_kernel_does_not_meet_itself() {
    let of = |sigma| TileProblem { kernel: Kernel::Gaussian(sigma), ..TileProblem::new(8, 1, 2) };
    assert!(of(1.3).validate().is_ok());
    let error = of(1.4).validate().unwrap_err().to_string();
    assert!(error.contains("radius of 4 pixels: too wide") && error.contains("a size of 16 or more"), "{error}");
    assert!(TileProblem { size: 16, ..of(1.4) }.validate().is_ok());
}

#[test]
fn convolution_with_a_box_changes_nothing() {
    let plain = Kernel::Tabulated(vec![vec![0.0, 0.5, 0.0], vec![0.25, 1.0, 0.25], vec![0.0, 0.5, 0.0]]);
    let both = Kernel::Convolution(Box::new(plain.clone()), Box::new(Kernel::Box));
    assert_eq!(both.taps().unwrap(), plain.taps().unwrap());
}

#[test]
fn kernels_are_written_as_they_are_read() {
    for text in ["box", "perceptual", "gaussian:0.5", "perceptual*gaussian:0.5", "gaussian:1.48"] {
        assert_eq!(text.parse::<Kernel>().unwrap().to_string(), text);
    }
    assert_eq!("perceptual*gaussian".parse::<Kernel>().unwrap(), "perceptual*gaussian:0.5".parse().unwrap());
    for text in ["ema:0.2", "mantiuk"] {
        assert_eq!(text.parse::<TemporalKernel>().unwrap().to_string(), text);
    }
    for text in [
        "",
        "perceptive",
        "gaussian:",
        "gaussian:-1",
        "gaussian:nan",
        "gaussian:99",
        "gaussian:1e-23",
        "box:2",
        "perceptual*",
        "*",
        "gaussian:1:2",
    ] {
        assert!(text.parse::<Kernel>().is_err(), "'{text}' was accepted");
    }
    for text in ["", "ema", "ema:0", "ema:1.5", "ema:x", "mantiuk:3", "box"] {
        assert!(text.parse::<TemporalKernel>().is_err(), "'{text}' was accepted");
    }
}

#[test]
fn tables_that_are_no_kernels_are_refused() {
    let bad =
        [vec![], vec![vec![1.0; 2]; 2], vec![vec![1.0; 3]; 1], vec![vec![0.0]], vec![vec![-1.0]], vec![vec![f32::NAN]]];
    for table in bad {
        assert!(Kernel::Tabulated(table.clone()).taps().is_err(), "{table:?} was accepted");
    }
    for table in [vec![], vec![0.0], vec![-1.0], vec![f32::INFINITY], vec![1.0; 5]] {
        assert!(TemporalKernel::Tabulated(table.clone()).weights(4).is_err(), "{table:?} was accepted");
    }
}

#[test]
fn an_exponential_moving_average_halves() {
    assert_eq!(TemporalKernel::Ema(0.5).weights(16).unwrap(), [1.0, 0.5, 0.25, 0.125, 0.0625]);
    assert_eq!(TemporalKernel::Ema(1.0).weights(16).unwrap(), [1.0]);
    // Cut at the animation's length.
    assert_eq!(TemporalKernel::Ema(0.05).weights(16).unwrap().len(), 16);
}

#[test]
fn frames_between_may_weigh_nothing() {
    assert_eq!(TemporalKernel::Tabulated(vec![2.0, 0.0, 1.0, 0.0]).weights(3).unwrap(), [1.0, 0.0, 0.5]);
}

/// Published values: the sustained response peaks at 60 ms; with the transient one added, the sum peaks earlier, and
/// has a tail of the other sign, whose absolute value is used.
#[test]
fn the_eye_answers_within_a_quarter_of_a_second() {
    let weights = TemporalKernel::Mantiuk.weights(32).unwrap();
    let peak = weights.iter().position(|&weight| weight == 1.0).unwrap();
    assert!((1..=3).contains(&peak), "peak at frame {peak}: {weights:?}");
    assert!(weights.len() <= 16, "{weights:?}");
    let zero = weights[peak..].windows(3).position(|w| w[1] < w[0] && w[1] < w[2]);
    assert!(zero.is_some(), "no change of sign: {weights:?}");
    assert_eq!(TemporalKernel::Mantiuk.weights(weights.len()).unwrap(), weights);
    let error = TemporalKernel::Mantiuk.weights(weights.len() - 1).unwrap_err().to_string();
    assert!(error.contains(&format!("spans {} frames", weights.len())), "{error}");
}

#[test]
fn every_shipped_tile_is_what_its_name_says() {
    for tile in Builtin::ALL {
        let (name, problem) = (tile.name(), preset(tile));
        problem.validate().unwrap();
        let TileProblem { size, spp, dims, .. } = problem;
        assert!(name.starts_with(&format!("{size}_{spp}SPP_{dims}D")), "{name}");
        assert_eq!(problem.progressive, name.ends_with("PROGRESSIVE"));
        assert_eq!(problem.temporal.is_some(), name.ends_with("TEMPORAL"));
        assert_eq!(problem.frames > 1, name.ends_with("TEMPORAL"));
    }
}
