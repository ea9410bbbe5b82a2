//! CSV, cell by cell. Columns are matched by name: a moved column is no difference, and a missing column is one difference, in the head.
//! Cells are compared as written.

use std::rc::Rc;

use csv::{ReaderBuilder, StringRecord};

use crate::listing::{Listing, Row};

/// Reads two tables whose first line names their columns.
pub fn read(tables: [&str; 2]) -> [Listing; 2] {
    let tables = tables.map(|table| {
        let reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(table.as_bytes());
        reader.into_records().map(|record| record.expect("a text in memory")).collect::<Vec<_>>()
    });
    let heads = tables.each_ref().map(|table| table.first().cloned().unwrap_or_default());
    let common: Vec<Rc<str>> =
        heads[0].iter().filter(|name| heads[1].iter().any(|other| other == *name)).map(Rc::from).collect();
    tables.map(|table| Listing { rows: rows(&table, &common), hidden: Vec::new() })
}

/// Head of a table, and the cells of the common columns of each line; of a longer line also the surplus cells.
fn rows(table: &[StringRecord], common: &[Rc<str>]) -> Vec<Row> {
    let Some((head, lines)) = table.split_first() else { return Vec::new() };
    let mut names = Row::at("columns");
    head.iter().for_each(|name| names.push(name, name));
    let places: Vec<Option<usize>> = common.iter().map(|name| head.iter().position(|it| it == &**name)).collect();
    let cells = |line: &StringRecord| {
        let mut row = Row::at(format!("line {}", line.position().map_or(0, csv::Position::line)));
        for (name, place) in common.iter().zip(&places) {
            if let Some(cell) = place.and_then(|place| line.get(place)) {
                row.push(Rc::clone(name), cell);
            }
        }
        line.iter().enumerate().skip(head.len()).for_each(|(at, cell)| row.push(format!("column {}", at + 1), cell));
        row
    };
    std::iter::once(names).chain(lines.iter().map(cells)).collect()
}
