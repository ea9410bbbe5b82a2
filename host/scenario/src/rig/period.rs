//! Result of one control period, for the recorders of a run.

use live::Sample;
use reference::closed_loop::SetPoint;
use simulation::sim::live_view::true_sample;

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
    /// State for the live view, with the gap by the observer where it is valid.
    pub fn live_sample(&self) -> Sample {
        let gap = self.answer.map(|answer| answer.estimates.gap).filter(|gap| gap.valid);
        let estimated_gap = gap.map_or(f64::NAN, |gap| gap.value.into());
        let (joint, torques) = (self.plant.joint(), self.plant.torques());
        Sample { estimated_gap, ..true_sample(joint, &torques, self.half_backlash, self.wanted) }
    }

    /// Torque that brakes the link [N m].
    pub fn load_torque(&self) -> f64 {
        self.plant.torques().load()
    }
}
