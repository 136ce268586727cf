//! The density, its projections and its samples.

use super::grid::Rows;
use super::projection::Profile;
use crate::error::{Error, Result};
use crate::picture::resample;
use crate::target::Target;
use noisefloor::rng::Rng;

/// Cells per point of the grid that a picture is reduced to: the cells are then a third of the mean distance between
/// points, and one projection of the grid costs about as much as sorting the points along the direction.
const CELLS_PER_POINT: usize = 8;
/// A coarser grid would show in the projections: smaller pictures are magnified, each pixel to a block of cells of
/// its value.
const MIN_CELLS: usize = 128 * 128;
/// The most cells on a side: pictures of a few lines are all length.
const MAX_SIDE: usize = 4096;

/// A density that is constant in each cell of a rectangular grid.
///
/// The longer side of the picture is mapped to `[0, 1]`, the shorter one to `[0, shorter / longer]`, so that
/// distances between points are distances in the picture. The first coordinate is x, to the right; the second is y,
/// downwards from the first row.
///
/// Projections (5.23-5.24) are analytic: a cell's footprint on a line is a trapezoid, whose mass in each bin of a
/// histogram as wide as the longer side of the projected cell is exact; within a bin the density is four steps of a
/// line whose slope is limited by the neighbours'.
///
/// Densities are relative to the mass spread evenly over the rectangle's mean projected length, not over that of the
/// direction at hand as in (5.24): that one is longer on diagonals, which weighs them more, and in long runs aligns
/// the points with the axes. With a fixed length, the mean force over all directions is the isotropic gradient of the
/// energy distance with the kernel -|x - y|.
#[derive(Clone, Debug)]
pub struct ImageTarget {
    /// Cells, of mean value 1; rows along x.
    rows: Rows,
    /// The same, transposed: rows along y.
    columns: Rows,
    extent: [f32; 2],
    /// Running sums of the rows' masses; the last one is the total.
    cumulative: Vec<f64>,
}

impl ImageTarget {
    /// The density of `width * height` weights, row after row from the top, at a resolution that is adequate for
    /// `points` points: about 8 cells for each (area averages of a larger picture), 128 x 128 at least, but no side of
    /// more than 4,096.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] if a side is 0, the number of weights is not `width * height`, a weight is negative or not
    /// finite, or all of them are 0.
    pub fn new(width: usize, height: usize, weights: &[f32], points: usize) -> Result<ImageTarget> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(weights.len()) {
            return Err(Error::Input(format!(
                "a density of {width} x {height} cells needs as many weights, and at least one; there are {}",
                weights.len()
            )));
        }
        if let Some(at) = weights.iter().position(|w| !w.is_finite() || *w < 0.0) {
            return Err(Error::Input(format!(
                "the density at column {}, row {} is {}; it must be finite and not negative",
                at % width,
                at / width,
                weights[at]
            )));
        }
        let (columns, rows) = resolution(width, height, points);
        let cells = resample(width, height, weights, columns, rows);
        let longer = width.max(height) as f64;
        ImageTarget::from_cells(columns, rows, cells, [(width as f64 / longer) as f32, (height as f64 / longer) as f32])
    }

    /// The weighted sum of densities of the same grid, each of them normalised first: the target of the union of
    /// subsets that have the fractions `weight` of the points ("weighted-average densities based on the respective
    /// energy", 5.5.1).
    ///
    /// # Errors
    ///
    /// [`Error::Input`] if there are no parts, their grids differ, or the weights are negative, not finite or all 0.
    pub fn mixture(parts: &[(f32, &ImageTarget)]) -> Result<ImageTarget> {
        let Some((_, first)) = parts.first() else {
            return Err(Error::input("a mixture of densities needs at least one"));
        };
        let mut cells = vec![0.0_f64; first.rows.width() * first.rows.height()];
        for (weight, part) in parts {
            if !weight.is_finite() || *weight < 0.0 {
                return Err(Error::Input(format!(
                    "the weight of a density is {weight}; it must be finite and not negative"
                )));
            }
            if part.size() != first.size() || part.extent != first.extent {
                return Err(Error::input("the densities of a mixture must come from pictures of the same size"));
            }
            for (y, row) in cells.chunks_exact_mut(first.rows.width()).enumerate() {
                for (sum, cell) in row.iter_mut().zip(part.rows.cells(y)) {
                    *sum += f64::from(*weight) * f64::from(*cell);
                }
            }
        }
        ImageTarget::from_cells(first.rows.width(), first.rows.height(), cells, first.extent)
    }

    fn from_cells(width: usize, height: usize, cells: Vec<f64>, extent: [f32; 2]) -> Result<ImageTarget> {
        let total: f64 = cells.iter().sum();
        // Of the f32 weights that are positive, even the smallest has a reciprocal in f64.
        if total <= 0.0 {
            return Err(Error::input("the density is 0 everywhere: there is nowhere to put a point"));
        }
        let scale = cells.len() as f64 / total;
        let cells: Vec<f32> = cells.into_iter().map(|cell| (cell * scale) as f32).collect();
        let mut sum = 0.0;
        let cumulative = cells
            .chunks_exact(width)
            .map(|row| {
                row.iter().for_each(|cell| sum += f64::from(*cell));
                sum
            })
            .collect();
        let rows = Rows::new(width, height, &cells);
        let columns = rows.transposed();
        Ok(ImageTarget { rows, columns, extent, cumulative })
    }

    /// The rectangle from the origin that holds all of the density: the longer side is 1.
    pub fn extent(&self) -> [f32; 2] {
        self.extent
    }

    /// The length of the rectangle's projection, in the mean of all directions: its circumference over pi.
    fn mean_range(&self) -> f64 {
        2.0 / std::f64::consts::PI * (f64::from(self.extent[0]) + f64::from(self.extent[1]))
    }

    /// Columns and rows of the grid.
    pub fn size(&self) -> [usize; 2] {
        [self.rows.width(), self.rows.height()]
    }

    /// The density of the cell at a column and row, relative to the mean of the rectangle.
    pub fn cell(&self, column: usize, row: usize) -> f32 {
        self.rows.cells(row)[column]
    }
}

/// Columns and rows of the grid for a picture and a number of points.
fn resolution(width: usize, height: usize, points: usize) -> (usize, usize) {
    let wanted = points.saturating_mul(CELLS_PER_POINT).max(MIN_CELLS) as f64;
    let pixels = width as f64 * height as f64;
    if pixels <= wanted {
        // Whole blocks, within the longest side: a magnified picture is the same density exactly.
        let factor = ((MIN_CELLS as f64 / pixels).sqrt().ceil() as usize).max(1);
        return ((width * factor).min(MAX_SIDE), (height * factor).min(MAX_SIDE));
    }
    let scale = (wanted / pixels).sqrt();
    let side = |length: usize| ((length as f64 * scale).round() as usize).clamp(1, length.min(MAX_SIDE));
    (side(width), side(height))
}

impl Target for ImageTarget {
    fn dims(&self) -> usize {
        2
    }

    fn bins(&self, direction: &[f32], means: &mut [f32], density: &mut [f32], scratch: &mut Vec<f32>) {
        let (x, y) = (f64::from(direction[0]), f64::from(direction[1]));
        let cell_x = f64::from(self.extent[0]) / self.rows.width() as f64;
        let cell_y = f64::from(self.extent[1]) / self.rows.height() as f64;
        let (along_x, along_y) = (x * cell_x, y * cell_y);
        // Rows run along the axis on which a cell's projection is longer, towards ascending coordinates.
        let (rows, along, across) = if along_x.abs() >= along_y.abs() {
            (&self.rows, along_x, along_y)
        } else {
            (&self.columns, along_y, along_x)
        };
        let mirrored = along < 0.0;
        let (along, across) = if mirrored { (-along, -across) } else { (along, across) };
        Profile::of(rows, across / along, scratch).cut(along, self.mean_range(), means, density);
        if mirrored {
            means.reverse();
            density.reverse();
            means.iter_mut().for_each(|mean| *mean = -*mean);
        }
    }

    fn sample(&self, rng: &mut Rng, point: &mut [f32]) {
        let total = self.cumulative.last().copied().unwrap_or(0.0);
        let at = rng.uniform_f64() * total;
        // The first running sum beyond `at` belongs to a row of positive mass. `at` may round up to the total: then
        // the last such.
        let row = self.cumulative.partition_point(|sum| *sum <= at);
        let row = if row < self.cumulative.len() { row } else { self.cumulative.partition_point(|sum| *sum < total) };
        let mut left = at - if row == 0 { 0.0 } else { self.cumulative[row - 1] };
        let cells = self.rows.cells(row);
        let mut column = cells.iter().rposition(|cell| *cell > 0.0).unwrap_or(0);
        for (index, cell) in cells.iter().enumerate() {
            left -= f64::from(*cell);
            if left < 0.0 {
                column = index;
                break;
            }
        }
        let within = |index: usize, cells: usize, length: f32, u: f64| {
            (((index as f64 + u) / cells as f64 * f64::from(length)) as f32).min(length)
        };
        point[0] = within(column, self.rows.width(), self.extent[0], rng.uniform_f64());
        point[1] = within(row, self.rows.height(), self.extent[1], rng.uniform_f64());
    }
}
