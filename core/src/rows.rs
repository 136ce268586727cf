//! The rows of a matrix that is stored row after row.

pub(crate) use crate::matrix::{row_at, row_at_mut, rows, rows_mut};
