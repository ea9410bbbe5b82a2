//! What can be read on an HTML page: its lines, a line for each block, and the cells of its tables, both masked. Pictures,
//! styles and scripts are passed over.

use crate::ignored::{COLUMNS, MARK, ROWS, TILES};
use crate::markup::{Piece, pieces};
use crate::mask::{fits, masked};

/// What can be read on a page.
#[derive(Debug, Default)]
pub struct Page {
    /// Text outside of pictures, a line for each block.
    pub lines: Vec<String>,
    /// Cells of tables.
    pub cells: Vec<String>,
    /// What a rule has left out.
    pub hidden: Vec<(&'static str, String)>,
}

/// Elements that cannot be read.
const UNSEEN: [&str; 4] = ["svg", "style", "script", "template"];
/// Elements in the middle of a line.
const INLINE: [&str; 14] =
    ["a", "b", "code", "em", "i", "span", "strong", "sub", "sup", "small", "abbr", "var", "mark", "kbd"];

/// Where reading has come to in a table.
#[derive(Debug, Default)]
struct Table {
    head: Vec<String>,
    row: Vec<String>,
    rows: usize,
}

/// Reads a page.
pub fn read(document: &str) -> Page {
    let (mut page, mut line) = (Page::default(), String::new());
    let mut cell: Option<String> = None;
    let mut tables: Vec<Table> = Vec::new();
    let mut unseen: Vec<String> = Vec::new();
    for piece in pieces(document) {
        match piece {
            Piece::Open { name, empty, .. } => {
                if !unseen.is_empty() || UNSEEN.contains(&name.as_str()) {
                    if !empty {
                        unseen.push(name);
                    }
                    continue;
                }
                if !INLINE.contains(&name.as_str()) {
                    end_line(&mut line, &mut page);
                }
                match name.as_str() {
                    "table" => tables.push(Table::default()),
                    "td" | "th" => cell = Some(String::new()),
                    _ => {}
                }
            }
            Piece::Close(name) => {
                if !unseen.is_empty() {
                    // What is left open inside ends with what it stands in.
                    if let Some(place) = unseen.iter().rposition(|open| *open == name) {
                        unseen.truncate(place);
                    }
                    continue;
                }
                match (name.as_str(), &mut cell) {
                    ("td" | "th", Some(text)) => {
                        end_cell(text, tables.last_mut(), &mut page);
                        cell = None;
                    }
                    (name, None) if !INLINE.contains(&name) => end_line(&mut line, &mut page),
                    // Blocks in a cell are words of their own.
                    (name, Some(text)) if !INLINE.contains(&name) => text.push(' '),
                    _ => {}
                }
                match (name.as_str(), tables.last_mut()) {
                    ("tr", Some(table)) => table.end_row(),
                    ("table", _) => drop(tables.pop()),
                    _ => {}
                }
            }
            Piece::Text(text) if unseen.is_empty() => {
                // A narrow space stands between the thousands of a number.
                let text = text.replace('\u{202f}', "");
                match &mut cell {
                    Some(cell) => *cell += &text,
                    None => line += &text,
                }
            }
            Piece::Text(_) => {}
        }
    }
    end_line(&mut line, &mut page);
    leave_out_tiles(&mut page);
    page
}

/// Takes out the lines beside the names of figures that do not count.
fn leave_out_tiles(page: &mut Page) {
    for tile in TILES {
        let form: Vec<&str> = tile.form.split(' ').collect();
        let is_form = |line: &String| {
            let words: Vec<&str> = line.split(' ').collect();
            words.len() == form.len() && words.iter().zip(&form).all(|(word, wanted)| fits(word, wanted))
        };
        while let Some(name) = page.lines.iter().position(|line| unmarked(line) == tile.name) {
            let beside = [name.wrapping_sub(1), name + 1];
            let found = beside.into_iter().find(|place| page.lines.get(*place).is_some_and(is_form));
            page.lines[name] += ":";
            if let Some(place) = found {
                page.hidden.push((tile.rule, page.lines.remove(place)));
            }
        }
    }
}

impl Table {
    fn end_row(&mut self) {
        let row = std::mem::take(&mut self.row);
        if self.rows == 0 {
            self.head = row;
        }
        self.rows += 1;
    }

    /// The rule by which the next cell is left out.
    fn rule(&self) -> Option<&'static str> {
        let by_row = self.row.last().and_then(|before| ROWS.iter().find(|(name, _)| *name == unmarked(before)));
        let first = self.head.first().map_or("", String::as_str);
        let of_column = |name: &String| {
            COLUMNS.iter().find(|column| column.first.eq_ignore_ascii_case(first) && column.column == name)
        };
        let by_column = self.head.get(self.row.len()).filter(|_| self.rows > 0).and_then(of_column);
        by_row.map(|(_, rule)| *rule).or_else(|| by_column.map(|column| column.rule))
    }
}

/// The name of a figure without the mark of an emulated one.
fn unmarked(name: &str) -> &str {
    name.strip_suffix(MARK).unwrap_or(name)
}

fn end_cell(text: &str, table: Option<&mut Table>, page: &mut Page) {
    let masked = masked(text);
    let text = masked.words.join(" ");
    match table.as_ref().and_then(|table| table.rule()) {
        Some(rule) => page.hidden.push((rule, text.clone())),
        None if text.is_empty() => {}
        None => {
            page.hidden.extend(masked.hidden);
            page.lines.push(text.clone());
            page.cells.push(text.clone());
        }
    }
    if let Some(table) = table {
        table.row.push(text);
    }
}

fn end_line(line: &mut String, page: &mut Page) {
    let masked = masked(&std::mem::take(line));
    page.hidden.extend(masked.hidden);
    if !masked.words.is_empty() {
        page.lines.push(masked.words.join(" "));
    }
}
