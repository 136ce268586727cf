//! All that a run measures.

use crate::cells::Cell;
use crate::speed::Speed;
use noisefloor_bench::Door;

/// All that a run measures.
pub(crate) struct Run {
    pub(crate) door: Door,
    pub(crate) cells: Vec<Cell>,
    pub(crate) speeds: Vec<Speed>,
    pub(crate) solves: Vec<Speed>,
}
