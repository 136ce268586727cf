//! Shared fits that choose, robust and by two halves, against their definition: every candidate a fit of its own,
//! solved for each pixel that is left out, every window by itself.

use crate::cv_support::{design, largest, points, smooth, wide};
use noisefloor::control_variate::{Config, Estimate, Estimator, Image, Samples};
use noisefloor_tests::legendre;
use noisefloor_tests::oracle::{Design, Regression, pixels};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::{block, image};
use noisefloor_tests::statistics::maximum;

/// Within this of the largest value, of the gain, and of the standard error.
const TOLERANCE: f64 = 1e-4;

/// The functions' degrees are below this, which stands for slices' copies of functions.
const LAST: usize = 4;

/// How candidates are judged, and pixels of overlapping windows averaged.
#[derive(Clone, Copy, Debug)]
struct Rule {
    /// Trust in a candidate of relative spread r is r^(-sharpness nu) at nu degrees of freedom.
    sharpness: f64,
    /// Trust in the mean, relative to the number of candidates.
    prior: f64,
    /// The mean keeps at least prior e^(-nu^2 / caution) of any candidate's trust.
    caution: f64,
    /// The penalty of all fits, per sample.
    ridge: f64,
    /// Whether what is nearer the centre of its window counts more.
    hat: bool,
    /// Whether a half chooses for the other.
    crossed: bool,
    /// Whether spreads are about the linear trend, or about the mean.
    trend: bool,
    /// How far from the others' range a value is, in units of that range, that its pixel is in no fit.
    far: f64,
    /// How far the mean must be trusted for that.
    doubt: f64,
    /// One of so many pixels may be out of the others' range at either end.
    share: usize,
    /// What samples say for a fit within their pixels counts as much of what the pixels' spread says.
    within: f64,
    /// What a colour's own pixels say where it is chosen for that colour counts as much of what the others say.
    own: f64,
    /// How much sharper that choice is.
    sharper: f64,
    /// With less freedom there is none.
    enough: f64,
}

const RULE: Rule = Rule {
    sharpness: 1.0 / 6.0,
    prior: 8.0,
    caution: 14.0,
    ridge: 0.003,
    hat: true,
    crossed: true,
    trend: true,
    far: 8.0,
    doubt: 0.5,
    share: 16,
    within: 0.25,
    own: 0.85,
    sharper: 1.05,
    enough: 16.0,
};

/// A pixel within a window.
#[derive(Clone)]
struct Member {
    pixel: usize,
    /// One of four.
    colour: usize,
    /// From -1 to 1 along each axis.
    at: Vec<f64>,
}

/// Estimates of one channel.
#[derive(Clone)]
struct Fits {
    /// The plain means of all members, then each candidate's estimates.
    estimates: Vec<Vec<f64>>,
    /// Sums of squares about the trend, of each, by colour.
    spreads: Vec<[f64; 4]>,
    freedom: f64,
    /// What each leaves of the samples' squares about their pixel's mean, of colours that it has not seen.
    within: Vec<[f64; 4]>,
    /// Pixels, if they have several samples.
    pixels: f64,
}

/// What a pixel should come to.
#[derive(Clone, Default)]
struct Expected {
    means: Vec<f64>,
    std_errors: Vec<f64>,
    gain: f64,
}

struct Case {
    config: Config,
    width: usize,
    height: usize,
    unordered: bool,
    n: usize,
    u: Vec<f32>,
    f: Vec<f32>,
    surfaces: Vec<u32>,
    factors: Vec<f32>,
    bright: Vec<usize>,
}

/// The lowest and the highest value of each channel that are not too far.
type Limits = [[f64; 2]; 2];

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn without(mut a: Vec<f64>, unit: &[f64]) -> Vec<f64> {
    let along = dot(&a, unit);
    a.iter_mut().zip(unit).for_each(|(a, unit)| *a -= along * unit);
    a
}

impl Case {
    /// Integrands that change across the image, another in each channel.
    fn new(estimator: Estimator, [width, height]: [usize; 2], unordered: bool, n: usize, rng: &mut SplitMix64) -> Self {
        let config = Config { estimator, ..Config::new(2, 3, 2) };
        let u = points(width * height * n, 2, rng);
        let mut f = vec![];
        for (sample, u) in wide(&u).chunks(2).enumerate() {
            let (x, y) = ((sample / n % width) as f64, (sample / n / width) as f64);
            let first = smooth(u) * (1.0 + 0.02 * x) + 0.03 * y;
            let second = f64::from(u8::from(u[0] + 0.5 * u[1] < 0.6 + 0.02 * x - 0.01 * y)) + 0.2 * rng.uniform();
            f.extend([first as f32, 2.0 * second as f32]);
        }
        Self { config, width, height, unordered, n, u, f, surfaces: vec![], factors: vec![], bright: vec![] }
    }

    fn pixels(&self) -> usize {
        self.width * self.height
    }

    fn with_surfaces(mut self, count: usize, rng: &mut SplitMix64) -> Self {
        self.surfaces = (0..self.pixels()).map(|_| 3 + rng.below(count) as u32).collect();
        self
    }

    /// The first of these pixels is bright in both channels, the others in one, and one of them by a single sample.
    fn with_bright(mut self, pixels: &[usize]) -> Self {
        for (index, &pixel) in pixels.iter().enumerate() {
            for sample in 0..if index == 1 { 1 } else { self.n } {
                let f = &mut self.f[2 * (pixel * self.n + sample)..][..2];
                f[0] *= 300.0;
                if index == 0 {
                    f[1] = -200.0;
                }
            }
        }
        self.bright = pixels.to_vec();
        self
    }

    /// Nearly linear and alike, so that fits are far better than the mean.
    fn with_planes(mut self) -> Self {
        for (f, u) in self.f.chunks_mut(2).zip(self.u.chunks(2)) {
            f.copy_from_slice(&[u[0] - 2.0 * u[1] + 0.01 * (9.0 * u[0]).sin(), 1.0 - u[1]]);
        }
        self
    }

    /// A further coordinate picks one of so many slices, each with a level and a slope of its own.
    fn with_slices(mut self, slices: usize, rng: &mut SplitMix64) -> Self {
        self.config = Config { dims: 3, slices, ..self.config };
        let mut u = vec![];
        for (f, own) in self.f.chunks_mut(2).zip(self.u.chunks(2)) {
            let slice = rng.below(slices) as f32;
            u.extend([own[0], own[1], (slice + 0.5) / slices as f32]);
            f[0] += 0.3 * slice + 0.1 * slice * own[0];
            f[1] += (1.7 * slice).sin();
        }
        self.u = u;
        self
    }

    fn with_factors(mut self, rng: &mut SplitMix64) -> Self {
        self.factors = (0..2 * self.pixels()).map(|_| [0.0, 0.5, 1.0, 2.0][rng.below(4)]).collect();
        self
    }

    fn factor(&self, pixel: usize, channel: usize) -> f64 {
        match self.factors.get(2 * pixel + channel) {
            Some(&factor) if factor > 0.0 => f64::from(factor),
            _ => 1.0,
        }
    }

    /// A pixel's values of a channel, as they are.
    fn values(&self, pixel: usize, channel: usize) -> Vec<f64> {
        (0..self.n).map(|i| f64::from(self.f[2 * (pixel * self.n + i) + channel])).collect()
    }

    /// The members of each window, row by row.
    fn windows(&self) -> Vec<Vec<Member>> {
        if self.unordered {
            return vec![(0..self.pixels()).map(|pixel| Member { pixel, colour: 0, at: vec![] }).collect()];
        }
        // Each fourth pixel begins a window of eight, and the last window ends where the image does.
        let starts = |extent: usize| {
            let last = extent.saturating_sub(8);
            (0..last).step_by(4).chain([last]).collect::<Vec<usize>>()
        };
        let place = |at: usize, extent: usize| (2 * at + 1) as f64 / extent.min(8) as f64 - 1.0;
        let mut windows = vec![];
        for top in starts(self.height) {
            for left in starts(self.width) {
                let mut window = vec![];
                for y in 0..self.height.min(8) {
                    for x in 0..self.width.min(8) {
                        let at = vec![place(x, self.width), place(y, self.height)];
                        let pixel = (top + y) * self.width + left + x;
                        window.push(((y / 2, x / 2, y, x), Member { pixel, colour: 0, at }));
                    }
                }
                // By squares of 2 x 2.
                window.sort_by_key(|&(order, _)| order);
                let window: Vec<Member> = window.into_iter().map(|(_, member)| member).collect();
                windows.push(window);
            }
        }
        windows
    }

    /// How many functions have products with the axes, in fits to a group and to its halves: those of degree 1, or none
    /// where there are no more than four samples for each column.
    fn moving(&self, group: &[Member], degrees: &[usize]) -> usize {
        let axes = group[0].at.len();
        let lines = degrees.iter().filter(|&&degree| degree <= 1).count();
        let columns = 1 + axes + degrees.len() + axes * lines;
        if 4 * columns < group.len() * self.n { lines } else { 0 }
    }

    /// A pixel's values of a channel, as fits see them.
    fn quotients(&self, pixel: usize, channel: usize) -> Vec<f64> {
        self.values(pixel, channel).iter().map(|value| value / self.factor(pixel, channel)).collect()
    }

    /// What values are not too far from the others, of channels whose mean is trusted; None if all are near.
    fn limits(&self, rule: &Rule, group: &[Member], all: &[Member], weights: &[Vec<f64>; 2]) -> Option<Limits> {
        let mut limits = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
        if group.len() < 8 {
            return None;
        }
        let aside = group.len().div_ceil(rule.share);
        for (channel, limits) in limits.iter_mut().enumerate() {
            let each = group.iter().map(|member| self.quotients(member.pixel, channel));
            let mut lowest: Vec<f64> = each.clone().map(|own| own.into_iter().fold(f64::INFINITY, f64::min)).collect();
            let mut highest: Vec<f64> = each.map(|own| own.into_iter().fold(f64::NEG_INFINITY, f64::max)).collect();
            lowest.sort_unstable_by(f64::total_cmp);
            highest.sort_unstable_by(|a, b| b.total_cmp(a));
            let (low, high) = (lowest[aside], highest[aside]);
            let near = [low - rule.far * (high - low), high + rule.far * (high - low)];
            // Where fits are trusted they explain what a judge itself has.
            if weights[channel][0] >= rule.doubt || (lowest[0] >= near[0] && highest[0] <= near[1]) {
                *limits = near;
            }
        }
        all.iter().any(|member| self.is_far(member.pixel, Some(&limits))).then_some(limits)
    }

    fn is_far(&self, pixel: usize, limits: Option<&Limits>) -> bool {
        limits.is_some_and(|limits| {
            let is_far = |channel: usize, value: f64| value < limits[channel][0] || value > limits[channel][1];
            (0..2).any(|channel| self.quotients(pixel, channel).into_iter().any(|value| is_far(channel, value)))
        })
    }

    /// Every candidate's estimates from the other members' samples, without those beyond the limits.
    fn fits(
        &self,
        rule: &Rule,
        group: &[Member],
        (moving, degrees): (usize, &[usize]),
        channel: usize,
        limits: Option<&Limits>,
    ) -> Fits {
        let far: Vec<bool> = group.iter().map(|member| self.is_far(member.pixel, limits)).collect();
        let (n, axes) = (self.n, group[0].at.len());
        let mut basis = design(&self.config, &wide(&self.u));
        // By degrees.
        for row in basis.rows.iter_mut().chain([&mut basis.weights]) {
            let mut sorted: Vec<(usize, f64)> = degrees.iter().copied().zip(row.iter().copied()).collect();
            sorted.sort_by_key(|&(degree, _)| degree);
            *row = sorted.into_iter().map(|(_, value)| value).collect();
        }
        let scaled = |at: &[f64]| at.iter().map(|at| 3.0_f64.sqrt() * at).collect::<Vec<f64>>();
        let (mut rows, mut values, mut estimates, mut within) = (vec![], vec![], vec![vec![]], vec![[0.0; 4]]);
        for member in group {
            let own = self.quotients(member.pixel, channel);
            let mean = own.iter().sum::<f64>() / n as f64;
            estimates[0].push(mean);
            if !self.is_far(member.pixel, limits) {
                within[0][member.colour] += own.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
            }
            values.extend(own);
            for functions in &basis.rows[member.pixel * n..(member.pixel + 1) * n] {
                let place = scaled(&member.at);
                let products = place.iter().flat_map(|place| functions[..moving].iter().map(move |own| place * own));
                rows.push([&place[..], functions, &products.collect::<Vec<f64>>()].concat());
            }
        }
        let products = (0..axes).flat_map(|_| basis.weights[..moving].iter().map(|weight| 8.0 * weight));
        let weights = [&vec![1e-3; axes][..], &basis.weights, &products.collect::<Vec<f64>>()].concat();

        let mut ends: Vec<usize> =
            (1..=LAST).map(|most| axes + degrees.iter().filter(|&&degree| degree <= most).count()).collect();
        ends.push(weights.len());
        ends.dedup();
        for end in ends {
            let rows = rows.iter().map(|row: &Vec<f64>| row[..end].to_vec()).collect();
            let whole = Design { rows, weights: weights[..end].to_vec() };
            // One sample is left out alone, several with all of their pixel's colour.
            let fit_to = |is_used: &dyn Fn(usize) -> bool| {
                let used: Vec<usize> = (0..group.len()).filter(|&index| is_used(index) && !far[index]).collect();
                let others: Vec<usize> = used.iter().flat_map(|index| index * n..(index + 1) * n).collect();
                let f: Vec<f64> = others.iter().map(|&sample| values[sample]).collect();
                // Whatever values the pixels have, as far as these may not say which are in the fit.
                let count = if n == 1 { group.len() - 1 } else { others.len() };
                let strength = rule.ridge * count as f64;
                let rows = whole.select(&others);
                let mut fit = if n == 1 {
                    Regression::fit(&rows, &f, strength)
                } else {
                    let places: Vec<Vec<f64>> = rows.rows.iter().step_by(n).map(|row| row[..axes].to_vec()).collect();
                    let share = |channel: usize| {
                        let own = used.iter().flat_map(|&index| self.quotients(group[index].pixel, channel));
                        pixels::noise_share(&places, &own.collect::<Vec<f64>>(), n)
                    };
                    pixels::fit(&rows, &f, n, share(0).min(share(1)), strength)
                };
                // The constant and the places follow the signal and correct nothing.
                fit.slopes[..axes].fill(0.0);
                fit
            };
            let by_colour: Vec<Regression> = match n {
                1 => vec![],
                _ => (0..4).map(|colour| fit_to(&|index| group[index].colour != colour)).collect(),
            };
            let mut left = [0.0; 4];
            let mut each = vec![];
            for (index, member) in group.iter().enumerate() {
                // A pixel that is in no fit leaves none.
                let alone = (n == 1).then(|| fit_to(&|other| other != index));
                let fit = alone.as_ref().unwrap_or_else(|| &by_colour[member.colour]);
                let residuals: Vec<f64> = (index * n..(index + 1) * n)
                    .map(|sample| values[sample] - fit.control(&whole.rows[sample]))
                    .collect();
                let mean = residuals.iter().sum::<f64>() / n as f64;
                if !far[index] {
                    left[member.colour] += residuals.iter().map(|residual| (residual - mean).powi(2)).sum::<f64>();
                }
                each.push(mean);
            }
            within.push(left);
            estimates.push(each);
        }
        let only_near = |values: &[f64]| {
            let near = values.iter().zip(&far).filter(|&(_, far)| !far);
            near.map(|(&value, _)| value).collect::<Vec<f64>>()
        };
        // An orthonormal basis of the linear functions of the place.
        let mut trend: Vec<Vec<f64>> = vec![];
        for axis in 0..=if rule.trend { axes } else { 0 } {
            let along: Vec<f64> =
                group.iter().map(|member| if axis == 0 { 1.0 } else { member.at[axis - 1] }).collect();
            let rest = trend.iter().fold(only_near(&along), |rest, unit| without(rest, unit));
            let length = dot(&rest, &rest).sqrt();
            if length > 1e-9 {
                trend.push(rest.iter().map(|value| value / length).collect());
            }
        }
        let freedom = (only_near(&estimates[0]).len() - trend.len()) as f64;
        let spread = |estimates: &Vec<f64>| {
            let rest = trend.iter().fold(only_near(estimates), |rest, unit| without(rest, unit));
            let mut spread = [0.0; 4];
            let near = group.iter().zip(&far).filter(|&(_, far)| !far);
            for ((member, _), value) in near.zip(rest).filter(|_| freedom > 0.0) {
                spread[member.colour] += value * value;
            }
            spread
        };
        let spreads = estimates.iter().map(spread).collect();
        let pixels = if n > 1 { far.iter().filter(|&&far| !far).count() as f64 } else { 0.0 };
        Fits { estimates, spreads, freedom, within, pixels }
    }

    /// By the definition, with what windows say of a pixel averaged.
    fn expected(&self, rule: &Rule) -> Vec<Expected> {
        let terms = legendre::terms(2, 3);
        let mut degrees: Vec<usize> = terms[1..].iter().map(|term| legendre::degree(term)).collect();
        // Slices have indicators, and copies of functions for which there is one candidate.
        degrees.extend(vec![1; self.config.slices]);
        degrees.resize(design(&self.config, &wide(&self.u[..self.config.dims])).weights.len(), LAST);
        let empty = Expected { means: vec![0.0; 2], std_errors: vec![0.0; 2], gain: 0.0 };
        let (mut sums, mut total) = (vec![empty; self.pixels()], vec![0.0; self.pixels()]);
        for window in self.windows() {
            let mut surfaces: Vec<u32> = window.iter().map(|member| self.surface(member.pixel)).collect();
            surfaces.sort_unstable();
            surfaces.dedup();
            for surface in surfaces {
                let own = window.iter().filter(|member| self.surface(member.pixel) == surface);
                let mut group: Vec<Member> = own.cloned().collect();
                group.iter_mut().enumerate().for_each(|(index, member)| member.colour = index % 4);
                let halves = self.config.estimator == Estimator::KFold;
                if group.len() < 3 + group[0].at.len() {
                    continue;
                }
                // One diagonal of a square, and the other.
                let half_of = |member: &Member| usize::from(member.colour == 1 || member.colour == 2);
                let moving = self.moving(&group, &degrees);
                let fits = |group: &[Member], limits: Option<&Limits>| {
                    [0, 1].map(|channel| self.fits(rule, group, (moving, &degrees), channel, limits))
                };
                let all = fits(&group, None);
                // For each half: how far fits to all are trusted, how far those that correct, and these.
                let choices = [0, 1].map(|turn| {
                    let judges = if rule.crossed { 1 - turn } else { turn };
                    let half: Vec<Member> = group.iter().filter(|member| half_of(member) == judges).cloned().collect();
                    let judges = if halves { &half } else { &group };
                    let chosen =
                        |limits: Option<&Limits>| fits(judges, limits).map(|fits| Weights::new(rule, &fits, halves));
                    let first = chosen(None);
                    let trust = first.each_ref().map(|weights| weights.all.clone());
                    match self.limits(rule, judges, &group, &trust) {
                        Some(limits) => (first, chosen(Some(&limits)), fits(&group, Some(&limits))),
                        None => (first.clone(), first, all.clone()),
                    }
                });
                for channel in 0..2 {
                    for (index, member) in group.iter().enumerate() {
                        let (_, weights, fits) = &choices[half_of(member)];
                        let (fits, all) = (&fits[channel], &all[channel]);
                        let weights = &weights[channel].of_colours[member.colour];
                        let spreads = summed(&all.spreads, None, rule);
                        let judged = if self.n > 1 { summed(&all.within, None, rule) } else { spreads.clone() };
                        let ratio = |first: &[f64]| {
                            if judged[0] > 0.0 { dot(first, &judged) / judged[0] } else { 1.0 }
                        };
                        let ratio = choices.iter().map(|(first, ..)| ratio(&first[channel].all)).sum::<f64>() / 2.0;
                        let mixed = ratio * spreads[0];
                        let near: f64 = member.at.iter().map(|at| 1.0 - at.abs()).product();
                        let near = if rule.hat { near } else { 1.0 };
                        let estimate: f64 = weights.iter().zip(&fits.estimates).map(|(w, each)| w * each[index]).sum();
                        let factor = self.factor(member.pixel, channel);
                        let error = if self.n > 1 { ratio.sqrt() } else { (mixed / all.freedom).sqrt() * factor };
                        let sums = &mut sums[member.pixel];
                        sums.means[channel] += near * (estimate - fits.estimates[0][index]) * factor;
                        sums.std_errors[channel] += near * error;
                        sums.gain += near * ratio / 2.0;
                        total[member.pixel] += near / 2.0;
                    }
                }
            }
        }
        for (pixel, (sums, total)) in sums.iter_mut().zip(total).enumerate() {
            sums.gain = if total > 0.0 { sums.gain / total } else { 1.0 };
            for channel in 0..2 {
                let values = self.values(pixel, channel);
                let count = self.n as f64;
                let mean = values.iter().sum::<f64>() / count;
                let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
                let correction = if total > 0.0 { sums.means[channel] / total } else { 0.0 };
                sums.means[channel] = mean + correction;
                let unknown = if self.n > 1 { 1.0 } else { f64::INFINITY };
                let spread = if total > 0.0 { sums.std_errors[channel] / total } else { unknown };
                sums.std_errors[channel] = if self.n > 1 {
                    // More where the pixel's own samples make its correction unlikely.
                    let variance = squares / (count * (count - 1.0));
                    let likely = if self.n == 2 { 195.1 } else { 4.0 + 10.3 / (count - 2.5) };
                    (spread * spread * variance + (correction * correction - likely * variance).max(0.0)).sqrt()
                } else {
                    spread
                };
            }
        }
        sums
    }

    fn surface(&self, pixel: usize) -> u32 {
        self.surfaces.get(pixel).copied().unwrap_or(0)
    }

    fn estimates(&self) -> Vec<Estimate> {
        let samples = Samples::new(&self.u, &self.f);
        if self.unordered && self.surfaces.is_empty() && self.factors.is_empty() {
            return block(&self.config, self.pixels(), samples).unwrap();
        }
        let (surfaces, factors) = (&self.surfaces[..], &self.factors[..]);
        let of = Image { unordered: self.unordered, surfaces, factors, ..Image::new(self.width, self.height) };
        image(&self.config, &of, samples).unwrap()
    }

    /// The largest differences of the means, relative to the largest value, of gain, and of standard errors.
    fn errors(&self, rule: &Rule) -> [f64; 3] {
        let expected = self.expected(rule);
        let pixels = self.f.chunks(2 * self.n).enumerate();
        let usual =
            pixels.filter(|(pixel, _)| !self.bright.contains(pixel)).map(|(_, f)| largest(f)).fold(0.0, f64::max);
        let mut errors = [0.0_f64; 3];
        for ((estimate, expected), own) in self.estimates().iter().zip(&expected).zip(self.f.chunks(2 * self.n)) {
            let scale = usual.max(largest(own));
            errors[1] = maximum([errors[1], (f64::from(estimate.gain) - expected.gain).abs()]);
            for channel in 0..2 {
                let error = (f64::from(estimate.mean[channel]) - expected.means[channel]).abs();
                errors[0] = maximum([errors[0], error / scale]);
                let pair = [f64::from(estimate.std_error[channel]), expected.std_errors[channel]];
                if pair[0] != pair[1] {
                    errors[2] = maximum([errors[2], (pair[0] - pair[1]).abs() / scale.max(pair[1])]);
                }
            }
        }
        errors
    }

    fn check(&self, what: &str) {
        let errors = self.errors(&RULE);
        let line = format!("{what}, {:?}, {} samples: {errors:?}", self.config.estimator, self.n);
        println!("{line}");
        assert!(errors.iter().all(|&error| error < TOLERANCE), "{line}");
    }
}

/// Of each estimate the sum over colours; of one that is chosen for less.
fn summed(of: &[[f64; 4]], colour: Option<usize>, rule: &Rule) -> Vec<f64> {
    let weight = |each: usize| if colour == Some(each) { rule.own } else { 1.0 };
    of.iter().map(|each| each.iter().enumerate().map(|(each, sum)| weight(each) * sum).sum()).collect()
}

/// How far the mean and the candidates are trusted: by all pixels, and for each colour.
#[derive(Clone)]
struct Weights {
    all: Vec<f64>,
    of_colours: [Vec<f64>; 4],
}

impl Weights {
    /// Where halves choose for each other, colours do not.
    fn new(rule: &Rule, fits: &Fits, halves: bool) -> Self {
        let all = weights(rule, fits, None);
        let of_colour = |colour| if halves { all.clone() } else { weights(rule, fits, Some(colour)) };
        Self { of_colours: [0, 1, 2, 3].map(of_colour), all }
    }
}

fn weights(rule: &Rule, fits: &Fits, colour: Option<usize>) -> Vec<f64> {
    // Of few pixels all choose alike.
    let colour = colour.filter(|_| fits.freedom >= rule.enough);
    let [spreads, within] = [&fits.spreads, &fits.within].map(|of| summed(of, colour, rule));
    let (plain, candidates) = spreads.split_first().unwrap();
    let mut trust = vec![0.0; spreads.len()];
    trust[0] = 1.0;
    if *plain > 0.0 && (fits.pixels == 0.0 || within[0] > 0.0) {
        let freedom = fits.freedom * if colour.is_some() { rule.sharper } else { 1.0 };
        let power = rule.sharpness * freedom;
        let inside = |fit: usize| {
            if fits.pixels == 0.0 {
                return 0.0;
            }
            let gain = (within[1 + fit] / within[0]).ln();
            rule.sharpness * fits.pixels * if gain < 0.0 { rule.within * gain } else { gain }
        };
        let spreads = candidates.iter().enumerate();
        let logarithms: Vec<f64> = spreads.map(|(fit, spread)| -power * (spread / plain).ln() - inside(fit)).collect();
        let highest = logarithms.iter().copied().fold(0.0, f64::max);
        let count = candidates.len() as f64;
        let cautious = (highest - freedom.powi(2) / rule.caution).max(0.0);
        trust[0] = rule.prior * count * (cautious - highest).exp();
        trust.iter_mut().skip(1).zip(logarithms).for_each(|(trust, logarithm)| *trust = (logarithm - highest).exp());
    }
    let sum: f64 = trust.iter().sum();
    trust.iter().map(|trust| trust / sum).collect()
}

const CHOOSING: [Estimator; 2] = [Estimator::Robust, Estimator::KFold];

/// Four windows of 8 x 8 pixels that overlap; at 1 and 2 samples one factor, at 8 one for each pixel.
#[test]
fn images() {
    let mut rng = SplitMix64::new(1);
    for estimator in CHOOSING {
        for n in [1, 2, 8] {
            Case::new(estimator, [11, 9], false, n, &mut rng).check("image");
        }
    }
}

/// Two surfaces, and nine of which some have too few pixels; factors.
#[test]
fn images_with_surfaces_and_factors() {
    let mut rng = SplitMix64::new(2);
    for estimator in CHOOSING {
        for n in [1, 2, 8] {
            let case = |rng: &mut SplitMix64| Case::new(estimator, [9, 7], false, n, rng);
            case(&mut rng).with_surfaces(2, &mut rng).check("two surfaces");
            case(&mut rng).with_surfaces(9, &mut rng).check("nine surfaces");
            case(&mut rng).with_surfaces(2, &mut rng).with_factors(&mut rng).check("two surfaces, factors");
        }
    }
}

/// So many slices that they are factored apart, surfaces and bright pixels among them.
#[test]
fn many_slices() {
    let mut rng = SplitMix64::new(6);
    for estimator in CHOOSING {
        let case =
            |size, is_block, rng: &mut SplitMix64| Case::new(estimator, size, is_block, 1, rng).with_slices(12, rng);
        let image = case([8, 7], false, &mut rng).with_bright(&[40, 46]);
        image.check("slices, bright pixels");
        image.with_surfaces(2, &mut rng).with_factors(&mut rng).check("slices, bright pixels, surfaces, factors");
        case([36, 1], true, &mut rng).check("a block of slices");
    }
}

/// Bright pixels, which are in no fit where the mean is trusted: the windows of an image have some or none of them.
#[test]
fn bright_pixels() {
    let mut rng = SplitMix64::new(5);
    for estimator in CHOOSING {
        for n in [1, 2, 8] {
            Case::new(estimator, [11, 9], false, n, &mut rng).with_bright(&[40, 46, 90]).check("bright pixels");
            Case::new(estimator, [36, 1], true, n, &mut rng).with_bright(&[0, 9]).check("bright pixels of a block");
            let case = Case::new(estimator, [9, 9], false, n, &mut rng).with_bright(&[30, 47]);
            case.with_surfaces(2, &mut rng).with_factors(&mut rng).check("bright pixels, surfaces, factors");
        }
    }
}

/// Pixels in no order: few, where caution decides, more, and surfaces among them.
#[test]
fn blocks() {
    let mut rng = SplitMix64::new(3);
    for estimator in CHOOSING {
        for n in [1, 2, 8] {
            Case::new(estimator, [10, 1], true, n, &mut rng).check("block");
            Case::new(estimator, [6, 1], true, n, &mut rng).with_planes().check("small block of planes");
            Case::new(estimator, [36, 1], true, n, &mut rng).check("large block");
            let case = Case::new(estimator, [24, 1], true, n, &mut rng);
            case.with_surfaces(2, &mut rng).with_factors(&mut rng).check("block with surfaces and factors");
        }
    }
}

/// The tests above can fail: by any number of the rule.
#[test]
fn the_oracle_is_sharp() {
    let mut rng = SplitMix64::new(4);
    let image = Case::new(Estimator::KFold, [11, 9], false, 1, &mut rng);
    let block = Case::new(Estimator::Robust, [6, 1], true, 8, &mut rng).with_planes();
    let bright = Case::new(Estimator::Robust, [11, 9], false, 1, &mut rng).with_bright(&[40, 46, 90]);
    let largest = Case::new(Estimator::Robust, [36, 1], true, 2, &mut rng).with_bright(&[0, 9, 20]);
    for (case, rule) in [
        (&bright, Rule { far: 1e3, ..RULE }),
        (&bright, Rule { doubt: 1.0, ..RULE }),
        (&largest, Rule { share: 32, ..RULE }),
        (&image, Rule { sharpness: 1.0 / 7.0, ..RULE }),
        (&image, Rule { prior: 9.0, ..RULE }),
        (&image, Rule { ridge: 0.004, ..RULE }),
        (&image, Rule { hat: false, ..RULE }),
        (&image, Rule { crossed: false, ..RULE }),
        (&image, Rule { trend: false, ..RULE }),
        (&block, Rule { caution: 17.0, ..RULE }),
        (&block, Rule { within: 1.0, ..RULE }),
        (&bright, Rule { own: 1.0, ..RULE }),
        (&bright, Rule { sharper: 1.0, ..RULE }),
    ] {
        let errors = case.errors(&rule);
        println!("{rule:?}: {errors:?}");
        assert!(errors[0] > 10.0 * TOLERANCE, "{rule:?}: {errors:?}");
    }
}
