//! Is a figure one of its sources'?

use super::nearest;
use super::number::Number;
use super::source::{Kind, Measured, Place, Sources, TILES, in_order, words};
use std::cell::Cell;
use std::collections::HashSet;
use std::rc::Rc;

/// What part of a source is meant: `embree/direct @ dining 64`.
pub(super) struct Selection {
    /// As it is written.
    pub(super) name: String,
    /// Whether a figure was found in it.
    pub(super) is_used: Cell<bool>,
    numbers: Vec<Measured>,
}

impl Selection {
    pub(super) fn new(name: &str, sources: &Sources) -> Result<Self, String> {
        let (source, wanted) = name.split_once('@').unwrap_or((name, ""));
        let source = source.trim();
        let all = sources.numbers(source).ok_or_else(|| {
            let like = sources.like(source).join("; ");
            let hint = if like.is_empty() { String::new() } else { format!("; there are {like}") };
            format!("there is no source `{source}`{hint}")
        })?;
        let place = |measured: &Measured| [&measured.place.row, &measured.place.column].map(|name| in_order(name));
        let places: Vec<[Vec<String>; 2]> = all.iter().map(place).collect();
        let wanted = phrases(&in_order(wanted), places.iter().flatten());
        // A phrase that names rows chooses among them: a heading that has it too would let every row pass.
        let names_rows = |phrase: &[String]| places.iter().any(|[row, _]| has(row, phrase));
        let wanted: Vec<_> = wanted.into_iter().map(|phrase| (usize::from(!names_rows(&phrase)), phrase)).collect();
        let is_wanted = |place: &[Vec<String>; 2]| wanted.iter().all(|(part, phrase)| has(&place[*part], phrase));
        let numbers: Vec<Measured> =
            all.iter().zip(&places).filter(|(_, place)| is_wanted(place)).map(|(one, _)| one.clone()).collect();
        if numbers.is_empty() && !wanted.is_empty() {
            return Err(format!("`{name}`: no row and column of {source} have these words"));
        }
        Ok(Self { name: name.to_owned(), is_used: Cell::new(false), numbers })
    }

    /// The numbers of the rows that share the most words with a row of the document, and how many words they share.
    fn of_row(&self, label: &HashSet<String>) -> (usize, Vec<&Measured>) {
        let shared = |measured: &&Measured| words(&measured.place.row).intersection(label).count();
        let most = self.numbers.iter().map(|measured| shared(&measured)).max().unwrap_or(0);
        if most == 0 && self.name == TILES {
            return (0, Vec::new());
        }
        (most, self.numbers.iter().filter(|measured| shared(measured) == most).collect())
    }
}

/// Each word alone, but a number with the word before it where a name has them together: `order 4` is not order 3 of 4 samples.
fn phrases<'a>(words: &[String], names: impl Iterator<Item = &'a Vec<String>> + Clone) -> Vec<Vec<String>> {
    let mut phrases: Vec<Vec<String>> = Vec::new();
    for word in words {
        let is_number = !word.contains(char::is_alphabetic);
        match phrases.last_mut().filter(|last| is_number && last.len() == 1) {
            Some(last) if names.clone().any(|name| has(name, &[last[0].clone(), word.clone()])) => {
                last.push(word.clone())
            }
            _ => phrases.push(vec![word.clone()]),
        }
    }
    phrases
}

fn has(name: &[String], phrase: &[String]) -> bool {
    name.windows(phrase.len()).any(|words| words == phrase)
}

/// Where a figure stands.
pub(super) struct Context<'a> {
    pub(super) line: &'a str,
    /// The words that name its row, of a table.
    pub(super) label: HashSet<String>,
    /// The cells that the figure before it may be of: half of an interval, or its end, must be of the same.
    pub(super) before: Vec<Rc<Place>>,
}

/// Where the figure may be from, or what is wrong, and what may stand there instead.
pub(super) fn search(
    number: &Number,
    context: &Context<'_>,
    selections: &[Selection],
) -> Result<Vec<Rc<Place>>, String> {
    let kind = match (number.is_half_width, number.is_bound) {
        (true, _) => Kind::HalfWidth,
        (_, true) => Kind::Bound,
        _ => Kind::Value,
    };
    let rows: Vec<_> = selections.iter().map(|selection| (selection, selection.of_row(&context.label))).collect();
    let is_named = rows.iter().any(|(_, (most, _))| *most > 0);
    let candidates: Vec<(&Selection, &Measured)> = rows
        .into_iter()
        // A table that knows nothing of the row is not meant.
        .filter(|(_, (most, _))| *most > 0 || !is_named)
        .flat_map(|(selection, (_, numbers))| numbers.into_iter().map(move |measured| (selection, measured)))
        .filter(|(_, measured)| measured.kind == kind)
        .filter(|(_, measured)| kind == Kind::Value || context.before.contains(&measured.place))
        .collect();
    let half = 0.5 * 10f64.powi(-number.decimals) * (1.0 + 1e-6);
    let rounds_to = |measured: &Measured, value: f64| {
        [measured.value, measured.other].iter().all(|own| (own - value).abs() <= half)
    };
    let is_right = |value: f64| candidates.iter().any(|(_, measured)| rounds_to(measured, value));
    let names = || selections.iter().map(|selection| selection.name.as_str()).collect::<Vec<_>>().join("; ");
    if !is_right(number.value) {
        let wrong = match kind {
            Kind::Value => format!("{} is not in {}", number.text, names()),
            Kind::Bound => format!("{} is no end of an interval of the figure before it in {}", number.text, names()),
            Kind::HalfWidth => format!(
                "± {} is not both sides of an interval of the figure before it in {}; where they differ, write [low, high]",
                number.text,
                names()
            ),
        };
        let all = selections.iter().flat_map(|selection| &selection.numbers).filter(|one| one.kind == kind);
        let nearest = nearest::of(number.value, context.line, all);
        return Err(if nearest.is_empty() { wrong } else { format!("{wrong}; nearest: {nearest}") });
    }
    if kind == Kind::Value {
        let (right, all) = neighbours(number, is_right);
        if 3 * right > all {
            return Err(format!(
                "{} says little: {right} of the {all} figures near it are in {} too; name a row or column (TABLE @ WORDS), or give more digits",
                number.text,
                names()
            ));
        }
    }
    let found = candidates.iter().filter(|(_, measured)| rounds_to(measured, number.value));
    Ok(found
        .map(|(selection, measured)| {
            selection.is_used.set(true);
            Rc::clone(&measured.place)
        })
        .collect())
}

/// How many of the figures of as many digits within a fourth of a figure, at least three on each side, would be right as well.
fn neighbours(number: &Number, is_right: impl Fn(f64) -> bool) -> (usize, usize) {
    let step = 10f64.powi(-number.decimals);
    let count = ((number.value.abs() / 4.0 / step).floor() as i32).clamp(3, 100);
    let others = (-count..=count).filter(|&i| i != 0).map(|i| number.value + f64::from(i) * step);
    let right = others.filter(|&other| is_right(other)).count();
    (right, 2 * count as usize)
}
