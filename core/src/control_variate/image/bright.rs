//! Pixels whose values lie far from those of all others: fireflies, small highlights.
//!
//! A fit has seen them, and even a fit that is hardly trusted then moves the other pixels by more than their own error.
//! So where the mean is trusted most, such pixels are left out of the fits to others.

use super::batch::Batch;
use super::products::*;

/// One of so many pixels may be set aside at each end, rounded up.
const SHARE: usize = 16;
/// No more are.
const MOST: usize = 16;
/// Fewer pixels do not say what is usual.
const FEWEST: f32 = 8.0;
/// How far from the others a value is, in units of their range, that its pixel is left out.
const FAR: f32 = 8.0;
/// The least trust in the mean: where fits are better, rare bright values are what they explain.
const DOUBT: f32 = 0.5;

/// The highest values, in falling order.
struct Highest([Eight; MOST + 1]);

impl Highest {
    fn new() -> Self {
        Self([[f32::NEG_INFINITY; LANES]; MOST + 1])
    }

    /// Adds a value, keeping `count` of them.
    #[inline]
    fn add(&mut self, mut value: Eight, count: usize) {
        for place in self.0.iter_mut().take(count) {
            let above = lanes::zip(place, &value, |place, value| if value > place { value } else { place });
            value = lanes::zip(place, &value, |place, value| if value > place { place } else { value });
            *place = above;
            lanes::keep_together();
        }
    }

    /// Makes the lanes one, in all of them.
    fn join(&mut self, count: usize) {
        let mut whole = Self::new();
        for values in self.0.iter().take(count) {
            for &value in values {
                whole.add([value; LANES], count);
            }
        }
        *self = whole;
    }

    /// The lane's value that is `aside` places below its highest.
    fn below(&self, aside: usize, lane: usize) -> f32 {
        self.0.get(aside).map_or(f32::INFINITY, |values| values[lane % LANES])
    }
}

/// The lowest and the highest value of a channel that fits are made to, in each lane: near those of the `judges`, where
/// any is too far; else infinite. `trust` is that in the mean.
/// Where a judge itself is too far and fits are trusted, they explain it, and keep such values.
#[inline(always)]
pub(super) fn limits(batch: &Batch<'_>, channel: usize, judges: Colours, trust: &Eight) -> [[f32; 2]; LANES] {
    let mut limits = [[f32::NEG_INFINITY, f32::INFINITY]; LANES];
    if judges == Colours::ALL && trust.iter().all(|&trust| trust < DOUBT) {
        return limits;
    }
    let mut counts = NONE;
    for inside in batch.blocks(judges).filter_map(|block| batch.inside.get(block)).flatten() {
        counts = plus(&counts, inside);
    }
    let counts = batch.joined(&counts);
    let aside = counts.map(|count| (count as usize).div_ceil(SHARE).min(MOST));
    let kept = 1 + aside.into_iter().fold(0, usize::max);
    // Of judges, and of others.
    let (mut highest, mut lowest) = (Highest::new(), Highest::new());
    let (mut most, mut least) = (Highest::new(), Highest::new());
    let inside = batch.inside.as_flattened();
    for (slot, (inside, [low, high])) in inside.iter().zip(row_at(batch.ranges, inside.len(), channel)).enumerate() {
        let seen = |value: Eight| {
            lanes::zip(&value, inside, |value, inside| if inside > 0.0 { value } else { f32::NEG_INFINITY })
        };
        let (high, low) = (seen(*high), seen(low.map(|low| -low)));
        if judges.has(slot / AT_ONCE) {
            highest.add(high, kept);
            lowest.add(low, kept);
        } else {
            most.add(high, 1);
            least.add(low, 1);
        }
    }
    if batch.is_joined {
        for highest in [&mut highest, &mut lowest, &mut most, &mut least] {
            highest.join(kept);
        }
    }
    for l in 0..LANES {
        if counts[l] < FEWEST {
            continue;
        }
        let [low, high] = [-lowest.below(aside[l], l), highest.below(aside[l], l)];
        let far = FAR * (high - low);
        let near = [low - far, high + far];
        let is_beyond = |least: f32, most: f32| least < near[0] || most > near[1];
        let is_far = is_beyond(-lowest.below(0, l), highest.below(0, l));
        let are_others = is_beyond(-least.below(0, l), most.below(0, l));
        let is_explained = is_far && trust[l] < DOUBT;
        if (is_far || are_others) && !is_explained {
            limits[l] = near;
        }
    }
    limits
}
