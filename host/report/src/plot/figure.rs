//! A picture: panels one above the other over a common horizontal axis, as SVG text.

use plotters::prelude::*;

use super::canvas::{CommonAxis, Drawn, FINE, FOOT, HorizontalAxis, LEFT, NOTE, Shape, text_style};
use super::compact;
use super::ink::{self, Ink};
use super::panel::Panel;
use super::unit::Unit;
use crate::escape::{escaped, escaped_xml};

/// A picture.
pub struct Figure {
    /// Description for readers who cannot see the picture.
    pub title: String,
    /// Name of the common axis.
    pub axis: String,
    /// Unit of the common axis.
    pub unit: Unit,
    /// Range of the common axis in SI.
    pub range: (f64, f64),
    /// Scale of the common axis.
    pub runs: HorizontalAxis,
    /// Width of the picture.
    pub shape: Shape,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Line below the panels; may be empty.
    pub note: String,
}

impl Figure {
    /// Picture of default width over a linear axis, without a note.
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

    /// Picture over time.
    pub fn over_time(title: impl Into<String>, unit: Unit, range: (f64, f64), panels: Vec<Panel>) -> Self {
        Self::new(title, "time", unit, range, panels)
    }

    /// Axis that the panels share.
    fn common_axis(&self) -> CommonAxis<'_> {
        CommonAxis { name: &self.axis, unit: self.unit, range: self.range, runs: self.runs, shape: self.shape }
    }

    /// Picture as an SVG element whose colours are CSS variables.
    pub fn to_svg(&self) -> String {
        let height = self.panels.iter().map(|panel| panel.height).sum::<i32>()
            + FOOT
            + if self.note.is_empty() { 0 } else { NOTE };
        let mut svg = String::new();
        if let Err(error) = self.draw(&mut svg, height) {
            // Drawing into a string cannot fail; if it ever does, the rest of the report is still useful.
            return format!("<!-- not drawn: {} -->", error.to_string().replace("--", "-"));
        }
        let (width, height) = (self.shape.width * FINE, height * FINE);
        let plain = format!("<svg width=\"{width}\" height=\"{height}\"");
        let title = escaped_xml(&escaped(&self.title));
        // Default attributes of plotters make up half of a picture of many small parts.
        let svg = compact::compact(&svg.replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", ""));
        ink::with_variables(svg.replacen(&plain, &format!("<svg role=\"img\" aria-label=\"{title}\""), 1))
    }

    /// Picture as a separate SVG file.
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
            panel.draw(&top, &self.common_axis(), last)?;
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
