//! Drive train around the reference joint: motor with current loop, frictions, gravity, efficiency, encoders,
//! disturbances; advanced by one control period at a time. It contains no controller and no observer, since it serves
//! to test them.
//!
//! A control period is divided into `parts_per_period` equal parts (10 us for Q1). In each part every torque is
//! constant, computed from angles and speeds at the start of the part; friction sticks instead of chattering. The joint
//! moves by the reference's adaptive steps. All randomness comes from one seed.
//!
//! Varying backlash and dry friction are updated at the start of each control period. With time t, angles of link and
//! motor, amplitudes a and phases p of the two variations, the half-backlash of every mesh is
//!
//! ```text
//! b max(0, 1 + drift t) (1 + a_l sin(theta_l + p_l) + a_m sin(theta_m + p_m))   (W1)
//! ```
//!
//! Both dry frictions are multiplied by max(0, 1 + drift t). Control period k begins at (k + j u_k) T with period T,
//! jitter j and u_k uniformly distributed in 0 to 1; the first period begins at 0.
//!
//! Load-dependent losses act at the sun as dry friction: (1/efficiency - 1) times the torque of the sun-planet meshes
//! while the motor drives, (1 - efficiency) times this torque while the load drives. A gear with an efficiency below
//! 1/2 is self-locking, as a worm gear: the part 2 - 1/efficiency of the load's torque that would reach the motor is
//! negative, and the loss while the load drives is also 1/efficiency - 1, more than the torque of the meshes.
//!
//! Equations: (R3), (R5), (R8) in docs/theory/real-joints.md.

mod bristles;
mod current_loop;
mod disturbance;
mod encoder;
mod friction;
mod joint_model;
mod parameters;
mod payload;
mod random;

use std::f64::consts::TAU;

use ::parameters::{Friction, JointParameters};
use bristles::Bristles;
use current_loop::CurrentLoop;
pub use disturbance::Disturbance;
use encoder::{Encoder, Place};
use friction::Shaft;
pub use joint_model::{JointModel, Stepping};
pub use parameters::{DriveTrainError, DriveTrainParameters, EffectPhases, ErrorPhases};
use payload::SwingingPayload;
use rand_chacha::ChaCha8Rng;

use crate::joint::{Observation, Reference, Start};

/// Encoder counts available to a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Measurement {
    /// Number of control periods since the start.
    pub period: u64,
    /// Counts of the motor encoder, whole turns included.
    pub motor_counts: i64,
    /// Counts of the output encoder, whole turns included.
    pub output_counts: i64,
}

impl Measurement {
    /// Returns the measurement with counts relative to the homing position.
    pub fn homed(self, home: &Self) -> Self {
        Self {
            motor_counts: self.motor_counts - home.motor_counts,
            output_counts: self.output_counts - home.output_counts,
            ..self
        }
    }
}

/// True torques during the last part of a period, hidden from controllers [N m].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrueTorques {
    /// Air-gap torque of the motor.
    pub air_gap: f64,
    /// Cogging torque, positive driving.
    pub cogging: f64,
    /// Friction at the motor including load-dependent gear losses, positive braking.
    pub motor_friction: f64,
    /// Friction at the link, positive braking.
    pub load_friction: f64,
    /// Weight of the link, positive braking.
    pub gravity: f64,
    /// Sum of the disturbances, positive braking.
    pub disturbance: f64,
    /// Torque of the payload's spring and damper, positive braking.
    pub payload: f64,
}

impl TrueTorques {
    /// Torque that brakes the link without the payload's spring and damper: friction, weight and disturbances [N m].
    pub fn load(&self) -> f64 {
        self.load_friction + self.gravity + self.disturbance
    }
}

/// Joint with its drive train; `J` is the joint model.
#[derive(Debug, Clone)]
pub struct DriveTrain<J = Reference> {
    parameters: DriveTrainParameters,
    disturbances: Vec<Disturbance>,
    /// Braking torque on the link in addition to the disturbances, once it is set [N m].
    external_torque: Option<f64>,
    joint_model: J,
    /// State of the joint at the end of the last part.
    joint: Observation,
    current_loop: CurrentLoop,
    motor_encoder: Encoder,
    output_encoder: Encoder,
    torques: TrueTorques,
    payload: Option<SwingingPayload>,
    motor_bristles: Option<Bristles>,
    load_bristles: Option<Bristles>,
    /// Dry frictions relative to their values at time zero.
    friction_scale: f64,
    /// Half-backlash relative to its initial or last set value.
    width_scale: f64,
    /// Inertia and weight of the link relative to their values at time zero.
    payload_scale: f64,
    jitter: ChaCha8Rng,
    parts_done: u64,
    /// Length of a part of a period without jitter [s].
    part: f64,
    /// Delays by jitter of the present and the next period's start [s].
    shifts: [f64; 2],
    delay_parts: u64,
    sun_radius: f64,
    carrier_lever: f64,
    motor_inertia: f64,
    /// Inertia that the link's friction brakes.
    load_inertia: f64,
    /// Inertia of the link without the payload on its spring.
    rigid_link_inertia: f64,
    compliant: bool,
    stepping: Stepping,
}

impl DriveTrain {
    /// Drive train around the reference at time zero.
    pub fn new(
        joint: &JointParameters,
        start: &Start,
        parameters: DriveTrainParameters,
        disturbances: Vec<Disturbance>,
        seed: u64,
    ) -> Result<Self, DriveTrainError> {
        parameters.check()?;
        let hysteresis = parameters.surroundings.hysteresis;
        let inside = Reference::start(joint, start)?.with_hysteresis(hysteresis.stiffness_share, hysteresis.torque);
        Self::around(inside, joint, parameters, disturbances, seed)
    }
}

impl<J: JointModel> DriveTrain<J> {
    /// Drive train around a joint model at time zero. The joint model includes the hysteresis between carrier and link.
    pub fn around(
        mut joint_model: J,
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
        let payload = SwingingPayload::on_link(
            &around.payload,
            joint.link_inertia,
            observation.link_angle,
            observation.link_speed,
        );
        let rigid_link_inertia = (1.0 - around.payload.inertia_share) * joint.link_inertia;
        if payload.is_some() {
            joint_model.set_link_inertia(rigid_link_inertia);
        }
        let motor_inertia = joint.rotor_inertia + joint.bodies.sun_equivalent_mass * sun_radius.powi(2);
        let load_inertia = rigid_link_inertia + if compliant { 0.0 } else { carrier_inertia };
        let presliding = around.presliding;
        parameters.check_presliding([motor_inertia, load_inertia], part)?;
        let phases = &parameters.effect_phases;
        let mut train = Self {
            disturbances,
            external_torque: None,
            current_loop: CurrentLoop::new(*around, seed),
            motor_encoder: Encoder::new(
                around.motor_encoder,
                parameters.motor_error_phases,
                phases.motor_subdivision,
                Place::Motor,
                seed,
            ),
            output_encoder: Encoder::new(
                around.output_encoder,
                parameters.output_error_phases,
                phases.output_subdivision,
                Place::Output,
                seed,
            ),
            torques: TrueTorques::default(),
            payload,
            motor_bristles: Bristles::new(&around.motor_friction, presliding.motor, motor_inertia),
            load_bristles: Bristles::new(&around.load_friction, presliding.load, load_inertia),
            friction_scale: 1.0,
            width_scale: 1.0,
            payload_scale: 1.0,
            jitter: random::stream(seed, random::CONTROL_JITTER),
            parts_done: 0,
            part,
            shifts: [0.0; 2],
            delay_parts: (around.delay * f64::from(parameters.parts_per_period)).round() as u64,
            sun_radius,
            carrier_lever,
            motor_inertia,
            load_inertia,
            rigid_link_inertia,
            compliant,
            stepping: Stepping::default(),
            parameters,
            joint_model,
            joint: observation,
        };
        train.note();
        Ok(train)
    }

    /// Returns the drive train with another integration of its joint.
    pub fn stepped(self, stepping: Stepping) -> Self {
        Self { stepping, ..self }
    }

    /// Sets a braking torque on the link in addition to the disturbances [N m].
    pub fn set_external_torque(&mut self, torque: f64) {
        self.external_torque = Some(torque);
    }

    /// Advances by one control period under a torque command [N m].
    pub fn advance(&mut self, command: f64) -> Result<(), DriveTrainError> {
        self.current_loop.command(command, self.parts_done + self.delay_parts);
        self.begin_period();
        for part in 0..self.parameters.parts_per_period {
            let torques = self.torques_now(part);
            self.torques = torques;
            let drive = torques.air_gap + torques.cogging - torques.motor_friction;
            let load = torques.load() + torques.payload;
            self.parts_done += 1;
            let end = self.moment(self.parts_done as f64, f64::from(part + 1));
            self.joint_model.advance(end, drive, load, self.stepping)?;
            self.joint = self.joint_model.observe();
            self.note();
        }
        self.motor_encoder.begin_reading();
        self.output_encoder.begin_reading();
        Ok(())
    }

    /// Draws the start of the next period and updates backlash, friction and link inertia.
    fn begin_period(&mut self) {
        let around = &self.parameters.surroundings;
        let period = self.part * f64::from(self.parameters.parts_per_period);
        if around.control_jitter_ratio > 0.0 {
            let lateness = around.control_jitter_ratio * random::uniform(&mut self.jitter);
            self.shifts = [self.shifts[1], lateness * period];
        }
        let time = self.joint.time;
        self.friction_scale = (1.0 + around.drift.friction * time).max(0.0);
        let phases = &self.parameters.effect_phases.width;
        let width = around.width;
        let around_the_turn = 1.0
            + width.per_link_turn * (self.joint.link_angle + phases[0]).sin()
            + width.per_motor_turn * (self.joint.motor_angle + phases[1]).sin();
        let scale = (1.0 + around.drift.width * time).max(0.0) * around_the_turn;
        if scale != self.width_scale {
            self.width_scale = scale;
            self.joint_model.scale_half_backlash(scale);
        }
        let step = around.payload_step;
        if step.ratio != self.payload_scale && step.ratio != 1.0 && time >= step.time {
            self.payload_scale = step.ratio;
            let more = (step.ratio - 1.0) * self.rigid_link_inertia;
            self.load_inertia += more;
            self.joint_model.set_link_inertia(self.rigid_link_inertia + more);
            if let Some(payload) = &mut self.payload {
                payload.scale(step.ratio);
            }
        }
    }

    /// Time after `parts` parts, `of_period` of them in the present control period [s].
    fn moment(&self, parts: f64, of_period: f64) -> f64 {
        let [begin, end] = self.shifts;
        parts * self.part + (begin + (end - begin) * of_period / f64::from(self.parameters.parts_per_period))
    }

    /// Delay of the present period's start by the jitter of the control loop [s].
    pub fn lateness(&self) -> f64 {
        self.shifts[1]
    }

    /// Half-backlash relative to its initial or last set value, as it varies around the turn and over time [-].
    pub fn width_scale(&self) -> f64 {
        self.width_scale
    }

    /// Returns the present measurement.
    pub fn measure(&self) -> Measurement {
        Measurement {
            period: self.parts_done / u64::from(self.parameters.parts_per_period),
            motor_counts: self.motor_encoder.counts(),
            output_counts: self.output_encoder.counts(),
        }
    }

    /// Returns the true state of the joint.
    pub fn joint(&self) -> &Observation {
        &self.joint
    }

    /// Joint model, for tests that change it during a run.
    pub fn joint_model(&mut self) -> &mut J {
        &mut self.joint_model
    }

    /// Returns the torques during the last part.
    pub fn torques(&self) -> TrueTorques {
        self.torques
    }

    /// Torques during a part of the present control period.
    fn torques_now(&mut self, part_of_period: u32) -> TrueTorques {
        let parts = f64::from(self.parameters.parts_per_period);
        let part = self.part + (self.shifts[1] - self.shifts[0]) / parts;
        let middle_of_part = self.moment(self.parts_done as f64 + 0.5, f64::from(part_of_period) + 0.5);
        let joint = &self.joint;
        let around = &self.parameters.surroundings;
        let motor_angle = joint.motor_angle + 0.5 * part * joint.motor_speed;
        let air_gap = self.current_loop.torque(self.parts_done, part, motor_angle);
        let cogging_angle = f64::from(around.cogging_periods_per_turn) * motor_angle.rem_euclid(TAU);
        let cogging = around.cogging_torque * cogging_angle.sin();
        let transmitted = joint.sun_force() * self.sun_radius;
        let driving = transmitted * joint.motor_speed >= 0.0;
        let efficiency = around.efficiency;
        let rubs_both_ways = driving || efficiency < 0.5;
        let loss = transmitted.abs() * if rubs_both_ways { 1.0 / efficiency - 1.0 } else { 1.0 - efficiency };
        let motor = Shaft {
            speed: joint.motor_speed,
            driving_torque: air_gap + cogging - transmitted,
            inertia: self.motor_inertia,
            part,
        };

        let gravity = self.payload_scale * around.gravity_torque * joint.link_angle.sin();
        // The value at the middle of the part is used for all of it.
        let stated = self.disturbances.iter().map(|disturbance| disturbance.torque(middle_of_part)).sum::<f64>();
        let disturbance = self.external_torque.map_or(stated, |torque| stated + torque);
        let payload =
            self.payload.as_mut().map_or(0.0, |payload| payload.advance(joint.link_angle, joint.link_speed, part));
        let from_gears = if self.compliant {
            joint.wind_up_torque
        } else {
            joint.mesh_forces.iter().flatten().sum::<f64>() * self.carrier_lever
        };
        let load = Shaft {
            speed: joint.link_speed,
            driving_torque: from_gears - gravity - disturbance - payload,
            inertia: self.load_inertia,
            part,
        };
        let drifted = |of: &Friction| Friction { coulomb: self.friction_scale * of.coulomb, ..*of };
        let friction = |shaft: &Shaft, of: &Friction, bristles: &mut Option<Bristles>, extra: f64| match bristles {
            Some(bristles) => bristles.friction(shaft, &drifted(of), extra),
            None => shaft.friction(&drifted(of), extra),
        };
        TrueTorques {
            air_gap,
            cogging,
            motor_friction: friction(&motor, &around.motor_friction, &mut self.motor_bristles, loss),
            load_friction: friction(&load, &around.load_friction, &mut self.load_bristles, 0.0),
            gravity,
            disturbance,
            payload,
        }
    }

    fn note(&mut self) {
        let joint = &self.joint;
        self.motor_encoder.note(joint.time, joint.motor_angle, joint.motor_speed);
        self.output_encoder.note(joint.time, joint.link_angle, joint.link_speed);
    }
}
