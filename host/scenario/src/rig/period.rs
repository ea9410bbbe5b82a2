//! The result of one control period, as shown to those who record a run.

use reference::closed_loop::SetPoint;

use crate::faults::ControllerInputs;
use crate::plant::Plant;
use crate::port::Answer;

/// The result of one control period.
pub struct Period<'r> {
    /// Place in the run, from 0.
    pub index: u64,
    /// When it began [s].
    pub time: f64,
    /// The plant at its end.
    pub plant: &'r Plant,
    /// Where the link was to be at its end [rad].
    pub wanted: f64,
    /// Half-backlash during it [m].
    pub half_backlash: f64,
    /// What the controller was shown at its beginning.
    pub seen: &'r ControllerInputs,
    /// What the controller was asked for.
    pub set_point: &'r SetPoint,
    /// Torque asked of the motor [N m].
    pub command: f64,
    /// The answer of observer and compensation, if they control.
    pub answer: Option<&'r Answer>,
}

impl Period<'_> {
    /// What brakes the link [N m].
    pub fn load_torque(&self) -> f64 {
        let torques = self.plant.torques();
        torques.load_friction + torques.gravity + torques.disturbance
    }
}
