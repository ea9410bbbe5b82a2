//! A document as lines for a terminal, in characters that every terminal has. `output` adds colours.

use std::fmt::Write as _;

use super::blocks::{Block, Checks, Document, Medium, Notice, Section, Table};
use super::text::{Span, Text};
use crate::checks::{Check, Source, Verdict};
use crate::number::TERMINAL;

/// Width of the column of verdicts.
const VERDICT_WIDTH: usize = 8;
/// Least width of the column of names below a heading, so that sheets of one kind look alike.
const MIN_NAME_WIDTH: usize = 28;
/// Width of a line of sentences.
const LINE_WIDTH: usize = 120;
/// Gap between two columns.
const COLUMN_GAP: &str = "  ";

/// Text of a document, ending with a newline.
pub fn terminal(document: &Document) -> String {
    let mut page = Page { text: String::new(), names: longest_name(&document.blocks), headed: false };
    page.line(&plain(&document.line));
    page.blocks(&document.blocks);
    page.text.truncate(page.text.trim_end_matches('\n').len());
    if !page.text.is_empty() {
        page.text.push('\n');
    }
    page.text
}

/// Text as a terminal shows it.
pub fn plain(text: &Text) -> String {
    text.0.iter().map(span).collect()
}

fn span(span: &Span) -> String {
    match span {
        Span::Plain(text)
        | Span::Strong(text)
        | Span::Quiet(text)
        | Span::Code(text)
        | Span::Whole(text)
        | Span::Inked(text, _)
        | Span::Mark(_, text)
        | Span::Link { shown: text, .. } => typed(text),
        Span::Sub(text) => format!("_{}", typed(text)),
        Span::Number { value, terminal } => terminal.write(*value),
        Span::Emulated => " EMULATED".to_owned(),
        Span::Break => " ".to_owned(),
    }
}

/// Replaces typographic characters by ASCII.
fn typed(text: &str) -> String {
    const TYPED: [(&str, &str); 10] = [
        ("± ", "+- "),
        ("µ", "u"),
        ("…", ".."),
        ("–", "-"),
        ("−", "-"),
        ("·", " "),
        ("≤", "<="),
        ("≥", ">="),
        ("\u{202f}", ""),
        ("’", "'"),
    ];
    TYPED.iter().fold(text.to_owned(), |text, (printed, typed)| text.replace(printed, typed))
}

/// Width of the longest name of all facts.
fn longest_name(blocks: &[Block]) -> usize {
    let longest = |block: &Block| match block {
        Block::Facts(rows) => rows.iter().map(|(name, _)| plain(name).chars().count()).max().unwrap_or(0),
        Block::Section(part) if part.line.is_some() => longest_name(&part.blocks),
        Block::Only(media, parts) if media.contains(&Medium::Terminal) => longest_name(parts),
        _ => 0,
    };
    blocks.iter().map(longest).max().unwrap_or(0)
}

/// Text under construction.
struct Page {
    text: String,
    /// Width of the column of names.
    names: usize,
    /// True within a section that has a heading.
    headed: bool,
}

impl Page {
    fn line(&mut self, line: &str) {
        let line = line.trim_end();
        if !line.is_empty() {
            self.text.push_str(line);
            self.text.push('\n');
        }
    }

    fn sentences(&mut self, text: &str) {
        let mut line = String::new();
        for word in text.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > LINE_WIDTH {
                self.line(&std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        self.line(&line);
    }

    /// Adds an empty line, unless the text is empty or ends with one.
    fn blank(&mut self) {
        if !self.text.is_empty() && !self.text.ends_with("\n\n") {
            self.text.push('\n');
        }
    }

    fn blocks(&mut self, blocks: &[Block]) {
        for block in blocks {
            self.block(block);
        }
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Section(part) => self.section(part),
            Block::Heading(text) | Block::Paragraph(text) | Block::Note(text) => self.line(&plain(text)),
            Block::Lead(text) => self.sentences(&plain(text)),
            Block::Notice(notice) => self.notice(notice),
            Block::Facts(rows) => {
                let (indent, width) =
                    if self.headed { (COLUMN_GAP, self.names.max(MIN_NAME_WIDTH)) } else { ("", self.names) };
                for (name, value) in rows {
                    self.line(&format!("{indent}{:width$}{COLUMN_GAP}{}", plain(name), plain(value)));
                }
            }
            Block::Table(table) => {
                self.blank();
                self.table(table);
                self.blank();
            }
            Block::Checks(table) => self.text.push_str(&checks(table)),
            Block::Again(command) => self.line(&format!("{:VERDICT_WIDTH$} {command}", "again:")),
            Block::List(items) => items.iter().for_each(|item| self.line(&format!("- {}", plain(item)))),
            Block::Details(part) => {
                self.blank();
                self.line(&format!("{}:", plain(&part.summary)));
                for block in &part.blocks {
                    match block {
                        Block::Table(table) => self.table(table),
                        other => self.block(other),
                    }
                }
                self.blank();
            }
            Block::Columns(parts) => self.blocks(parts),
            Block::Only(media, parts) if media.contains(&Medium::Terminal) => self.blocks(parts),
            Block::Only(..) | Block::Tiles(_) | Block::Picture(_) => {}
        }
    }

    fn section(&mut self, part: &Section) {
        let Some(line) = &part.line else { return };
        self.blank();
        self.line(&plain(line));
        let outside = std::mem::replace(&mut self.headed, !line.is_empty());
        self.blocks(&part.blocks);
        self.headed = outside;
    }

    /// Prints a notice; a strong word at its beginning goes into the column of verdicts.
    fn notice(&mut self, notice: &Notice) {
        let line = match notice.text.0.as_slice() {
            [word @ Span::Strong(_), rest @ ..] => {
                let rest: String = rest.iter().map(span).collect();
                format!("{:VERDICT_WIDTH$} {}", span(word), rest.trim_start())
            }
            all => all.iter().map(span).collect(),
        };
        self.line(&line);
        for block in &notice.more {
            match block {
                Block::Paragraph(text) => self.line(&format!("{:VERDICT_WIDTH$} {}", "", plain(text))),
                other => self.block(other),
            }
        }
    }

    fn table(&mut self, table: &Table) {
        let shown = table.shown(Medium::Terminal);
        let (heads, rows) = table.texts(Medium::Terminal, plain);
        let width = |place: usize| {
            // A cell that spans the remaining columns does not count for their widths.
            let cells = rows.iter().zip(&table.rows).filter_map(|(cells, row)| {
                let own = !row.spans || place + 1 < cells.len();
                cells.get(place).filter(|_| own).map(|cell| cell.chars().count())
            });
            cells.chain([heads[place].chars().count()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..shown.len()).map(width).collect();
        let line = |cells: &[String]| {
            let places = widths.iter().zip(&shown).map(|(width, (_, column))| (column.align, *width));
            let cells = cells.iter().zip(places).map(|(cell, (align, width))| align.placed(cell, width));
            cells.collect::<Vec<_>>().join(COLUMN_GAP)
        };
        self.line(&line(&heads));
        for cells in &rows {
            self.line(&line(cells));
        }
    }
}

/// Verdict, name, figure and bound of each check, with the note of a failed check below.
pub(super) fn checks(table: &Checks) -> String {
    let width = table.checks.iter().map(|check| check.name.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for check in &table.checks {
        let figure = check.figure.map_or_else(|| "-".to_owned(), |figure| TERMINAL.write(figure));
        let marked = table.emulated && check.source == Source::Board && is_time(check);
        let bound = check.bound.sign_and_value();
        let bound = bound.map(|(sign, bound)| format!("{:2} {}", typed(sign), TERMINAL.write(bound)));
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{:VERDICT_WIDTH$} {:width$}  {figure:>10} {:2} {:18}{}",
            verdict(check.verdict),
            check.name,
            check.unit,
            bound.unwrap_or_default(),
            if marked { "  EMULATED" } else { "" }
        );
        text.truncate(text.trim_end().len());
        if !check.note.is_empty() && check.verdict != Verdict::Passed {
            let _ = write!(text, "\n{:VERDICT_WIDTH$} {:4}{}", "", "", check.note);
        }
        text.push('\n');
    }
    text
}

/// On a terminal only times are marked EMULATED: all other figures are equal on a real board.
fn is_time(check: &Check) -> bool {
    matches!(check.unit.as_str(), "us" | "%") || check.name == "overruns"
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "ok",
        Verdict::Failed => "FAILED",
        Verdict::NotRun => "not made",
        Verdict::Reported => "-",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::Bound;
    use crate::document::blocks::{facts, numbers, row, section_everywhere, table, words};
    use crate::document::text::{number, strong, sub, text};

    fn shown(blocks: Vec<Block>) -> String {
        terminal(&Document { blocks, ..Document::default() })
    }

    #[test]
    fn check_line_shows_figure_bound_and_reason() {
        let good = Check::new("overruns", 0.0, "", Bound::Exactly(0.0), Source::Board).note("fine");
        let bad = Check::new("lateness", 61.25, "us", Bound::AtMost(50.0), Source::Board).note("too late");
        let checks = |checks, emulated| shown(vec![Block::Checks(Checks { checks, emulated, keys: false })]);
        let shown = checks(vec![good, bad], true);
        let lines: Vec<&str> = shown.lines().collect();
        assert_eq!(lines.len(), 3, "{shown}");
        assert!(lines[0].starts_with("ok ") && lines[0].ends_with("EMULATED"), "{shown}");
        assert!(lines[1].starts_with("FAILED") && lines[1].contains("61.25 us <= 50"), "{shown}");
        assert_eq!(lines[2].trim(), "too late");
        let real = checks(vec![Check::new("x", 1.0, "us", Bound::None, Source::Board)], false);
        assert!(!real.contains("EMULATED"), "{real}");
    }

    #[test]
    fn wide_cell_spans_remaining_columns() {
        let wide = crate::document::blocks::Row { spans: true, ..row(["b", "not to be had from this log"]) };
        let rows = vec![row([text("a long name"), number(1.5), text("µm")]), wide];
        let shown = shown(vec![table(vec![words("what"), numbers("found"), words("unit")], rows)]);
        assert_eq!(
            shown,
            "what         found  unit\na long name  1.500  um\nb            not to be had from this log\n"
        );
    }

    #[test]
    fn facts_follow_their_heading() {
        let one = section_everywhere("Gears", vec![facts([("planets", "3"), ("ratio", "6")])]);
        let other = section_everywhere("Masses", vec![facts([("link", text("M") + sub("c"))])]);
        assert_eq!(
            shown(vec![one, other]),
            format!("Gears\n  {:28}  3\n  {:28}  6\n\nMasses\n  {:28}  M_c\n", "planets", "ratio", "link")
        );
    }

    #[test]
    fn notice_word_aligns_with_verdicts() {
        let broken = crate::document::blocks::bad_notice(strong("BROKEN") + " the board fell silent");
        assert_eq!(
            shown(vec![broken, Block::Again("joint hil".into())]),
            "BROKEN   the board fell silent\nagain:   joint hil\n"
        );
    }
}
