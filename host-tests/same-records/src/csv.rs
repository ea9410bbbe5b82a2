//! CSV, cell by cell. Columns belong together by their names, so that a column that has moved is no difference; a missing
//! row is one. Cells are compared as they are written.

use std::borrow::Cow;

use crate::align::{Step, steps};
use crate::findings::Findings;

type Row<'a> = Vec<Cow<'a, str>>;

/// Compares two tables whose first line names their columns.
pub fn compare(old: &str, new: &str, findings: &mut Findings) {
    let (mut old, mut new) = (rows(old), rows(new));
    if old.is_empty() || new.is_empty() {
        if old != new {
            findings.differs("all of it", Some(format!("{} rows", old.len())), Some(format!("{} rows", new.len())));
        }
        return;
    }
    let (old_head, new_head) = (old.remove(0), new.remove(0));
    let common: Vec<(usize, usize)> = match old_head == new_head {
        true => (0..old_head.len()).map(|place| (place, place)).collect(),
        false => {
            let named = |(place, name): (usize, &Cow<'_, str>)| Some((place, new_head.iter().position(|n| n == name)?));
            old_head.iter().enumerate().filter_map(named).collect()
        }
    };
    findings.same(common.len() as u64);
    for name in old_head.iter().filter(|name| !new_head.contains(name)) {
        findings.differs("columns", Some(name.to_string()), None);
    }
    for name in new_head.iter().filter(|name| !old_head.contains(name)) {
        findings.differs("columns", None, Some(name.to_string()));
    }
    // A row may be longer or shorter than the head; then its whole length counts.
    let old_rows = chosen(old, old_head.len(), common.iter().map(|pair| pair.0));
    let new_rows = chosen(new, new_head.len(), common.iter().map(|pair| pair.1));
    let mut same: usize = old_rows.iter().map(Vec::len).sum();
    for step in steps(&old_rows, &new_rows) {
        let whole = |row: &Row<'_>| Some(row.join(","));
        // The head is line 1.
        match step {
            Step::OnlyOld(a) => {
                same -= old_rows[a].len();
                findings.differs(format!("line {}", a + 2), whole(&old_rows[a]), None);
            }
            Step::OnlyNew(b) => findings.differs(format!("line {}", b + 2), None, whole(&new_rows[b])),
            Step::Pair(a, b) => {
                let (a_row, b_row) = (&old_rows[a], &new_rows[b]);
                for place in 0..a_row.len().max(b_row.len()) {
                    let (old, new) = (a_row.get(place), b_row.get(place));
                    if old == new {
                        continue;
                    }
                    same -= usize::from(old.is_some());
                    let name = common.get(place).map_or("beyond the head", |pair| &*old_head[pair.0]);
                    let cell = |cell: Option<&Cow<'_, str>>| cell.map(ToString::to_string);
                    findings.differs(format!("line {}, {name}", a + 2), cell(old), cell(new));
                }
            }
        }
    }
    findings.same(same as u64);
}

/// The cells of some columns of each row; of a row that is not as long as the head, all.
fn chosen<'a>(rows: Vec<Row<'a>>, length: usize, columns: impl Iterator<Item = usize>) -> Vec<Row<'a>> {
    let columns: Vec<usize> = columns.collect();
    let cells = |row: Row<'a>| match row.len() == length {
        true => columns.iter().map(|place| row[*place].clone()).collect(),
        false => row,
    };
    rows.into_iter().map(cells).collect()
}

/// Cells by line. A cell may be quoted; a line break in it does not occur in what we write.
fn rows(text: &str) -> Vec<Row<'_>> {
    text.lines().map(cells).collect()
}

fn cells(line: &str) -> Row<'_> {
    if !line.contains('"') {
        return line.split(',').map(Cow::Borrowed).collect();
    }
    let (mut cells, mut cell, mut quoted) = (Vec::new(), String::new(), false);
    let mut signs = line.chars().peekable();
    while let Some(sign) = signs.next() {
        match sign {
            '"' if quoted && signs.peek() == Some(&'"') => {
                signs.next();
                cell.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(Cow::Owned(std::mem::take(&mut cell))),
            other => cell.push(other),
        }
    }
    cells.push(Cow::Owned(cell));
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_hold_commas() {
        assert_eq!(cells("a,\"b,c\",\"d\"\"e\","), ["a", "b,c", "d\"e", ""]);
    }
}
