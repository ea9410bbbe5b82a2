//! The closed loop of a joint on the host: a plant in its drive train, a reference motion, faults between plant and
//! controller, and a controller.
//!
//! A control period begins late by the drawn jitter of the loop; samples and set-points are taken at that time. Then
//! the teeth change by their faults; the set-point passes through its faults to the controller; the encoders are read
//! through their faults; the controller gives a torque; the motor applies the torque through its faults, and the plant
//! advances. Encoders are homed at the start of a run.

mod active_controller;
mod error;
mod period;
mod setup;
mod true_state;

pub use active_controller::ActiveController;
pub use error::RunError;
pub use period::Period;
pub use setup::Setup;
pub use true_state::TrueStateCompensation;

use model_core::gears::Kinematics;
use reference::closed_loop::SharedProfile;
use reference::drive_train::{Measurement, TrueTorques};
use reference::joint::Observation;

use super::faults::{ControllerInputs, HostFaults};
use super::file::Fault;
use super::plant::{Plant, plant_from};
use super::set_point_source::SetPointSource;
use report::failure::Outcome;

/// A joint in its drive train, with reference motion and faults, ready for a controller.
pub struct Rig {
    plant: Plant,
    faults: HostFaults,
    motion: SharedProfile,
    /// Control period [s].
    period: f64,
    /// Control periods of a run.
    periods: u64,
    /// Control periods that are over.
    index: u64,
}

/// Control period at its start.
pub struct BegunPeriod {
    /// Index in the run, from 0.
    pub index: u64,
    /// Start [s].
    pub time: f64,
    /// Inputs of the controller.
    pub seen: ControllerInputs,
    /// True state of the joint.
    pub joint: Observation,
    /// True torques of the period before.
    pub torques: TrueTorques,
}

/// Callback for every period, which may end the run.
pub type OnPeriod<'w> = &'w mut dyn FnMut(&Period<'_>) -> Result<(), RunError>;

impl Rig {
    /// Rig at rest before its first period.
    pub fn new(setup: &Setup) -> Outcome<Self> {
        let Setup { joint, train, .. } = setup;
        let rate = f64::from(train.surroundings.control_rate);
        let plant_at = |state| plant_from(setup.plant, joint, state, train, setup.disturbances.clone(), setup.seed);
        let plant = plant_at(&setup.start)?;
        let faults = HostFaults::new(&setup.faults, setup.seed, joint, train);
        let mounted = setup.mounting.as_ref().map(plant_at).transpose()?;
        let mounted = mounted.as_ref().unwrap_or(&plant).joint();
        let faults = faults.starting_at(plant.joint(), mounted, joint.geometry.ratio_by_teeth());
        Ok(Self {
            plant: plant.stepped(setup.stepping),
            faults,
            motion: setup.motion.clone(),
            period: 1.0 / rate,
            periods: (setup.duration * rate).round() as u64,
            index: 0,
        })
    }

    /// Control period [s].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Control periods in a run.
    pub fn periods(&self) -> u64 {
        self.periods
    }

    /// Current readings of the encoders from their own zeros; before a run they are the home positions.
    pub fn home(&self) -> Measurement {
        self.plant.measure()
    }

    /// Begins a control period: changes the teeth by their faults and reads the encoders through theirs. Set-points and
    /// samples are taken at the true start of the period, `BegunPeriod::time`.
    pub fn begin_period(&mut self) -> BegunPeriod {
        let Self { plant, faults, period, index, .. } = self;
        let time = *index as f64 * *period + plant.lateness();
        let joint = plant.joint().clone();
        faults.update_teeth(time, &joint, plant.joint_model().as_mut());
        let seen = faults.sense_late(&plant.measure(), plant.lateness());
        BegunPeriod { index: *index, time, seen, joint, torques: plant.torques() }
    }

    /// Ends a control period: the motor applies a torque [N m] through its faults, and the plant advances.
    pub fn end_period(&mut self, time: f64, command: f64) -> Result<(), RunError> {
        if !command.is_finite() {
            return Err(RunError::Broke(format!("the controller's torque is not finite at t = {time:.4} s")));
        }
        self.plant
            .advance(self.faults.torque(time, command))
            .map_err(|error| RunError::Broke(format!("the plant at t = {time:.4} s: {error}")))?;
        self.index += 1;
        Ok(())
    }

    /// Fails if the joint's motion is no longer finite.
    pub fn check_motion(&self, time: f64) -> Result<(), RunError> {
        let joint = self.plant.joint();
        if (joint.link_angle + joint.sun_force()).is_finite() {
            return Ok(());
        }
        Err(RunError::Broke(format!("the joint's motion is not finite at t = {time:.4} s")))
    }

    /// Sets a braking torque on the link in addition to the disturbances [N m].
    pub fn set_external_torque(&mut self, torque: f64) {
        self.plant.set_external_torque(torque);
    }

    /// Sets the half-backlash of the sound teeth [m].
    pub fn set_half_backlash(&mut self, half_backlash: f64) {
        self.faults.set_half_backlash(half_backlash);
    }

    /// Adds a fault during a run, with times of the run [s].
    pub fn inject(&mut self, fault: &Fault, seed: u64) {
        self.faults.inject(fault, seed);
    }

    /// Ends all faults at a time of the run [s]; counts that an encoder lost stay lost.
    pub fn end_faults(&mut self, time: f64) {
        self.faults.end_all(time);
    }

    /// Plant, at the end of the last period.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Current half-backlash of every mesh [m].
    pub fn half_backlash(&self) -> f64 {
        self.plant.width_scale() * self.faults.current_half_backlash()
    }

    /// Runs the loop from the first period to the last.
    pub fn run(
        mut self,
        controller: &mut ActiveController<'_>,
        set_points: &mut SetPointSource,
        on_period: OnPeriod<'_>,
    ) -> Result<(), RunError> {
        for _ in 0..self.periods {
            let BegunPeriod { index, time, seen, joint, torques } = self.begin_period();
            let (number, set_point) = set_points.at(time, index);
            let set_point = self.faults.receive(time, number, set_point);
            controller.set_true_state(&joint, &torques);
            let (command, answer) = controller.step(&seen, &set_point)?;
            self.end_period(time, command)?;
            on_period(&Period {
                index,
                time,
                plant: &self.plant,
                wanted: self.motion.at(self.plant.joint().time).position,
                half_backlash: self.half_backlash(),
                seen: &seen,
                set_point: &set_point,
                command,
                answer: answer.as_ref(),
            })?;
            self.check_motion(time)?;
        }
        Ok(())
    }
}
