//! What every chapter is written with.

pub(crate) use super::chapter::{Cell, Chapter, row};
pub(crate) use super::figure::{Figure, Unit};
pub(crate) use super::statistics::Estimate;
pub(crate) use super::targets::{Side, Targets};
pub(crate) use crate::measure::table::{Row, Table};
pub(crate) use anyhow::{Context, Result, bail};
