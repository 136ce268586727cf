//! Grids of cells: their rows, and their resolution.

/// Cells of a grid, row after row, each row with two zeros on either side: what a projection, a filter of three taps, reads.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    width: usize,
    height: usize,
    padded: Vec<f32>,
    /// Of each row, the first cell that is not 0 and the one after the last.
    spans: Vec<(u32, u32)>,
}

const PADDING: usize = 2;

impl Rows {
    /// `cells`: `width * height`, row after row.
    pub(super) fn new(width: usize, height: usize, cells: &[f32]) -> Rows {
        let stride = width + 2 * PADDING;
        let mut padded = vec![0.0; stride * height];
        let mut spans = Vec::with_capacity(height);
        for (row, to) in cells.chunks_exact(width).zip(padded.chunks_exact_mut(stride)) {
            to[PADDING..PADDING + width].copy_from_slice(row);
            let first = row.iter().position(|cell| *cell != 0.0).unwrap_or(0);
            let end = row.iter().rposition(|cell| *cell != 0.0).map_or(0, |last| last + 1);
            spans.push((first as u32, end as u32));
        }
        Rows { width, height, padded, spans }
    }

    pub(super) fn transposed(&self) -> Rows {
        let mut cells = Vec::with_capacity(self.width * self.height);
        for x in 0..self.width {
            cells.extend((0..self.height).map(|y| self.cells(y)[x]));
        }
        Rows::new(self.height, self.width, &cells)
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    pub(super) fn cells(&self, row: usize) -> &[f32] {
        let from = row * (self.width + 2 * PADDING) + PADDING;
        &self.padded[from..from + self.width]
    }

    /// The cells of a row from the first to the last that is not 0, with two more on either side; and the index of that first
    /// cell. `None` for a row of zeros.
    pub(super) fn occupied(&self, row: usize) -> Option<(usize, &[f32])> {
        let (first, end) = self.spans[row];
        if first >= end {
            return None;
        }
        let from = row * (self.width + 2 * PADDING);
        Some((first as usize, &self.padded[from + first as usize..from + end as usize + 2 * PADDING]))
    }
}

/// The sums of weights over the cells of a grid of `columns * rows`, row after row; a weight is spread evenly over its pixel.
pub(super) fn resample(width: usize, height: usize, weights: &[f32], columns: usize, rows: usize) -> Vec<f64> {
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

    #[test]
    fn rows_know_where_they_are_empty() {
        let rows = Rows::new(4, 2, &[0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(rows.occupied(0), Some((1, &[0.0, 0.0, 1.0, 2.0, 0.0, 0.0][..])));
        assert_eq!(rows.occupied(1), None);
        assert_eq!(rows.transposed().cells(2), [2.0, 0.0]);
    }
}
