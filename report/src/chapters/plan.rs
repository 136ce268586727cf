//! How much is measured: report/chapters/plan.toml.

use anyhow::Result;
use serde_json::Value;
use std::collections::BTreeMap;
use xtask::paths;

/// What a run is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Whether everything works, not the figures.
    Quick,
    Default,
    /// Narrow intervals.
    Full,
}

pub(crate) struct Plan {
    extent: Extent,
    values: BTreeMap<String, Value>,
}

impl Plan {
    pub(crate) fn new(extent: Extent) -> Result<Self> {
        let all: BTreeMap<String, [Value; 3]> = toml::from_str(&paths::read("report/chapters/plan.toml")?)?;
        let value = |(name, each): (String, [Value; 3])| (name, each[extent as usize].clone());
        Ok(Self { extent, values: all.into_iter().map(value).collect() })
    }

    /// A number of plan.toml, by its name.
    pub(crate) fn of(&self, name: &str) -> u32 {
        self.values[name].as_u64().and_then(|number| u32::try_from(number).ok()).unwrap_or(0)
    }

    /// The text with what stands in plan.toml for its names behind a dollar sign.
    pub(crate) fn filled(&self, text: &str) -> String {
        // No name is the beginning of one that comes before it.
        let values = self.values.iter().rev();
        values.fold(text.to_owned(), |text, (name, value)| text.replace(&format!("${name}"), &value.to_string()))
    }

    /// As the index calls it.
    pub(crate) fn name(&self) -> &'static str {
        ["quick", "default", "full"][self.extent as usize]
    }

    pub(crate) fn is_quick(&self) -> bool {
        self.extent == Extent::Quick
    }

    /// Time matters less than what is measured.
    pub(crate) fn is_full(&self) -> bool {
        self.extent == Extent::Full
    }

    /// What measurement programs are compiled with. A quick report tests the report: most of its time would go into
    /// link-time optimisation, and with this profile the dependencies are those of the tests.
    pub(crate) fn profile(&self) -> &'static str {
        if self.is_quick() { "suite" } else { "bench" }
    }

    /// The same for a measurement program.
    pub(crate) fn option(&self) -> Option<String> {
        (self.extent != Extent::Default).then(|| format!("--{}", self.name()))
    }

    /// Those of `all` that are measured: of several scenes and settings the first, if it is quick.
    pub(crate) fn some<'a, T>(&self, all: &'a [T]) -> &'a [T] {
        if self.is_quick() { &all[..all.len().min(1)] } else { all }
    }
}
