//! Observer and compensation of the core as a controller, or the compensation alone on perfect estimates. Judging it is
//! left to the tests.

use std::f64::consts::TAU;

use model_core::joint::JointParameters;
use model_core::mesh::ContactState;
use model_core::real::Real;
use model_core::realtime::compensation::{self, Command, Compensation, ImpedancePoint, Position};
use model_core::realtime::observer::{Estimate, Estimates, Shaft, Source};
use model_core::tables::compensation::CompensationTables;

use super::{Controller, Motion, SetPoint};
use crate::drive_train::{Measurement, TrueTorques};
use crate::reference::Observation;

/// What the compensation sees by.
#[derive(Debug, Clone)]
pub enum Sight<T: Real> {
    /// The truth.
    Perfect(Estimates<T>),
}

/// The core's compensation as a controller.
#[derive(Debug)]
pub struct Compensated<'tables, T: Real> {
    compensation: Compensation<'tables, T>,
    sight: Sight<T>,
    half_backlash: f64,
    compliance: f64,
    ratio: f64,
    lever: f64,
    load_inertia: f64,
    last_speed: f64,
    /// What it was about in every period, if it is to be kept.
    pub trace: Option<Vec<(compensation::Stage, f64)>>,
}

impl<'tables, T: Real> Compensated<'tables, T> {
    /// A compensation that sees the truth of a joint.
    pub fn perfect(tables: &'tables CompensationTables<T>, joint: &JointParameters) -> Self {
        Self {
            compensation: Compensation::new(tables),
            sight: Sight::Perfect(Estimates::default()),
            half_backlash: joint.sun_planet.half_backlash.iter().sum::<f64>() / joint.geometry.planets as f64,
            compliance: joint.compliance.map_or(0.0, |compliance| 1.0 / compliance.stiffness),
            ratio: joint.geometry.ratio_by_teeth(),
            lever: joint.geometry.carrier_base_radius(),
            load_inertia: joint.link_inertia,
            last_speed: 0.0,
            trace: None,
        }
    }
}

/// An angle in turns.
fn position<T: Real>(angle: f64) -> (i32, T) {
    let turns = (angle / TAU).floor();
    (turns as i32, T::from_f64(angle / TAU - turns))
}

fn shaft<T: Real>(angle: f64, speed: f64) -> Shaft<T> {
    let (turns, fraction) = position(angle);
    Shaft { turns, fraction, speed: T::from_f64(speed) }
}

fn motion<T: Real>(of: Motion) -> compensation::Motion<T> {
    let (turns, fraction) = position(of.position);
    compensation::Motion {
        position: Position { turns, fraction },
        speed: T::from_f64(of.speed),
        acceleration: T::from_f64(of.acceleration),
    }
}

impl<T: Real> Controller for Compensated<'_, T> {
    fn period(&mut self, _measurement: &Measurement, set_point: &SetPoint) -> f64 {
        let command = match *set_point {
            SetPoint::Position { now, ahead } => Command::Position { now: motion(now), ahead: ahead.map(motion) },
            SetPoint::Impedance { about, torque, stiffness, damping } => {
                let point = motion(about);
                Command::Impedance(ImpedancePoint {
                    position: point.position,
                    speed: point.speed,
                    torque: T::from_f64(torque),
                    stiffness: T::from_f64(stiffness),
                    damping: T::from_f64(damping),
                })
            }
        };
        let Sight::Perfect(estimates) = &self.sight;
        let shaped = self.compensation.step(estimates, &command);
        if let Some(trace) = self.trace.as_mut() {
            trace.push((shaped.stage, shaped.side.to_f64()));
        }
        shaped.torque.to_f64()
    }

    fn witness(&mut self, joint: &Observation, torques: &TrueTorques) {
        let Sight::Perfect(estimates) = &mut self.sight;
        let exact = |value: f64| Estimate { value: T::from_f64(value), variance: T::ZERO, valid: true };
        let force = joint.sun_force();
        let near = 2.0 * self.half_backlash * 0.98;
        let contact = if joint.gap > near {
            ContactState::DriveSide
        } else if joint.gap < -near {
            ContactState::BackSide
        } else {
            ContactState::Separated
        };
        let _ = (self.load_inertia, self.last_speed);
        *estimates = Estimates {
            source: Source::Both,
            gap: exact(joint.gap),
            gap_rate: T::from_f64(joint.gap_rate),
            contact,
            reported_contact: contact,
            contact_valid: true,
            settled: contact != ContactState::Separated,
            mesh_torque: exact(force * self.lever * 2.0),
            load_torque: exact(torques.load_friction + torques.gravity + torques.disturbance),
            half_backlash: exact(self.half_backlash),
            encoder_offset: exact(0.0),
            compliance: exact(self.compliance),
            skew: exact(0.0),
            torque_bias: exact(0.0),
            motor: shaft(joint.motor_angle, joint.motor_speed),
            link: shaft(joint.link_angle, joint.link_speed),
        };
        let _ = self.ratio;
    }
}
