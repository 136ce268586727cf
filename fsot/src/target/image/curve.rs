//! Starting positions: points spread along a space-filling curve.

use super::density::ImageTarget;
use crate::points::BELOW_ONE;
use crate::target::Target;
use noisefloor::rng::Rng;

/// Spreads points over densities of the same grid: `counts[k]` points for `targets[k]`, the sets one after the other,
/// x and y of each point, below 1.
///
/// All sets are drawn in one walk along a Hilbert curve: a point is due each time another unit of mass lies behind,
/// and it goes to the set that is furthest behind its own mass. Every set and every union then has about the right
/// number of points in every region, which white noise reaches only after many iterations. A target that is not of
/// the first one's grid is sampled at random.
pub fn spread(targets: &[&ImageTarget], counts: &[usize], rng: &mut Rng) -> Vec<f32> {
    let sets = targets.len().min(counts.len());
    let mut points: Vec<Vec<f32>> = counts[..sets].iter().map(|count| Vec::with_capacity(2 * count)).collect();
    let Some(first) = targets.first() else { return Vec::new() };
    let [width, height] = first.size();
    let shared: Vec<usize> = (0..sets).filter(|k| targets[*k].size() == first.size()).collect();
    let [side_x, side_y] = first.extent();
    // Masses that lie behind, in points of each set.
    let unit: Vec<f64> = shared.iter().map(|k| counts[*k] as f64 / (width * height) as f64).collect();
    let mut behind = vec![0.0_f64; shared.len()];
    let mut due = rng.uniform_f64();
    hilbert(width.max(height), &mut |column, row| {
        if column >= width || row >= height {
            return;
        }
        let mut mass = 0.0;
        for (slot, k) in shared.iter().enumerate() {
            let here = unit[slot] * f64::from(targets[*k].cell(column, row));
            behind[slot] += here;
            mass += here;
        }
        due -= mass;
        while due < 0.0 {
            due += 1.0;
            // Only sets with density here: a point of another would start where it has no target.
            let candidate = shared
                .iter()
                .enumerate()
                .filter(|(_, k)| points[**k].len() < 2 * counts[**k] && targets[**k].cell(column, row) > 0.0)
                .max_by(|a, b| behind[a.0].total_cmp(&behind[b.0]));
            let Some((slot, k)) = candidate else { continue };
            behind[slot] -= 1.0;
            points[*k].push((column as f32 + rng.uniform_f32()) / width as f32 * side_x);
            points[*k].push((row as f32 + rng.uniform_f32()) / height as f32 * side_y);
        }
    });
    let mut all = Vec::with_capacity(2 * counts.iter().sum::<usize>());
    for (k, set) in points.into_iter().enumerate() {
        let drawn = set.len() / 2;
        all.extend(set);
        for _ in drawn..counts[k] {
            let mut point = [0.0; 2];
            targets[k].sample(rng, &mut point);
            all.extend(point);
        }
    }
    all.iter_mut().for_each(|x| *x = x.min(BELOW_ONE));
    all
}

/// Visits the cells of a square whose side is the power of two from `side` on, along a Hilbert curve.
fn hilbert(side: usize, visit: &mut impl FnMut(usize, usize)) {
    let side = side.next_power_of_two();
    for index in 0..side * side {
        let (mut x, mut y, mut rest, mut level) = (0, 0, index, 1);
        while level < side {
            let right = 1 & (rest / 2);
            let down = 1 & (rest ^ right);
            if down == 0 {
                if right == 1 {
                    (x, y) = (level - 1 - x, level - 1 - y);
                }
                (x, y) = (y, x);
            }
            x += level * right;
            y += level * down;
            rest /= 4;
            level *= 2;
        }
        visit(x, y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_cell_by_steps_of_one() {
        let mut cells = Vec::new();
        hilbert(7, &mut |x, y| cells.push((x as i32, y as i32)));
        assert_eq!(cells.len(), 64);
        assert!(cells.windows(2).all(|w| (w[0].0 - w[1].0).abs() + (w[0].1 - w[1].1).abs() == 1));
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 64);
    }
}
