//! How much is measured: report/chapters/plan.toml.

use anyhow::{Context, Result};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::collections::BTreeMap;
use xtask::tools::Package;
use xtask::{paths, start};

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

    /// report/chapters/NAME.toml, with what stands in plan.toml for its names behind a dollar sign.
    pub(crate) fn read<T: DeserializeOwned>(&self, name: &str) -> Result<T> {
        let path = format!("report/chapters/{name}.toml");
        // No name is the beginning of one that comes before it.
        let values = self.values.iter().rev();
        let text = values
            .fold(paths::read(&path)?, |text, (name, value)| text.replace(&format!("${name}"), &value.to_string()));
        toml::from_str(&text).context(path)
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

    /// Cargo's options for measurement programs. A quick report tests the report: most of its time would go into
    /// link-time optimisation, and so the programs share what the tests have compiled.
    pub(crate) fn compiled(&self) -> Vec<&'static str> {
        match self.is_quick() {
            true => [&["--profile", "suite"][..], &start::OTHERS].concat(),
            false => vec!["--profile", "bench", "--package", "noisefloor-bench"],
        }
    }

    /// The same as a measurement program takes it.
    pub(crate) fn option(&self) -> Option<String> {
        (self.extent != Extent::Default).then(|| format!("--{}", self.name()))
    }

    /// Those of `all` that are measured: of several scenes and settings the first, if it is quick.
    pub(crate) fn some<'a, T>(&self, all: &'a [T]) -> &'a [T] {
        if self.is_quick() { &all[..all.len().min(1)] } else { all }
    }
}

/// Debian's packages, each with a file that it brings.
pub(crate) fn packages<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Package>, D::Error> {
    let all = Vec::<[String; 2]>::deserialize(from)?;
    Ok(all.into_iter().map(|[name, file]| Package { name: name.leak(), file: file.leak() }).collect())
}
