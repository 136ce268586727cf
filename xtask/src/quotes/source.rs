//! The measured numbers, by where they were measured.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Numbers by the name of their source: `embree`, `embree/direct`, `tiles`, `tiles/128_4SPP_2D`.
pub(super) struct Sources(BTreeMap<String, Vec<f64>>);

impl Sources {
    /// `report`: a folder of JSON files; `tiles`: one of TOML files.
    pub(super) fn new(report: &Path, tiles: &Path) -> Self {
        let mut sources = Self(BTreeMap::new());
        for (stem, text) in files(report, "json") {
            let json: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{stem}.json: {error}"));
            sources.add(&stem, &json);
            sources.add(&format!("{stem}/quoted"), &json["quoted"]);
            sources.add(&format!("{stem}/settings"), &json["settings"]);
            for table in json["tables"].as_array().map_or(&[][..], Vec::as_slice) {
                if let Some(name) = table["name"].as_str() {
                    // Several tables of a name are one source.
                    sources.add(&format!("{stem}/{name}"), &table["rows"]);
                }
            }
        }
        for (stem, text) in files(tiles, "toml") {
            let numbers = super::text::numbers(&text).into_iter().map(|number| number.value);
            let numbers: Vec<f64> = numbers.collect();
            sources.0.entry("tiles".to_owned()).or_default().extend(&numbers);
            sources.0.entry(format!("tiles/{stem}")).or_default().extend(numbers);
        }
        sources
    }

    fn add(&mut self, name: &str, json: &Value) {
        collect(json, self.0.entry(name.to_owned()).or_default());
    }

    /// None: there is no such source.
    pub(super) fn numbers(&self, name: &str) -> Option<&[f64]> {
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
fn collect(json: &Value, numbers: &mut Vec<f64>) {
    match json {
        Value::Number(number) => numbers.extend(number.as_f64()),
        Value::String(text) => numbers.extend(super::text::numbers(text).into_iter().map(|number| number.value)),
        Value::Array(values) => values.iter().for_each(|value| collect(value, numbers)),
        Value::Object(fields) => {
            if let Some([low, high]) = fields.get("interval").and_then(Value::as_array).map(Vec::as_slice) {
                numbers.extend(low.as_f64().zip(high.as_f64()).map(|(low, high)| (high - low) / 2.0));
            }
            fields.values().for_each(|value| collect(value, numbers));
        }
        Value::Null | Value::Bool(_) => {}
    }
}
