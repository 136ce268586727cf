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
use crate::arena::Arena;
use crate::processor::{Processor, Step};

/// Corrects every pixel of the colours `taken`, of which fits have seen no sample, by those to the others of them.
pub(super) fn correct<P: Processor>(fits: &mut Fits<'_>, batch: &Batch<'_>, taken: Colours) {
    let several = batch.call.n > 1;
    for colour in (0..if several { COLOURS } else { 1 }).filter(|&colour| !several || taken.has(colour)) {
        let training = if several { taken.without(colour) } else { taken };
        match &mut fits.apart {
            Some(apart) => fit_slices::<P>(apart, batch, fits.penalties, training, fits.corrections),
            None => factor::<P>(fits, batch, training),
        }
        match (several, fits.apart.is_some()) {
            (true, true) => correct_slices::<P>(fits, batch, colour),
            (true, false) => correct_colour::<P>(fits, batch, colour),
            (false, true) => {}
            (false, false) => leave_own::<P>(fits, batch, training),
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
    fit_slices = Apart::fit(
        apart: &'s mut Apart<'a>, batch: &'s Batch<'s>, penalties: &'s [f32], training: Colours,
        corrections: &'s mut [Four],
    ) -> ();
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
