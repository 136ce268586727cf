//! Grids of another resolution.

/// The sums of weights over the cells of a grid of `columns * rows`, row after row; a weight is spread evenly over
/// its pixel.
pub(crate) fn resample(width: usize, height: usize, weights: &[f32], columns: usize, rows: usize) -> Vec<f64> {
    let across = shares(width, columns);
    let down = shares(height, rows);
    let mut cells = vec![0.0; columns * rows];
    let mut line = vec![0.0; columns];
    for (source, targets) in weights.chunks_exact(width).zip(&down) {
        line.fill(0.0);
        for (weight, targets) in source.iter().zip(&across) {
            for (column, share) in targets.iter() {
                line[column] += f64::from(*weight) * share;
            }
        }
        for (row, share) in targets.iter() {
            for (cell, sum) in cells[row * columns..(row + 1) * columns].iter_mut().zip(&line) {
                *cell += sum * share;
            }
        }
    }
    cells
}

/// Of an interval cut into `from` parts, the share of one part in each of the `to` parts of another cut.
struct Shares {
    first: usize,
    shares: Vec<f64>,
}

impl Shares {
    fn iter(&self) -> impl Iterator<Item = (usize, f64)> {
        self.shares.iter().enumerate().map(|(index, share)| (self.first + index, *share))
    }
}

fn shares(from: usize, to: usize) -> Vec<Shares> {
    // In units of 1 / (from * to) every boundary is an integer, and so is every overlap.
    (0..from)
        .map(|part| {
            let (begin, end) = (part * to, (part + 1) * to);
            let first = begin / from;
            let shares = (first..end.div_ceil(from))
                .map(|other| (end.min((other + 1) * from) - begin.max(other * from)) as f64 / to as f64)
                .collect();
            Shares { first, shares }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resampling_keeps_the_mass_where_it_is() {
        let weights: Vec<f32> = (0..15).map(|i| (i * i % 7) as f32).collect();
        for (columns, rows) in [(5, 3), (10, 6), (2, 2), (3, 1), (7, 4)] {
            let cells = resample(5, 3, &weights, columns, rows);
            let total: f64 = cells.iter().sum();
            let centre: f64 = cells.iter().enumerate().map(|(i, c)| c * ((i % columns) as f64 + 0.5)).sum();
            let expected: f64 = weights.iter().map(|w| f64::from(*w)).sum();
            assert!((total - expected).abs() < 1e-9, "{columns} x {rows}: {total}");
            if columns >= 5 && columns % 5 == 0 {
                let source: f64 = weights.iter().enumerate().map(|(i, w)| f64::from(*w) * ((i % 5) as f64 + 0.5)).sum();
                assert!((centre / columns as f64 - source / 5.0).abs() < 1e-9);
            }
        }
    }
}
