//! What every chapter is written with.

pub(crate) use super::chapter::Chapter;
pub(crate) use super::figure::{Figure, Unit};
pub(crate) use super::report::Report;
pub(crate) use super::statistics::Estimate;
pub(crate) use super::targets::Bound;
pub(crate) use crate::measure::table::{Row, Table};
pub(crate) use anyhow::{Context, Result, bail};
pub(crate) use serde_json::{Value, json};
