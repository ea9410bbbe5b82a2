//! Findings of the inertias, as a check of the joint file.

use super::finding::{Finding, finding};
use crate::estimate::Estimate;
use crate::prior::PriorModel;
use crate::scales::{Scale, Scales};

/// Inertias that turn with the motor and with the link. The joint file states parts of them, so they are not written to
/// it.
pub(super) fn inertias(scales: &Scales, prior: &PriorModel) -> [Finding; 2] {
    let of = |name: &str, inertia: f64, scale: Scale| {
        let estimate = Estimate { value: inertia, half: inertia * scale.half() };
        let found = finding(name, "kg m^2", "", estimate);
        if scale.differs_from_stated() {
            let share = 100.0 * (scale.factor() - 1.0);
            found.with_note(format!("{share:+.1} % of the joint file's, which the torque contradicts"))
        } else {
            found.with_note("as expected of the joint file's").unchanged()
        }
    };
    [
        of("inertia that turns with the motor", prior.motor_inertia, scales.motor_inertia),
        of("inertia that turns with the link", prior.link_inertia, scales.link_inertia),
    ]
}
