//! Is what a chapter's text says in its JSON?

use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::collections::BTreeSet;

/// Fails with the first thing that the Markdown says and the JSON does not. Tables must be the JSON's, cell by cell and
/// in order; headings its sections; numbers of any other line must be quoted figures or settings, in the sense of
/// [`super::chapter::Chapter`]. Numbers of figures and chapters of the thesis, and those in links and code, are no
/// measurements. The text of every figure must be its value, rounded.
pub(crate) fn numbers_are_recorded(markdown: &str, json: &str) -> Result<()> {
    let json: Value = serde_json::from_str(json).context("the report's JSON is damaged")?;
    figures_are_their_values(&json)?;
    let list = |name: &str| json[name].as_array().map_or(&[][..], Vec::as_slice);
    let (mut known, mut found, mut unknown) = (BTreeSet::new(), 0, Vec::new());
    collect(&json["settings"], &mut known);
    collect(&texts(&json["quoted"]), &mut known);
    let mut tables = list("tables").iter();
    let mut lines = markdown.lines().peekable();
    while let Some(line) = lines.next() {
        if line.starts_with('|') {
            let mut rows = vec![cells(line)];
            while let Some(row) = lines.next_if(|line| line.starts_with('|')) {
                rows.push(cells(row));
            }
            let table = tables.next().with_context(|| format!("no table of the JSON is this: {line}"))?;
            found += table_is_recorded(&rows, table)?;
        } else if let Some(heading) = line.strip_prefix('#') {
            let heading = heading.trim_start_matches('#').trim();
            if !list("sections").iter().any(|section| section == heading) {
                bail!("the JSON has no section `{heading}`");
            }
        } else {
            // A whole paragraph: a reference may be broken between its lines.
            let mut text = line.to_owned();
            while let Some(more) = lines.next_if(|line| !line.is_empty() && !line.starts_with(['|', '#'])) {
                text += &format!(" {}", more.trim());
            }
            for number in numbers(&without_references(&text)) {
                found += 1;
                if !known.contains(&number) {
                    unknown.push(format!("{number} in: {text}"));
                }
            }
        }
    }
    if !unknown.is_empty() {
        bail!("the text says what is neither a quoted figure nor a setting of the JSON: {}", unknown.join("\n"));
    }
    if let Some(table) = tables.next() {
        bail!("the JSON's table {} is not in the text", table["name"]);
    }
    if found == 0 {
        bail!("the text has no number at all");
    }
    Ok(())
}

/// A line of a table.
fn cells(line: &str) -> Vec<&str> {
    line.trim().trim_matches('|').split(" | ").map(str::trim).collect()
}

/// Counts the numbers; the second row is the rule below the headings.
fn table_is_recorded(rows: &[Vec<&str>], table: &Value) -> Result<usize> {
    let text = |cell: &Value| match cell {
        Value::Null => "-".to_owned(),
        Value::String(text) => text.clone(),
        other => other["text"].as_str().unwrap_or_default().to_owned(),
    };
    let row = |row: &Value| -> Vec<String> {
        row.as_array().map_or(&[][..], Vec::as_slice).iter().map(|cell| text(cell).trim().to_owned()).collect()
    };
    let name = &table["name"];
    let recorded: Vec<Vec<String>> = [row(&table["columns"])]
        .into_iter()
        .chain(table["rows"].as_array().map_or(&[][..], Vec::as_slice).iter().map(row))
        .collect();
    let written: Vec<&Vec<&str>> = rows.iter().take(1).chain(rows.iter().skip(2)).collect();
    if written.len() != recorded.len() {
        bail!("table {name} has {} lines, in the JSON {}", written.len(), recorded.len());
    }
    for (written, recorded) in written.iter().zip(&recorded) {
        if *written != recorded {
            bail!("a line of table {name} is {written:?}, in the JSON {recorded:?}");
        }
    }
    Ok(recorded.iter().flatten().map(|cell| numbers(cell).len()).sum())
}

/// What figures show, without their values.
fn texts(quoted: &Value) -> Value {
    let figures = quoted.as_object().into_iter().flat_map(|figures| figures.values());
    Value::Array(figures.map(|figure| figure["text"].clone()).collect())
}

/// Wherever a figure is.
fn figures_are_their_values(json: &Value) -> Result<()> {
    match json {
        Value::Array(values) => values.iter().try_for_each(figures_are_their_values),
        Value::Object(object) => {
            if let (Some(text), Some(value)) =
                (json.get("text").and_then(Value::as_str), json.get("value").and_then(Value::as_f64))
            {
                figure_is_its_value(text, value)?;
            }
            object.values().try_for_each(figures_are_their_values)
        }
        _ => Ok(()),
    }
}

fn figure_is_its_value(text: &str, value: f64) -> Result<()> {
    let number = numbers(text).into_iter().next().with_context(|| format!("the figure `{text}` is no number"))?;
    let shown: f64 = number.parse().with_context(|| format!("the figure `{text}` is no number"))?;
    let (mantissa, exponent) = number.split_once('e').unwrap_or((&number, "0"));
    let digits = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len() as i32);
    let last = 10.0_f64.powi(exponent.parse::<i32>().unwrap_or(0) - digits);
    if (shown - value.abs()).abs() > 0.500_001 * last {
        bail!("the figure `{text}` is written for the value {value}");
    }
    Ok(())
}

/// The numbers of every number and string, wherever they are.
fn collect(value: &Value, known: &mut BTreeSet<String>) {
    match value {
        Value::Number(number) => {
            known.insert(number.to_string());
            // A text has 5 where JSON has 5.0.
            known.extend(number.as_f64().map(|number| number.to_string()));
        }
        Value::String(text) => known.extend(numbers(text)),
        Value::Array(values) => values.iter().for_each(|value| collect(value, known)),
        Value::Object(values) => values.values().for_each(|value| collect(value, known)),
        Value::Null | Value::Bool(_) => {}
    }
}

/// Drops what is in backquotes and in parentheses of links, and the numbers behind the words figure and chapter, and
/// years behind authors' names.
fn without_references(line: &str) -> String {
    let outside_code: String = line.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    let mut rest = outside_code.as_str();
    let mut text = String::new();
    while let Some((before, link)) = rest.split_once("](") {
        // A picture's description is no text.
        text += before.rsplit_once("![").map_or(before, |(before, _)| before);
        rest = link.split_once(')').map_or("", |(_, after)| after);
    }
    text += rest;
    let mut kept = String::new();
    let (mut reference, mut before) = (false, "");
    for word in text.split_whitespace() {
        let is_number = word.trim_start_matches('(').starts_with(|c: char| c.is_ascii_digit());
        reference = if is_number || word == "and" || word == "to" {
            reference
        } else {
            matches!(
                word.trim_start_matches('(').to_lowercase().as_str(),
                "figure" | "figures" | "chapter" | "chapters" | "section" | "sections" | "equation" | "equations"
            )
        };
        let year =
            word.trim_end_matches([',', '.', ':', ';', ')']).parse().is_ok_and(|year| (1900..2100).contains(&year));
        let cited = year && (before == "al." || before.starts_with(|c: char| c.is_uppercase()));
        before = word;
        if !(cited || reference && is_number) {
            kept += word;
            kept.push(' ');
        }
    }
    kept
}

/// Numbers as they are written: digits with a point and an exponent. A digit behind a letter is part of a name.
fn numbers(text: &str) -> Vec<String> {
    let bytes = text.as_bytes();
    let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
    let mut found = Vec::new();
    let mut i = 0;
    while i < bytes.len() {
        let named = i > 0 && (bytes[i - 1].is_ascii_alphabetic() || bytes[i - 1] == b'_');
        if !digit(i) || named {
            // A name's digits are skipped together.
            if digit(i) {
                while digit(i) {
                    i += 1;
                }
            } else {
                i += 1;
            }
            continue;
        }
        let start = i;
        while digit(i) {
            i += 1;
        }
        if bytes.get(i) == Some(&b'.') && digit(i + 1) {
            i += 1;
            while digit(i) {
                i += 1;
            }
        }
        let exponent = i + 1 + usize::from(bytes.get(i + 1) == Some(&b'-'));
        if bytes.get(i) == Some(&b'e') && digit(exponent) {
            i = exponent;
            while digit(i) {
                i += 1;
            }
        }
        found.push(text[start..i].to_owned());
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_line() {
        assert_eq!(
            numbers("a 0.25 [0.2, 1.30e-3], 16x16 pixels; plane_64 O2 7."),
            ["0.25", "0.2", "1.30e-3", "16", "7"]
        );
        assert!(numbers(&without_references("(figures 4.4 and 4.5), chapter 5: `n = 3` [x](a1.svg 7)")).is_empty());
        assert_eq!(numbers(&without_references("figure 4.4 has 3 rows")), ["3"]);
        assert_eq!(
            numbers(&without_references("Heitz 2019: Kim et al. 2004, the 2000 samples, MC 2500")),
            ["2000", "2500"]
        );
    }

    #[test]
    fn chapters_that_are_committed_are_recorded() {
        let folder = xtask::paths::root().join("docs/report");
        for entry in std::fs::read_dir(&folder).expect("the report is committed") {
            let path = entry.expect("readable").path();
            // Sentences of sizes.md say how programs were built, in versions, options and bits.
            if path.extension().is_some_and(|end| end == "json") && path.file_stem().is_some_and(|name| name != "sizes")
            {
                let [json, text] = ["json", "md"]
                    .map(|end| std::fs::read_to_string(path.with_extension(end)).expect("both are committed"));
                if let Err(error) = numbers_are_recorded(&text, &json) {
                    panic!("{}: {error:#}", path.display());
                }
            }
        }
    }

    fn check(markdown: &str) -> Result<()> {
        let json = r#"{
            "settings": {"spp": 64},
            "quoted": {"worst": {"text": "0.250 [0.2, 0.3]", "value": 0.2500001, "interval": [0.2, 0.3123]}},
            "sections": ["Title 9"],
            "tables": [{"name": "t", "columns": ["scene", "O1"], "rows": [["a", {"text": "7.5", "value": 7.5}], ["b", null]]}]
        }"#;
        numbers_are_recorded(markdown, json)
    }

    const TABLE: &str = "| scene | O1 |\n| - | -: |\n| a     | 7.5 |\n| b     |   - |\n";

    #[test]
    fn a_number_that_is_not_recorded_is_found() {
        assert!(check(&format!("# Title 9\nAt 64 samples: 0.250 (figure 4.4).\n{TABLE}")).is_ok());
        // Neither a number of a table, nor the end of an interval that is not written, nor a section's may be quoted as
        // another.
        for text in ["At 64 samples: 0.251.", "7.5 samples.", "0.3123", "9 samples"] {
            let error = check(&format!("{text}\n{TABLE}")).expect_err(text);
            assert!(error.to_string().contains("neither a quoted figure nor a setting"), "{error}");
        }
        assert!(check(&format!("## Other\n64\n{TABLE}")).is_err(), "a section that is not recorded");
        assert!(numbers_are_recorded("No number.", r#"{"tables": []}"#).is_err());
        assert!(numbers_are_recorded("At 64 samples.", "{").is_err());
    }

    #[test]
    fn tables_are_compared_cell_by_cell() {
        assert!(check(&TABLE.replace("7.5", "64")).is_err(), "a number of another place");
        assert!(check(&TABLE.replace("a ", "b ")).is_err(), "rows in another order");
        assert!(check("64").is_err(), "the table is not in the text");
        assert!(check(&format!("{TABLE}\n{TABLE}")).is_err(), "a table more than recorded");
        assert!(check(TABLE.trim_end().rsplit_once('\n').expect("lines").0).is_err(), "a row less");
    }

    #[test]
    fn a_figure_is_its_value_rounded() {
        for (text, value) in [("0.250 [0.2, 0.3]", 0.2504), ("-2.1", -2.14), ("1.30e-3", 0.001_299), ("12", 12.4)] {
            assert!(figure_is_its_value(text, value).is_ok(), "{text}");
        }
        for (text, value) in [("0.250", 0.2506), ("12", 12.6), ("word", 1.0), ("1.30e-3", 0.001_31)] {
            assert!(figure_is_its_value(text, value).is_err(), "{text}");
        }
    }
}
