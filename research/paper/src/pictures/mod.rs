//! The pictures of a study, each with the name of its file. What they show is in the record; how a panel is drawn is
//! `report::plot`'s business.

mod dead_zone;
mod diagram;
mod regimes;
mod stiffness;

pub use diagram::diagram;
pub use regimes::regime;

use super::record::StudyRecord;
use report::number::PAGE;
use report::plot::Figure;
use report::plot::unit::Unit;

/// A picture.
pub struct Picture {
    /// File name without its ending.
    pub name: String,
    /// What is drawn.
    pub figure: Figure,
}

/// A number without unit; the name is what stands at the axis.
const fn plain(name: &'static str) -> Unit {
    Unit { factor: 1.0, name }
}

/// Points of two columns.
fn points(across: &[f64], up: &[f64]) -> Vec<(f64, f64)> {
    across.iter().copied().zip(up.iter().copied()).collect()
}

/// b in micrometres, without the noise of the way to metres and back.
pub fn micrometres(length: f64) -> String {
    PAGE.write((length * 1e9).round() / 1e3)
}

/// Fig. 3.
pub fn stiffness(record: &StudyRecord) -> Picture {
    Picture { name: "figure-3-stiffness".into(), figure: stiffness::figure(&record.stiffness) }
}

/// Figs 4 and 5.
pub fn dead_zone(record: &StudyRecord) -> [Picture; 2] {
    [
        Picture { name: "figure-4-dead-zone".into(), figure: dead_zone::curves(&record.dead_zone) },
        Picture { name: "figure-5-dead-zone-error".into(), figure: dead_zone::errors(&record.dead_zone) },
    ]
}
