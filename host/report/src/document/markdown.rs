//! A document as a part of a Markdown file, with aligned tables that a terminal shows as well as a page does.

use super::blocks::{Align, Block, Document, Medium, Notice, Table};
use super::terminal::checks;
use super::text::{Span, Text};
use crate::escape::escaped;

/// Blocks of a document, ending with a newline; the file has the heading. A terminal shows no pictures.
pub fn markdown(document: &Document, medium: Medium) -> String {
    let mut text = String::new();
    blocks(&document.blocks, medium, &mut text);
    text.truncate(text.trim_end().len());
    text.push('\n');
    escaped(&text).into_owned()
}

fn inline(text: &Text) -> String {
    text.0.iter().map(span).collect()
}

fn span(span: &Span) -> String {
    match span {
        Span::Plain(text) | Span::Quiet(text) | Span::Whole(text) | Span::Inked(text, _) | Span::Mark(_, text) => {
            text.clone()
        }
        Span::Strong(text) => format!("**{text}**"),
        Span::Code(text) => format!("`{text}`"),
        Span::Sub(text) => format!("_{text}"),
        Span::Link { to, shown } => format!("[{shown}]({to})"),
        Span::Number { value, terminal } => terminal.write(*value),
        Span::Emulated => " **EMULATED**".to_owned(),
        Span::Break => " ".to_owned(),
    }
}

/// Appends a separate paragraph.
fn paragraph(paragraph: &str, text: &mut String) {
    if paragraph.is_empty() {
        return;
    }
    if !text.is_empty() {
        text.push('\n');
    }
    text.push_str(paragraph);
    text.push('\n');
}

fn blocks(blocks: &[Block], medium: Medium, text: &mut String) {
    for one in blocks {
        block(one, medium, text);
    }
}

fn block(block: &Block, medium: Medium, text: &mut String) {
    match block {
        Block::Section(part) => {
            paragraph(&format!("### {}", inline(&part.heading)), text);
            paragraph(&inline(&part.subtitle), text);
            blocks(&part.blocks, medium, text);
        }
        Block::Heading(heading) => paragraph(&format!("#### {}", inline(heading)), text),
        Block::Paragraph(one) | Block::Lead(one) | Block::Note(one) => paragraph(&inline(one), text),
        Block::Notice(Notice { text: one, more, .. }) => {
            paragraph(&inline(one), text);
            blocks(more, medium, text);
        }
        Block::Tiles(tiles) => {
            let tiles = tiles.iter().map(|tile| format!("- {}: {}", inline(&tile.name), inline(&tile.value)));
            paragraph(&tiles.collect::<Vec<_>>().join("\n"), text);
        }
        Block::Facts(rows) => {
            let rows = rows.iter().map(|(name, value)| vec![inline(name), inline(value)]).collect::<Vec<_>>();
            paragraph(&aligned(&[String::new(), String::new()], &[Align::Left, Align::Left], &rows), text);
        }
        Block::Table(one) => paragraph(&table(one, medium), text),
        Block::Checks(one) => paragraph(&format!("```\n{}```", checks(one)), text),
        Block::Picture(picture) if medium == Medium::Markdown && !picture.file.is_empty() => {
            let title = picture.figures.first().map_or("", |figure| figure.title.as_str());
            paragraph(&format!("![{title}]({}.svg)", picture.file), text);
        }
        Block::Picture(_) => {}
        Block::Again(command) => paragraph(&format!("Again: `{command}`"), text),
        Block::List(items) => {
            paragraph(&items.iter().map(|item| format!("- {}", inline(item))).collect::<Vec<_>>().join("\n"), text);
        }
        Block::Details(part) => {
            paragraph(&format!("{}:", inline(&part.summary)), text);
            blocks(&part.blocks, medium, text);
        }
        Block::Columns(parts) => blocks(parts, medium, text),
        Block::Only(media, parts) if media.contains(&medium) => blocks(parts, medium, text),
        Block::Only(..) => {}
    }
}

fn table(table: &Table, medium: Medium) -> String {
    let (heads, mut rows) = table.texts(medium, inline);
    rows.iter_mut().for_each(|row| row.resize(heads.len(), String::new()));
    let aligns: Vec<Align> = table.shown(medium).iter().map(|(_, column)| column.align).collect();
    aligned(&heads, &aligns, &rows)
}

/// A table with aligned columns.
fn aligned(heads: &[String], aligns: &[Align], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        cells.chain([heads[column].chars().count(), 3]).max().unwrap_or(3)
    };
    let widths: Vec<usize> = (0..heads.len()).map(width).collect();
    let line = |cells: &[String]| {
        let places = widths.iter().zip(aligns);
        let cells = cells.iter().zip(places).map(|(cell, (width, align))| format!(" {} ", align.placed(cell, *width)));
        format!("|{}|", cells.collect::<Vec<_>>().join("|"))
    };
    let rule = widths.iter().zip(aligns).map(|(width, align)| match align {
        Align::Left | Align::Note => "-".repeat(width + 2),
        Align::Centre => format!(":{}:", "-".repeat(*width)),
        Align::Right => format!("{}:", "-".repeat(width + 1)),
    });
    let rule = format!("|{}|", rule.collect::<Vec<_>>().join("|"));
    let lines: Vec<String> = [line(heads), rule].into_iter().chain(rows.iter().map(|row| line(row))).collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::blocks::{PAGES, numbers, row, section, words};
    use crate::document::text::{strong, sub, text};

    #[test]
    fn columns_line_up() {
        let rows = vec![row(["a", "1.0"]), row(["long name", "20"])];
        let table = crate::document::blocks::table(vec![words("method"), numbers("x")], rows);
        let blocks = vec![section(text("Case ") + strong("A"), vec![Block::Lead(text("b") + sub("c")), table])];
        let shown = markdown(&Document { blocks, ..Document::default() }, Medium::Markdown);
        assert!(shown.starts_with("### Case **A**\n\nb_c\n\n| method"), "{shown}");
        let widths: Vec<usize> = shown.lines().filter(|line| line.starts_with('|')).map(str::len).collect();
        assert!(widths.len() == 4 && widths.windows(2).all(|pair| pair[0] == pair[1]), "{shown}");
        assert!(shown.contains("| long name |  20 |"), "{shown}");
    }

    #[test]
    fn page_only_blocks_are_omitted() {
        let blocks = vec![Block::Only(PAGES, vec![Block::Lead("only there".into())]), Block::Lead("here".into())];
        assert_eq!(markdown(&Document { blocks, ..Document::default() }, Medium::Markdown), "here\n");
    }
}
