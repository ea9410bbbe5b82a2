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
    /// Title of the window and of the file.
    pub title: String,
    /// Heading of a page.
    pub heading: Text,
    /// Verdict beside the heading.
    pub verdict: Option<(Tone, String)>,
    /// True if an emulator measured the figures.
    pub emulated: bool,
    /// Subtitle of a page.
    pub subtitle: Text,
    /// First line on a terminal; may be empty.
    pub line: Text,
    /// Contents.
    pub blocks: Vec<Block>,
    /// Footer of a page.
    pub footer: Text,
}

/// Output medium of a document.
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
/// Pages only.
pub const PAGES: &[Medium] = &[Medium::Page];
/// Terminals only.
pub const TERMINALS: &[Medium] = &[Medium::Terminal];

/// A part of a document.
pub enum Block {
    /// A section with its own heading.
    Section(Section),
    /// A heading within a section.
    Heading(Text),
    /// Sentences.
    Paragraph(Text),
    /// Sentences that introduce a section.
    Lead(Text),
    /// Sentences that explain the block above.
    Note(Text),
    /// A notice at the top of a section.
    Notice(Notice),
    /// Key figures.
    Tiles(Vec<Tile>),
    /// Pairs of name and value.
    Facts(Vec<(Text, Text)>),
    /// Rows and columns.
    Table(Table),
    /// Table of checks.
    Checks(Checks),
    /// One or several pictures side by side, with a caption.
    Picture(Picture),
    /// Command that repeats the run.
    Again(String),
    /// List of sentences.
    List(Vec<Text>),
    /// A collapsible section.
    Details(Details),
    /// Blocks side by side, if there is room.
    Columns(Vec<Block>),
    /// Blocks for these media only.
    Only(&'static [Medium], Vec<Block>),
}

/// A section with its own heading.
#[derive(Default)]
pub struct Section {
    /// Heading.
    pub heading: Text,
    /// Anchor for links; may be empty.
    pub anchor: String,
    /// Verdict beside the heading.
    pub verdict: Option<(Tone, String)>,
    /// Text below the heading.
    pub subtitle: Text,
    /// First line on a terminal; `None` hides the section there.
    pub line: Option<Text>,
    /// Contents.
    pub blocks: Vec<Block>,
}

/// A notice at the top of a section. A strong word at its beginning states the kind.
pub struct Notice {
    /// Severity.
    pub tone: Tone,
    /// True if a screen reader should announce the notice at once.
    pub alert: bool,
    /// Text of the notice.
    pub text: Text,
    /// Further blocks.
    pub more: Vec<Block>,
}

/// A key figure.
pub struct Tile {
    /// Name.
    pub name: Text,
    /// Value.
    pub value: Text,
}

/// Rows and columns. Headings are omitted if all of them are empty.
#[derive(Default)]
pub struct Table {
    /// Columns from left to right.
    pub columns: Vec<Column>,
    /// Rows from top to bottom.
    pub rows: Vec<Row>,
    /// True for a log in a monospaced font.
    pub log: bool,
}

/// A column.
pub struct Column {
    /// Heading.
    pub heading: Text,
    /// Unit of all its figures; may be empty.
    pub unit: &'static str,
    /// Alignment of its cells.
    pub align: Align,
    /// Media that show the column.
    pub shown: &'static [Medium],
}

/// Alignment of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Explanations.
    Note,
    /// Intervals.
    Centre,
    /// Numbers.
    Right,
}

/// A row.
#[derive(Default)]
pub struct Row {
    /// Cells from left to right.
    pub cells: Vec<Text>,
    /// The last cell spans all remaining columns.
    pub spans: bool,
    /// Verdict colour of the row.
    pub tone: Tone,
}

/// Table of checks: verdict, figure, bound.
pub struct Checks {
    /// Checks, the most important first.
    pub checks: Vec<Check>,
    /// True if the board is emulated.
    pub emulated: bool,
    /// True if names are keys, which are not capitalized.
    pub keys: bool,
}

/// One or several pictures side by side.
pub struct Picture {
    /// Pictures.
    pub figures: Vec<Figure>,
    /// Caption; may be empty.
    pub caption: Text,
    /// Name, without extension, of an SVG file beside the document with the picture; may be empty.
    pub file: String,
}

/// A collapsible section.
pub struct Details {
    /// Summary line.
    pub summary: Text,
    /// True if open at first.
    pub open: bool,
    /// Contents.
    pub blocks: Vec<Block>,
}

/// Section on pages only.
pub fn section(heading: impl Into<Text>, blocks: Vec<Block>) -> Block {
    Block::Section(Section { heading: heading.into(), blocks, ..Section::default() })
}

/// Section with a heading on all media.
pub fn section_everywhere(heading: impl Into<Text>, blocks: Vec<Block>) -> Block {
    let heading = heading.into();
    Block::Section(Section { line: Some(heading.clone()), heading, blocks, ..Section::default() })
}

/// Section whose heading a terminal omits.
pub fn section_bare(heading: impl Into<Text>, blocks: Vec<Block>) -> Block {
    Block::Section(Section { heading: heading.into(), line: Some(Text::default()), blocks, ..Section::default() })
}

/// Neutral notice.
pub fn notice(text: Text) -> Block {
    Block::Notice(Notice { tone: Tone::Open, alert: false, text, more: Vec::new() })
}

/// Notice of a failure.
pub fn bad_notice(text: Text) -> Block {
    Block::Notice(Notice { tone: Tone::Failed, alert: false, text, more: Vec::new() })
}

/// Notice of a failure that invalidates the rest.
pub fn alert(text: Text) -> Block {
    Block::Notice(Notice { tone: Tone::Failed, alert: true, text, more: Vec::new() })
}

/// Key figure.
pub fn tile(name: impl Into<Text>, value: Text) -> Tile {
    Tile { name: name.into(), value }
}

/// Picture with a caption.
pub fn picture(figure: Figure, caption: Text) -> Block {
    Block::Picture(Picture { figures: vec![figure], caption, file: String::new() })
}

/// Pairs of name and value.
pub fn facts<N: Into<Text>, V: Into<Text>>(rows: impl IntoIterator<Item = (N, V)>) -> Block {
    Block::Facts(rows.into_iter().map(|(name, value)| (name.into(), value.into())).collect())
}

/// Table.
pub fn table(columns: Vec<Column>, rows: Vec<Row>) -> Block {
    Block::Table(Table { columns, rows, log: false })
}

/// Column of words.
pub fn words(heading: impl Into<Text>) -> Column {
    Column { heading: heading.into(), unit: "", align: Align::Left, shown: EVERYWHERE }
}

/// Column of numbers.
pub fn numbers(heading: impl Into<Text>) -> Column {
    Column { align: Align::Right, ..words(heading) }
}

/// Column of explanations.
pub fn notes(heading: impl Into<Text>) -> Column {
    Column { align: Align::Note, ..words(heading) }
}

impl Table {
    /// Columns that a medium shows, with their indices.
    pub fn shown(&self, medium: Medium) -> Vec<(usize, &Column)> {
        self.columns.iter().enumerate().filter(|(_, column)| column.shown.contains(&medium)).collect()
    }

    /// Headings with units, and the cells of each row, as text of a medium.
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
    /// Aligns a cell within a width in characters.
    pub fn placed(self, cell: &str, width: usize) -> String {
        match self {
            Self::Left | Self::Note => format!("{cell:<width$}"),
            Self::Centre => format!("{cell:^width$}"),
            Self::Right => format!("{cell:>width$}"),
        }
    }
}

impl Column {
    /// Sets the unit.
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Limits the column to the given media.
    pub fn only(self, shown: &'static [Medium]) -> Self {
        Self { shown, ..self }
    }

    /// Sets the alignment.
    pub fn aligned(self, align: Align) -> Self {
        Self { align, ..self }
    }
}

/// Row.
pub fn row<T: Into<Text>>(cells: impl IntoIterator<Item = T>) -> Row {
    Row { cells: cells.into_iter().map(Into::into).collect(), ..Row::default() }
}

/// Verdict of a report by the number of failed checks.
pub fn verdict_of(failed: usize) -> (Tone, String) {
    match failed {
        0 => (Tone::Passed, "PASSED".into()),
        1 => (Tone::Failed, "1 CHECK FAILED".into()),
        many => (Tone::Failed, format!("{many} CHECKS FAILED")),
    }
}
