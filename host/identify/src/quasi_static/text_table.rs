//! Columns out of text whose separator is not known beforehand, with a header or without: numbers take the place of names
//! then.

use crate::columns::Columns;
use report::failure::{Failure, Outcome};

/// What stands between the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Separator {
    Letter(char),
    Blanks,
}

impl Separator {
    /// The one of a line.
    fn of(line: &str) -> Self {
        let letter = [';', '\t', ','].into_iter().find(|letter| line.contains(*letter));
        letter.map_or(Self::Blanks, Self::Letter)
    }

    fn cells<'l>(self, line: &'l str) -> Box<dyn Iterator<Item = &'l str> + 'l> {
        match self {
            Self::Letter(letter) => Box::new(line.split(letter).map(str::trim)),
            Self::Blanks => Box::new(line.split_whitespace()),
        }
    }
}

/// Columns by the names of the first line, or by their numbers from 1 on if that has none.
pub fn columns(text: &str) -> Outcome<Columns> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = (1..).zip(text.lines().map(str::trim));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let Some(&(_, first)) = lines.peek() else {
        return Err(Failure::new("the log is empty").with_help("a row for each sample: time, output, motor"));
    };
    let separator = Separator::of(first);
    let has_names = separator.cells(first).any(|cell| cell.parse::<f64>().is_err());
    let names = separator
        .cells(first)
        .enumerate()
        .map(|(index, cell)| if has_names { cell.trim_matches('"').to_owned() } else { (index + 1).to_string() });
    let mut row: Vec<(String, f64)> = names.map(|name| (name, f64::NAN)).collect();
    if has_names {
        lines.next();
    }
    let mut columns = Columns::of("line");
    for (line, text) in lines {
        let mut cells = separator.cells(text);
        for (index, (_, value)) in row.iter_mut().enumerate() {
            let Some(cell) = cells.next() else {
                let message = format!("line {line} has {index} values, the first one has more");
                return Err(Failure::new(message).with_help(
                    "give every row a value for every column, all with the same separator, or cut the log there",
                ));
            };
            // A cell that is no number matters only in a column that is used.
            *value = cell.parse().unwrap_or(f64::NAN);
        }
        columns.push(line, &row);
    }
    if columns.names().next().is_none() {
        return Err(Failure::new("the log has a header and no rows").with_help("a row for each sample"));
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_separator_is_understood_with_a_header_and_without() {
        for separator in [",", ";", "\t", " ", "   ", ", "] {
            let rows = ["1.5", "2", "-3e0"].join(separator) + "\n" + &["2", "4", "6"].join(separator) + "\n";
            let bare = columns(&format!("# a remark\n{rows}")).expect("numbers");
            assert_eq!(bare.names().collect::<Vec<_>>(), ["1", "2", "3"], "{separator:?}");
            assert_eq!(bare.maybe("3").expect("numbers"), Some(vec![-3.0, 6.0]), "{separator:?}");
            let named = columns(&format!("{}\n{rows}", ["a", "b", "c"].join(separator))).expect("names");
            assert_eq!(named.maybe("b").expect("numbers"), Some(vec![2.0, 4.0]), "{separator:?}");
        }
    }

    #[test]
    fn a_short_row_and_a_log_without_rows_are_refused() {
        assert_eq!(
            columns("1 2 3\n4 5\n").expect_err("short").message(),
            "line 2 has 2 values, the first one has more"
        );
        for text in ["", "# nothing\n", "time_s;output_counts\n"] {
            assert!(columns(text).expect_err("no rows").help().is_some());
        }
    }
}
