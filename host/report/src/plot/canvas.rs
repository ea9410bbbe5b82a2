//! Common parts of a picture and its panels: canvas, sizes, and the common axis.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::ink::Ink;
use super::unit::Unit;

/// Scale of the drawing: plotters uses whole pixels, so pictures are drawn enlarged and shown at their size.
pub const FINE: i32 = 4;
/// Default width of a picture [px].
const WIDTH: i32 = 1040;
/// Space for numbers and unit at the left [px].
pub const LEFT: i32 = 92;
/// Space at the right [px].
pub const RIGHT: i32 = 14;
/// Height of the numbers and the name of the common axis [px].
pub const FOOT: i32 = 32;
/// Height of a note below the panels [px].
pub const NOTE: i32 = 28;

/// Drawing area of a panel.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Result of drawing into a string, which does not fail.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Width of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Width [px].
    pub width: i32,
    /// Space for numbers and unit at the left [px].
    pub left: i32,
}

impl Default for Shape {
    /// Full width of a page.
    fn default() -> Self {
        Self { width: WIDTH, left: LEFT }
    }
}

/// Scale of the common axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HorizontalAxis {
    /// Linear.
    #[default]
    Linear,
    /// Logarithmic.
    Decades,
}

/// Axis that all panels of a picture share.
#[derive(Debug, Clone, Copy)]
pub struct CommonAxis<'a> {
    /// Name.
    pub name: &'a str,
    /// Unit.
    pub unit: Unit,
    /// Range in SI.
    pub range: (f64, f64),
    /// Scale.
    pub runs: HorizontalAxis,
    /// Width of the picture.
    pub shape: Shape,
}

impl CommonAxis<'_> {
    /// Position of a value on the axis.
    pub fn across(&self, value: f64) -> f64 {
        let value = value * self.unit.factor;
        match self.runs {
            HorizontalAxis::Linear => value,
            HorizontalAxis::Decades => value.max(f64::MIN_POSITIVE).log10(),
        }
    }
}

/// Text of a size [px] in a colour.
pub fn text_style(size: i32, ink: Ink, style: FontStyle) -> TextStyle<'static> {
    // plotters takes the size of the em box, 1.24 times that of the letters.
    let font = ("sans-serif", f64::from(size * FINE) * 1.24, style).into_font();
    TextStyle { color: ink.colour().to_backend_color(), ..TextStyle::from(font) }
}
