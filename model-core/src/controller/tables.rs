//! Tables that a controller runs on.

use crate::compensation::CompensationTables;
use crate::numbers::Real;
use crate::observer::{ObserverTables, ProbeTable};

/// Tables of observer, width probe and compensation of one joint, computed offline in f64.
#[cfg_attr(feature = "design", doc = "[`ControllerDesign::new`] designs them.")]
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerDesign<T: Real = f32> {
    /// Table of the observer.
    pub observer: ObserverTables<T>,
    /// Table of the width probe, if it can be designed.
    pub probe: Option<ProbeTable<T>>,
    /// Table of the compensation.
    pub compensation: CompensationTables<T>,
}
