//! What a slice may select: the subclasses of a pixel (5.14), as lists of samples relative to it.

use super::kernel::{Kernel, Tap};
use super::problem::TileProblem;
use crate::counted::counted;
use crate::{Error, error::Result};

/// The most samples of a subclass.
const MAX_SAMPLES: usize = 1 << 16;

/// The most that the pixels of all classes weigh together.
///
/// A sample is in at most as many slices of a step as the classes have pixels. Each adds to a 64-bit sum an offset of
/// at most 2^24, times a bin's weight, times the subclass's. The projected cube is nowhere more than 4 times as dense
/// as in the mean (a section is at most sqrt 2, Ball 1986; the length at most sqrt 8), and the offset correction at
/// most 2: a bin weighs at most 2^4 [`WEIGHT_UNIT`]s, and the sum is less than 2^(18 + 24 + 4 + 2 * 8) = 2^62.
const MAX_WEIGHT: f64 = (1u32 << 18) as f64;

/// A subclass's size grows at least by this part from one threshold to the next: finer ones are joined with the next.
const JOIN: f64 = 0.02;

/// What a tap over several frames weighs at least, unless the spatial kernel has smaller ones.
const LEAST: f32 = 1.0 / 60.0;

/// The class of each prefix of a progressive tile, by the number of doublings to the whole: share and weight.
const PREFIXES: [(f64, f32); 9] =
    [(2.0, 1.0), (0.7, 1.0), (1.5, 2.0), (0.5, 2.0), (1.0, 2.0), (0.5, 2.0), (1.0, 2.0), (0.5, 2.0), (1.0, 2.0)];

/// A subclass, the same at every pixel: the first `prefix` samples of the first `taps` pixels of a class.
#[derive(Clone, Debug)]
struct Entry {
    /// Which class: an index for [`Lattice`].
    class: usize,
    /// The pixels, in decreasing order of the class function.
    taps: usize,
    /// The samples of each.
    prefix: usize,
    /// How often a slice selects it.
    probability: f64,
    /// What its displacements count.
    weight: f32,
}

impl Entry {
    /// The number of samples.
    fn length(&self) -> usize {
        self.taps * self.prefix
    }
}

/// The pixels of a class in decreasing order of its function, and its share of the slices.
struct Class {
    taps: Vec<Tap>,
    share: f64,
    weight: f32,
}

impl TileProblem {
    /// An [`Error::Input`] that names the first value that cannot be.
    pub fn validate(&self) -> Result<()> {
        self.stencils().map(|_| ())
    }

    /// Everything that a slice may select; checks all parameters.
    pub(super) fn stencils(&self) -> Result<Stencils> {
        self.check_ranges()?;
        Stencils::new(self)
    }
}

fn classes(problem: &TileProblem) -> Result<Vec<Class>> {
    let spatial = narrow(&problem.kernel, problem.size)?;
    let own = narrow(&problem.reconstruction, problem.size)?;
    let box_share = f64::from(problem.box_class.share);
    let box_class = |taps| Class { taps, share: box_share, weight: problem.box_class.weight };
    let Some(temporal) = &problem.temporal else {
        return Ok(vec![Class { taps: spatial, share: 1.0 - box_share, weight: 1.0 }, box_class(own)]);
    };
    let weights = temporal.weights(problem.frames)?;
    let frame_share = f64::from(problem.frame_share);
    Ok(vec![
        Class { taps: over_time(&spatial, &weights), share: 1.0 - box_share - frame_share, weight: 1.0 },
        box_class(over_time(&own, &weights)),
        Class { taps: spatial, share: frame_share, weight: 1.0 },
    ])
}

/// The product of a spatial kernel and the weights of a frame and those before it, down to the spatial kernel's least
/// value.
fn over_time(spatial: &[Tap], weights: &[f32]) -> Vec<Tap> {
    let least = spatial.last().map_or(0.0, |tap| tap.weight).min(LEAST);
    let frames = weights.iter().enumerate();
    let all = frames.flat_map(|(frame, weight)| {
        spatial.iter().map(move |tap| Tap { frame: frame as i32, weight: tap.weight * weight, ..*tap })
    });
    sorted(all.filter(|tap| tap.weight >= least && tap.weight > 0.0).collect())
}

/// A kernel's pixels in decreasing order, unless they would overlap in the tile.
fn narrow(kernel: &Kernel, size: usize) -> Result<Vec<Tap>> {
    let taps = sorted(kernel.taps()?);
    let radius = taps.iter().map(|tap| tap.dx.abs().max(tap.dy.abs())).max().unwrap_or(0) as usize;
    if 2 * radius >= size {
        return Err(Error::input(format!(
            "the kernel {kernel} has a radius of {}: too wide for a tile of {size} pixels; use a size of {} or more, \
             or a narrower kernel",
            counted(radius, "pixel"),
            (2 * radius + 1).next_power_of_two()
        )));
    }
    Ok(taps)
}

/// In decreasing order of weight; of equal weight, in a fixed order.
fn sorted(mut taps: Vec<Tap>) -> Vec<Tap> {
    taps.sort_by(|a, b| b.weight.total_cmp(&a.weight).then((a.frame, a.dy, a.dx).cmp(&(b.frame, b.dy, b.dx))));
    taps
}

/// All subclasses of a problem, with their probabilities, which add up to 1.
fn entries(problem: &TileProblem, classes: &[Class]) -> Vec<Entry> {
    let prefixes = prefixes(problem);
    let mut entries = Vec::new();
    for (index, class) in classes.iter().enumerate() {
        if class.share <= 0.0 {
            continue;
        }
        for (taps, probability) in levels(&class.taps, f64::from(problem.threshold_exponent)) {
            for &(prefix, share, weight) in &prefixes {
                let probability = class.share * probability * share;
                entries.push(Entry { class: index, taps, prefix, probability, weight: class.weight * weight });
            }
        }
    }
    entries.retain(|entry| entry.probability > 0.0);
    entries
}

/// The prefixes of each pixel's samples, with their shares, which add up to 1, and weights.
fn prefixes(problem: &TileProblem) -> Vec<(usize, f64, f32)> {
    if !problem.progressive {
        return vec![(problem.spp, 1.0, 1.0)];
    }
    let levels = problem.spp.trailing_zeros() as usize;
    let class = |level: usize| PREFIXES[levels - level];
    let total: f64 = (0..=levels).map(|level| class(level).0).sum();
    (0..=levels).map(|level| (1 << level, class(level).0 / total, class(level).1)).collect()
}

/// The subclasses of a class, each as the number of its pixels and the probability that a threshold z = u^exponent
/// selects it: pixels of equal weight come together, (5.15).
fn levels(taps: &[Tap], exponent: f64) -> Vec<(usize, f64)> {
    let cut = |weight: f32| libm::pow(f64::from(weight), 1.0 / exponent);
    let equal = |a: f32, b: f32| (a - b).abs() <= 1e-5 * a;
    let mut levels: Vec<(usize, f64)> = Vec::new();
    let mut joined = 0.0;
    for count in 1..=taps.len() {
        let weight = taps[count - 1].weight;
        let next = taps.get(count).map_or(0.0, |tap| tap.weight);
        if count < taps.len() && equal(weight, next) {
            continue;
        }
        joined += cut(weight) - if count < taps.len() { cut(next) } else { 0.0 };
        let last = levels.last().map_or(0, |level| level.0);
        if count < taps.len() && ((count - last) as f64) < JOIN * last as f64 {
            continue;
        }
        levels.push((count, joined));
        joined = 0.0;
    }
    // What lies below the last weight: a threshold there selects all that the kernel has.
    levels
}

/// A lattice of samples with a margin, so that no slice has to wrap around.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    /// Pixels along each side.
    pub(super) size: usize,
    /// Frames.
    pub(super) frames: usize,
    /// Samples per pixel.
    pub(super) spp: usize,
    /// Pixels of margin on every side.
    pub(super) margin: usize,
    /// Frames of margin before the first.
    pub(super) past: usize,
}

impl Lattice {
    /// Pixels along each side, with the margin.
    pub(super) fn side(&self) -> usize {
        self.size + 2 * self.margin
    }

    /// Samples in all, with the margin.
    pub(super) fn samples(&self) -> usize {
        (self.frames + self.past) * self.side() * self.side() * self.spp
    }

    /// The first sample of the pixel at a place that includes the margin.
    pub(super) fn index(&self, frame: usize, y: usize, x: usize) -> usize {
        ((frame * self.side() + y) * self.side() + x) * self.spp
    }
}

/// A subclass, ready for use.
#[derive(Clone, Debug)]
pub(super) struct Stencil {
    /// Its samples, relative to the first sample of the pixel, minus [`Stencils::lowest`]: never negative.
    pub(super) samples: Vec<u32>,
    /// What its displacements count, in units of 1 / [`WEIGHT_UNIT`].
    pub(super) weight: i64,
    /// Where among the bins of all lengths its bins begin.
    pub(super) bins: usize,
}

/// A displacement that counts once counts this much.
pub(super) const WEIGHT_UNIT: f32 = 256.0;

/// All subclasses of a problem, and what finds one by a random number.
#[derive(Debug)]
pub(super) struct Stencils {
    pub(super) lattice: Lattice,
    stencils: Vec<Stencil>,
    /// The subclass ends at this 32-bit number.
    ends: Vec<u32>,
    /// The subclass where the search begins, by the 8 highest bits.
    guide: Vec<u16>,
    /// What a sample's relative place is less than 0, at most.
    pub(super) lowest: usize,
    /// The different numbers of samples, and where their bins begin.
    pub(super) lengths: Vec<(usize, usize)>,
    /// The number of samples of the largest.
    pub(super) longest: usize,
}

impl Stencils {
    /// All subclasses of a problem whose ranges were checked.
    pub(super) fn new(problem: &TileProblem) -> Result<Stencils> {
        let classes = classes(problem)?;
        let entries = entries(problem, &classes);
        let taps = || classes.iter().flat_map(|class| &class.taps);
        let margin = taps().map(|tap| tap.dx.abs().max(tap.dy.abs())).max().unwrap_or(0) as usize;
        let past = taps().map(|tap| tap.frame).max().unwrap_or(0) as usize;
        let lattice = Lattice { size: problem.size, frames: problem.frames, spp: problem.spp, margin, past };
        let longest = entries.iter().map(Entry::length).max().unwrap_or(0);
        if longest > MAX_SAMPLES {
            return Err(Error::input(format!(
                "the kernel holds {longest} samples at {} per pixel, more than {MAX_SAMPLES}: take a narrower kernel \
                 or fewer samples",
                problem.spp
            )));
        }
        let heaviest = |class: usize| {
            let weights = entries.iter().filter(|entry| entry.class == class).map(|entry| f64::from(entry.weight));
            weights.fold(0.0, f64::max)
        };
        let weight: f64 =
            classes.iter().enumerate().map(|(index, class)| class.taps.len() as f64 * heaviest(index)).sum();
        if weight > MAX_WEIGHT {
            return Err(Error::input(format!(
                "the pixels of all classes weigh {weight}, each as much as its class times its prefix: use at most \
                 {MAX_WEIGHT}"
            )));
        }
        let lowest = lattice.index(past, margin, margin);
        let mut lengths: Vec<(usize, usize)> = Vec::new();
        for length in entries.iter().map(Entry::length) {
            if lengths.iter().all(|known| known.0 != length) {
                let start = lengths.last().map_or(0, |last| last.0 + last.1);
                lengths.push((length, start));
            }
        }
        let stencil = |entry: &Entry| {
            let class = &classes[entry.class];
            // In the order of memory.
            let mut pixels: Vec<usize> = class.taps[..entry.taps].iter().map(|tap| lattice.place(tap)).collect();
            pixels.sort_unstable();
            let samples =
                pixels.iter().flat_map(|pixel| (0..entry.prefix).map(move |sample| (pixel + sample) as u32)).collect();
            let weight = libm::roundf(entry.weight * WEIGHT_UNIT).max(1.0) as i64;
            let bins = lengths.iter().find(|known| known.0 == entry.length()).map_or(0, |known| known.1);
            Stencil { samples, weight, bins }
        };
        let mut sum = 0.0;
        let mut ends: Vec<u32> = Vec::new();
        for entry in &entries {
            sum += entry.probability;
            ends.push((sum * 4_294_967_296.0).min(4_294_967_295.0) as u32);
        }
        if let Some(last) = ends.last_mut() {
            *last = u32::MAX;
        }
        let first = |number: u32| ends.iter().position(|&end| number <= end).unwrap_or(0) as u16;
        let guide = (0..256).map(|high| first(high << 24)).collect();
        let stencils = entries.iter().map(stencil).collect();
        Ok(Stencils { lattice, stencils, guide, ends, lowest, lengths, longest })
    }

    /// The subclass of a uniform random number.
    #[inline]
    pub(super) fn pick(&self, number: u32) -> &Stencil {
        let mut index = usize::from(self.guide[(number >> 24) as usize]);
        while number > self.ends[index] {
            index += 1;
        }
        &self.stencils[index]
    }

    /// The number of bins of all lengths together.
    pub(super) fn bins(&self) -> usize {
        self.lengths.last().map_or(0, |last| last.0 + last.1)
    }
}

impl Lattice {
    /// The first sample of a tap, relative to that of the pixel, plus [`Stencils::lowest`].
    fn place(&self, tap: &Tap) -> usize {
        let shift = |margin: usize, by: i32| (margin as i64 + i64::from(by)) as usize;
        self.index(shift(self.past, -tap.frame), shift(self.margin, tap.dy), shift(self.margin, tap.dx))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tile::TemporalKernel;
    use proptest::prelude::*;

    /// The number of joined thresholds must not hide a subclass: all that a threshold can select, found by brute force.
    fn subclasses(taps: &[Tap]) -> Vec<usize> {
        let mut counts: Vec<usize> =
            taps.iter().map(|tap| taps.iter().filter(|other| other.weight >= tap.weight).count()).collect();
        counts.sort_unstable();
        counts.dedup();
        counts
    }

    proptest! {
        /// Point-set filtering: the subclass that a threshold z selects holds the taps with w > z, and no other; its
        /// probability is that of the thresholds that select it.
        #[test]
        fn a_threshold_selects_the_taps_above_it(
            values in prop::collection::vec(0u32..6, 25),
            exponent in 0.5f64..2.0,
        ) {
            prop_assume!(values.iter().any(|&value| value > 0));
            let rows = values.chunks(5).map(|row| row.iter().map(|&value| value as f32 / 5.0).collect()).collect();
            let taps = sorted(Kernel::Tabulated(rows).taps().unwrap());
            let levels = levels(&taps, exponent);
            prop_assert_eq!(levels.iter().map(|level| level.0).collect::<Vec<_>>(), subclasses(&taps));
            let mut above = 1.0;
            for &(count, probability) in &levels {
                // Thresholds in the middle of those that select this subclass.
                let z = (above - probability / 2.0).powf(exponent);
                prop_assert_eq!(taps.iter().filter(|tap| f64::from(tap.weight) > z).count(), count);
                above -= probability;
            }
            prop_assert!(above.abs() < 1e-6);
        }

        /// However many classes, prefixes and frames: probabilities add up to 1 and every random number finds a
        /// subclass inside the lattice.
        #[test]
        fn every_number_finds_a_subclass(
            number in any::<u32>(),
            spp in 0u32..4,
            share in 0.0f32..0.5,
            frames in 1usize..5,
            progressive in any::<bool>(),
        ) {
            let mut problem = TileProblem::new(16, 1 << spp, 2);
            problem.box_class.share = share;
            problem.progressive = progressive;
            problem.frames = frames;
            problem.temporal = (frames > 1).then_some(TemporalKernel::Ema(0.5));
            let all = entries(&problem, &classes(&problem).unwrap());
            let sum: f64 = all.iter().map(|entry| entry.probability).sum();
            prop_assert!((sum - 1.0).abs() < 1e-6);
            let stencils = problem.stencils().unwrap();
            let lattice = stencils.lattice;
            let end = 15 + lattice.margin;
            let last = lattice.index(frames - 1 + lattice.past, end, end) - stencils.lowest;
            let stencil = stencils.pick(number);
            prop_assert!(!stencil.samples.is_empty());
            prop_assert!(stencil.samples.iter().all(|&sample| last + (sample as usize) < lattice.samples()));
            prop_assert!(stencil.bins + stencil.samples.len() <= stencils.bins());
        }
    }
}
