//! What a chapter is written from.

use super::chapter::Chapter;
use super::clock::Clock;
use super::described::{Description, Measured};
use super::plan::Plan;
use crate::measure::output::Output;
use anyhow::Result;
use serde_json::Value;
use std::cell::OnceCell;

pub(crate) struct Report<'a> {
    /// The chapter that is written, as files name it, its title, and the index's line.
    pub(crate) names: [&'a str; 3],
    pub(crate) description: &'a Description,
    pub(crate) plan: &'a Plan,
    /// Markdown, JSON, plots.
    pub(crate) output: &'a Output,
    pub(crate) clock: Clock,
    /// Where the chapter is of what was measured before: how that came about.
    pub(crate) earlier: OnceCell<Value>,
}

impl Report<'_> {
    /// To be called once everything is compiled: a chapter's time is counted from here.
    pub(crate) fn compiled(&self) {
        self.clock.restart();
    }

    /// The chapter as it is described.
    pub(crate) fn described(&self, measured: Measured) -> Result<Chapter> {
        let mut chapter = Chapter::new(self.names[1]);
        self.description.write(measured, &mut chapter, self.plan)?;
        Ok(chapter)
    }
}
