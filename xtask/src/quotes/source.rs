//! The measured numbers, by where they were measured.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::rc::Rc;

/// A measured number, and where it stands: the names of its row and its column. Empty for what is in no table.
pub(super) struct Measured {
    pub(super) value: f64,
    pub(super) place: Rc<str>,
}

/// Numbers by the name of their source: `embree`, `embree/direct`, `tiles`, `tiles/128_4SPP_2D`.
pub(super) struct Sources(BTreeMap<String, Vec<Measured>>);

impl Sources {
    /// `report`: a folder of JSON files; `tiles`: one of TOML files.
    pub(super) fn new(report: &Path, tiles: &Path) -> Self {
        let mut sources = Self(BTreeMap::new());
        for (stem, text) in files(report, "json") {
            let json: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{stem}.json: {error}"));
            sources.add(&format!("{stem}/quoted"), &json["quoted"], "");
            sources.add(&format!("{stem}/settings"), &json["settings"], "");
            for table in json["tables"].as_array().map_or(&[][..], Vec::as_slice) {
                if let Some(name) = table["name"].as_str() {
                    // Several tables of a name are one source.
                    sources.add_table(&format!("{stem}/{name}"), table);
                    sources.add_table(&stem, table);
                }
            }
            // Last: what is in a table has been told with its row.
            sources.add(&stem, &json, "");
        }
        for (stem, text) in files(tiles, "toml") {
            // Line by line, as a line's name tells its numbers apart.
            for line in text.lines() {
                let (key, _) = line.split_once(" = ").unwrap_or_default();
                let line = Value::String(line.to_owned());
                sources.add("tiles", &line, &format!("{stem} {key}"));
                sources.add(&format!("tiles/{stem}"), &line, key);
            }
        }
        sources
    }

    fn add(&mut self, name: &str, json: &Value, place: &str) {
        collect(json, &Rc::from(place), self.0.entry(name.to_owned()).or_default());
    }

    fn add_table(&mut self, name: &str, table: &Value) {
        let array = |key: &str| table[key].as_array().map_or(&[][..], Vec::as_slice);
        // A table without rows is a source too.
        self.0.entry(name.to_owned()).or_default();
        for row in array("rows").iter().filter_map(Value::as_array) {
            let label = row.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(", ");
            for (cell, i) in row.iter().zip(0..) {
                let column = array("columns").get(i).and_then(Value::as_str).unwrap_or_default();
                self.add(name, cell, &format!("{label}: {column}"));
            }
        }
    }

    /// None: there is no such source.
    pub(super) fn numbers(&self, name: &str) -> Option<&[Measured]> {
        self.0.get(name).map(Vec::as_slice)
    }
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

/// The numbers of values and of texts, and half the width of intervals.
fn collect(json: &Value, place: &Rc<str>, found: &mut Vec<Measured>) {
    let mut push = |value: f64| found.push(Measured { value, place: Rc::clone(place) });
    match json {
        Value::Number(number) => number.as_f64().into_iter().for_each(push),
        Value::String(text) => super::text::numbers(text).into_iter().for_each(|number| push(number.value)),
        Value::Array(values) => values.iter().for_each(|value| collect(value, place, found)),
        Value::Object(fields) => {
            if let Some([low, high]) = fields.get("interval").and_then(Value::as_array).map(Vec::as_slice) {
                let half = low.as_f64().zip(high.as_f64()).map(|(low, high)| (high - low) / 2.0);
                half.into_iter().for_each(push);
            }
            fields.values().for_each(|value| collect(value, place, found));
        }
        Value::Null | Value::Bool(_) => {}
    }
}
