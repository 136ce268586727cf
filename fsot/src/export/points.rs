//! Point sets as text, CSV and JSON. [`crate::read`] reads all three.

use crate::counted::counted;
use crate::error::{Error, Result};
use crate::points::Points;
use crate::read::ending;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;

/// Points, and to which class each belongs.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The points.
    pub points: Points,
    /// To which class each belongs, if there are classes.
    pub classes: Option<Labels>,
}

/// A class for each point.
#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    /// The names of the classes.
    pub names: Vec<String>,
    /// The index of each point's class in `names`.
    pub index: Vec<usize>,
}

impl Labels {
    /// From a name for each point; the classes in the order in which they appear.
    pub fn from_names(of_points: impl IntoIterator<Item = String>) -> Labels {
        let mut known = HashMap::new();
        let mut number = |name| {
            let next = known.len();
            *known.entry(name).or_insert(next)
        };
        let index = of_points.into_iter().map(&mut number).collect();
        let mut names = vec![String::new(); known.len()];
        known.into_iter().for_each(|(name, number)| names[number] = name);
        Labels { names, index }
    }

    /// The name of each point's class.
    pub fn of_points(&self) -> impl Iterator<Item = &str> {
        self.index.iter().map(|index| self.names.get(*index).map_or("", String::as_str))
    }
}

/// A file format of point sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A line of numbers per point, separated by spaces: the coordinates, then the class's index if there are classes,
    /// which are named in a last line `# classes: NAME NAME ...`, by [`words`].
    Text,
    /// A header row `x,y,class`, then a row per point with its class's name.
    Csv,
    /// `{"dims": 2, "points": [[x, y], ...], "classes": ["name", ...]}`.
    Json,
}

#[derive(Serialize, Deserialize)]
pub(crate) struct Json {
    pub(crate) dims: usize,
    pub(crate) points: Vec<Vec<f32>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) classes: Option<Vec<String>>,
}

impl Format {
    /// By the ending of the name: `.csv`, `.json`; anything else is text.
    pub fn of(path: &Path) -> Format {
        match ending(path).as_str() {
            "csv" => Format::Csv,
            "json" => Format::Json,
            _ => Format::Text,
        }
    }
}

/// The names of `dims` columns of coordinates: x, y, z, w, then x5, x6, ...
pub fn column_names(dims: usize) -> impl Iterator<Item = String> {
    (0..dims).map(|axis| match ["x", "y", "z", "w"].get(axis) {
        Some(name) => (*name).to_owned(),
        None => format!("x{}", axis + 1),
    })
}

/// The content of a file. Coordinates have as many digits as it takes to read the same bits back.
///
/// # Errors
/// Not one class per point; as text, those of [`words`].
pub fn encode(table: &Table, format: Format) -> Result<Vec<u8>> {
    if let Some(classes) = &table.classes {
        let known = classes.index.iter().all(|index| *index < classes.names.len());
        if !known || classes.index.len() != table.points.len() {
            return Err(Error::Input(format!(
                "{} cannot have {}: give each its class, one of those that have names",
                counted(table.points.len(), "point"),
                counted(classes.index.len(), "class")
            )));
        }
    }
    match format {
        Format::Text => text(table).map(String::into_bytes),
        Format::Csv => csv(table).map_err(|error| Error::Input(error.to_string())),
        Format::Json => json(table).map_err(|error| Error::Input(error.to_string())),
    }
}

/// Names as words: without white space at their ends, which readers of CSV remove. Spaces and `#` in them, or nothing,
/// become `_`.
///
/// # Errors
/// Two of them are then the same.
pub fn words<'a>(names: impl IntoIterator<Item = &'a String>) -> Result<Vec<String>> {
    let unfit = |c: char| c.is_whitespace() || c.is_control() || c == '#';
    let mut known = HashMap::new();
    let word = |name: &'a String| {
        let word = if name.trim().is_empty() { "_".to_owned() } else { name.trim().replace(unfit, "_") };
        match known.insert(word.clone(), name) {
            Some(other) => Err(Error::Input(format!(
                "classes {other:?} and {name:?} cannot be told apart: give them names that differ in more than spaces, \
                 # and _"
            ))),
            None => Ok(word),
        }
    };
    names.into_iter().map(word).collect()
}

fn text(table: &Table) -> Result<String> {
    let mut text = String::new();
    for (number, point) in table.points.iter().enumerate() {
        let class = table.classes.iter().filter_map(|classes| classes.index.get(number)).map(usize::to_string);
        let row: Vec<String> = point.iter().map(f32::to_string).chain(class).collect();
        text.push_str(&row.join(" "));
        text.push('\n');
    }
    if let Some(classes) = &table.classes {
        text.push_str(&format!("# classes: {}\n", words(&classes.names)?.join(" ")));
    }
    Ok(text)
}

fn csv(table: &Table) -> std::io::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(column_names(table.points.dims()).chain(table.classes.iter().map(|_| "class".to_owned())))?;
    let mut classes = table.classes.iter().flat_map(Labels::of_points);
    for point in table.points.iter() {
        writer.write_record(point.iter().map(f32::to_string).chain(classes.next().map(str::to_owned)))?;
    }
    writer.into_inner().map_err(|error| error.into_error())
}

fn json(table: &Table) -> serde_json::Result<Vec<u8>> {
    let classes = table.classes.as_ref().map(|classes| classes.of_points().map(str::to_owned).collect());
    let points = table.points.iter().map(<[f32]>::to_vec).collect();
    let mut bytes = serde_json::to_vec(&Json { dims: table.points.dims(), points, classes })?;
    bytes.push(b'\n');
    Ok(bytes)
}
