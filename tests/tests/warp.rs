//! The warps: they map where they say, uniformly where they say, and back.
//!
//! Seeds are fixed; chi-square tests are at significance 1e-5.

use glam::{Vec2, Vec3};
use noisefloor::rng::Rng;
use noisefloor::warp::*;
use noisefloor_tests::statistics::uniform_z;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// A warp onto directions, with everything a test needs.
struct Directions {
    name: &'static str,
    warp: fn(Vec2) -> Vec3,
    pdf: fn(Vec3) -> f32,
    inverse: fn(Vec3) -> Vec2,
    /// The probability of a height below z, times that of an angle below phi: phi / 2 pi.
    height: fn(f64) -> f64,
}

/// Heights of caps.
const NARROW: f32 = 1e-4;
const WIDE: f32 = 1.4;

const DIRECTIONS: [Directions; 6] = [
    Directions {
        name: "uniform hemisphere",
        warp: uniform_hemisphere,
        pdf: uniform_hemisphere_pdf,
        inverse: uniform_hemisphere_inverse,
        height: |z| z.clamp(0.0, 1.0),
    },
    Directions {
        name: "cosine hemisphere",
        warp: cosine_hemisphere,
        pdf: cosine_hemisphere_pdf,
        inverse: cosine_hemisphere_inverse,
        height: |z| z.clamp(0.0, 1.0).powi(2),
    },
    Directions {
        name: "uniform sphere",
        warp: uniform_sphere,
        pdf: uniform_sphere_pdf,
        inverse: uniform_sphere_inverse,
        height: |z| 0.5 * (z + 1.0),
    },
    Directions {
        name: "narrow cap",
        warp: |u| uniform_cap(u, NARROW),
        pdf: |d| uniform_cap_pdf(d, NARROW),
        inverse: |d| uniform_cap_inverse(d, NARROW),
        height: |z| (1.0 - (1.0 - z) / f64::from(NARROW)).clamp(0.0, 1.0),
    },
    Directions {
        name: "wide cap",
        warp: |u| uniform_cap(u, WIDE),
        pdf: |d| uniform_cap_pdf(d, WIDE),
        inverse: |d| uniform_cap_inverse(d, WIDE),
        height: |z| (1.0 - (1.0 - z) / f64::from(WIDE)).clamp(0.0, 1.0),
    },
    Directions {
        name: "cap of every direction",
        warp: |u| uniform_cap(u, 2.0),
        pdf: |d| uniform_cap_pdf(d, 2.0),
        inverse: |d| uniform_cap_inverse(d, 2.0),
        height: |z| 0.5 * (z + 1.0),
    },
];

/// The coordinates that matter: both ends, next to them, the diagonals, and what is no coordinate at all.
const EDGES: [f32; 13] =
    [0.0, -0.0, f32::MIN_POSITIVE, 1e-8, 0.25, 0.5, 0.75, 0.99999994, 1.0, 1.5, -3.0, f32::INFINITY, f32::NAN];

fn edges() -> impl Iterator<Item = Vec2> {
    EDGES.into_iter().flat_map(|x| EDGES.into_iter().map(move |y| Vec2::new(x, y)))
}

fn inside(u: Vec2) -> bool {
    (0.0..=1.0).contains(&u.x) && (0.0..=1.0).contains(&u.y)
}

fn squared_length(d: Vec3) -> f64 {
    f64::from(d.x).powi(2) + f64::from(d.y).powi(2) + f64::from(d.z).powi(2)
}

/// Beyond 4.265 either way has probability 2e-5.
fn assert_uniform(name: &str, counts: &[u64]) {
    let z = uniform_z(counts);
    assert!(z.abs() < 4.265, "{name}: chi-square z = {z:.2}");
}

/// `cells` x `cells` counts of points given in coordinates that must be uniform on the unit square.
fn grid(cells: usize, seed: u64, mut coordinates: impl FnMut(Vec2) -> (f64, f64)) -> Vec<u64> {
    let mut rng = Rng::seed(seed);
    let mut counts = vec![0; cells * cells];
    let cell = |x: f64| ((x * cells as f64) as usize).min(cells - 1);
    for _ in 0..400_000 {
        let (x, y) = coordinates(Vec2::new(rng.uniform_f32(), rng.uniform_f32()));
        counts[cell(x) * cells + cell(y)] += 1;
    }
    counts
}

fn turn(x: f32, y: f32) -> f64 {
    (f64::from(y).atan2(f64::from(x)) / TAU).rem_euclid(1.0)
}

#[test]
fn directions_have_the_stated_distribution() {
    for (seed, d) in DIRECTIONS.iter().enumerate() {
        // z of the narrow cap is too coarse in f32 for fine cells: its radius says more.
        let narrow = d.name == "narrow cap";
        let counts = grid(16, seed as u64, |u| {
            let w = (d.warp)(u);
            let z = if narrow { (1.0 - f64::from(w.x).powi(2) - f64::from(w.y).powi(2)).sqrt() } else { w.z.into() };
            ((d.height)(z), turn(w.x, w.y))
        });
        assert_uniform(d.name, &counts);
    }
}

#[test]
fn the_disc_is_uniform() {
    let counts = grid(16, 20, |u| {
        let p = concentric_disc(u);
        (f64::from(p.x).powi(2) + f64::from(p.y).powi(2), turn(p.x, p.y))
    });
    assert_uniform("disc", &counts);
}

/// In small triangles of equal area: the barycentric coordinates cut into `n` strips each way.
#[test]
fn the_triangle_is_uniform() {
    let n = 12;
    let mut rng = Rng::seed(21);
    let mut counts = std::collections::BTreeMap::new();
    for _ in 0..400_000 {
        let b = uniform_triangle(Vec2::new(rng.uniform_f32(), rng.uniform_f32()));
        let strips = [b.x, b.y, b.z].map(|b| ((f64::from(b) * f64::from(n)) as u32).min(n - 1));
        *counts.entry(strips).or_insert(0) += 1;
    }
    // The points on the lines between are of measure 0 but f32 finds a few: they are in cells of their own.
    let counts: Vec<u64> = counts.into_values().filter(|&c| c > 100).collect();
    assert_eq!(counts.len(), (n * n) as usize);
    assert_uniform("triangle", &counts);
}

/// The density is the inverse of the warp's area stretch: measured with the solid angle of a small square's image.
#[test]
fn densities_are_those_of_the_warps() {
    let mut rng = Rng::seed(30);
    let h = 1.0 / 256.0;
    for d in &DIRECTIONS {
        for _ in 0..200 {
            let u = Vec2::new(0.02 + 0.96 * rng.uniform_f32(), 0.02 + 0.96 * rng.uniform_f32());
            // The concentric map has creases on the diagonals.
            if (u.x - u.y).abs() < 0.02 || (u.x + u.y - 1.0).abs() < 0.02 {
                continue;
            }
            let at = |x, y| {
                let w = (d.warp)(u + Vec2::new(x, y));
                [w.x, w.y, w.z].map(f64::from)
            };
            let along = |a: [f64; 3], b: [f64; 3]| [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
            let (e, f) = (along(at(-h, 0.0), at(h, 0.0)), along(at(0.0, -h), at(0.0, h)));
            let cross = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
            let area = cross.iter().map(|c| c * c).sum::<f64>().sqrt() / f64::from(4.0 * h * h);
            let product = f64::from((d.pdf)((d.warp)(u))) * area;
            // Central differences near the poles, where the curvature is strongest, are off by a few per cent.
            assert!((product - 1.0).abs() < 0.05, "{} at {u}: {product}", d.name);
        }
    }
}

/// Integrated over the sphere by midpoints of equal solid angle.
#[test]
fn densities_integrate_to_one() {
    let n = 2000;
    for d in DIRECTIONS.iter().filter(|d| d.name != "narrow cap") {
        let total: f64 = (0..n)
            .map(|i| {
                let z = 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
                let r = (1.0 - z * z).sqrt();
                f64::from((d.pdf)(Vec3::new(r as f32, 0.0, z as f32)))
            })
            .sum();
        let integral = total * 4.0 * PI / f64::from(n);
        assert!((integral - 1.0).abs() < 2e-3, "{}: {integral}", d.name);
    }
    assert_eq!(concentric_disc_pdf(Vec2::ZERO), std::f32::consts::FRAC_1_PI);
    let right = [Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 4.0)];
    assert_eq!(uniform_triangle_pdf(right), 1.0 / 6.0);
    // Far from the origin, where f32 products would have lost the triangle.
    let far = right.map(|v| v + Vec3::splat(4096.0));
    assert!((uniform_triangle_pdf(far) - 1.0 / 6.0).abs() < 1e-6);
}

#[test]
fn edges_map_into_the_range_and_have_density() {
    for u in edges() {
        for d in &DIRECTIONS {
            let w = (d.warp)(u);
            assert!((squared_length(w) - 1.0).abs() < 5e-7, "{} at {u}: {w}", d.name);
            let pdf = (d.pdf)(w);
            assert!(pdf > 0.0 || (d.name == "cosine hemisphere" && w.z == 0.0), "{} at {u}: {w}", d.name);
            assert!(inside((d.inverse)(w)), "{} at {u}", d.name);
        }
        assert!(cosine_hemisphere(u).z >= 0.0 && uniform_hemisphere(u).z >= 0.0);
        let p = concentric_disc(u);
        assert!(concentric_disc_pdf(p) > 0.0 && inside(concentric_disc_inverse(p)));
        let b = uniform_triangle(u);
        assert!(b.min_element() >= 0.0 && (b.x + b.y + b.z - 1.0).abs() < 2e-7, "{u}: {b}");
    }
    // The whole rim: rounding takes no point off the disc, and lifts none off the horizon.
    for t in (0..1000).map(|turn| turn as f32 / 1000.0) {
        for u in [Vec2::new(1.0, t), Vec2::new(0.0, t), Vec2::new(t, 1.0), Vec2::new(t, 0.0)] {
            assert!(concentric_disc_pdf(concentric_disc(u)) > 0.0, "{u}");
            assert_eq!(cosine_hemisphere(u).z, 0.0, "{u}");
        }
    }
}

#[test]
fn outside_is_clamped_and_nan_is_zero() {
    let (nan, infinity) = (f32::NAN, f32::INFINITY);
    for d in &DIRECTIONS {
        assert_eq!((d.warp)(Vec2::new(nan, nan)), (d.warp)(Vec2::ZERO));
        assert_eq!((d.warp)(Vec2::new(infinity, -infinity)), (d.warp)(Vec2::X));
    }
    assert_eq!(concentric_disc(Vec2::new(nan, 2.0)), concentric_disc(Vec2::new(0.0, 1.0)));
    assert_eq!(uniform_triangle(Vec2::new(nan, 2.0)), uniform_triangle(Vec2::new(0.0, 1.0)));
}

#[test]
fn known_points() {
    assert_eq!(concentric_disc(Vec2::splat(0.5)), Vec2::ZERO);
    assert_eq!(concentric_disc(Vec2::new(1.0, 0.5)), Vec2::X);
    assert_eq!(concentric_disc(Vec2::new(0.5, 0.0)), Vec2::NEG_Y);
    assert_eq!(concentric_disc_inverse(Vec2::ZERO), Vec2::splat(0.5));
    assert_eq!(uniform_hemisphere(Vec2::ZERO), Vec3::Z);
    assert_eq!(uniform_hemisphere(Vec2::X), Vec3::X);
    assert_eq!(uniform_hemisphere(Vec2::new(0.0, 0.5)), Vec3::Z);
    assert_eq!(uniform_sphere(Vec2::new(0.0, 0.5)), Vec3::Z);
    assert!((uniform_cap(Vec2::X, 0.5).z - 0.5).abs() < 1e-6);
    assert_eq!(uniform_sphere(Vec2::X), Vec3::NEG_Z);
    assert_eq!(cosine_hemisphere(Vec2::splat(0.5)), Vec3::Z);
    assert_eq!(cosine_hemisphere(Vec2::new(1.0, 0.5)), Vec3::X);
    assert_eq!(uniform_triangle(Vec2::ZERO), Vec3::Z);
    assert_eq!(uniform_triangle(Vec2::X), Vec3::X);
    assert_eq!(uniform_triangle(Vec2::Y), Vec3::Y);
}

#[test]
fn densities_outside_and_degenerate() {
    let (up, down, level) = (Vec3::Z, Vec3::NEG_Z, Vec3::X);
    assert_eq!(uniform_hemisphere_pdf(down), 0.0);
    assert_eq!(cosine_hemisphere_pdf(down), 0.0);
    assert_eq!(cosine_hemisphere_pdf(level), 0.0);
    assert_eq!(cosine_hemisphere_pdf(up), std::f32::consts::FRAC_1_PI);
    assert_eq!(uniform_cap_pdf(level, 0.5), 0.0);
    assert_eq!(concentric_disc_pdf(Vec2::ONE), 0.0);
    // Just outside: what is tolerated there is rounding.
    assert_eq!(concentric_disc_pdf(1.001 * Vec2::X), 0.0);
    for height in [1.5_f32, 0.5, 0.01] {
        let z = 1.0 - height - 1e-5;
        assert_eq!(uniform_cap_pdf(Vec3::new((1.0 - z * z).sqrt(), 0.0, z), height), 0.0);
    }
    // A cap of no height is a delta distribution, as is a triangle without area.
    for height in [0.0, -1.0, f32::NAN] {
        assert_eq!(uniform_cap(Vec2::splat(0.7), height), up);
        assert_eq!(uniform_cap_pdf(up, height), f32::INFINITY);
        assert_eq!(uniform_cap_pdf(Vec3::new(1e-4, 0.0, 1.0), height), 0.0);
        assert!(inside(uniform_cap_inverse(up, height)));
    }
    assert_eq!(uniform_triangle_pdf([up, up, level]), f32::INFINITY);
    assert_eq!(uniform_triangle_pdf([Vec3::NAN, up, level]), 0.0);
    assert_eq!(uniform_triangle_pdf([Vec3::INFINITY, up, level]), 0.0);
    // What is no direction has no density, and still an inverse in the square.
    for v in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::MAX), Vec3::INFINITY, 2.0 * up, 1.001 * up] {
        for d in &DIRECTIONS {
            assert_eq!((d.pdf)(v), 0.0, "{} of {v}", d.name);
            assert!(inside((d.inverse)(v)), "{} of {v}: {}", d.name, (d.inverse)(v));
        }
        assert!(inside(concentric_disc_inverse(v.truncate())) && inside(uniform_triangle_inverse(v)));
    }
    assert_eq!(concentric_disc_pdf(Vec2::NAN), 0.0);
}

/// Towards spheres so small, or so far, that the cosine is 1 in f32: all digits of the density, and no wider.
#[test]
fn small_spheres_keep_their_digits() {
    for ratio in [0.5_f32, 1e-3, 1.5e-4, 1e-6, 1e-12] {
        let square = ratio * ratio;
        let height = square / (1.0 + (1.0 - square).sqrt());
        let exact = f64::from(ratio).powi(2) / (1.0 + (1.0 - f64::from(ratio).powi(2)).sqrt());
        for u in edges() {
            let d = uniform_cap(u, height);
            let product = f64::from(uniform_cap_pdf(d, height)) * TAU * exact;
            assert!((product - 1.0).abs() < 5e-7, "{ratio}, {u}: {product}");
            assert!(f64::from(d.x).hypot(d.y.into()) <= f64::from(ratio) * (1.0 + 5e-7), "{ratio}, {u}: {d}");
        }
        let beside = ratio * (1.0 + 2e-6);
        assert_eq!(uniform_cap_pdf(Vec3::new(beside, 0.0, (1.0 - beside * beside).sqrt()), height), 0.0, "{ratio}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn inverses_bring_back_the_point(x in 0.0..=1.0_f32, y in 0.0..=1.0_f32) {
        let u = Vec2::new(x, y);
        for d in &DIRECTIONS {
            let back = (d.inverse)((d.warp)(u));
            // The rounding of the direction to f32, magnified where the warp squeezes: by 1/z or by 1/r.
            let tolerance = match d.name {
                "cosine hemisphere" => 4e-7,
                _ => 4e-7 + 2e-7 / x.clamp(1e-3, 1.0),
            };
            let turn = (back.y - u.y).abs();
            prop_assert!((back.x - u.x).abs() < 4e-7, "{} at {}: {}", d.name, u, back);
            prop_assert!(turn.min(1.0 - turn) < tolerance, "{} at {}: {}", d.name, u, back);
        }
        let disc = concentric_disc_inverse(concentric_disc(u));
        prop_assert!((disc - u).abs().max_element() < 4e-7, "{} {}", u, disc);
        let triangle = uniform_triangle_inverse(uniform_triangle(u));
        prop_assert!((triangle - u).abs().max_element() < 4e-7, "{} {}", u, triangle);
    }
}
