//! Is every number of a chapter's text in its JSON?

use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::collections::BTreeSet;

/// Fails with the first number of the Markdown that the JSON does not hold. Numbers of figures and chapters of the thesis,
/// and those in links and code, are no measurements.
pub(crate) fn numbers_are_recorded(markdown: &str, json: &str) -> Result<()> {
    let json: Value = serde_json::from_str(json).context("the report's JSON is damaged")?;
    let mut known = BTreeSet::new();
    collect(&json, &mut known);
    let mut found = 0;
    for line in markdown.lines() {
        for number in numbers(&without_references(line)) {
            found += 1;
            if !known.contains(&number) {
                bail!("the text quotes {number}, which is not in the JSON: {line}");
            }
        }
    }
    if found == 0 {
        bail!("the text quotes no number at all");
    }
    Ok(())
}

/// The numbers of every number and string, wherever they are.
fn collect(value: &Value, known: &mut BTreeSet<String>) {
    match value {
        Value::Number(number) => {
            known.insert(number.to_string());
        }
        Value::String(text) => known.extend(numbers(text)),
        Value::Array(values) => values.iter().for_each(|value| collect(value, known)),
        Value::Object(values) => values.values().for_each(|value| collect(value, known)),
        Value::Null | Value::Bool(_) => {}
    }
}

/// Drops what is in backquotes and in parentheses of links, and the numbers behind the words figure and chapter.
fn without_references(line: &str) -> String {
    let outside_code: String = line.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    let mut rest = outside_code.as_str();
    let mut text = String::new();
    while let Some((before, link)) = rest.split_once("](") {
        text += before;
        rest = link.split_once(')').map_or("", |(_, after)| after);
    }
    text += rest;
    let mut kept = String::new();
    let mut reference = false;
    for word in text.split_whitespace() {
        let is_number = word.trim_start_matches('(').starts_with(|c: char| c.is_ascii_digit());
        reference = if is_number || word == "and" || word == "to" {
            reference
        } else {
            matches!(
                word.trim_start_matches('(').to_lowercase().as_str(),
                "figure" | "figures" | "chapter" | "section" | "equation"
            )
        };
        if !(reference && is_number) {
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
    }

    #[test]
    fn a_number_that_is_not_recorded_is_found() {
        let json =
            r#"{"settings": {"spp": 64}, "tables": [{"rows": [[{"text": "0.250 [0.2, 0.3]", "value": 0.2500001}]]}]}"#;
        assert!(numbers_are_recorded("At 64 samples: 0.250 (figure 4.4).", json).is_ok());
        assert!(numbers_are_recorded("At 64 samples: 0.251.", json).is_err());
        assert!(numbers_are_recorded("No number.", json).is_err());
        assert!(numbers_are_recorded("At 64 samples.", "{").is_err());
    }
}
