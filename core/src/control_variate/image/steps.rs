//! The work of a batch, in functions that are compiled for a processor, each by itself.

use super::super::config::Estimate;
use super::batch::Batch;
use super::call::Call;
use super::choice::{Choices, Shares, Spreads};
use super::edges::Edges;
use super::fit::Fits;
use super::groups::Groups;
use super::products::{COLOURS, Colours, Eight, Four};
use super::slices::Apart;
use super::sums::Band;
use super::terms::Terms;
use crate::arena::Arena;
use crate::error::Error;
use crate::processor::{Processor, Step};

/// Corrects every pixel of the colours `taken`, of which fits have seen no sample, by those to the others of them.
pub(super) fn correct<P: Processor>(
    fits: &mut Fits<'_>,
    call: &Call<'_>,
    terms: &Terms,
    batch: &Batch<'_>,
    taken: Colours,
) {
    if let Some((apart, penalties, corrections)) = fits.apart() {
        correct_slices::<P>(apart, terms, batch, penalties, taken, corrections);
    } else if call.n == 1 {
        factor::<P>(fits, call, terms, batch, taken);
        leave_own::<P>(fits, terms, batch, taken);
    } else {
        for colour in (0..COLOURS).filter(|&colour| taken.has(colour)) {
            factor::<P>(fits, call, terms, batch, taken.without(colour));
            correct_colour::<P>(fits, terms, batch, colour);
        }
    }
}

macro_rules! steps {
    ($(
        $(#[$doc:meta])*
        fn $name:ident($($argument:ident: $type:ty),* $(,)?) -> $result:ty $body:block
    )*) => {$(
        $(#[$doc])*
        pub(super) fn $name<'s, 'a, P: Processor>($($argument: $type),*) -> $result {
            struct Arguments<'s, 'a> {
                $($argument: $type),*
            }
            impl<'s, 'a> Step for Arguments<'s, 'a> {
                type Output = $result;

                #[inline(always)]
                fn run(self) -> $result {
                    let Self { $($argument),* } = self;
                    $body
                }
            }
            P::run(Arguments { $($argument),* })
        }
    )*};
}

steps! {
    /// [`Batch::survey`].
    fn survey(batch: &'s mut Batch<'a>, call: &'s Call<'s>, groups: &'s Groups<'s>, terms: &'s Terms) -> () {
        batch.survey(call, groups, terms);
    }

    /// [`Batch::relate`].
    fn relate(batch: &'s mut Batch<'a>, call: &'s Call<'s>, arena: &'s mut Arena<'a, f32>) -> Result<(), Error> {
        batch.relate(call, arena)
    }

    /// [`Batch::load`].
    fn load(
        batch: &'s mut Batch<'a>,
        call: &'s Call<'s>,
        terms: &'s Terms,
        arena: &'s mut Arena<'a, f32>,
    ) -> Result<(), Error> {
        batch.load(call, terms, arena)
    }

    /// [`Fits::factor`].
    fn factor(
        fits: &'s mut Fits<'a>,
        call: &'s Call<'s>,
        terms: &'s Terms,
        batch: &'s Batch<'s>,
        training: Colours,
    ) -> () {
        fits.factor(call, terms, batch, training);
    }

    /// [`Fits::leave_own`].
    fn leave_own(fits: &'s mut Fits<'a>, terms: &'s Terms, batch: &'s Batch<'s>, taken: Colours) -> () {
        fits.leave_own(terms, batch, taken);
    }

    /// [`Fits::correct_colour`].
    fn correct_colour(fits: &'s mut Fits<'a>, terms: &'s Terms, batch: &'s Batch<'s>, colour: usize) -> () {
        fits.correct_colour(terms, batch, colour);
    }

    /// [`Apart::correct`].
    fn correct_slices(
        apart: &'s mut Apart<'a>,
        terms: &'s Terms,
        batch: &'s Batch<'s>,
        penalties: &'s [f32],
        taken: Colours,
        corrections: &'s mut [Four],
    ) -> () {
        apart.correct(terms, batch, penalties, taken, corrections);
    }

    /// [`Edges::load`].
    fn load_edges(edges: &'s mut Edges<'a>, call: &'s Call<'s>, batch: &'s Batch<'s>) -> () {
        edges.load(call, batch);
    }

    /// [`Edges::correct`].
    fn correct_edges(edges: &'s mut Edges<'a>, batch: &'s Batch<'s>, taken: Colours, fits: &'s mut Fits<'a>) -> () {
        edges.correct(batch, taken, fits);
    }

    /// [`Spreads::new`].
    fn spreads(
        choices: Choices,
        terms: &'s Terms,
        batch: &'s Batch<'s>,
        fits: &'s Fits<'s>,
        taken: Colours,
        arena: &'s mut Arena<'a, f32>,
    ) -> Result<Spreads<'a>, Error> {
        Spreads::new(choices, terms, batch, fits, taken, arena)
    }

    /// [`Spreads::choose`] for all pixels, and for those of each of so many colours.
    fn choose(
        spreads: &'s Spreads<'s>,
        colours: usize,
        time: usize,
        is_stratified: bool,
        present: &'s Eight,
        shares: &'s mut Shares<'a>,
    ) -> () {
        spreads.choose(None, time, is_stratified, present, shares);
        for colour in 0..colours {
            spreads.choose(Some(colour), 1 + colour, is_stratified, present, shares);
        }
    }

    /// [`Call::find_limits`].
    fn find_limits(
        call: &'s Call<'s>,
        groups: &'s mut Groups<'a>,
        batch: &'s Batch<'s>,
        by: (usize, Colours),
        shares: &'s Shares<'s>,
    ) -> () {
        call.find_limits(groups, batch, by, shares);
    }

    /// [`Call::put`].
    fn put(
        call: &'s Call<'s>,
        groups: &'s mut Groups<'a>,
        batch: &'s Batch<'s>,
        fits: &'s Fits<'s>,
        turn: Option<usize>,
        shares: &'s Shares<'s>,
    ) -> () {
        call.put(groups, batch, fits, turn, shares);
    }

    /// [`Call::add`].
    fn add(call: &'s Call<'s>, first: usize, groups: &'s Groups<'a>, band: &'s mut Band<'a>) -> () {
        call.add(first, groups, band);
    }

    /// [`Call::write`].
    fn write(
        call: &'s Call<'s>,
        row: (usize, usize),
        band: &'s mut Band<'a>,
        out: &'s mut (dyn FnMut(usize, Estimate) + 'a),
    ) -> () {
        call.write(row, band, out);
    }
}
