//! Observer and compensation of the core as a controller, or the compensation alone on perfect estimates. Judging it is
//! left to the tests.

use model_core::gears::Kinematics;
use std::f64::consts::TAU;

use model_core::compensation::design::CompensationSettings;
use model_core::compensation::{self, Command, Compensation, CompensationTables, ImpedancePoint, Position, Shaped};
use model_core::numbers::Real;
use model_core::observer::design::{CLOCK_TICKS, ObserverSettings};
use model_core::observer::{Estimate, Estimates, MAPPED, Observer, ObserverTables, Reading, Samples, Shaft, Source};
use parameters::{ContactState, JointParameters};

use reference::closed_loop::{Controller, Motion, SetPoint};
use reference::drive_train::{DriveTrainParameters, Measurement, TrueTorques};
use reference::joint::Observation;

/// What the compensation sees by.
#[derive(Debug, Clone)]
pub enum Sight<'tables, T: Real> {
    /// The truth.
    Perfect(Box<Perfect<T>>),
    /// The observer on the encoders.
    Observed(Box<Observed<'tables, T>>),
}

/// What turns the truth into estimates.
#[derive(Debug, Clone)]
pub struct Perfect<T: Real> {
    estimates: Estimates<T>,
    half_backlash: f64,
    compliance: f64,
    lever: f64,
}

/// What turns counts into samples of the observer.
#[derive(Debug, Clone)]
pub struct Observed<'tables, T: Real> {
    observer: Observer<'tables, T, MAPPED>,
    ranges: [i64; 2],
    torque: T,
}

/// The core's compensation as a controller.
#[derive(Debug)]
pub struct Compensated<'tables, T: Real> {
    compensation: Compensation<'tables, T>,
    sight: Sight<'tables, T>,
    /// What it was about in every period and by which estimates, if that is to be kept.
    pub trace: Option<Vec<(Shaped<T>, Estimates<T>)>>,
}

/// Settings of an observer for a drive train: what data sheets say, sizes of errors but never their phases or signs.
pub fn observer_settings(train: &DriveTrainParameters) -> ObserverSettings {
    model_core::observer::design::observer_settings(&train.surroundings)
}

/// Settings of a compensation for a drive train.
pub fn compensation_settings(train: &DriveTrainParameters, bandwidth: f64) -> CompensationSettings {
    model_core::compensation::design::compensation_settings(&train.surroundings, bandwidth)
}

impl<'tables, T: Real> Compensated<'tables, T> {
    /// A compensation that sees the truth of a joint.
    pub fn perfect(tables: &'tables CompensationTables<T>, joint: &JointParameters) -> Self {
        let perfect = Perfect {
            estimates: Estimates::default(),
            half_backlash: joint.sun_planet.half_backlash.iter().sum::<f64>() / joint.geometry.planets as f64,
            compliance: joint.compliance.map_or(0.0, |compliance| 1.0 / compliance.stiffness),
            lever: joint.geometry.carrier_base_radius(),
        };
        Self { compensation: Compensation::new(tables), sight: Sight::Perfect(Box::new(perfect)), trace: None }
    }

    /// A compensation behind an observer, as on a board.
    pub fn observed(
        tables: &'tables CompensationTables<T>,
        observer_tables: &'tables ObserverTables<T>,
        train: &DriveTrainParameters,
    ) -> Self {
        let around = &train.surroundings;
        let observed = Observed {
            observer: Observer::new(observer_tables),
            ranges: [around.motor_encoder, around.output_encoder].map(|encoder| 1_i64 << encoder.bits),
            torque: T::ZERO,
        };
        Self { compensation: Compensation::new(tables), sight: Sight::Observed(Box::new(observed)), trace: None }
    }
}

impl<T: Real> Observed<'_, T> {
    fn see(&mut self, measurement: &Measurement) -> Estimates<T> {
        let time = (measurement.period as u32).wrapping_mul(CLOCK_TICKS);
        let reading = |counts: i64, range: i64| Reading { counts: counts.rem_euclid(range) as u32, time };
        let samples = Samples {
            time,
            motor: reading(measurement.motor_counts, self.ranges[0]),
            output: Some(reading(measurement.output_counts, self.ranges[1])),
            torque: self.torque,
        };
        *self.observer.step(&samples)
    }
}

impl<T: Real> Perfect<T> {
    fn show(&mut self, joint: &Observation, torques: &TrueTorques) {
        let exact = |value: f64| Estimate { value: T::from_f64(value), variance: T::ZERO, valid: true };
        // Mesh deflections under load are a few percent of the gap: what is that near to a flank touches it.
        let near = 0.98 * 2.0 * self.half_backlash;
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
            gap_rate: T::from_f64(joint.gap_rate),
            contact,
            reported_contact: contact,
            contact_valid: true,
            settled: contact != ContactState::Separated,
            mesh_torque: exact(2.0 * self.lever * joint.sun_force()),
            load_torque: exact(torques.load_friction + torques.gravity + torques.disturbance),
            half_backlash: exact(self.half_backlash),
            compliance: exact(self.compliance),
            motor: shaft(joint.motor_angle, joint.motor_speed),
            link: shaft(joint.link_angle, joint.link_speed),
            ..Estimates::default()
        };
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
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
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
        let estimates = match &mut self.sight {
            Sight::Perfect(perfect) => perfect.estimates,
            Sight::Observed(observed) => observed.see(measurement),
        };
        let shaped = self.compensation.step(&estimates, &command);
        if let Sight::Observed(observed) = &mut self.sight {
            observed.torque = shaped.torque;
        }
        if let Some(trace) = self.trace.as_mut() {
            trace.push((shaped, estimates));
        }
        shaped.torque.to_f64()
    }

    fn witness(&mut self, joint: &Observation, torques: &TrueTorques) {
        if let Sight::Perfect(perfect) = &mut self.sight {
            perfect.show(joint, torques);
        }
    }
}
