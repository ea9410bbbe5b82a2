//! Columns out of text whose separator is not known beforehand, with a header or without: numbers take the place of names
//! then.

use super::columns::{Columns, HEADER_HELP};
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

    /// A cell's number. Where rows are not separated by commas, a comma is the decimal sign of half the world.
    fn number(self, cell: &str) -> Option<f64> {
        let number = cell.parse().ok();
        match self {
            _ if number.is_some() => number,
            Self::Letter(',') => None,
            _ if cell.contains('.') => None,
            _ => cell.replacen(',', ".", 1).parse().ok(),
        }
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
        return Err(Failure::new("the log is empty").with_help(HEADER_HELP));
    };
    let separator = Separator::of(first);
    let has_names = separator.cells(first).any(|cell| separator.number(cell).is_none());
    let names = separator
        .cells(first)
        .enumerate()
        .map(|(index, cell)| if has_names { cell.trim_matches('"').to_owned() } else { (index + 1).to_string() });
    let mut row: Vec<(String, f64)> = names.map(|name| (name, f64::NAN)).collect();
    if has_names {
        lines.next();
    }
    let mut columns = Columns::of("line");
    let count = row.len();
    for (line, text) in lines {
        let mut cells = separator.cells(text);
        for (index, (_, value)) in row.iter_mut().enumerate() {
            let Some(cell) = cells.next() else {
                let message = format!("line {line} has {index} values, the first one has {count}");
                return Err(Failure::new(message).with_help(
                    "give every row a value for every column, all with the same separator, or cut the log there",
                ));
            };
            // A cell that is no number matters only in a column that is used.
            *value = separator.number(cell).unwrap_or(f64::NAN);
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
    fn a_decimal_comma_is_a_number_where_commas_separate_nothing() {
        let columns = columns("time_s;a\n0,001;-1,5e-3\n0.002;7\n0,003;1,2,3\n").expect("numbers");
        assert_eq!(columns.maybe("time_s").expect("numbers"), Some(vec![0.001, 0.002, 0.003]));
        assert!(columns.maybe("a").is_err(), "two commas make no number");
    }

    #[test]
    fn a_row_is_not_filled_up_to_a_header_that_is_much_longer() {
        // 40,000 rows of two bytes under 40,000 names would take 13 GB.
        let text = format!("time_s{}\n{}", ",x".repeat(40_000), "1\n".repeat(40_000));
        assert_eq!(columns(&text).expect_err("short rows").message(), "line 2 has 1 values, the first one has 40001");
        let more = columns("time_s,motor_counts\n0,1,\n1,,\n").expect("a comma at the end is no harm");
        assert_eq!(more.maybe("time_s").expect("numbers"), Some(vec![0.0, 1.0]));
        assert!(more.maybe("motor_counts").is_err(), "an empty cell matters in a column that is used");
    }

    #[test]
    fn a_short_row_and_a_log_without_rows_are_refused() {
        assert_eq!(columns("1 2 3\n4 5\n").expect_err("short").message(), "line 2 has 2 values, the first one has 3");
        for text in ["", "# nothing\n", "time_s;output_counts\n"] {
            assert!(columns(text).expect_err("no rows").help().is_some());
        }
    }
}
