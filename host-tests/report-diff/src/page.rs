//! Visible content of an HTML page: a line for each block, and the cells of its tables, both masked. Pictures, styles and scripts are
//! skipped.

use regex::Regex;

use crate::ignored::{MARK, Place, RULES, rule};
use crate::markup::{Piece, pieces};
use crate::mask::{Hidden, masked, pattern};

/// Visible content of a page.
#[derive(Debug, Default)]
pub struct Page {
    /// Text outside of pictures, a line for each block.
    pub lines: Vec<String>,
    /// Cells of tables.
    pub cells: Vec<String>,
    /// Ignored values with their rules.
    pub hidden: Vec<Hidden>,
}

/// Invisible elements.
const INVISIBLE: [&str; 4] = ["svg", "style", "script", "template"];
/// Elements within a line.
const INLINE: [&str; 14] =
    ["a", "b", "code", "em", "i", "span", "strong", "sub", "sup", "small", "abbr", "var", "mark", "kbd"];

/// Table in progress.
#[derive(Debug, Default)]
struct Table {
    head: Vec<String>,
    row: Vec<String>,
}

/// Reads a page; fails if it cannot be parsed.
pub fn read(document: &str) -> Result<Page, String> {
    let (mut page, mut table, mut text) = (Page::default(), Table::default(), String::new());
    let (mut invisible_depth, mut in_cell) = (0_usize, false);
    for piece in pieces(document)? {
        let (name, opens) = match piece {
            // A narrow space separates the thousands of a number.
            Piece::Text(part) if invisible_depth == 0 => {
                text += &part.replace('\u{202f}', "");
                continue;
            }
            Piece::Text(_) => continue,
            Piece::Open { name, .. } => (name, true),
            Piece::Close(name) => (name, false),
        };
        if INVISIBLE.contains(&name.as_str()) {
            invisible_depth = if opens { invisible_depth + 1 } else { invisible_depth.saturating_sub(1) };
        } else if invisible_depth == 0 && !INLINE.contains(&name.as_str()) {
            match (name.as_str(), opens) {
                ("td" | "th", false) => page.end_cell(&std::mem::take(&mut text), &mut table),
                // Blocks in a cell are separate words.
                _ if in_cell => text.push(' '),
                _ => page.end_line(&std::mem::take(&mut text)),
            }
            match (name.as_str(), opens) {
                ("td" | "th", _) => in_cell = opens,
                ("table", true) => table = Table::default(),
                ("tr", false) if table.head.is_empty() => table.head = std::mem::take(&mut table.row),
                ("tr", false) => table.row.clear(),
                _ => {}
            }
        }
    }
    page.end_line(&text);
    page.leave_out_tiles();
    Ok(page)
}

impl Page {
    fn end_line(&mut self, text: &str) {
        let (text, hidden) = masked(text);
        self.hidden.extend(hidden);
        if !text.is_empty() {
            self.lines.push(text);
        }
    }

    fn end_cell(&mut self, text: &str, table: &mut Table) {
        let (text, hidden) = masked(text);
        if let Some(rule) = table.rule() {
            self.hidden.push((rule, text.clone()));
        } else if !text.is_empty() {
            self.hidden.extend(hidden);
            self.lines.push(text.clone());
            self.cells.push(text.clone());
        }
        table.row.push(text);
    }

    /// Removes the lines beside the names of ignored figures.
    fn leave_out_tiles(&mut self) {
        for (place, rule) in RULES {
            let Place::Tile(tile, words) = place else { continue };
            let pattern = Regex::new(&format!("^{}$", pattern(words))).expect("a pattern");
            while let Some(name) = self.lines.iter().position(|line| unmarked(line) == *tile) {
                let beside = [name.wrapping_sub(1), name + 1];
                let found =
                    beside.into_iter().find(|at| self.lines.get(*at).is_some_and(|line| pattern.is_match(line)));
                self.lines[name] += ":";
                if let Some(at) = found {
                    self.hidden.push((rule, self.lines.remove(at)));
                }
            }
        }
    }
}

impl Table {
    /// Rule that ignores the next cell.
    fn rule(&self) -> Option<&'static str> {
        let (before, first) = (self.row.last()?, self.head.first().map_or("", String::as_str));
        let own_head = self.head.get(self.row.len()).map_or("", String::as_str);
        rule(|place| match place {
            Place::Beside(name) => *name == unmarked(before),
            Place::Column(head, column) => head.eq_ignore_ascii_case(first) && *column == own_head,
            _ => false,
        })
    }
}

/// Name of a figure without the suffix of an emulated one.
fn unmarked(name: &str) -> &str {
    name.strip_suffix(MARK).unwrap_or(name)
}
