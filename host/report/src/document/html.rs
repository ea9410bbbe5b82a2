//! A document as one HTML page without network or scripts, in light or dark colours as the reader prefers; style and
//! pictures are embedded.

use maud::{DOCTYPE, Markup, PreEscaped, html as markup};

use super::blocks::{Align, Block, Checks, Document, Medium, Notice, Picture, Section, Table};
use super::text::{Span, Text, Tone};
use crate::checks::{Check, Source, Verdict};
use crate::escape::escaped;
use crate::number::PAGE;
use crate::plot::ink;

const STYLE: &str = include_str!("../style.css");

/// Columns above which headings wrap.
const NARROW: usize = 6;

/// Name of the generator in a page.
const GENERATOR: &str = "joint";

/// Returns the whole page, without characters that reorder or hide text.
pub fn html(document: &Document) -> String {
    let page = markup! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="generator" content=(GENERATOR);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (document.title) }
                style { (PreEscaped(ink::style_sheet(":root"))) (PreEscaped(STYLE)) }
            }
            body { main {
                header {
                    div.title {
                        h1 { (inline(&document.heading)) }
                        (pill(document.verdict.as_ref()))
                        @if document.emulated { " " (span(&Span::Emulated)) }
                    }
                    @if !document.subtitle.is_empty() { p.subtitle { (inline(&document.subtitle)) } }
                }
                (blocks(&document.blocks))
                @if !document.footer.is_empty() { footer { (inline(&document.footer)) } }
            } }
        }
    };
    escaped(&page.into_string()).into_owned()
}

fn class(tone: Tone) -> &'static str {
    match tone {
        Tone::Passed => "passed",
        Tone::Failed => "failed",
        Tone::Open => "open",
        Tone::Plain => "reported",
    }
}

fn pill(verdict: Option<&(Tone, String)>) -> Markup {
    markup! { @if let Some((tone, word)) = verdict { span class={ "pill " (class(*tone)) } { (word) } } }
}

fn inline(text: &Text) -> Markup {
    markup! { @for piece in &text.0 { (span(piece)) } }
}

fn span(span: &Span) -> Markup {
    markup! {
        @match span {
            Span::Plain(text) => { (text) }
            Span::Strong(text) => { strong { (text) } }
            Span::Quiet(text) => { span.of { (text) } }
            Span::Code(text) => { code { (text) } }
            Span::Sub(text) => { sub { (text) } }
            Span::Whole(text) => { span.whole { (text) } }
            Span::Inked(text, ink) => { span.inked style={ "color:var(--" (ink.name()) ")" } { (text) } }
            Span::Mark(tone, word) => { span class={ "mark " (class(*tone)) } { (word) } }
            Span::Link { to, shown } => { a href=(to) { (shown) } }
            Span::Number { value, .. } => { (PAGE.write(*value)) }
            Span::Emulated => { span.emulated { "EMULATED" } }
            Span::Break => { br; }
        }
    }
}

fn blocks(blocks: &[Block]) -> Markup {
    markup! { @for part in blocks { (block(part)) } }
}

fn block(block: &Block) -> Markup {
    markup! {
        @match block {
            Block::Section(part) => { (section(part)) }
            Block::Heading(text) => { h3 { (inline(text)) } }
            Block::Paragraph(text) => { p { (inline(text)) } }
            Block::Lead(text) => { p.lead { (inline(text)) } }
            Block::Note(text) => { p.note { (inline(text)) } }
            Block::Notice(one) => { (notice(one)) }
            Block::Tiles(tiles) => {
                section.tiles { @for tile in tiles {
                    div.tile { div.value { (inline(&tile.value)) } div.name { (inline(&tile.name)) } }
                } }
            }
            Block::Facts(rows) => {
                table.identity { tbody { @for (name, value) in rows {
                    tr { th { (inline(name)) } td { (inline(value)) } }
                } } }
            }
            Block::Table(one) => { (table(one)) }
            Block::Checks(one) => { (checks(one)) }
            Block::Picture(one) => { (picture(one)) }
            Block::Again(command) => { h3 { "To run exactly this again" } pre { (command) } }
            Block::List(items) => { ul { @for item in items { li { (inline(item)) } } } }
            Block::Details(part) => {
                details open[part.open] { summary { (inline(&part.summary)) } (blocks(&part.blocks)) }
            }
            Block::Columns(parts) => { div.columns { @for part in parts { div { (self::block(part)) } } } }
            Block::Only(media, parts) => { @if media.contains(&Medium::Page) { (blocks(parts)) } }
        }
    }
}

fn section(part: &Section) -> Markup {
    let anchor = (!part.anchor.is_empty()).then_some(part.anchor.as_str());
    markup! {
        section id=[anchor] {
            @if !part.heading.is_empty() {
                div.title { h2 { (inline(&part.heading)) } (pill(part.verdict.as_ref())) }
            }
            @if !part.subtitle.is_empty() { p.subtitle { (inline(&part.subtitle)) } }
            (blocks(&part.blocks))
        }
    }
}

fn notice(notice: &Notice) -> Markup {
    markup! {
        div.notice.bad[notice.tone == Tone::Failed] role=[notice.alert.then_some("alert")] {
            (inline(&notice.text))
            @for part in &notice.more { @match part {
                Block::Paragraph(text) => { div { (inline(text)) } }
                Block::Again(command) => { pre { (command) } }
                other => { (block(other)) }
            } }
        }
    }
}

fn table(table: &Table) -> Markup {
    let shown = table.shown(Medium::Page);
    let headed = shown.iter().any(|(_, column)| !column.heading.is_empty());
    let align = |align: Align| match align {
        Align::Left => None,
        Align::Note => Some("note"),
        Align::Centre => Some("middle"),
        Align::Right => Some("number"),
    };
    markup! {
        table.wide[shown.len() > NARROW].log[table.log] {
            @if headed { thead { tr { @for (_, column) in &shown {
                th class=[align(column.align)] {
                    (inline(&column.heading)) @if !column.unit.is_empty() { " " span.whole { "[" (column.unit) "]" } }
                }
            } } } }
            tbody { @for row in &table.rows { tr class=[(row.tone != Tone::Plain).then(|| class(row.tone))] {
                @for (place, (index, column)) in shown.iter().enumerate() {
                    @let last = row.spans && index + 1 == row.cells.len();
                    @if let Some(cell) = row.cells.get(*index) {
                        td class=[align(column.align)] colspan=[last.then_some(shown.len() - place)] { (inline(cell)) }
                    }
                }
            } } }
        }
    }
}

/// Table of checks, failed ones first.
fn checks(table: &Checks) -> Markup {
    let mut checks: Vec<&Check> = table.checks.iter().collect();
    checks.sort_by_key(|check| match check.verdict {
        Verdict::Failed => 0,
        Verdict::NotRun => 1,
        Verdict::Passed => 2,
        Verdict::Reported => 3,
    });
    markup! {
        @if checks.is_empty() { p.none { "No check was made." } } @else {
            table.checks.keys[table.keys] {
                thead { tr { th { "Verdict" } th { "Check" } th.number { "Figure" } th.number { "Bound" } th { "Note" } } }
                tbody { @for one in checks { (check(one, table.emulated)) } }
            }
        }
    }
}

fn check(check: &Check, emulated: bool) -> Markup {
    let (class, word) = match check.verdict {
        Verdict::Passed => ("passed", "held"),
        Verdict::Failed => ("failed", "FAILED"),
        Verdict::NotRun => ("open", "not made"),
        Verdict::Reported => ("reported", "reported"),
    };
    let with_unit = |value: f64| match check.unit.as_str() {
        "" => PAGE.write(value),
        // ASCII on a terminal, a micro sign on a page.
        "us" => format!("{} µs", PAGE.write(value)),
        unit => format!("{} {unit}", PAGE.write(value)),
    };
    let bound = check.bound.sign_and_value().map(|(sign, bound)| format!("{sign} {}", with_unit(bound)));
    let marked = emulated && check.source == Source::Board;
    markup! {
        tr class=(class) {
            td.verdict { span class={ "mark " (class) } { (word) } }
            td.name { (check.name) @if marked { " " (span(&Span::Emulated)) } }
            td.number { (check.figure.map_or("–".into(), with_unit)) }
            td.number { (bound.unwrap_or("–".into())) }
            td.note { (check.note) }
        }
    }
}

fn picture(picture: &Picture) -> Markup {
    let widths: Vec<String> = picture.figures.iter().map(|figure| format!("{}fr", figure.shape.width)).collect();
    let drawn = markup! { @for figure in &picture.figures { (PreEscaped(figure.to_svg())) } };
    markup! {
        figure {
            @if let [_] = picture.figures.as_slice() { (drawn) }
            @else { div.beside style={ "--widths:" (widths.join(" ")) } { (drawn) } }
            @if !picture.caption.is_empty() { figcaption { (inline(&picture.caption)) } }
        }
    }
}
