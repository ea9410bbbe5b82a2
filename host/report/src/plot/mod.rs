//! Pictures as SVG text: panels one above the other over a common horizontal axis, drawn by `plotters`. Which lines go
//! into which panel is decided by those who have something to show.

mod compact;
pub mod ink;
pub mod mark;
pub mod panel;
mod thin;
pub mod unit;

use ink::Ink;
use panel::Panel;
use plotters::coord::Shift;
use plotters::prelude::*;
use unit::Unit;

/// plotters places things on whole pixels: drawn this much larger and shown at size, nothing looks jagged.
pub const FINE: i32 = 4;
/// Width of a picture over the whole page [px].
const WIDTH: i32 = 1040;
/// Room for numbers and unit at the left of it [px].
const LEFT: i32 = 92;
/// Room at the right [px].
pub const RIGHT: i32 = 14;
/// Height of the numbers and the name of the common axis [px].
const FOOT: i32 = 32;
/// Height of a note below everything [px].
const NOTE: i32 = 28;

/// Where a panel is drawn.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// What drawing into a string may say; it never does.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// How wide a picture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Width [px].
    pub width: i32,
    /// Room for numbers and unit at the left [px].
    pub left: i32,
}

impl Default for Shape {
    /// Over the whole page.
    fn default() -> Self {
        Self { width: WIDTH, left: LEFT }
    }
}

/// How the common axis runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HorizontalAxis {
    /// Evenly.
    #[default]
    Linear,
    /// By powers of ten.
    Decades,
}

/// A picture.
pub struct Figure {
    /// What it shows, for readers that cannot see it.
    pub title: String,
    /// Name of the common axis.
    pub axis: String,
    /// Unit of the common axis.
    pub unit: Unit,
    /// Its range in SI.
    pub range: (f64, f64),
    /// How it runs.
    pub runs: HorizontalAxis,
    /// How wide the picture is.
    pub shape: Shape,
    /// From top to bottom.
    pub panels: Vec<Panel>,
    /// A line below everything; may be empty.
    pub note: String,
}

impl Figure {
    /// Over the whole page and an even axis, without a note.
    pub fn new(
        title: impl Into<String>,
        axis: impl Into<String>,
        unit: Unit,
        range: (f64, f64),
        panels: Vec<Panel>,
    ) -> Self {
        Self {
            title: title.into(),
            axis: axis.into(),
            unit,
            range,
            runs: HorizontalAxis::Linear,
            shape: Shape::default(),
            panels,
            note: String::new(),
        }
    }

    /// The same over time.
    pub fn over_time(title: impl Into<String>, unit: Unit, range: (f64, f64), panels: Vec<Panel>) -> Self {
        Self::new(title, "time", unit, range, panels)
    }

    /// A value of the common axis as it is drawn.
    fn across(&self, value: f64) -> f64 {
        let value = value * self.unit.factor;
        match self.runs {
            HorizontalAxis::Linear => value,
            HorizontalAxis::Decades => value.max(f64::MIN_POSITIVE).log10(),
        }
    }

    /// The picture as an SVG element whose colours are CSS variables.
    pub fn to_svg(&self) -> String {
        let height = self.panels.iter().map(|panel| panel.height).sum::<i32>()
            + FOOT
            + if self.note.is_empty() { 0 } else { NOTE };
        let mut svg = String::new();
        if let Err(error) = self.draw(&mut svg, height) {
            // Drawing into a string has nothing to fail on; should it ever, the rest of the report is worth having.
            return format!("<!-- not drawn: {} -->", error.to_string().replace("--", "-"));
        }
        let (width, height) = (self.shape.width * FINE, height * FINE);
        let plain = format!("<svg width=\"{width}\" height=\"{height}\"");
        let title = self.title.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
        // What plotters says though it is the default anyway makes up half of a picture of many small parts.
        let svg = compact::compact(&svg.replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", ""));
        ink::with_variables(svg.replacen(&plain, &format!("<svg role=\"img\" aria-label=\"{title}\""), 1))
    }

    /// The picture as a file of its own.
    pub fn to_file(&self) -> String {
        let svg = self.to_svg();
        let style = format!(
            "<style>\n{}svg{{font-family:system-ui,sans-serif;background:#fff}}\n\
             @media screen and (prefers-color-scheme:dark){{svg{{background:#12171e}}}}\n\
             rect{{shape-rendering:crispEdges}}polyline{{stroke-linejoin:round}}\n</style>\n",
            ink::style_sheet("svg")
        );
        match svg.split_once('\n') {
            Some((open, rest)) => format!("{open}\n{style}{rest}"),
            None => svg,
        }
    }

    fn draw(&self, svg: &mut String, height: i32) -> Drawn {
        let size = ((self.shape.width * FINE) as u32, (height * FINE) as u32);
        let mut rest = SVGBackend::with_string(svg, size).into_drawing_area();
        for (index, panel) in self.panels.iter().enumerate() {
            let last = index + 1 == self.panels.len();
            let own = panel.height + if last { FOOT } else { 0 };
            let (top, below) = rest.split_vertically(own * FINE);
            panel.draw(&top, self, last)?;
            rest = below;
        }
        let style = text_style(11, Ink::Muted, FontStyle::Normal);
        if !self.note.is_empty() {
            rest.draw(&Text::new(self.note.clone(), (LEFT * FINE, 8 * FINE), style))?;
        }
        rest.present()?;
        Ok(())
    }
}

/// Text of a size [px] in a colour.
pub fn text_style(size: i32, ink: Ink, style: FontStyle) -> TextStyle<'static> {
    // plotters takes the size of the em box, 1.24 times the size of the letters.
    let font = ("sans-serif", f64::from(size * FINE) * 1.24, style).into_font();
    TextStyle { color: ink.colour().to_backend_color(), ..TextStyle::from(font) }
}
