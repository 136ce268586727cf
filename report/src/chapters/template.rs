//! Texts: report/templates/CHAPTER.md, whose holes are filled from the chapter's JSON.
//!
//! - `{{table NAME}}`, on a line of its own: the next table of this name in the section of the heading above it.
//! - `{{NAME}}`: a figure that was quoted, a setting, or the JSON's own NAME.
//! - `{{not NAME}}`: nothing, where there is no NAME; where there is one, nothing fills it.
//! - `{{targets}}`, on a line of its own: templates/targets.md.
//!
//! What a run did not measure is left out: a paragraph or an item with a hole that nothing fills, a picture that is not
//! there, a section none of whose tables are. A table that no hole shows is an error.

use crate::measure::markdown;
use anyhow::{Context, Result, bail};
use serde_json::Value;
use xtask::paths::{self, elements};
use xtask::texts::WIDTH;

/// Which pictures there are.
pub(crate) type Exists<'a> = &'a dyn Fn(&str) -> bool;

/// The text of a chapter.
pub(crate) fn chapter(name: &str, json: &Value, exists: Exists) -> Result<String> {
    // A long run is told in the same words.
    let read = |name: &str| paths::read(format!("report/templates/{name}.md"));
    let template = format!("\n\n{}\n", read(name.trim_end_matches("_full"))?);
    let template = template.replace("\n\n{{targets}}\n", &format!("\n\n{}", read("targets")?));
    let text = fill(&template, json, exists);
    text.with_context(|| format!("report/templates/{name}.md"))
}

/// Blocks that stand below one heading.
#[derive(Default)]
struct Section {
    blocks: Vec<String>,
    wanted: usize,
    found: usize,
}

fn fill(template: &str, json: &Value, exists: Exists) -> Result<String> {
    let mut tables: Vec<&Value> = elements(&json["tables"]).iter().collect();
    let (mut heading, mut sections) = (String::new(), vec![Section::default()]);
    for block in template.trim().split("\n\n").map(str::trim) {
        let name = block.strip_prefix("{{table ").and_then(|rest| rest.strip_suffix("}}"));
        let filled: Vec<String> = items(block).iter().filter_map(|item| holes(item, json)).collect();
        let filled = filled.iter().map(|text| wrap(text)).collect::<Vec<_>>().join("\n");
        if block.starts_with('#') {
            sections.push(Section::default());
            filled.trim_start_matches('#').trim().clone_into(&mut heading);
        }
        let Some(section) = sections.last_mut() else { continue };
        if let Some(name) = name {
            section.wanted += 1;
            let is_here = |table: &&Value| table["name"] == name && table["section"] == heading.as_str();
            if let Some(at) = tables.iter().position(is_here) {
                section.found += 1;
                section.blocks.push(table(tables.remove(at)));
            }
        } else if picture(&filled).is_none_or(exists) && !filled.is_empty() {
            section.blocks.push(filled);
        }
    }
    if let Some(table) = tables.first() {
        bail!("no hole shows the table {} of the section {}", table["name"], table["section"]);
    }
    sections.retain(|section| section.wanted == 0 || section.found > 0);
    let blocks: Vec<String> = sections.into_iter().flat_map(|section| section.blocks).collect();
    Ok(blocks.join("\n\n") + "\n")
}

/// The items of a list, or the whole block.
fn items(block: &str) -> Vec<String> {
    let list = block.strip_prefix("- ").map(|items| items.split("\n- ").map(|item| format!("- {item}")).collect());
    list.unwrap_or_else(|| vec![block.to_owned()])
}

/// Breaks lines between words, but before none that would begin a list.
fn wrap(text: &str) -> String {
    let indent = if text.starts_with("- ") { "  " } else { "" };
    let begins_list =
        |word: &&str| matches!(*word, "-" | "+" | "*") || word.trim_end_matches('.').parse::<u32>().is_ok();
    let mut lines: Vec<String> = Vec::new();
    let mut words = text.split_whitespace().peekable();
    while let Some(word) = words.next() {
        let mut unit = word.to_owned();
        while let Some(next) = words.next_if(begins_list) {
            unit += &format!(" {next}");
        }
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + unit.chars().count() <= WIDTH => *line += &format!(" {unit}"),
            Some(_) => lines.push(format!("{indent}{unit}")),
            None => lines.push(unit),
        }
    }
    lines.join("\n")
}

fn picture(block: &str) -> Option<&str> {
    block.strip_prefix("![")?.rsplit_once("](")?.1.strip_suffix(')')
}

/// The text with its holes filled; none if one cannot be.
fn holes(text: &str, json: &Value) -> Option<String> {
    let (mut out, mut rest) = (String::new(), text);
    while let Some((before, behind)) = rest.split_once("{{") {
        let (name, after) = behind.split_once("}}")?;
        // A name may be broken between lines.
        let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
        let known = |name: &str| {
            let places = [&json["quoted"][name], &json["settings"][name], &json["run"][name], &json[name]];
            places.into_iter().find_map(word)
        };
        out += before;
        match name.strip_prefix("not ") {
            Some(name) if known(name).is_some() => return None,
            Some(_) => {}
            None => out += &known(&name)?,
        }
        rest = after;
    }
    Some(out + rest)
}

pub(crate) fn word(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => number.as_f64().map(|number| number.to_string()),
        Value::Object(figure) => word(figure.get("text")?),
        _ => None,
    }
}

fn table(table: &Value) -> String {
    let texts = |cells: &Value| -> Vec<String> {
        elements(cells).iter().map(|cell| word(cell).unwrap_or_else(|| "-".to_owned())).collect()
    };
    let rows: Vec<Vec<String>> = elements(&table["rows"]).iter().map(texts).collect();
    let words = table["words"].as_u64().unwrap_or(1) as usize;
    markdown::lines(&texts(&table["columns"]), words, &rows).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;

    #[test]
    fn holes_are_filled_and_what_was_not_measured_is_left_out() {
        let cell = json!({"text": "0.250 [0.2, 0.3]", "value": 0.25});
        let table = |section| json!({"name": "t", "section": section, "columns": ["a", "b"], "rows": [["x", cell]]});
        let json = json!({"title": "T", "settings": {"spp": 64}, "tables": [table("Two"), table("One")]});
        let template = "# {{title}}\n\nAt {{spp}}.\n\n- {{none}}\n- {{spp}} too\n- {{not spp}}A\n- {{not none}}B\n\n\
                        ## One\n\n{{table t}}\n\n{{table t}}\n\n\
                        ## None\n\nText.\n\n{{table t}}\n\n## Two\n\n{{table t}}\n\n![x](no.svg)\n\n![x](a.svg)";
        let text = fill(template, &json, &|file| file == "a.svg").expect("a text");
        let shown = "| a |                b |\n| - | ---------------: |\n| x | 0.250 [0.2, 0.3] |";
        let expected =
            format!("# T\n\nAt 64.\n\n- 64 too\n- B\n\n## One\n\n{shown}\n\n## Two\n\n{shown}\n\n![x](a.svg)\n");
        assert_eq!(text, expected);
        assert!(fill("# T\n\n## One\n\n{{table t}}", &json, &|_| true).is_err(), "a table that is not shown");
    }

    #[test]
    fn committed_texts_are_those_of_the_committed_figures() {
        let folder = paths::root().join("docs/report");
        for path in paths::of_kind("docs/report", "json").expect("the report is committed") {
            let name = path.file_stem().expect("a name").to_string_lossy();
            let json = paths::json(&path).expect("JSON");
            let text = chapter(&name, &json, &|file| folder.join(file).exists()).expect("a text");
            let committed = fs::read_to_string(path.with_extension("md")).expect("readable");
            assert!(committed == text, "{name}.md is not current: `cargo xtask report --render` writes it");
        }
    }
}
