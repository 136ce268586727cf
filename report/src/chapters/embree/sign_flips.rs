//! Is a mean image off, all over? A randomisation test that holds whatever the dependence between pixels.

/// Deviations from the truth of the means of independent batches of frames, number by number of the image. Without bias
/// each batch's deviation is as likely as its negative, for means of many frames: every choice of signs makes an
/// equally likely sum, and the mean square of the one that was measured must not be among the largest (R. Fisher's
/// randomisation test).
///
/// All batches share the reference, whose noise e does not flip with them: the sum of n batches has n e in it, one of
/// signs that add up to s has s e. What is missing of its variance, (n^2 - s^2) var(e), is made up for by half of the
/// difference of the reference's halves, which varies as e does and is independent of it: times the root of n^2 - s^2
/// it is added, with either sign.
pub(crate) struct SignFlips {
    /// Mean squares of the sums, by choice of signs; the first is the measured one.
    squares: Vec<f64>,
}

impl SignFlips {
    /// `deviations`: of each batch, from two independent halves of a reference, so that its own noise cancels; each
    /// number's in units of the standard deviation of its sum over all batches.
    pub(crate) fn new(deviations: &[[Vec<f64>; 2]]) -> Self {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len().max(1) as f64;
        let both = |a: &[Vec<f64>; 2], b: &[Vec<f64>; 2]| 0.5 * (product(&a[0], &b[1]) + product(&a[1], &b[0]));
        // Of a batch's deviation from the mean of the halves, and of theirs from it, which is the same for all.
        let apart = |[a, b]: &[Vec<f64>; 2]| 0.25 * (product(a, a) - product(b, b));
        let apart: Vec<f64> = deviations.iter().map(apart).collect();
        let mut products = vec![vec![0.0; deviations.len()]; deviations.len()];
        for (a, b) in (0..deviations.len()).flat_map(|a| (0..=a).map(move |b| (a, b))) {
            products[a][b] = both(&deviations[a], &deviations[b]);
            products[b][a] = products[a][b];
        }
        let mut signs = vec![1.0; deviations.len()];
        let mut square: f64 = products.iter().flatten().sum();
        let (mut sum, mut across) = (signs.iter().sum::<f64>(), apart.iter().sum::<f64>());
        let mut squares = Vec::new();
        // Negating all is the same: the last batch keeps its sign. One sign changes from a choice to the next.
        for choice in 0..1_u32 << deviations.len().saturating_sub(1) {
            if choice > 0 {
                let batch = choice.trailing_zeros() as usize;
                signs[batch] = -signs[batch];
                let product: f64 = products[batch].iter().zip(&signs).map(|(product, sign)| product * sign).sum();
                square += 4.0 * (signs[batch] * product - products[batch][batch]);
                sum += 2.0 * signs[batch];
                across += 2.0 * signs[batch] * apart[batch];
            }
            let missing = ((deviations.len() as f64).powi(2) - sum * sum).max(0.0).sqrt();
            squares.extend([square + 2.0 * missing * across, square - 2.0 * missing * across]);
        }
        Self { squares }
    }

    /// The measured mean square.
    pub(crate) fn measured(&self) -> f64 {
        self.squares.first().copied().unwrap_or(f64::NAN)
    }

    /// What at most a share `significance` of all choices of signs exceed.
    pub(crate) fn allowed(&self, significance: f64) -> f64 {
        let mut squares = self.squares.clone();
        let exceed = (significance * squares.len() as f64).floor() as usize;
        if exceed < squares.len() { *squares.select_nth_unstable_by(exceed, |a, b| b.total_cmp(a)).1 } else { f64::NAN }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    /// 12 batches of 300 numbers of variance 1/3, the same in neighbouring `shared`, and a reference whose variance is
    /// that of their mean times `reference`.
    fn flips(seed: u64, bias: f64, shared: usize, reference: f64) -> SignFlips {
        let mut random = Rng::with_seed(seed);
        let mut noise = |scale: f64| -> Vec<f64> {
            let uniform = || scale * (2.0 * random.f64() - 1.0);
            let noise: Vec<f64> = std::iter::repeat_with(uniform).take(300 / shared).collect();
            (0..300).map(|number| noise[number / shared]).collect()
        };
        let halves = [(); 2].map(|()| noise((2.0 * reference / 12.0).sqrt()));
        let batch = |_| {
            let mean = noise(1.0);
            halves.each_ref().map(|half| mean.iter().zip(half).map(|(mean, half)| (bias + mean - half) / 2.0).collect())
        };
        let deviations: Vec<[Vec<f64>; 2]> = (0..12).map(batch).collect();
        SignFlips::new(&deviations)
    }

    #[test]
    fn the_level_holds_whatever_the_dependence_between_numbers() {
        // With a reference a tenth and three tenths as noisy as what is tested, too.
        for (shared, reference) in
            [(1, 0.0), (30, 0.0), (300, 0.0), (1, 0.1), (30, 0.1), (300, 0.1), (1, 0.3), (30, 0.3), (300, 0.3)]
        {
            let exceeded = (0..400).filter(|&seed| {
                let flips = flips(1 + seed, 0.0, shared, reference);
                flips.measured() > flips.allowed(0.05)
            });
            // 20 of 400; 36 is 3.7 standard deviations more. Without regard to a reference of .3 it is 44 of
            // independent numbers.
            let exceeded = exceeded.count();
            assert!((5..36).contains(&exceeded), "{exceeded} of 400, {shared} numbers alike, reference {reference}");
        }
    }

    #[test]
    fn a_small_bias_all_over_shows() {
        // A sum of 12 has 1.2 of bias and 2 of deviation: a mean square of 1.36 where 1 is expected. Six seeds in ten
        // show it at this level.
        let shows = |seed: &u64| {
            let flips = flips(*seed, 0.1, 1, 0.0);
            flips.measured() > 1.2 && flips.measured() > flips.allowed(0.001)
        };
        let shown = (1..=30).filter(shows).count();
        assert!(shown >= 10, "{shown} of 30");
    }
}
