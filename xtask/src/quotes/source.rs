//! The measured numbers, by where they were measured.

use super::number;
use serde_json::Value;
use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::Path;
use std::rc::Rc;

/// What a number says of its cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Value,
    /// An end of its interval.
    Bound,
    /// The distance from it to the ends of its interval.
    HalfWidth,
}

/// Where a number stands: the names of its row (what is quoted or set, a tile) and of its column.
#[derive(Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Place {
    pub(super) row: String,
    pub(super) column: String,
}

/// A measured number.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub(super) value: f64,
    /// Of the width of an interval the other side, which must be the same as far as is quoted; else the value.
    pub(super) other: f64,
    pub(super) kind: Kind,
    /// The same for what one cell holds.
    pub(super) place: Rc<Place>,
}

/// All tiles: the row of a figure must name which.
pub(super) const TILES: &str = "tiles";

/// Numbers by the name of their source: `embree/direct`, `embree/quoted`, `tiles/128_4SPP_2D`.
#[derive(Default)]
pub(super) struct Sources(BTreeMap<String, Vec<Measured>>);

impl Sources {
    /// `report`: a folder of JSON files; `tiles`: one of TOML files.
    pub(super) fn new(report: &Path, tiles: &Path) -> Self {
        let mut sources = Self::default();
        for (stem, text) in files(report, "json") {
            let json: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{stem}.json: {error}"));
            for part in ["quoted", "settings"] {
                let name = format!("{stem}/{part}");
                sources.0.entry(name.clone()).or_default();
                for (key, value) in json[part].as_object().into_iter().flatten() {
                    sources.add(&name, value, key, "");
                }
            }
            for table in json["tables"].as_array().map_or(&[][..], Vec::as_slice) {
                if let Some(name) = table["name"].as_str() {
                    // Several tables of a name are one source.
                    sources.add_table(&format!("{stem}/{name}"), table);
                }
            }
        }
        for (stem, text) in files(tiles, "toml") {
            // Line by line, as a line's name tells its numbers apart.
            for line in text.lines() {
                let (key, value) = line.split_once(" = ").unwrap_or_default();
                let value = Value::String(value.to_owned());
                sources.add(&format!("tiles/{stem}"), &value, key, "");
                sources.add(TILES, &value, &format!("{stem} NF_TILE_{stem}"), key);
            }
        }
        sources
    }

    fn add(&mut self, name: &str, json: &Value, row: &str, column: &str) {
        let place = Rc::new(Place { row: row.to_owned(), column: column.to_owned() });
        collect(json, &place, self.0.entry(name.to_owned()).or_default());
    }

    fn add_table(&mut self, name: &str, table: &Value) {
        let array = |key: &str| table[key].as_array().map_or(&[][..], Vec::as_slice);
        // A table without rows is a source too.
        self.0.entry(name.to_owned()).or_default();
        for row in array("rows").iter().filter_map(Value::as_array) {
            let is_label = |cell: &&str| !is_measured(cell);
            let label: Vec<&str> = row.iter().filter_map(Value::as_str).filter(is_label).collect();
            for (cell, i) in row.iter().zip(0..) {
                if cell.as_str().is_some_and(|text| !is_measured(text)) {
                    continue;
                }
                let column = array("columns").get(i).and_then(Value::as_str).unwrap_or_default();
                self.add(name, cell, &label.join(", "), column);
            }
        }
    }

    /// None: there is no such source.
    pub(super) fn numbers(&self, name: &str) -> Option<&[Measured]> {
        self.0.get(name).map(Vec::as_slice)
    }

    /// What a name that is no source may have meant.
    pub(super) fn like(&self, name: &str) -> Vec<&str> {
        let (chapter, _) = name.split_once('/').unwrap_or((name, ""));
        self.0.keys().map(String::as_str).filter(|known| known.split('/').next() == Some(chapter)).collect()
    }
}

/// A text that says what was measured, `0.891; 1.010`, and is no name, no count and no bound.
fn is_measured(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        && number::numbers(text).iter().any(|number| number.decimals > 0)
}

fn files(folder: &Path, extension: &str) -> Vec<(String, String)> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let wanted = paths.filter(|path| path.extension().is_some_and(|own| own == extension));
    wanted
        .map(|path| {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            (stem, fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
        })
        .collect()
}

/// The numbers of values and of texts; of a figure its value and its interval, not how it is written or from how many seeds it is.
fn collect(json: &Value, place: &Rc<Place>, found: &mut Vec<Measured>) {
    let mut add = |kind, value, other| found.push(Measured { value, other, kind, place: Rc::clone(place) });
    let mut push = |kind, value| add(kind, value, value);
    match json {
        Value::Number(number) => number.as_f64().into_iter().for_each(|value| push(Kind::Value, value)),
        Value::String(text) => {
            for number in number::numbers(text) {
                push(if number.is_half_width { Kind::HalfWidth } else { Kind::Value }, number.value);
            }
        }
        Value::Array(values) => values.iter().for_each(|value| collect(value, place, found)),
        Value::Object(fields) => {
            let value = fields.get("value").and_then(Value::as_f64);
            value.into_iter().for_each(|value| push(Kind::Value, value));
            let interval = fields.get("interval").and_then(Value::as_array).map(Vec::as_slice);
            if let Some([Some(low), Some(high)]) = interval.map(|ends| [0, 1].map(|end| ends.get(end)?.as_f64())) {
                push(Kind::Bound, low);
                push(Kind::Bound, high);
                value.into_iter().for_each(|value| add(Kind::HalfWidth, high - value, value - low));
            }
        }
        Value::Null | Value::Bool(_) => {}
    }
}

/// Words and numbers of a name, in no order.
pub(super) fn words(text: &str) -> HashSet<String> {
    in_order(text).into_iter().collect()
}

pub(super) fn in_order(text: &str) -> Vec<String> {
    text.split(|c: char| !c.is_alphanumeric() && !"._".contains(c))
        .map(|word| word.trim_matches('.').to_lowercase())
        .filter(|word| !word.is_empty())
        .collect()
}
