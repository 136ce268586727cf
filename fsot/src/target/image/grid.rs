//! Grids of cells, and their rows as projections read them.

/// Cells of a grid, row after row, each row with two zeros on either side: what a projection, a filter of three taps,
/// reads.
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

    /// The cells of a row from the first to the last that is not 0, with two more on either side; and the index of
    /// that first cell. `None` for a row of zeros.
    pub(super) fn occupied(&self, row: usize) -> Option<(usize, &[f32])> {
        let (first, end) = self.spans[row];
        if first >= end {
            return None;
        }
        let from = row * (self.width + 2 * PADDING);
        Some((first as usize, &self.padded[from + first as usize..from + end as usize + 2 * PADDING]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_know_where_they_are_empty() {
        let rows = Rows::new(4, 2, &[0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(rows.occupied(0), Some((1, &[0.0, 0.0, 1.0, 2.0, 0.0, 0.0][..])));
        assert_eq!(rows.occupied(1), None);
        assert_eq!(rows.transposed().cells(2), [2.0, 0.0]);
    }
}
