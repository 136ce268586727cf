//! Class files: classes written down by a person, in TOML or JSON.

use super::function::ClassFunction;
use super::weighted::{Class, check_weight};
use crate::Error;
use crate::error::Result;
use crate::export::points::words;
use crate::read;
use crate::target::{Target, Uniform};
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a class file says.
///
/// ```toml
/// [[class]]
/// name = "red"
/// function = { box = { from = 0.0, to = 0.5 } }
///
/// [[class]]
/// name = "all"
/// weight = 0.5
/// function = "constant"
/// target = { image = "density.png" }
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassFile {
    /// The classes, in order.
    pub class: Vec<ClassEntry>,
}

/// A class of a [`ClassFile`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassEntry {
    /// Its name.
    pub name: String,
    /// Its weight, 1 if not given.
    #[serde(default = "one")]
    pub weight: f32,
    /// Its class function.
    #[serde(deserialize_with = "one_key")]
    pub function: ClassFunction,
    /// Its target, uniform if not given.
    #[serde(default, deserialize_with = "one_key")]
    pub target: TargetSpec,
}

fn one() -> f32 {
    1.0
}

/// A name, or a table of one key. Of more keys serde says nothing that helps.
fn one_key<'de, D: Deserializer<'de>, T: DeserializeOwned>(deserializer: D) -> std::result::Result<T, D::Error> {
    let value = Value::deserialize(deserializer)?;
    if let Some(table) = value.as_object().filter(|table| table.len() > 1) {
        let keys: Vec<String> = table.keys().map(|key| format!("`{key}`")).collect();
        return Err(D::Error::custom(format!("there are {}, and one key is possible", keys.join(" and "))));
    }
    T::deserialize(value).map_err(D::Error::custom)
}

/// A target in a [`ClassFile`].
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TargetSpec {
    /// The uniform distribution.
    #[default]
    Uniform,
    /// A picture: many points where it is bright.
    Image(PathBuf),
}

impl ClassFile {
    /// Reads the text of a class file; `path` is for messages, and for the format: JSON if it ends so, else TOML.
    pub fn parse(path: &Path, text: &str) -> Result<ClassFile> {
        let parsed: std::result::Result<ClassFile, String> = if read::ending(path) == "json" {
            serde_json::from_str(text).map_err(|error| error.to_string())
        } else {
            toml::from_str(text).map_err(|error| error.to_string())
        };
        let file = parsed.map_err(|error| Error::Input(format!("{}: not a class file: {error}", path.display())))?;
        if file.class.is_empty() {
            return Err(Error::Input(format!("{}: no class: give at least one", path.display())));
        }
        words(file.class.iter().map(|entry| &entry.name))
            .map_err(|error| Error::Input(format!("{}: {error}", path.display())))?;
        for entry in &file.class {
            entry.function.check(&entry.name)?;
            check_weight(entry.weight, &entry.name)?;
        }
        Ok(file)
    }

    /// Its classes, for points of `dims` coordinates; `image` opens the targets that are pictures.
    pub fn classes(self, dims: usize, mut image: impl FnMut(&Path) -> Result<Arc<dyn Target>>) -> Result<Vec<Class>> {
        let uniform: Arc<dyn Target> = Arc::new(Uniform::new(dims));
        self.class
            .into_iter()
            .map(|entry| {
                let target = match &entry.target {
                    TargetSpec::Uniform => Arc::clone(&uniform),
                    TargetSpec::Image(path) => image(path)?,
                };
                Ok(Class { function: entry.function, target, weight: entry.weight, name: entry.name })
            })
            .collect()
    }
}
