//! Result of one control period, for the recorders of a run.

use reference::closed_loop::SetPoint;

use crate::faults::ControllerInputs;
use crate::plant::Plant;
use crate::port::Answer;

/// Result of one control period.
pub struct Period<'r> {
    /// Index in the run, from 0.
    pub index: u64,
    /// Start [s].
    pub time: f64,
    /// Plant at the end of the period.
    pub plant: &'r Plant,
    /// Desired link angle at the end of the period [rad].
    pub wanted: f64,
    /// Half-backlash during the period [m].
    pub half_backlash: f64,
    /// Inputs of the controller at the start of the period.
    pub seen: &'r ControllerInputs,
    /// Set-point of the controller.
    pub set_point: &'r SetPoint,
    /// Commanded motor torque [N m].
    pub command: f64,
    /// Answer of observer and compensation, if they control.
    pub answer: Option<&'r Answer>,
}

impl Period<'_> {
    /// Torque that brakes the link [N m].
    pub fn load_torque(&self) -> f64 {
        let torques = self.plant.torques();
        torques.load_friction + torques.gravity + torques.disturbance
    }
}
