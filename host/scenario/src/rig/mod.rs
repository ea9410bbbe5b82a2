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
mod recording;
mod setup;
mod true_state;

pub use active_controller::ActiveController;
pub use error::RunError;
pub use period::Period;
pub use recording::PeriodSample;
pub use setup::Setup;
pub use true_state::TrueStateCompensation;

use model_core::gears::Kinematics;
use reference::closed_loop::SharedProfile;
use reference::drive_train::Measurement;

use super::faults::HostFaults;
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
}

/// Callback for every period, which may end the run.
pub type OnPeriod<'w> = &'w mut dyn FnMut(&Period<'_>) -> Result<(), RunError>;

impl Rig {
    /// Rig at rest before its first period.
    pub fn new(setup: &Setup) -> Outcome<Self> {
        let Setup { joint, train, .. } = setup;
        let rate = f64::from(train.surroundings.control_rate);
        let plant = plant_from(setup.plant, joint, &setup.start, train, setup.disturbances.clone(), setup.seed)?;
        let faults = HostFaults::new(&setup.faults, setup.seed, joint, train);
        let faults = faults.starting_at(plant.joint().link_angle, joint.geometry.ratio_by_teeth());
        Ok(Self {
            plant: plant.stepped(setup.stepping),
            faults,
            motion: setup.motion.clone(),
            period: 1.0 / rate,
            periods: (setup.duration * rate).round() as u64,
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

    /// Runs the loop from the first period to the last.
    pub fn run(
        mut self,
        controller: &mut ActiveController<'_>,
        set_points: &mut SetPointSource,
        on_period: OnPeriod<'_>,
    ) -> Result<(), RunError> {
        let Self { plant, faults, motion, period, periods } = &mut self;
        for index in 0..*periods {
            // Set-points and samples are taken at the true start of the period.
            let time = index as f64 * *period + plant.lateness();
            let joint = plant.joint().clone();
            faults.update_teeth(time, &joint, plant.joint_model().as_mut());
            let (number, set_point) = set_points.at(time, index);
            let set_point = faults.receive(time, number, set_point);
            let seen = faults.sense_late(&plant.measure(), plant.lateness());
            controller.set_true_state(&joint, &plant.torques());
            let (command, answer) = controller.step(&seen, &set_point)?;
            if !command.is_finite() {
                return Err(RunError::Broke(format!("the controller's torque is not finite at t = {time:.4} s")));
            }
            plant
                .advance(faults.torque(time, command))
                .map_err(|error| RunError::Broke(format!("the plant at t = {time:.4} s: {error}")))?;
            let joint = plant.joint();
            on_period(&Period {
                index,
                time,
                plant,
                wanted: motion.at(joint.time).position,
                half_backlash: plant.width_scale() * faults.current_half_backlash(),
                seen: &seen,
                set_point: &set_point,
                command,
                answer: answer.as_ref(),
            })?;
            if !(joint.link_angle + joint.sun_force()).is_finite() {
                return Err(RunError::Broke(format!("the joint's motion is not finite at t = {time:.4} s")));
            }
        }
        Ok(())
    }

    /// Runs the loop and records measurements and truth.
    pub fn record(
        self,
        controller: &mut ActiveController<'_>,
        set_points: &mut SetPointSource,
    ) -> Result<Vec<PeriodSample>, RunError> {
        let mut moments = Vec::with_capacity(self.periods as usize);
        self.run(controller, set_points, &mut |period| {
            moments.push(PeriodSample::at_end_of(period));
            Ok(())
        })?;
        Ok(moments)
    }
}
