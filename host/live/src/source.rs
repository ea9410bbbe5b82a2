//! Sources of samples: a joint on a bus, or one run of a test.

use std::time::{SystemTime, UNIX_EPOCH};

/// Description of a source for viewers.
#[derive(Debug, Clone)]
pub struct Description {
    /// Identifier of the joint, part of its topic.
    pub id: u8,
    /// Name of the joint or run.
    pub name: String,
    /// Planets of the gear; 1 for an equivalent gear.
    pub planets: usize,
    /// Motor turns in a turn of the link.
    pub ratio: f64,
    /// Rated torque of the link [N m].
    pub rated_torque: f64,
}

/// Source of samples.
#[derive(Debug)]
pub struct Source {
    /// Description.
    pub description: Description,
    /// Number of the source since the view began; no two sources share it.
    pub number: u32,
    /// Start of the run as time since 1970 [s].
    pub epoch: f64,
}

impl Source {
    /// Source that starts now.
    pub fn starting(description: Description, number: u32) -> Self {
        let epoch = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64());
        Self { description, number, epoch }
    }
}
