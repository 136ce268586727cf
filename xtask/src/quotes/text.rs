//! The figures of a document, and whether its sources have them.

use super::nearest;
use super::source::Sources;
use crate::paths;

/// A number as it is written.
pub(super) struct Number {
    pub(super) text: String,
    pub(super) value: f64,
    /// Digits behind the point.
    decimals: i32,
    /// Before a unit of time, or `%`.
    has_unit: bool,
    /// Alone in parentheses, as the numbers of equations are.
    in_parentheses: bool,
}

/// What a check found, with the numbers of lines.
pub(super) struct Found {
    pub(super) wrong: Vec<String>,
    pub(super) without_source: Vec<String>,
}

/// Stands for sources whose numbers are not compared.
const UNCHECKED: &str = "none";
const START: &str = "<!-- figures:";
const UNITS: [&str; 8] = ["ns", "us", "µs", "ms", "s", "seconds", "minutes", "%"];
/// The number behind such a word is the name of something.
const REFERENCES: [&str; 13] = [
    "figure",
    "figures",
    "section",
    "sections",
    "chapter",
    "chapters",
    "equation",
    "eq.",
    "algorithm",
    "version",
    "rust",
    "gcc",
    "clang",
];

pub(super) fn check(document: &str, sources: &Sources) -> Found {
    let mut found = Found { wrong: Vec::new(), without_source: Vec::new() };
    let mut named: Option<Vec<String>> = None;
    let mut in_code = false;
    for (line, text) in (1..).zip(document.lines()) {
        if text.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code || text.starts_with("    ") {
            continue;
        }
        if text.starts_with('#') {
            named = None;
        }
        if let Some(names) = text.trim().strip_prefix(START) {
            match parse(names, sources) {
                Ok(names) => named = Some(names),
                Err(message) => {
                    found.wrong.push(format!("{line}: {message}"));
                    // What follows is not told a second time.
                    named = Some(vec![UNCHECKED.to_owned()]);
                }
            }
            continue;
        }
        for number in figures(text) {
            match &named {
                None => found.without_source.push(format!("{line}: {}", number.text)),
                Some(names) if names.iter().any(|name| name == UNCHECKED) => {}
                Some(names) => found
                    .wrong
                    .extend(search(&number, text, names, sources).map(|message| format!("{line}: {message}"))),
            }
        }
    }
    found
}

/// The names of sources, all of which are there.
fn parse(names: &str, sources: &Sources) -> Result<Vec<String>, String> {
    let names = names.trim().strip_suffix("-->").ok_or("a line of figures must end in -->")?.trim();
    if names.starts_with("none") {
        let why = names.trim_start_matches("none").trim();
        return if why.len() > 2 {
            Ok(vec!["none".to_owned()])
        } else {
            Err("`none` must say why: none (settings)".to_owned())
        };
    }
    if let Some(test) = names.strip_prefix("test ") {
        let path = paths::root().join("tests/tests").join(format!("{}.rs", test.trim()));
        return if path.exists() { Ok(vec![UNCHECKED.to_owned()]) } else { Err(format!("there is no test `{test}`")) };
    }
    // A table's name may have a comma: sources are separated by semicolons too.
    let names: Vec<String> = names.split(';').map(|name| name.trim().to_owned()).collect();
    let parts = |name: &String| -> Vec<String> {
        let is_known = sources.numbers(name).is_some();
        if is_known { vec![name.clone()] } else { name.split(',').map(|part| part.trim().to_owned()).collect() }
    };
    let names: Vec<String> = names.iter().flat_map(parts).collect();
    match names.iter().find(|name| sources.numbers(name).is_none()) {
        Some(name) => Err(format!("there is no source `{name}`")),
        None => Ok(names),
    }
}

/// None: one of the sources has the number. Otherwise what is wrong, and what may stand there instead.
fn search(number: &Number, line: &str, names: &[String], sources: &Sources) -> Option<String> {
    let all = || names.iter().filter_map(|name| sources.numbers(name)).flatten();
    let half = 0.5 * 10f64.powi(-number.decimals);
    let mut same_row = all().filter(|measured| nearest::is_in_row(measured, line)).peekable();
    let candidates: Vec<_> = if same_row.peek().is_some() { same_row.collect() } else { all().collect() };
    if candidates.iter().any(|measured| (measured.value.abs() - number.value).abs() <= half * (1.0 + 1e-6)) {
        return None;
    }
    let wrong = format!("{} is not in {}", number.text, names.join("; "));
    let nearest = nearest::of(number.value, line, all());
    Some(if nearest.is_empty() {
        format!("{wrong}, which has no numbers")
    } else {
        format!("{wrong}; nearest: {nearest}")
    })
}

/// The numbers of a line that look measured.
fn figures(line: &str) -> Vec<Number> {
    let mut text: String = line.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    while let Some((start, end)) = text.find("](").and_then(|start| Some((start, start + text[start..].find(')')?))) {
        text.replace_range(start..=end, " ");
    }
    let numbers = numbers(&text);
    numbers.into_iter().filter(|number| (number.decimals > 0 && !number.in_parentheses) || number.has_unit).collect()
}

/// All numbers of a text: digits, with thousands apart by commas, a point, an exponent; `.5` too. Digits of names, of versions
/// and of references are left out.
pub(super) fn numbers(text: &str) -> Vec<Number> {
    let bytes: Vec<char> = text.chars().collect();
    let at = |i: usize| bytes.get(i).copied().unwrap_or(' ');
    let digit = |i: usize| at(i).is_ascii_digit();
    let mut found = Vec::new();
    let mut i = 0;
    while i < bytes.len() {
        let begins = digit(i) || (at(i) == '.' && digit(i + 1));
        if !begins {
            i += 1;
            continue;
        }
        let start = i;
        let mut points = 0;
        while digit(i) || (matches!(at(i), '.' | ',') && digit(i + 1)) {
            // A comma is part of a number only before three digits.
            if at(i) == ',' && !(digit(i + 2) && digit(i + 3) && !digit(i + 4) && points == 0 && i > start) {
                break;
            }
            points += usize::from(at(i) == '.');
            i += 1;
        }
        let mantissa: String = bytes[start..i].iter().filter(|&&c| c != ',').collect();
        let signed = i + 1 + usize::from(matches!(at(i + 1), '-' | '+'));
        let mut exponent = 0;
        if at(i) == 'e' && digit(signed) {
            let first = i + 1;
            i = signed;
            while digit(i) {
                i += 1;
            }
            exponent = bytes[first..i].iter().collect::<String>().parse().unwrap_or(0);
        }
        let before = if start == 0 { ' ' } else { bytes[start - 1] };
        // "Apache-2.0" is a name too.
        let hyphened = before == '-' && start >= 2 && bytes[start - 2].is_alphabetic();
        let followed = at(i).is_alphabetic() && !has_unit(&bytes, i);
        let named = before.is_alphanumeric() || before == '_' || hyphened || followed;
        let Ok(value) = mantissa.parse::<f64>() else { continue };
        if named || points > 1 || is_reference(&bytes[..start]) {
            continue;
        }
        let decimals = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len() as i32) - exponent;
        found.push(Number {
            text: bytes[start..i].iter().collect(),
            value: value * 10f64.powi(exponent),
            decimals,
            has_unit: has_unit(&bytes, i),
            in_parentheses: before == '(' && at(i) == ')',
        });
    }
    found
}

/// Whether a unit follows, after a blank or not.
fn has_unit(text: &[char], end: usize) -> bool {
    let rest: String = text.iter().skip(end).collect();
    let word: String = rest.trim_start().chars().take_while(|c| c.is_alphabetic() || *c == '%').collect();
    UNITS.contains(&word.as_str()) && rest.len() - rest.trim_start().len() <= 1
}

/// "figure 4.3", "figures 4.3, 4.5 and 4.6".
fn is_reference(before: &[char]) -> bool {
    let before: String = before.iter().collect::<String>().to_lowercase();
    let is_number = |word: &str| word.chars().all(|c| c.is_ascii_digit() || ".,-()".contains(c));
    let mut words = before.split_whitespace().rev();
    let word = words.find(|word| !is_number(word) && !["and", "to", "or"].contains(word));
    word.is_some_and(|word| REFERENCES.contains(&word.trim_start_matches('(')))
}

#[test]
fn figures_of_a_line() {
    let texts = |line: &str| figures(line).into_iter().map(|number| number.text).collect::<Vec<_>>();
    assert_eq!(texts("from .43 to 1,234.5, 12 ns, 5 % of 7 in 128x128"), [".43", "1,234.5", "12", "5"]);
    assert_eq!(texts("figures 4.3, 4.5 and 4.6; (6.11); `0.5`; [a](b-0.5.svg); POV-Ray 3.7.0.10, Apache-2.0"), [""; 0]);
    assert_eq!(texts("-.33 ± .08 | 2.3e-4"), [".33", ".08", "2.3e-4"]);
    assert_eq!(numbers("2.3e-4")[0].decimals, 5);
    assert_eq!(numbers("at 60,000 items")[0].value, 60_000.0);
}
