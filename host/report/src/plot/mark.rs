//! Marks of a panel: lines, points, bands, limits and boxes, with their legend entries. Values are in SI; `panel`
//! scales and draws them.

use super::ink::Ink;

/// A mark in a panel.
pub enum Mark {
    /// A line through points.
    Line {
        /// Points, SI.
        points: Vec<(f64, f64)>,
        /// Colour.
        ink: Ink,
        /// Entry in the legend; may be empty.
        label: String,
        /// Width [px].
        width: f64,
    },
    /// Separate points.
    Points {
        /// Points, SI.
        points: Vec<(f64, f64)>,
        /// Colour.
        ink: Ink,
        /// Entry in the legend; may be empty.
        label: String,
        /// Width of a point [px].
        size: f64,
    },
    /// A horizontal band.
    Band {
        /// Lower and upper end, SI.
        range: (f64, f64),
        /// Entry in the legend.
        label: String,
    },
    /// A vertical limit.
    Deadline {
        /// Position on the common axis, SI.
        at: f64,
        /// Entry in the legend.
        label: String,
    },
    /// Filled rectangles: left, right, bottom, top.
    Boxes {
        /// Rectangles, SI.
        boxes: Vec<[f64; 4]>,
        /// Colour.
        ink: Ink,
        /// Entry in the legend.
        label: String,
    },
}

impl Mark {
    /// Line.
    pub fn line(points: Vec<(f64, f64)>, ink: Ink, label: impl Into<String>, width: f64) -> Self {
        Self::Line { points, ink, label: label.into(), width }
    }

    /// Legend entry with its colour.
    pub fn label(&self) -> (&str, Ink) {
        match self {
            Self::Line { label, ink, .. } | Self::Points { label, ink, .. } | Self::Boxes { label, ink, .. } => {
                (label, *ink)
            }
            Self::Band { label, .. } => (label, Ink::Band),
            Self::Deadline { label, .. } => (label, Ink::Limit),
        }
    }

    /// Vertical values of the mark.
    pub fn values(&self) -> Box<dyn Iterator<Item = f64> + '_> {
        match self {
            Self::Line { points, .. } | Self::Points { points, .. } => Box::new(points.iter().map(|point| point.1)),
            Self::Band { range, .. } => Box::new([range.0, range.1].into_iter()),
            Self::Boxes { boxes, .. } => Box::new(boxes.iter().flat_map(|b| [b[2], b[3]])),
            Self::Deadline { .. } => Box::new(std::iter::empty()),
        }
    }
}
