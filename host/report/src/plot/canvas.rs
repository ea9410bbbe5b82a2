//! What a picture and its panels share: the canvas with its sizes, and the common axis.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::ink::Ink;
use super::unit::Unit;

/// plotters places things on whole pixels: drawn this much larger and shown at size, nothing looks jagged.
pub const FINE: i32 = 4;
/// Width of a picture over the whole page [px].
const WIDTH: i32 = 1040;
/// Room for numbers and unit at the left of it [px].
pub const LEFT: i32 = 92;
/// Room at the right [px].
pub const RIGHT: i32 = 14;
/// Height of the numbers and the name of the common axis [px].
pub const FOOT: i32 = 32;
/// Height of a note below everything [px].
pub const NOTE: i32 = 28;

/// Where a panel is drawn.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Result of drawing into a string, which does not fail.
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

/// Linear or logarithmic common axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HorizontalAxis {
    /// Evenly.
    #[default]
    Linear,
    /// By powers of ten.
    Decades,
}

/// The axis that all panels of a picture have in common.
#[derive(Debug, Clone, Copy)]
pub struct CommonAxis<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its unit.
    pub unit: Unit,
    /// Its range in SI.
    pub range: (f64, f64),
    /// How it runs.
    pub runs: HorizontalAxis,
    /// How wide the picture is.
    pub shape: Shape,
}

impl CommonAxis<'_> {
    /// A value as it is drawn.
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
    // plotters takes the size of the em box, 1.24 times the size of the letters.
    let font = ("sans-serif", f64::from(size * FINE) * 1.24, style).into_font();
    TextStyle { color: ink.colour().to_backend_color(), ..TextStyle::from(font) }
}
