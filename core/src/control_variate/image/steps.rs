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

/// `name = function(arguments)`: the function as a step of its own.
macro_rules! steps {
    ($(
        $name:ident = $owner:ident::$function:ident($($argument:ident: $type:ty),* $(,)?) -> $result:ty;
    )*) => {$(
        pub(super) fn $name<'s, 'a, P: Processor>($($argument: $type),*) -> $result {
            struct Arguments<'s, 'a> {
                $($argument: $type),*
            }
            impl<'s, 'a> Step for Arguments<'s, 'a> {
                type Output = $result;

                #[inline(always)]
                fn run(self) -> $result {
                    $owner::$function($(self.$argument),*)
                }
            }
            P::run(Arguments { $($argument),* })
        }
    )*};
}

steps! {
    survey = Batch::survey(batch: &'s mut Batch<'a>, call: &'s Call<'s>, groups: &'s Groups<'s>, terms: &'s Terms) -> ();
    relate = Batch::relate(batch: &'s mut Batch<'a>, call: &'s Call<'s>, arena: &'s mut Arena<'a, f32>)
        -> Result<(), Error>;
    load = Batch::load(batch: &'s mut Batch<'a>, call: &'s Call<'s>, terms: &'s Terms, arena: &'s mut Arena<'a, f32>)
        -> Result<(), Error>;
    factor = Fits::factor(
        fits: &'s mut Fits<'a>, call: &'s Call<'s>, terms: &'s Terms, batch: &'s Batch<'s>, training: Colours,
    ) -> ();
    leave_own = Fits::leave_own(fits: &'s mut Fits<'a>, terms: &'s Terms, batch: &'s Batch<'s>, taken: Colours) -> ();
    correct_colour = Fits::correct_colour(
        fits: &'s mut Fits<'a>, terms: &'s Terms, batch: &'s Batch<'s>, colour: usize,
    ) -> ();
    correct_slices = Apart::correct(
        apart: &'s mut Apart<'a>, terms: &'s Terms, batch: &'s Batch<'s>,
        penalties: &'s [f32], taken: Colours, corrections: &'s mut [Four],
    ) -> ();
    load_edges = Edges::load(edges: &'s mut Edges<'a>, call: &'s Call<'s>, batch: &'s Batch<'s>) -> ();
    correct_edges = Edges::correct(
        edges: &'s mut Edges<'a>, batch: &'s Batch<'s>, taken: Colours, fits: &'s mut Fits<'a>,
    ) -> ();
    spreads = Spreads::new(
        choices: Choices, terms: &'s Terms, batch: &'s Batch<'s>, fits: &'s Fits<'s>, taken: Colours,
        arena: &'s mut Arena<'a, f32>,
    ) -> Result<Spreads<'a>, Error>;
    choose = Spreads::choose(
        spreads: &'s Spreads<'s>, colours: usize, time: usize, is_stratified: bool, present: &'s Eight,
        shares: &'s mut Shares<'a>,
    ) -> ();
    find_limits = Call::find_limits(
        call: &'s Call<'s>, groups: &'s mut Groups<'a>, batch: &'s Batch<'s>, by: (usize, Colours),
        shares: &'s Shares<'s>,
    ) -> ();
    put = Call::put(
        call: &'s Call<'s>, groups: &'s mut Groups<'a>, batch: &'s Batch<'s>, fits: &'s Fits<'s>,
        turn: Option<usize>, shares: &'s Shares<'s>,
    ) -> ();
    add = Call::add(call: &'s Call<'s>, first: usize, groups: &'s Groups<'a>, band: &'s mut Band<'a>) -> ();
    write = Call::write(
        call: &'s Call<'s>, row: (usize, usize), band: &'s mut Band<'a>, out: &'s mut (dyn FnMut(usize, Estimate) + 'a),
    ) -> ();
}
