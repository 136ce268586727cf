//! Sums of products, of eight groups side by side: what fits are made from. All files here are written with its words.

pub(super) use crate::arena::Arena;
use crate::basis::MAX_DIMS;
pub(super) use crate::lanes::{self, LANES, Lanes};
pub(super) use crate::linalg::ldlt;
pub(super) use crate::matrix::*;
pub(super) use crate::real::{Real, rounding, saturate};

/// A number for each of eight groups.
pub(super) type Eight = Lanes<f32>;
/// The same for four samples or pixels of each.
pub(super) type Four = [Eight; AT_ONCE];
/// Nothing in any lane.
pub(super) const NONE: Eight = [0.0; LANES];
pub(super) const COLOURS: usize = 4;
/// Samples or pixels that are worked on at a time.
pub(super) const AT_ONCE: usize = 4;

impl<'a> Arena<'a, f32> {
    /// The next groups of eight, by fours.
    pub(super) fn take_fours(&mut self, count: usize) -> &'a mut [Four] {
        self.take_lanes(count.saturating_mul(AT_ONCE)).as_chunks_mut().0
    }
}

/// The lanes where `mask` is not 0; 0 elsewhere, whatever is there.
#[inline(always)]
pub(super) fn only(mask: &Eight, value: &Eight) -> Eight {
    lanes::zip(value, mask, |value, mask| if mask > 0.0 { value } else { 0.0 })
}

#[inline(always)]
pub(super) fn plus(a: &Eight, b: &Eight) -> Eight {
    lanes::zip(a, b, |a, b| a + b)
}

pub(super) fn minus(a: &Eight, b: &Eight) -> Eight {
    lanes::zip(a, b, |a, b| a - b)
}

pub(super) fn product(a: &Eight, b: &Eight) -> Eight {
    lanes::zip(a, b, |a, b| a * b)
}

/// Sets sums to zero: they are few, and a call of memset takes longer.
pub(super) fn empty(sums: &mut [Eight]) {
    let (fours, rest) = sums.as_chunks_mut();
    for four in fours {
        *four = [NONE; AT_ONCE];
        lanes::keep_together();
    }
    for sum in rest {
        *sum = NONE;
        lanes::keep_together();
    }
}

#[inline(always)]
pub(super) fn total([a, b, c, d]: &Four) -> Eight {
    plus(&plus(a, b), &plus(c, d))
}

/// `f(a, b)` for each of four.
#[inline(always)]
pub(super) fn zip_four(a: &Four, b: &Four, f: impl Fn(&Eight, &Eight) -> Eight) -> Four {
    let mut out = *a;
    for (out, b) in out.iter_mut().zip(b) {
        *out = f(out, b);
    }
    out
}

/// The products of four numbers with others.
#[inline(always)]
pub(super) fn times(a: &Four, b: &Four) -> Four {
    zip_four(a, b, product)
}

/// A sum and four products, one after the other.
#[inline(always)]
pub(super) fn plus_four(mut sum: Eight, a: &Four, b: &Four) -> Eight {
    for row in 0..AT_ONCE {
        sum = lanes::plus_product(sum, a[row], b[row]);
    }
    sum
}

/// Adds to each sum the products of a column with one of `columns`.
#[inline(always)]
pub(super) fn add_products(sums: &mut [Eight], column: &Four, columns: &[Four]) {
    let (column, len) = (*column, sums.len().min(columns.len()));
    let (Some(sums), Some(columns)) = (sums.get_mut(..len), columns.get(..len)) else { return };
    let ((pairs, rest), (others, last)) = (sums.as_chunks_mut::<2>(), columns.as_chunks::<2>());
    for ([a, b], [c, d]) in pairs.iter_mut().zip(others) {
        *a = plus_four(*a, &column, c);
        *b = plus_four(*b, &column, d);
        lanes::keep_together();
    }
    if let ([sum], [other]) = (rest, last) {
        *sum = plus_four(*sum, &column, other);
    }
}

/// Four sums, and the products of columns with their coefficients.
#[inline(always)]
pub(super) fn combine(sums: Four, columns: &[Four], coefficients: &[Eight]) -> Four {
    lanes::with_products(sums, columns, coefficients, lanes::plus_product)
}

/// Sums of the products of two rows up to each of `ends`.
#[inline(always)]
pub(super) fn sums_to(ends: &[usize], a: &[Eight], b: &[Eight], mut out: impl FnMut(usize, Eight)) {
    let (mut sum, mut begin) = (NONE, 0);
    for (index, &end) in ends.iter().enumerate() {
        for (a, b) in part(a, begin, end - begin).iter().zip(from(b, begin)) {
            sum = lanes::plus_product(sum, *a, *b);
            lanes::keep_together();
        }
        out(index, sum);
        begin = end;
    }
}

/// Some of the colours, a bit each.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Colours(pub(super) u8);

impl Colours {
    pub(super) const ALL: Self = Self(0b1111);
    /// Either half of them.
    pub(super) const HALVES: [Self; 2] = [Self(0b1001), Self(0b0110)];

    /// Whether a block, or a part, is of one of these.
    pub(super) fn has(self, index: usize) -> bool {
        self.0 >> (index % COLOURS) & 1 == 1
    }

    /// These without one.
    pub(super) fn without(self, colour: usize) -> Self {
        Self(self.0 & !(1 << colour))
    }
}

/// Numbers of a [`Four`].
pub(super) const AT_ONCE_LANES: usize = AT_ONCE * LANES;

/// Four rows of samples or pixels.
pub(super) struct Rows<'a> {
    /// Where samples are: what is left of others where there is no row.
    pub(super) x: [Lanes<f32, AT_ONCE_LANES>; MAX_DIMS],
    pub(super) columns: &'a mut [Four],
    pub(super) values: &'a mut [Four],
}

impl<'a> Rows<'a> {
    pub(super) fn new(columns: usize, values: usize, arena: &mut Arena<'a, f32>) -> Self {
        let (columns, values) = (arena.take_fours(columns), arena.take_fours(values));
        values.iter_mut().for_each(|four| *four = [NONE; AT_ONCE]);
        Self { x: [[0.0; AT_ONCE_LANES]; MAX_DIMS], columns, values }
    }
}

/// Sums of products, part after part; of slices, those of every slice of the first part, then of the next.
pub(super) struct Sums<'a> {
    all: &'a mut [Eight],
    columns: usize,
    values: usize,
}

/// Those of one part: of columns with columns, packed; of each value with columns, and with itself.
pub(super) struct Part<S> {
    pub(super) gram: S,
    pub(super) sides: S,
    pub(super) squares: S,
}

impl<'a> Sums<'a> {
    /// Lanes of one part.
    pub(super) fn len(columns: usize, values: usize) -> usize {
        packed_len(columns) + values * columns + values
    }

    pub(super) fn new(parts: usize, columns: usize, values: usize, arena: &mut Arena<'a, f32>) -> Self {
        Self { all: arena.take_lanes(parts * Self::len(columns, values)), columns, values }
    }

    pub(super) fn empty(&mut self) {
        empty(self.all);
    }

    /// Joins the lanes, in all of them.
    pub(super) fn join(&mut self) {
        self.all.iter_mut().for_each(|sum| *sum = [lanes::sum(sum); LANES]);
    }

    pub(super) fn part(&self, part: usize) -> Part<&[Eight]> {
        let sums = row_at(self.all, Self::len(self.columns, self.values), part);
        let (gram, rest) = halves(sums, packed_len(self.columns));
        let (sides, squares) = halves(rest, self.values * self.columns);
        Part { gram, sides, squares }
    }

    pub(super) fn part_mut(&mut self, part: usize) -> Part<&mut [Eight]> {
        let sums = row_at_mut(self.all, Self::len(self.columns, self.values), part);
        let (gram, rest) = halves_mut(sums, packed_len(self.columns));
        let (sides, squares) = halves_mut(rest, self.values * self.columns);
        Part { gram, sides, squares }
    }

    /// Adds those of a block: its columns, and its values.
    #[inline(always)]
    pub(super) fn add(&mut self, part: usize, columns: &[Four], values: &[Four]) {
        let (width, Part { mut gram, sides, squares }) = (columns.len(), self.part_mut(part));
        for (i, column) in columns.iter().enumerate() {
            let Some((row, rest)) = gram.split_at_mut_checked(i + 1) else { return };
            gram = rest;
            add_products(row, column, columns);
        }
        for (value, sides) in values.iter().zip(rows_mut(sides, width)) {
            add_products(sides, value, columns);
        }
        for (value, square) in values.iter().zip(squares) {
            *square = plus_four(*square, value, value);
        }
    }

    /// Makes it the sum of as large parts of another, those of some colours.
    #[inline(always)]
    pub(super) fn set_total(&mut self, of: &Sums<'_>, colours: Colours) {
        let parts = rows(of.all, self.all.len()).zip(0..).filter(|&(_, part)| colours.has(part)).map(|(part, _)| part);
        let mut each = [&[][..]; COLOURS];
        each.iter_mut().zip(parts).for_each(|(out, part)| *out = part);
        let [a, b, c, d] = each;
        // Mostly three, in one pass.
        for (((out, a), b), c) in self.all.iter_mut().zip(a).zip(b).zip(c) {
            *out = plus(&plus(a, b), c);
            lanes::keep_together();
        }
        if c.is_empty() {
            copy(self.all, a);
        }
        for (out, sum) in self.all.iter_mut().zip(if c.is_empty() { b } else { d }) {
            *out = plus(out, sum);
            lanes::keep_together();
        }
    }

    /// Adds another's one part, times a weight.
    #[inline(always)]
    pub(super) fn add_weighted(&mut self, other: &Sums<'_>, weight: &Eight) {
        let weight = *weight;
        for (out, sum) in self.all.iter_mut().zip(other.all.iter()) {
            *out = lanes::plus_product(*out, *sum, weight);
            lanes::keep_together();
        }
    }
}
