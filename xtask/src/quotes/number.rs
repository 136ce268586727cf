//! Numbers as texts have them.

/// A number as it is written.
#[derive(Debug)]
pub(super) struct Number {
    pub(super) text: String,
    /// With its sign.
    pub(super) value: f64,
    /// Digits behind the point.
    pub(super) decimals: i32,
    /// Before a unit, or the first of several that share one: `20 to 40 %`.
    has_unit: bool,
    /// Alone in parentheses, as the numbers of equations are.
    in_parentheses: bool,
    /// Behind `±`: half of an interval.
    pub(super) is_half_width: bool,
    /// Between brackets: an end of an interval.
    pub(super) is_bound: bool,
    /// Where it begins and ends, in characters.
    place: [usize; 2],
}

const UNITS: [&str; 10] = ["ns", "us", "µs", "ms", "s", "seconds", "minutes", "%", "instructions", "times"];
/// The number behind such a word is the name of something, or a setting by its name.
const REFERENCES: [&str; 17] = [
    "figure",
    "figures",
    "section",
    "sections",
    "chapter",
    "chapters",
    "equation",
    "eq.",
    "algorithm",
    "listing",
    "version",
    "rust",
    "gcc",
    "clang",
    "delta",
    "fraction",
    "rate",
];

/// The numbers of a line that look measured: with decimals or a unit, outside of code and links.
pub(super) fn figures(line: &str) -> Vec<Number> {
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
    let all: Vec<char> = text.chars().collect();
    let at = |i: usize| all.get(i).copied().unwrap_or(' ');
    let digit = |i: usize| at(i).is_ascii_digit();
    let mut found: Vec<Number> = Vec::new();
    let mut i = 0;
    while i < all.len() {
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
        let mantissa: String = all[start..i].iter().filter(|&&c| c != ',').collect();
        let signed = i + 1 + usize::from(matches!(at(i + 1), '-' | '+'));
        let mut exponent = 0;
        if at(i) == 'e' && digit(signed) {
            let first = i + 1;
            i = signed;
            while digit(i) {
                i += 1;
            }
            exponent = all[first..i].iter().collect::<String>().parse().unwrap_or(0);
        }
        let back = |count: usize| if start < count { ' ' } else { all[start - count] };
        let before = back(1);
        // "Apache-2.0" is a name too, and "8-16" a range.
        let hyphen = matches!(before, '-' | '−');
        let hyphened = before == '-' && back(2).is_alphabetic();
        let negative = hyphen && !back(2).is_alphanumeric();
        let followed = at(i).is_alphabetic() && !has_unit(&all, i);
        let named = before.is_alphanumeric() || before == '_' || hyphened || followed;
        let Ok(value) = mantissa.parse::<f64>() else { continue };
        if named || points > 1 || is_reference(&all[..start]) {
            continue;
        }
        let decimals = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len() as i32) - exponent;
        let first = start - usize::from(negative);
        let behind: String = all[..first].iter().collect();
        let bracket = behind.rfind(['[', ']']).is_some_and(|at| behind[at..].starts_with('['));
        found.push(Number {
            text: all[first..i].iter().collect(),
            value: value * 10f64.powi(exponent) * if negative { -1.0 } else { 1.0 },
            decimals,
            has_unit: has_unit(&all, i),
            in_parentheses: before == '(' && at(i) == ')',
            is_half_width: ["±", "+-"].iter().any(|sign| behind.trim_end().ends_with(sign)),
            is_bound: bracket && all[i..].contains(&']'),
            place: [first, i],
        });
    }
    // "20 to 40 %": the unit is of both.
    for i in (1..found.len()).rev() {
        let between: String = all[found[i - 1].place[1]..found[i].place[0]].iter().collect();
        let joined = ["to", "and", "or", ",", "/", "–", "±"].contains(&between.trim());
        found[i - 1].has_unit |= joined && found[i].has_unit;
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
    assert_eq!(
        texts("figures 4.3, 4.5 and 4.6; (6.11); `0.5`; [a](b-0.5.svg); POV-Ray 3.7.0.10, Apache-2.0, delta .2"),
        [""; 0]
    );
    assert_eq!(texts("-.33 ± .08 | 2.3e-4"), ["-.33", ".08", "2.3e-4"]);
    assert_eq!(texts("20 to 40 %, 359 and 4,520 times, 3 of 4"), ["20", "40", "359", "4,520"]);
    assert_eq!(numbers("2.3e-4")[0].decimals, 5);
    assert_eq!(numbers("at 60,000 items")[0].value, 60_000.0);
}

#[test]
fn signs_and_intervals() {
    let values = |line: &str| numbers(line).into_iter().map(|number| number.value).collect::<Vec<_>>();
    assert_eq!(values("-.33, −.5 (-2) |-1| 8-16, [-3, 4]"), [-0.33, -0.5, -2.0, -1.0, 8.0, 16.0, -3.0, 4.0]);
    let kinds = |line: &str| numbers(line).iter().map(|n| (n.is_half_width, n.is_bound)).collect::<Vec<_>>();
    assert_eq!(
        kinds("1.5 ± .2 [1.3, 1.7] 2"),
        [(false, false), (true, false), (false, true), (false, true), (false, false)]
    );
}
