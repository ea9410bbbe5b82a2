//! A picture: panels one above the other over a common horizontal axis, as SVG text.

use plotters::prelude::*;

use super::canvas::{CommonAxis, Drawn, FINE, FOOT, HorizontalAxis, LEFT, NOTE, Shape, text_style};
use super::compact;
use super::ink::{self, Ink};
use super::panel::Panel;
use super::unit::Unit;
use crate::escape::escaped;

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

    /// The axis that its panels have in common.
    fn common_axis(&self) -> CommonAxis<'_> {
        CommonAxis { name: &self.axis, unit: self.unit, range: self.range, runs: self.runs, shape: self.shape }
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
        let title = escaped(&self.title).replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
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
