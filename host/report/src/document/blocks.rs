//! A document as plain data: its blocks in reading order, independent of the output format.

use super::text::{Text, Tone};
use crate::checks::Check;
use crate::plot::Figure;

/// One report.
///
/// ```
/// use report::document::{Document, Medium, facts, html, markdown, number, section_everywhere, terminal};
///
/// let gap = facts([("half-backlash [um]", number(40.0)), ("lost motion [mrad]", number(3.78))]);
/// let document = Document {
///     title: "Q1".into(),
///     heading: "Joint Q1".into(),
///     line: "Joint Q1".into(),
///     blocks: vec![section_everywhere("The gap", vec![gap])],
///     ..Document::default()
/// };
/// // The same figures wherever it is shown.
/// for text in [html(&document), terminal(&document), markdown(&document, Medium::Markdown)] {
///     assert!(text.contains("The gap") && text.contains("lost motion [mrad]") && text.contains("3.78"), "{text}");
/// }
/// ```
#[derive(Default)]
pub struct Document {
    /// Name of the window and of the file.
    pub title: String,
    /// What heads a page.
    pub heading: Text,
    /// What came of it, beside the heading.
    pub verdict: Option<(Tone, String)>,
    /// An emulator has measured it.
    pub emulated: bool,
    /// Below the heading of a page.
    pub subtitle: Text,
    /// What heads a terminal's text, in one line; may be empty.
    pub line: Text,
    /// What it says.
    pub blocks: Vec<Block>,
    /// Below everything in a page.
    pub footer: Text,
}

/// Where a document is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Medium {
    /// An HTML page.
    Page,
    /// Lines of text.
    Terminal,
    /// Part of a Markdown file.
    Markdown,
}

/// All media.
pub const EVERYWHERE: &[Medium] = &[Medium::Page, Medium::Terminal, Medium::Markdown];
/// Pages and nothing else.
pub const PAGES: &[Medium] = &[Medium::Page];
/// Terminals and nothing else.
pub const TERMINALS: &[Medium] = &[Medium::Terminal];

/// A part of a document.
pub enum Block {
    /// A part with its own heading.
    Section(Section),
    /// A heading within a section.
    Heading(Text),
    /// Sentences.
    Paragraph(Text),
    /// Sentences that lead into a section.
    Lead(Text),
    /// Sentences that explain what stands above them.
    Note(Text),
    /// A notice at the top of a section.
    Notice(Notice),
    /// Key figures.
    Tiles(Vec<Tile>),
    /// Names and what belongs to them.
    Facts(Vec<(Text, Text)>),
    /// Rows and columns.
    Table(Table),
    /// The table of checks.
    Checks(Checks),
    /// One picture or several beside each other, with what is to be seen in them.
    Picture(Picture),
    /// How to run exactly this again.
    Again(String),
    /// Sentences one below the other.
    List(Vec<Text>),
    /// A part that unfolds on a click.
    Details(Details),
    /// Beside each other where there is room.
    Columns(Vec<Block>),
    /// Shown in these media only.
    Only(&'static [Medium], Vec<Block>),
}

/// A part with its own heading.
#[derive(Default)]
pub struct Section {
    /// Heading.
    pub heading: Text,
    /// Name by which it is linked to; may be empty.
    pub anchor: String,
    /// What came of it, beside the heading.
    pub verdict: Option<(Tone, String)>,
    /// Below the heading.
    pub subtitle: Text,
    /// What heads it on a terminal, nothing if it is empty; a section without is not shown there.
    pub line: Option<Text>,
    /// What it says.
    pub blocks: Vec<Block>,
}

/// A notice at the top of a section. Text that begins with a strong word shows what kind it is.
pub struct Notice {
    /// How bad it is.
    pub tone: Tone,
    /// Whether a screen reader should say it at once.
    pub alert: bool,
    /// What it is.
    pub text: Text,
    /// More about it.
    pub more: Vec<Block>,
}

/// A key figure.
pub struct Tile {
    /// What it is.
    pub name: Text,
    /// The figure.
    pub value: Text,
}

/// Rows and columns. A table whose columns have no headings shows none.
#[derive(Default)]
pub struct Table {
    /// From left to right.
    pub columns: Vec<Column>,
    /// From top to bottom.
    pub rows: Vec<Row>,
    /// Lines of a machine, in its own letters.
    pub log: bool,
}

/// A column.
pub struct Column {
    /// What is in it.
    pub heading: Text,
    /// Unit of all its figures; may be empty.
    pub unit: &'static str,
    /// Where its cells stand.
    pub align: Align,
    /// Where it is shown.
    pub shown: &'static [Medium],
}

/// Alignment of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// What explains the rest.
    Note,
    /// Intervals.
    Centre,
    /// Numbers.
    Right,
}

/// A row.
#[derive(Default)]
pub struct Row {
    /// From left to right.
    pub cells: Vec<Text>,
    /// The last cell goes over all columns that are left.
    pub spans: bool,
    /// How it is judged.
    pub tone: Tone,
}

/// The table of checks: verdict, figure, bound.
pub struct Checks {
    /// The checks, the weightiest first.
    pub checks: Vec<Check>,
    /// Whether what a board measured was measured by an emulator.
    pub emulated: bool,
    /// Names are keys, which have no capital letter.
    pub keys: bool,
}

/// One picture or several beside each other.
pub struct Picture {
    /// What is drawn.
    pub figures: Vec<Figure>,
    /// What is to be seen; may be empty.
    pub caption: Text,
    /// Name of a file beside the document that has the same picture, without its ending; may be empty.
    pub file: String,
}

/// A part that unfolds on a click.
pub struct Details {
    /// What it is.
    pub summary: Text,
    /// Shown from the start.
    pub open: bool,
    /// What it says.
    pub blocks: Vec<Block>,
}

/// A part that stands in pages only.
pub fn section(heading: impl Into<Text>, blocks: Vec<Block>) -> Block {
    Block::Section(Section { heading: heading.into(), blocks, ..Section::default() })
}

/// A part with the same heading everywhere.
pub fn section_everywhere(heading: impl Into<Text>, blocks: Vec<Block>) -> Block {
    let heading = heading.into();
    Block::Section(Section { line: Some(heading.clone()), heading, blocks, ..Section::default() })
}

/// A part whose heading a terminal leaves out.
pub fn section_bare(heading: impl Into<Text>, blocks: Vec<Block>) -> Block {
    Block::Section(Section { heading: heading.into(), line: Some(Text::default()), blocks, ..Section::default() })
}

/// What is good to know.
pub fn notice(text: Text) -> Block {
    Block::Notice(Notice { tone: Tone::Open, alert: false, text, more: Vec::new() })
}

/// What is bad.
pub fn bad_notice(text: Text) -> Block {
    Block::Notice(Notice { tone: Tone::Failed, alert: false, text, more: Vec::new() })
}

/// What is so bad that nothing else counts.
pub fn alert(text: Text) -> Block {
    Block::Notice(Notice { tone: Tone::Failed, alert: true, text, more: Vec::new() })
}

/// A key figure.
pub fn tile(name: impl Into<Text>, value: Text) -> Tile {
    Tile { name: name.into(), value }
}

/// A picture with what is to be seen in it.
pub fn picture(figure: Figure, caption: Text) -> Block {
    Block::Picture(Picture { figures: vec![figure], caption, file: String::new() })
}

/// Names and what belongs to them.
pub fn facts<N: Into<Text>, V: Into<Text>>(rows: impl IntoIterator<Item = (N, V)>) -> Block {
    Block::Facts(rows.into_iter().map(|(name, value)| (name.into(), value.into())).collect())
}

/// A table.
pub fn table(columns: Vec<Column>, rows: Vec<Row>) -> Block {
    Block::Table(Table { columns, rows, log: false })
}

/// A column of words.
pub fn words(heading: impl Into<Text>) -> Column {
    Column { heading: heading.into(), unit: "", align: Align::Left, shown: EVERYWHERE }
}

/// A column of numbers.
pub fn numbers(heading: impl Into<Text>) -> Column {
    Column { align: Align::Right, ..words(heading) }
}

/// A column that explains the others.
pub fn notes(heading: impl Into<Text>) -> Column {
    Column { align: Align::Note, ..words(heading) }
}

impl Table {
    /// Columns that are shown in a medium, each with its place.
    pub fn shown(&self, medium: Medium) -> Vec<(usize, &Column)> {
        self.columns.iter().enumerate().filter(|(_, column)| column.shown.contains(&medium)).collect()
    }

    /// Headings with their units, and rows with the cells that they have, as a medium writes text.
    pub fn texts(&self, medium: Medium, write: fn(&Text) -> String) -> (Vec<String>, Vec<Vec<String>>) {
        let shown = self.shown(medium);
        let heads = shown.iter().map(|(_, column)| match column.unit {
            "" => write(&column.heading),
            unit => format!("{} [{}]", write(&column.heading), write(&unit.into())),
        });
        let cells = |row: &Row| shown.iter().filter_map(|(index, _)| row.cells.get(*index)).map(write).collect();
        (heads.collect(), self.rows.iter().map(cells).collect())
    }
}

impl Align {
    /// A cell in its place within so many letters.
    pub fn placed(self, cell: &str, width: usize) -> String {
        match self {
            Self::Left | Self::Note => format!("{cell:<width$}"),
            Self::Centre => format!("{cell:^width$}"),
            Self::Right => format!("{cell:>width$}"),
        }
    }
}

impl Column {
    /// The same with a unit.
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// The same, but shown in these media only.
    pub fn only(self, shown: &'static [Medium]) -> Self {
        Self { shown, ..self }
    }

    /// The same with its cells elsewhere.
    pub fn aligned(self, align: Align) -> Self {
        Self { align, ..self }
    }
}

/// A row.
pub fn row<T: Into<Text>>(cells: impl IntoIterator<Item = T>) -> Row {
    Row { cells: cells.into_iter().map(Into::into).collect(), ..Row::default() }
}

/// The verdict that heads a report of checks: how many have failed, or that all have held.
pub fn verdict_of(failed: usize) -> (Tone, String) {
    match failed {
        0 => (Tone::Passed, "PASSED".into()),
        1 => (Tone::Failed, "1 CHECK FAILED".into()),
        many => (Tone::Failed, format!("{many} CHECKS FAILED")),
    }
}
