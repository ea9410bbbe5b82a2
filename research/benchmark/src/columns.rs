//! Rows as a Markdown table whose columns line up, and how its figures are written. What stands in it is its user's
//! business.

/// Two digits and a power of ten; nothing stands for a motion that got lost.
pub fn scientific(value: Option<f64>) -> String {
    value.map_or_else(|| "lost".into(), |value| format!("{value:.1e}"))
}

/// A Markdown table whose columns line up: the first to the left, numbers to the right.
pub fn table<H: AsRef<str>>(heads: &[H], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        cells.chain([heads[column].as_ref().chars().count(), 3]).max().unwrap_or(3)
    };
    let widths: Vec<usize> = (0..heads.len()).map(width).collect();
    let words = |column: usize| {
        rows.iter().all(|row| row.get(column).is_some_and(|cell| !cell.starts_with(|c: char| c.is_ascii_digit())))
    };
    let left: Vec<bool> = (0..heads.len()).map(words).collect();
    let line = |cells: Vec<&str>| {
        let cells = cells.iter().zip(&widths).zip(&left).map(|((cell, width), left)| match left {
            true => format!(" {cell:<width$} "),
            false => format!(" {cell:>width$} "),
        });
        format!("|{}|\n", cells.collect::<Vec<_>>().join("|"))
    };
    let rule = widths.iter().zip(&left).map(|(width, left)| match left {
        true => "-".repeat(width + 2),
        false => format!("{}:", "-".repeat(width + 1)),
    });
    let mut text = line(heads.iter().map(AsRef::as_ref).collect());
    text += &format!("|{}|\n", rule.collect::<Vec<_>>().join("|"));
    for row in rows {
        text += &line(row.iter().map(String::as_str).collect());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let rows = [vec!["a".to_owned(), "1.0".to_owned()], vec!["long name".to_owned(), "20".to_owned()]];
        let text = table(&["method", "x"], &rows);
        let widths: Vec<usize> = text.lines().map(str::len).collect();
        assert!(widths.windows(2).all(|pair| pair[0] == pair[1]), "{text}");
        assert!(text.contains("| long name |  20 |"), "{text}");
    }
}
