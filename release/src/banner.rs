//! What stands before a chapter of the header: all its functions on one screen, each with what it is for.

/// The width of the header's lines.
const WIDTH: usize = 118;

/// The title, the guides in docs/, and every function's name and summary.
pub(crate) fn banner<'a>(
    title: &str,
    guides: &str,
    functions: impl Iterator<Item = &'a (String, String)> + Clone,
) -> String {
    let rule = "-".repeat(WIDTH - 4);
    let mut text = format!("\n/* {rule}\n * {title}\n");
    if !guides.is_empty() {
        text += &format!(" * Guides, in docs/: {guides}\n");
    }
    text += " *\n";
    let names = functions.clone().map(|(name, _)| name.len()).max().unwrap_or(0) + 2;
    for (name, summary) in functions {
        let mut name = name.as_str();
        for line in lines(summary, WIDTH - names - 5) {
            text += &format!(" *   {name:names$}{line}\n");
            name = "";
        }
    }
    text + &format!(" * {rule} */\n")
}

/// A summary in lines of at most `width`: one if all of it fits, or enough of it up to a comma.
fn lines(summary: &str, width: usize) -> Vec<String> {
    let mut commas = summary.rmatch_indices(", ").map(|(at, _)| at);
    let kept = commas.find(|at| (width / 2..=width).contains(at));
    let summary = if summary.len() > width { &summary[..kept.unwrap_or(summary.len())] } else { summary };
    let mut lines = vec![String::new()];
    for word in summary.split_whitespace() {
        let Some(last) = lines.last_mut() else { break };
        if last.is_empty() {
            last.push_str(word);
        } else if last.len() + 1 + word.len() <= width {
            last.push(' ');
            last.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// The first sentence of a description: up to a colon, a semicolon, or a full stop, but for "et al. (2019)".
pub(crate) fn first_sentence(comment: &[&str]) -> String {
    let lines = comment.iter().map(|line| line.trim_start_matches('/').trim()).take_while(|line| !line.is_empty());
    let text = lines.collect::<Vec<_>>().join(" ");
    let is_end = |&(at, mark): &(usize, &str)| {
        let next = text[at + mark.len()..].chars().next();
        mark != ". " || next != Some('(')
    };
    let marks = text.match_indices(". ").chain(text.match_indices(": ")).chain(text.match_indices("; "));
    let end = marks.filter(is_end).map(|(at, _)| at).min().unwrap_or(text.len());
    text[..end].trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::{first_sentence, lines};

    #[test]
    fn sentences_end_at_their_full_stops() {
        let comment = [
            "// The weight of Kondapaneni et al. (2019), (2.15). Where f is 0 it",
            "// does not exist.",
            "",
            "// More",
        ];
        assert_eq!(first_sentence(&comment), "The weight of Kondapaneni et al. (2019), (2.15)");
        assert_eq!(first_sentence(&["// Tiles: bytes."]), "Tiles");
        assert_eq!(first_sentence(&["// Forgets all samples."]), "Forgets all samples");
    }

    #[test]
    fn what_is_too_long_ends_at_a_comma_or_goes_on() {
        assert_eq!(lines("Draws items, all of them, again", 30), ["Draws items, all of them"]);
        assert_eq!(lines("Draws items, all of them", 30), ["Draws items, all of them"]);
        assert_eq!(lines("one, two three four five", 12), ["one, two", "three four", "five"]);
    }
}
