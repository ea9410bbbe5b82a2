//! Columns of a text with an unknown separator, with or without a header; without one, columns are named by numbers.

use super::columns::{Columns, HEADER_HELP};
use report::failure::{Failure, Outcome};

/// Separator between the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Separator {
    Letter(char),
    Blanks,
}

impl Separator {
    /// Separator of a line.
    fn detect(line: &str) -> Self {
        let letter = [';', '\t', ','].into_iter().find(|letter| line.contains(*letter));
        letter.map_or(Self::Blanks, Self::Letter)
    }

    /// Number in a cell. Unless commas separate the cells, a comma may be the decimal sign.
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

/// Lines searched for a header.
const HEADER_LINES_MAX: usize = 200;
/// Lines from the middle of the text that give the number of cells per row.
const MIDDLE_LINES: usize = 9;

/// Cells of a line of units, beside any text in brackets.
const UNITS: [&str; 20] = [
    "", "-", "s", "ms", "us", "ns", "rad", "mrad", "deg", "turns", "counts", "Nm", "N m", "N_m", "mNm", "A", "V",
    "rpm", "rad/s", "Hz",
];

/// Line with its number.
type Line<'t> = (usize, &'t str);

/// Columns named by the header, or numbered from 1 without one. Lines before the header and a line of units below it
/// are skipped with a note. An empty cell is NaN, a missing value; a cell with other text is infinite.
pub fn columns(text: &str) -> Outcome<Columns> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // A trailing tab may be an empty cell.
    let trimmed = text.lines().map(|line| line.trim_matches(' ').trim_end_matches(['\r', ' ']));
    let all = (1..).zip(trimmed).filter(|(_, line)| !line.trim().is_empty());
    let lines: Vec<Line<'_>> = all.clone().filter(|(_, line)| !line.starts_with('#')).collect();
    if lines.is_empty() {
        return Err(Failure::new("the log is empty").with_help(HEADER_HELP));
    }
    let (head, separator) = header(&lines);
    let (head_line, first) = (lines[head].0, lines[head].1.trim());
    let has_names = separator.cells(first).any(|cell| separator.number(cell).is_none());
    let names = separator
        .cells(first)
        .enumerate()
        .map(|(index, cell)| if has_names { cell.trim_matches('"').to_owned() } else { (index + 1).to_string() });
    let mut row: Vec<(String, f64)> = names.map(|name| (name, f64::NAN)).collect();
    let mut body = if has_names { head + 1 } else { head };
    let mut columns = Columns::new("line");
    let before: Vec<usize> = all.map(|(line, _)| line).take_while(|line| *line < head_line).collect();
    if let [first, .., last] | [first @ last] = before[..] {
        let lines = if first == last { format!("Line {first}") } else { format!("Lines {first} to {last}") };
        columns.add_note(format!("{lines} before the header skipped."));
    }
    let has_numbers = |line: &str| separator.cells(line).any(|cell| separator.number(cell).is_some());
    let is_full = |line: &str| separator.cells(line).all(|cell| !cell.is_empty());
    if has_names && lines.len() > body + 1 && !has_numbers(lines[body].1) && is_full(lines[body].1) {
        columns.add_note(format!("Line {} below the header has no number and is skipped.", lines[body].0));
        body += 1;
    }
    let count = row.len();
    for (line, text) in &lines[body..] {
        let mut cells = separator.cells(text);
        for (index, (_, value)) in row.iter_mut().enumerate() {
            let Some(cell) = cells.next() else {
                let message = format!("line {line} has {index} values, the first one has {count}");
                return Err(Failure::new(message).with_help(
                    "give every row a value for every column, all with the same separator, or cut the log there",
                ));
            };
            // Text in a cell matters only if the column is used.
            let missing = if cell.is_empty() { f64::NAN } else { f64::INFINITY };
            *value = separator.number(cell).unwrap_or(missing);
        }
        columns.push(*line, &row);
    }
    if columns.names().next().is_none() {
        return Err(Failure::new("the log has a header but no rows").with_help("write a row per sample"));
    }
    Ok(columns)
}

/// Index of the header, or of the first row of a table without one, and the separator. A header has the number of cells
/// of the rows in the middle of the text, and no number; the last such line before the first row of numbers is chosen.
fn header(lines: &[Line<'_>]) -> (usize, Separator) {
    let middle = &lines[lines.len() / 2..];
    let fits = |line: &str| {
        let separator = Separator::detect(line.trim());
        let count = separator.cells(line.trim()).count();
        let as_many = |row: &&Line<'_>| {
            let cells = separator.cells(row.1).count();
            cells == count || (cells == count + 1 && separator.cells(row.1).last().is_some_and(str::is_empty))
        };
        count > 1 && middle.iter().take(MIDDLE_LINES).filter(as_many).count() * 2 > middle.len().min(MIDDLE_LINES)
    };
    let numbers = |line: &str| {
        let separator = Separator::detect(line);
        separator.cells(line).filter(|cell| separator.number(cell).is_some()).count()
    };
    let all_numbers = |line: &str| {
        let separator = Separator::detect(line);
        numbers(line) > 0 && separator.cells(line).all(|cell| cell.is_empty() || separator.number(cell).is_some())
    };
    let few = &lines[..lines.len().min(HEADER_LINES_MAX)];
    let fitting: Vec<usize> = (0..few.len()).filter(|line| fits(few[*line].1)).collect();
    let first_row = fitting.iter().copied().find(|line| all_numbers(few[*line].1));
    let named =
        fitting.iter().copied().filter(|line| first_row.is_none_or(|row| *line < row) && numbers(few[*line].1) == 0);
    let is_unit = |cell: &str| UNITS.contains(&cell) || cell.starts_with(['[', '(']);
    let names = |line: &usize| !Separator::detect(few[*line].1).cells(few[*line].1).all(is_unit);
    let named: Vec<usize> = named.filter(names).collect();
    // Without a row of numbers, as with a column of words, the first line of names is the header.
    let names = if first_row.is_some() { named.last() } else { named.first() };
    let head = names.copied().or(first_row.filter(|row| fitting.first() == Some(row))).or(fitting.first().copied());
    // Rows of numbers with another length are no lines before a header.
    let is_row = |line: &Line<'_>| all_numbers(line.1) && numbers(line.1) > 1;
    let head = head.filter(|head| !few[..*head].iter().any(is_row)).unwrap_or_default();
    (head, Separator::detect(lines[head].1.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every separator is detected, with and without a header.
    #[test]
    fn text_separators_are_detected() {
        for separator in [",", ";", "\t", " ", "   ", ", "] {
            let rows = ["1.5", "2", "-3e0"].join(separator) + "\n" + &["2", "4", "6"].join(separator) + "\n";
            let bare = columns(&format!("# a remark\n{rows}")).expect("numbers");
            assert_eq!(bare.names().collect::<Vec<_>>(), ["1", "2", "3"], "{separator:?}");
            assert_eq!(bare.finite("3").expect("numbers"), Some(vec![-3.0, 6.0]), "{separator:?}");
            let named = columns(&format!("{}\n{rows}", ["a", "b", "c"].join(separator))).expect("names");
            assert_eq!(named.finite("b").expect("numbers"), Some(vec![2.0, 4.0]), "{separator:?}");
        }
    }

    /// A decimal comma is read unless commas separate the cells.
    #[test]
    fn text_decimal_comma_is_read() {
        let columns = columns("time_s;a\n0,001;-1,5e-3\n0.002;7\n0,003;1,2,3\n").expect("numbers");
        assert_eq!(columns.finite("time_s").expect("numbers"), Some(vec![0.001, 0.002, 0.003]));
        assert!(columns.finite("a").is_err(), "two commas make no number");
    }

    /// Rows far shorter than the header are rejected before memory is filled.
    #[test]
    fn text_short_rows_are_rejected_early() {
        // 40,000 rows of two bytes under 40,000 names would take 13 GB.
        let text = format!("time_s{}\n{}", ",x".repeat(40_000), "1\n".repeat(40_000));
        assert_eq!(columns(&text).expect_err("short rows").message(), "line 2 has 1 values, the first one has 40001");
        let more = columns("time_s,motor_counts\n0,1,\n1,,\n").expect("a comma at the end is no harm");
        assert_eq!(more.finite("time_s").expect("numbers"), Some(vec![0.0, 1.0]));
        assert!(more.finite("motor_counts").is_err(), "an empty cell is no number");
    }

    /// Lines before the header and a line of units below it are skipped with a note.
    #[test]
    fn text_preamble_and_units_are_noted() {
        let rows = "0.1,5,6\n0.2,,7\n0.3,8,9\n0.4,1,2\n";
        for (before, units, told) in [
            ("", "", &[][..]),
            ("# made by a drive\n", "", &["Line 1 before"][..]),
            ("Drive 7\nDate,2024-05-01\nRate,10000\n\n", "", &["Lines 1 to 3 before"]),
            ("Drive,serial,firmware\n", "[s],[-],[-]\n", &["Line 1 before", "Line 3 below"]),
        ] {
            let columns = columns(&format!("{before}time_s,motor_counts,x\n{units}{rows}")).expect("a table");
            assert_eq!(columns.names().collect::<Vec<_>>(), ["time_s", "motor_counts", "x"], "{before}");
            assert_eq!(columns.finite("time_s").expect("numbers"), Some(vec![0.1, 0.2, 0.3, 0.4]), "{before}");
            assert_eq!(columns.notes().len(), told.len(), "{:?}", columns.notes());
            assert!(
                columns.notes().iter().zip(told).all(|(told, word)| told.starts_with(word)),
                "{:?}",
                columns.notes()
            );
        }
        let words = columns("Drive\ntime_s,mode,x\n0.1,idle,6\n0.2,run,7\n").expect("a table");
        assert_eq!(words.finite("x").expect("numbers"), Some(vec![6.0, 7.0]));
        let tabs = columns("time_s\ta\tb\n0.1\t5\t\n0.2\t\t\n\t6\t7\n").expect("empty cells at both ends");
        assert!(tabs.column("b").is_some_and(|b| b[0].is_nan() && b[1].is_nan() && b[2] == 7.0));
    }

    /// Rows without a needed value are removed; text in a needed cell is rejected.
    #[test]
    fn incomplete_rows_are_removed() {
        let mut columns = columns("time_s,motor_counts,x\n0.1,5,\n0.2,,7\n0.3,8,none\n").expect("a table");
        columns.remove_incomplete(&[&["time_s"], &["motor_counts"], &["output_counts"]]).expect("some are whole");
        assert_eq!(columns.finite("motor_counts").expect("numbers"), Some(vec![5.0, 8.0]));
        assert!(
            columns.notes()[0].contains("1 of 3 rows") && columns.notes()[0].contains("`motor_counts` is empty in 1")
        );
        let refused =
            columns.remove_incomplete(&[&["x"]]).and_then(|()| columns.finite("x").map(drop)).expect_err("a word");
        assert!(refused.message().contains("line 4 has no finite number"), "{refused}");
    }

    /// A short row and a log without rows are rejected.
    #[test]
    fn text_short_row_or_no_rows_rejected() {
        assert_eq!(columns("1 2 3\n4 5\n").expect_err("short").message(), "line 2 has 2 values, the first one has 3");
        for text in ["", "# nothing\n", "time_s;output_counts\n"] {
            assert!(columns(text).expect_err("no rows").help().is_some());
        }
    }
}
