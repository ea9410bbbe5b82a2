//! The drive train around the joint: motor with current loop, frictions, gravity, efficiency, encoders, disturbances,
//! advanced one control period at a time with the reference inside. Controllers and observers are what it is there to
//! test, so there is none in it.
//!
//! Within a control period time is cut into `parts_per_period` equal parts (10 us for Q1). Over each part every torque
//! is held at its value from the angles and speeds at the part's beginning, friction so that it sticks instead of
//! chattering; the joint itself moves by the reference's own adaptive steps. All randomness comes from one seed.
//!
//! Losses that grow with the load sit at the sun: dry friction of (1/efficiency - 1) times the torque that the
//! sun-planet meshes carry while the motor drives, and (1 - efficiency) times it while the load drives.

mod current_loop;
mod disturbance;
mod encoder;
mod friction;
mod joint_model;
mod parameters;

use std::f64::consts::TAU;

use ::parameters::JointParameters;
use current_loop::CurrentLoop;
pub use disturbance::Disturbance;
use encoder::Encoder;
use friction::Shaft;
pub use joint_model::{JointModel, Stepping};
pub use parameters::{DriveTrainError, DriveTrainParameters, ErrorPhases};

use crate::joint::{Observation, Reference, Start};

/// What a controller is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Measurement {
    /// Control periods since the start.
    pub period: u64,
    /// Motor encoder, whole turns included.
    pub motor_counts: i64,
    /// Output encoder, whole turns included.
    pub output_counts: i64,
}

impl Measurement {
    /// The same with counts from where the encoders were homed.
    pub fn homed(self, home: &Self) -> Self {
        Self {
            motor_counts: self.motor_counts - home.motor_counts,
            output_counts: self.output_counts - home.output_counts,
            ..self
        }
    }
}

/// What no controller is given: the torques of the last part of time [N m].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrueTorques {
    /// In the motor's air gap.
    pub air_gap: f64,
    /// Cogging, driving.
    pub cogging: f64,
    /// Friction at the motor with the gears' load-dependent losses, braking.
    pub motor_friction: f64,
    /// Friction at the link, braking.
    pub load_friction: f64,
    /// Weight of the link, braking.
    pub gravity: f64,
    /// Sum of the disturbances, braking.
    pub disturbance: f64,
}

/// A joint with everything around it; `J` is the joint model.
#[derive(Debug, Clone)]
pub struct DriveTrain<J = Reference> {
    parameters: DriveTrainParameters,
    disturbances: Vec<Disturbance>,
    joint_model: J,
    /// State of the joint at the end of the last part.
    joint: Observation,
    current_loop: CurrentLoop,
    motor_encoder: Encoder,
    output_encoder: Encoder,
    torques: TrueTorques,
    parts_done: u64,
    part: f64,
    delay_parts: u64,
    sun_radius: f64,
    carrier_lever: f64,
    motor_inertia: f64,
    load_inertia: f64,
    compliant: bool,
    stepping: Stepping,
}

impl DriveTrain {
    /// A drive train around the reference at time zero.
    pub fn new(
        joint: &JointParameters,
        start: &Start,
        parameters: DriveTrainParameters,
        disturbances: Vec<Disturbance>,
        seed: u64,
    ) -> Result<Self, DriveTrainError> {
        parameters.check()?;
        Self::around(Reference::start(joint, start)?, joint, parameters, disturbances, seed)
    }
}

impl<J: JointModel> DriveTrain<J> {
    /// A drive train around a joint that is at time zero.
    pub fn around(
        joint_model: J,
        joint: &JointParameters,
        parameters: DriveTrainParameters,
        disturbances: Vec<Disturbance>,
        seed: u64,
    ) -> Result<Self, DriveTrainError> {
        parameters.check()?;
        let observation = joint_model.observe();
        let around = &parameters.surroundings;
        let part = 1.0 / (f64::from(around.control_rate) * f64::from(parameters.parts_per_period));
        let sun_radius = joint.geometry.sun_base_radius;
        let carrier_lever = joint.geometry.carrier_radius * joint.geometry.working_pressure_angle.cos();
        let carrier_inertia = joint.bodies.carrier_inertia_over_radius_squared * joint.geometry.carrier_radius.powi(2)
            + joint.geometry.planets as f64 * joint.bodies.planet_mass * joint.geometry.carrier_radius.powi(2);
        let compliant = joint.compliance.is_some();
        let mut train = Self {
            disturbances,
            current_loop: CurrentLoop::new(*around, part, seed),
            motor_encoder: Encoder::new(around.motor_encoder, parameters.motor_error_phases),
            output_encoder: Encoder::new(around.output_encoder, parameters.output_error_phases),
            torques: TrueTorques::default(),
            parts_done: 0,
            part,
            delay_parts: (around.delay * f64::from(parameters.parts_per_period)).round() as u64,
            sun_radius,
            carrier_lever,
            motor_inertia: joint.rotor_inertia + joint.bodies.sun_equivalent_mass * sun_radius.powi(2),
            load_inertia: joint.link_inertia + if compliant { 0.0 } else { carrier_inertia },
            compliant,
            stepping: Stepping::default(),
            parameters,
            joint_model,
            joint: observation,
        };
        train.note();
        Ok(train)
    }

    /// The same drive train, its joint stepped as stated.
    pub fn stepped(self, stepping: Stepping) -> Self {
        Self { stepping, ..self }
    }

    /// Moves on by one control period under a torque command [N m].
    pub fn advance(&mut self, command: f64) -> Result<(), DriveTrainError> {
        self.current_loop.command(command, self.parts_done + self.delay_parts);
        for _ in 0..self.parameters.parts_per_period {
            self.torques = self.torques_now();
            let drive = self.torques.air_gap + self.torques.cogging - self.torques.motor_friction;
            let load = self.torques.load_friction + self.torques.gravity + self.torques.disturbance;
            self.parts_done += 1;
            let end = self.parts_done as f64 * self.part;
            self.joint_model.advance(end, drive, load, self.stepping)?;
            self.joint = self.joint_model.observe();
            self.note();
        }
        Ok(())
    }

    /// What a controller is given now.
    pub fn measure(&self) -> Measurement {
        Measurement {
            period: self.parts_done / u64::from(self.parameters.parts_per_period),
            motor_counts: self.motor_encoder.counts(),
            output_counts: self.output_encoder.counts(),
        }
    }

    /// The joint as it truly is now.
    pub fn joint(&self) -> &Observation {
        &self.joint
    }

    /// The joint model, for tests that change it during a run.
    pub fn joint_model(&mut self) -> &mut J {
        &mut self.joint_model
    }

    /// Torques of the last part of time.
    pub fn torques(&self) -> TrueTorques {
        self.torques
    }

    fn torques_now(&mut self) -> TrueTorques {
        let joint = &self.joint;
        let around = &self.parameters.surroundings;
        let air_gap = self.current_loop.torque(self.parts_done);
        let cogging_angle = f64::from(around.cogging_periods_per_turn)
            * (joint.motor_angle + 0.5 * self.part * joint.motor_speed).rem_euclid(TAU);
        let cogging = around.cogging_torque * cogging_angle.sin();
        let transmitted = joint.sun_force() * self.sun_radius;
        let driving = transmitted * joint.motor_speed >= 0.0;
        let efficiency = around.efficiency;
        let loss = transmitted.abs() * if driving { 1.0 / efficiency - 1.0 } else { 1.0 - efficiency };
        let motor = Shaft {
            speed: joint.motor_speed,
            driving_torque: air_gap + cogging - transmitted,
            inertia: self.motor_inertia,
            part: self.part,
        };

        let gravity = around.gravity_torque * joint.link_angle.sin();
        // The middle of the part stands for the whole of it.
        let middle = (self.parts_done as f64 + 0.5) * self.part;
        let disturbance = self.disturbances.iter().map(|disturbance| disturbance.torque(middle)).sum::<f64>();
        let from_gears = if self.compliant {
            joint.wind_up_torque
        } else {
            joint.mesh_forces.iter().flatten().sum::<f64>() * self.carrier_lever
        };
        let load = Shaft {
            speed: joint.link_speed,
            driving_torque: from_gears - gravity - disturbance,
            inertia: self.load_inertia,
            part: self.part,
        };
        TrueTorques {
            air_gap,
            cogging,
            motor_friction: motor.friction(&around.motor_friction, loss),
            load_friction: load.friction(&around.load_friction, 0.0),
            gravity,
            disturbance,
        }
    }

    fn note(&mut self) {
        let joint = &self.joint;
        self.motor_encoder.note(joint.time, joint.motor_angle, joint.motor_speed);
        self.output_encoder.note(joint.time, joint.link_angle, joint.link_speed);
    }
}
