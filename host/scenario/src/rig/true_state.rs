//! Compensation fed with the true state in place of an observer's estimates: an upper bound of its performance. Only
//! tests use it; no test file names it.

use model_core::compensation::{Compensation, CompensationTables};
use model_core::gears::Kinematics;
use model_core::observer::{Estimate, Estimates, Shaft, Source};
use parameters::{ContactState, JointParameters};
use reference::closed_loop::SetPoint;
use reference::drive_train::TrueTorques;
use reference::joint::{Observation, mean_half_backlash};

use crate::port::{command, position};

/// Share of the half-gap above which a gap coordinate counts as contact [-]: meshes deflect by a few percent of the gap
/// under load.
const TOUCHING: f64 = 0.98;

/// A compensation fed with the true state of a joint.
#[derive(Debug)]
pub struct TrueStateCompensation<'t> {
    compensation: Compensation<'t, f64>,
    estimates: Estimates<f64>,
    half_backlash: f64,
    /// Compliance between carrier and link [rad/(N m)].
    compliance: f64,
    /// Base radius of the carrier [m].
    lever: f64,
    /// Motor turns in a turn of the link.
    ratio: f64,
}

impl<'t> TrueStateCompensation<'t> {
    /// Compensation for a true joint.
    pub fn new(tables: &'t CompensationTables<f64>, joint: &JointParameters) -> Self {
        Self {
            compensation: Compensation::new(tables),
            estimates: Estimates::default(),
            half_backlash: mean_half_backlash(joint),
            compliance: joint.compliance.map_or(0.0, |compliance| 1.0 / compliance.stiffness),
            lever: joint.geometry.carrier_base_radius(),
            ratio: joint.geometry.ratio_by_teeth(),
        }
    }

    /// Sets the estimates to the true values, with zero variance.
    pub fn set_true_state(&mut self, joint: &Observation, torques: &TrueTorques) {
        let exact = |value: f64| Estimate { value, variance: 0.0, valid: true };
        let near = TOUCHING * 2.0 * self.half_backlash;
        let contact = if joint.gap > near {
            ContactState::DriveSide
        } else if joint.gap < -near {
            ContactState::BackSide
        } else {
            ContactState::Separated
        };
        self.estimates = Estimates {
            source: Source::Both,
            gap: exact(joint.gap),
            gap_rate: joint.gap_rate,
            contact,
            reported_contact: contact,
            contact_valid: true,
            settled: contact != ContactState::Separated,
            mesh_torque: exact(2.0 * self.lever * joint.sun_force()),
            load_torque: exact(torques.load()),
            half_backlash: exact(self.half_backlash),
            compliance: exact(self.compliance),
            motor_lead: joint.motor_angle / self.ratio - joint.link_angle,
            motor: shaft(joint.motor_angle, joint.motor_speed),
            link: shaft(joint.link_angle, joint.link_speed),
            ..Estimates::default()
        };
    }

    /// Torque for the period that begins [N m].
    pub fn step(&mut self, set_point: &SetPoint) -> f64 {
        self.compensation.step(&self.estimates, &command(set_point, 0.0)).torque
    }
}

fn shaft(angle: f64, speed: f64) -> Shaft<f64> {
    let of = position(angle, 0.0);
    Shaft { turns: of.turns, fraction: of.fraction, speed }
}
