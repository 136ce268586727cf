//! The figures of a document, line by line, and whether their sources have them.

use super::compare::{self, Context, Selection};
use super::number;
use super::source::{Sources, words};
use std::collections::HashSet;

/// What a check found, with the numbers of lines.
#[derive(Default)]
pub(super) struct Found {
    pub(super) wrong: Vec<(usize, String)>,
    pub(super) without_source: Vec<(usize, String)>,
}

const START: &str = "<!-- figures:";

/// What a line of figures says of those that follow.
enum Named {
    Sources(Vec<Selection>),
    /// The figures are nobody's measurements, for a reason; how many there are.
    None(usize),
    /// It was wrong, and that was told.
    Damaged,
}

/// The figures up to the next line of figures or heading.
struct Part {
    line: usize,
    named: Named,
}

impl Part {
    fn new(line: usize, names: &str, sources: &Sources, found: &mut Found) -> Self {
        let named = parse(names, sources).unwrap_or_else(|message| {
            found.wrong.push((line, message));
            Named::Damaged
        });
        Self { line, named }
    }

    /// What is named must be needed: else the list says less and less.
    fn end(self, found: &mut Found) {
        match self.named {
            Named::Sources(selections) => {
                for Selection { name, .. } in selections.iter().filter(|selection| !selection.is_used.get()) {
                    found.wrong.push((self.line, format!("no figure is from {name}: remove it")));
                }
            }
            Named::None(0) => found.wrong.push((self.line, "no figure needs this `none`: remove the line".to_owned())),
            Named::None(_) | Named::Damaged => {}
        }
    }
}

pub(super) fn check(document: &str, sources: &Sources) -> Found {
    let mut found = Found::default();
    let mut part: Option<Part> = None;
    let (mut in_code, mut first_cell) = (false, String::new());
    for (line, text) in (1..).zip(document.lines()) {
        if text.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code || text.starts_with("    ") {
            continue;
        }
        let names = text.trim().strip_prefix(START);
        if names.is_some() || text.starts_with('#') {
            part.take().into_iter().for_each(|part| part.end(&mut found));
        }
        if let Some(names) = names {
            part = Some(Part::new(line, names, sources, &mut found));
            continue;
        }
        let label = label(text, &mut first_cell);
        let mut context = Context { line: text, label, before: Vec::new() };
        for number in number::figures(text) {
            match part.as_mut().map(|part| &mut part.named) {
                None => found.without_source.push((line, number.text)),
                Some(Named::Damaged) => {}
                Some(Named::None(count)) => *count += 1,
                Some(Named::Sources(selections)) => {
                    let is_value = !number.is_half_width && !number.is_bound;
                    match compare::search(&number, &context, selections) {
                        Ok(places) if is_value => context.before = places,
                        Ok(_) => {}
                        Err(message) => {
                            found.wrong.push((line, message));
                            if is_value {
                                context.before.clear();
                            }
                        }
                    }
                }
            }
        }
    }
    part.into_iter().for_each(|part| part.end(&mut found));
    found
}

/// The words that name a table's row: of the cells without figures; an empty first cell is that of the row above.
fn label(line: &str, first: &mut String) -> HashSet<String> {
    let Some(row) = line.strip_prefix('|') else {
        first.clear();
        return HashSet::new();
    };
    let mut cells: Vec<&str> = row.trim_end().trim_end_matches('|').split('|').map(str::trim).collect();
    if cells.iter().all(|cell| cell.chars().all(|c| "-: ".contains(c))) {
        return HashSet::new();
    }
    if let Some(cell) = cells.first_mut() {
        if cell.is_empty() {
            *cell = first;
        } else {
            *first = (*cell).to_owned();
        }
    }
    let is_name = |cell: &&&str| number::figures(cell).is_empty();
    let names = cells.iter().filter(|cell| is_name(cell));
    // Of a number it can be told what it counts only where it begins the name: "4 samples", but not "lens (4)".
    names
        .flat_map(|cell| {
            let first = cell.split_whitespace().next().unwrap_or_default();
            let is_meant = |word: &String| word.contains(char::is_alphabetic) || words(first).contains(word);
            words(cell).into_iter().filter(is_meant).collect::<Vec<_>>()
        })
        .collect()
}

/// Sources, all of which are there.
fn parse(names: &str, sources: &Sources) -> Result<Named, String> {
    let names = names.trim().strip_suffix("-->").ok_or("a line of figures must end in -->")?.trim();
    if let Some(why) = names.strip_prefix("none") {
        let why = why.trim().trim_start_matches('(').trim_end_matches(')');
        return if why.is_empty() {
            Err("`none` must say why: none (settings)".to_owned())
        } else {
            Ok(Named::None(0))
        };
    }
    let selections = names.split(';').map(|name| Selection::new(name.trim(), sources));
    Ok(Named::Sources(selections.collect::<Result<_, _>>()?))
}
