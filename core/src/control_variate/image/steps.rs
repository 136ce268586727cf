//! The work of a batch, in functions that are compiled for a processor, each by itself.

use super::super::config::Estimate;
use super::batch::Batch;
use super::call::Call;
use super::choice::{Choices, Shares, Spreads};
use super::edges::Edges;
use super::fit::Fits;
use super::groups::Groups;
use super::products::{COLOURS, Colours, Eight};
use super::sums::Band;
use crate::arena::Arena;
use crate::processor::{Processor, Step};

/// Corrects every pixel of the colours `taken`, of which fits have seen no sample, by those to the others of them.
pub(super) fn correct<P: Processor>(fits: &mut Fits<'_>, batch: &Batch<'_>, taken: Colours) {
    if batch.terms.ends.is_empty() {
        return;
    }
    let is_apart = fits.apart.is_some();
    if batch.call.n == 1 {
        if is_apart {
            return fit_slices::<P>(fits, batch, taken);
        }
        factor::<P>(fits, batch, taken);
        return leave_own::<P>(fits, batch, taken);
    }
    for colour in (0..COLOURS).filter(|&colour| taken.has(colour)) {
        let training = taken.without(colour);
        if is_apart {
            fit_slices::<P>(fits, batch, training);
            correct_slices::<P>(fits, batch, colour);
        } else {
            factor::<P>(fits, batch, training);
            correct_colour::<P>(fits, batch, colour);
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
    survey = Batch::survey(batch: &'s mut Batch<'a>, groups: &'s Groups<'s>) -> ();
    relate = Batch::relate(batch: &'s mut Batch<'a>, arena: &'s mut Arena<'a, f32>) -> ();
    load = Batch::load(batch: &'s mut Batch<'a>, arena: &'s mut Arena<'a, f32>) -> ();
    factor = Fits::factor(fits: &'s mut Fits<'a>, batch: &'s Batch<'s>, training: Colours) -> ();
    leave_own = Fits::leave_own(fits: &'s mut Fits<'a>, batch: &'s Batch<'s>, taken: Colours) -> ();
    correct_colour = Fits::correct_colour(fits: &'s mut Fits<'a>, batch: &'s Batch<'s>, colour: usize) -> ();
    fit_slices = Fits::fit_slices(fits: &'s mut Fits<'a>, batch: &'s Batch<'s>, training: Colours) -> ();
    correct_slices = Fits::correct_slices(fits: &'s mut Fits<'a>, batch: &'s Batch<'s>, colour: usize) -> ();
    load_edges = Edges::load(edges: &'s mut Edges<'a>, batch: &'s Batch<'s>) -> ();
    correct_edges = Edges::correct(
        edges: &'s mut Edges<'a>, batch: &'s Batch<'s>, taken: Colours, fits: &'s mut Fits<'a>,
    ) -> Eight;
    spreads = Spreads::new(
        choices: Choices, batch: &'s Batch<'s>, fits: &'s Fits<'s>, taken: Colours, arena: &'s mut Arena<'a, f32>,
    ) -> Spreads<'a>;
    choose = Spreads::choose(
        spreads: &'s Spreads<'s>, colours: usize, time: usize, is_stratified: bool, present: &'s Eight,
        shares: &'s mut Shares<'a>,
    ) -> ();
    find_limits = Batch::find_limits(
        batch: &'s Batch<'s>, groups: &'s mut Groups<'a>, by: (usize, Colours), shares: &'s Shares<'s>,
    ) -> ();
    put = Batch::put(
        batch: &'s Batch<'s>, groups: &'s mut Groups<'a>, fits: &'s Fits<'s>, turn: Option<usize>,
        shares: &'s Shares<'s>,
    ) -> ();
    add = Call::add(call: &'s Call<'s>, groups: &'s Groups<'a>, band: &'s mut Band<'a>) -> ();
    write = Call::write(
        call: &'s Call<'s>, row: (usize, usize), band: &'s mut Band<'a>, out: &'s mut (dyn FnMut(usize, Estimate) + 'a),
    ) -> ();
}
