//! Pictures of a study, each with the name of its file. Their data is in the record.

mod axes;
mod dead_zone;
mod diagram;
mod picture;
mod regimes;
mod stiffness;

pub use axes::micrometres;
pub use diagram::diagram;
pub use picture::Picture;
pub use regimes::regime;

use super::record::StudyRecord;

/// Picture of Fig. 3.
pub fn stiffness(record: &StudyRecord) -> Picture {
    Picture { name: "figure-3-stiffness".into(), figure: stiffness::figure(&record.stiffness) }
}

/// Pictures of Figs 4 and 5.
pub fn dead_zone(record: &StudyRecord) -> [Picture; 2] {
    [
        Picture { name: "figure-4-dead-zone".into(), figure: dead_zone::curves(&record.dead_zone) },
        Picture { name: "figure-5-dead-zone-error".into(), figure: dead_zone::errors(&record.dead_zone) },
    ]
}
