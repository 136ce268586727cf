//! The rows of a matrix that is stored row after row.

// `chunks_exact` panics for a width of zero, which a matrix without columns has; these iterators then have no rows.

/// Rows to read; see [`rows`].
#[derive(Clone)]
pub(crate) struct Rows<'a, T> {
    rest: &'a [T],
    width: usize,
}

/// Rows to write; see [`rows_mut`].
pub(crate) struct RowsMut<'a, T> {
    rest: &'a mut [T],
    width: usize,
}

/// The whole rows of `width` entries.
#[inline]
pub(crate) fn rows<T>(matrix: &[T], width: usize) -> Rows<'_, T> {
    Rows { rest: matrix, width }
}

/// The whole rows of `width` entries.
#[inline]
pub(crate) fn rows_mut<T>(matrix: &mut [T], width: usize) -> RowsMut<'_, T> {
    RowsMut { rest: matrix, width }
}

impl<'a, T> Iterator for Rows<'a, T> {
    type Item = &'a [T];

    #[inline]
    fn next(&mut self) -> Option<&'a [T]> {
        if self.width == 0 {
            return None;
        }
        let (row, rest) = self.rest.split_at_checked(self.width)?;
        self.rest = rest;
        Some(row)
    }
}

impl<'a, T> Iterator for RowsMut<'a, T> {
    type Item = &'a mut [T];

    #[inline]
    fn next(&mut self) -> Option<&'a mut [T]> {
        if self.width == 0 || self.rest.len() < self.width {
            return None;
        }
        let (row, rest) = core::mem::take(&mut self.rest).split_at_mut_checked(self.width)?;
        self.rest = rest;
        Some(row)
    }
}
