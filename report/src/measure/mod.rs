//! What the demo and the report share: running a renderer, reading its images, judging them, and showing the outcome.

pub(crate) mod filter;
pub(crate) mod image;
pub(crate) mod markdown;
pub(crate) mod metric;
pub(crate) mod output;
pub(crate) mod part;
pub(crate) mod plot;
pub(crate) mod progress;
pub(crate) mod renderer;
pub(crate) mod running;
pub(crate) mod table;
pub(crate) mod text;
