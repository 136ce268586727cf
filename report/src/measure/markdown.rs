//! Tables as Markdown, aligned as plain text too, and as CSV.

/// `words`: the columns that are words and aligned left; columns of numbers are aligned right. A row that is too short
/// ends early.
pub(crate) fn lines(headings: &[&str], words: &[usize], rows: Vec<Vec<String>>) -> String {
    let length = |cell: &str| cell.chars().count();
    let width = |(column, heading): (usize, &&str)| {
        rows.iter().filter_map(|cells| cells.get(column)).map(|cell| length(cell)).fold(length(heading), usize::max)
    };
    let widths: Vec<usize> = headings.iter().enumerate().map(width).collect();
    let line = |cells: &[String]| {
        let padded = cells.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| {
            if words.contains(&column) { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        format!("| {} |\n", padded.collect::<Vec<_>>().join(" | "))
    };
    let mut text = line(&headings.iter().map(|&heading| heading.to_owned()).collect::<Vec<_>>());
    let rule = widths.iter().enumerate().map(|(column, &width)| {
        if words.contains(&column) { "-".repeat(width) } else { "-".repeat(width.max(2) - 1) + ":" }
    });
    text += &format!("| {} |\n", rule.collect::<Vec<_>>().join(" | "));
    text.extend(rows.iter().map(|cells| line(cells)));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_equally_long() {
        let rows = [["mean", "1.25"], ["control variate", "0"]].map(|row| row.map(str::to_owned).to_vec());
        let text = lines(&["estimator", "ratio"], &[0], rows.to_vec());
        assert_eq!(text.lines().count(), 4);
        assert!(text.lines().all(|line| line.len() == "| control variate | ratio |".len()));
        assert_eq!(text.lines().nth(1), Some("| --------------- | ----: |"));
    }
}
