//! Tables as Markdown, aligned as plain text too.

use itertools::Itertools;

/// The first `words` columns are words and aligned left; columns of numbers are aligned right. A row that is too short
/// ends early.
pub(crate) fn lines(headings: &[String], words: usize, rows: &[Vec<String>]) -> String {
    let length = |cell: &str| cell.chars().count();
    let width = |(column, heading): (usize, &String)| {
        rows.iter().filter_map(|cells| cells.get(column)).map(|cell| length(cell)).fold(length(heading), usize::max)
    };
    let widths: Vec<usize> = headings.iter().enumerate().map(width).collect();
    let line = |cells: &[String]| {
        let padded = cells.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| {
            if column < words { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        format!("| {} |\n", padded.format(" | "))
    };
    let mut text = line(headings);
    let rule = |(column, &width): (usize, &usize)| {
        if column < words { "-".repeat(width) } else { "-".repeat(width.max(2) - 1) + ":" }
    };
    text += &format!("| {} |\n", widths.iter().enumerate().map(rule).join(" | "));
    text.extend(rows.iter().map(|cells| line(cells)));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_equally_long() {
        let rows = [["mean", "1.25"], ["control variate", "0"]].map(|row| row.map(str::to_owned).to_vec());
        let text = lines(&["estimator", "ratio"].map(str::to_owned), 1, &rows);
        assert_eq!(text.lines().count(), 4);
        assert!(text.lines().all(|line| line.len() == "| control variate | ratio |".len()));
        assert_eq!(text.lines().nth(1), Some("| --------------- | ----: |"));
    }
}
