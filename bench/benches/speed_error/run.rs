//! All that a run measures.

use crate::cells::{Cell, Extent};
use crate::machine::Machine;
use crate::speed::Speed;
use noisefloor_bench::Door;

/// All that a run measures.
pub(crate) struct Run {
    pub(crate) extent: Extent,
    pub(crate) door: Door,
    pub(crate) machine: Machine,
    pub(crate) cells: Vec<Cell>,
    pub(crate) speeds: Vec<Speed>,
    pub(crate) solves: Vec<Speed>,
}
