//! One closed-loop run: a drive train, a motion asked for, a controller, and what truly happened period by period. What
//! it is worth is `metrics`' business.

use std::fmt;

use parameters::JointParameters;

use super::{Controller, Motion, Reference, SetPoint};
use crate::drive_train::{Disturbance, DriveTrain, DriveTrainError, DriveTrainParameters, Stepping};
use crate::joint::{Observation, RelativeState, Start};

/// Stiffness, damping and sending rate of impedance set-points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpedanceGains {
    /// [N m/rad].
    pub stiffness: f64,
    /// [N m s/rad].
    pub damping: f64,
    /// Set-points a second, held in between [Hz].
    pub rate: f64,
    /// Torque sent along for each unit of the motion's acceleration [kg m^2].
    pub inertia: f64,
}

/// Everything about a run but the controller and the motion.
#[derive(Debug, Clone)]
pub struct Bench {
    /// The joint.
    pub joint: JointParameters,
    /// What surrounds it.
    pub train: DriveTrainParameters,
    /// Torques on the link.
    pub disturbances: Vec<Disturbance>,
    /// How the joint is stepped.
    pub stepping: Stepping,
    /// Of all noise.
    pub seed: u64,
    /// Length [s].
    pub duration: f64,
    /// How far ahead the controller is told the motion; `None` tells it the present only [s].
    pub preview: Option<f64>,
    /// Impedance set-points instead of positions.
    pub impedance: Option<ImpedanceGains>,
}

/// The truth at the end of one control period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sample {
    /// [s].
    pub time: f64,
    /// Where the link was to be [rad].
    pub wanted: f64,
    /// Where it is [rad].
    pub link: f64,
    /// [rad/s].
    pub link_speed: f64,
    /// Gap coordinate over 2b: -1 to 1 while every mesh is free.
    pub gap: f64,
    /// All sun-planet meshes together [N].
    pub mesh_force: f64,
    /// Between carrier and link [N m].
    pub transmitted: f64,
    /// Asked of the motor [N m].
    pub command: f64,
}

impl Sample {
    /// Of a joint whose half-backlash is now so much [m], under a command [N m].
    pub fn of(joint: &Observation, wanted: f64, half_backlash: f64, command: f64) -> Self {
        Self {
            time: joint.time,
            wanted,
            link: joint.link_angle,
            link_speed: joint.link_speed,
            gap: if half_backlash > 0.0 { joint.gap / (2.0 * half_backlash) } else { joint.gap.signum() },
            mesh_force: joint.sun_force(),
            transmitted: joint.wind_up_torque,
            command,
        }
    }
}

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// One for each control period.
    pub samples: Vec<Sample>,
    /// Control period [s].
    pub period: f64,
}

/// Why a run broke off.
#[derive(Debug, Clone, PartialEq)]
pub enum BenchError {
    /// The plant.
    Plant(DriveTrainError),
    /// The controller gave something that is no torque, at this time [s].
    NotATorque(f64),
}

impl fmt::Display for BenchError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plant(error) => error.fmt(formatter),
            Self::NotATorque(time) => write!(formatter, "the controller's torque is not finite at t = {time} s"),
        }
    }
}

impl std::error::Error for BenchError {}

impl From<DriveTrainError> for BenchError {
    fn from(error: DriveTrainError) -> Self {
        Self::Plant(error)
    }
}

impl Bench {
    /// A joint and its drive train without disturbances, stepped fast.
    pub fn new(joint: JointParameters, train: DriveTrainParameters, duration: f64, seed: u64) -> Self {
        Self {
            joint,
            train,
            disturbances: Vec::new(),
            stepping: Stepping::Fixed,
            seed,
            duration,
            preview: None,
            impedance: None,
        }
    }

    /// Closes the loop. The teeth start in the middle of their gap.
    pub fn run(&self, controller: &mut dyn Controller, motion: &dyn Reference) -> Result<Run, BenchError> {
        let planets = self.joint.geometry.planets;
        let start = Start::Relative(RelativeState::centred(planets));
        let disturbances = self.disturbances.clone();
        let mut train =
            DriveTrain::new(&self.joint, &start, self.train.clone(), disturbances, self.seed)?.stepped(self.stepping);
        let period = 1.0 / f64::from(self.train.surroundings.control_rate);
        let periods = (self.duration * f64::from(self.train.surroundings.control_rate)).round() as u64;
        let half = self.joint.sun_planet.half_backlash.iter().sum::<f64>() / planets as f64;
        let mut samples = Vec::with_capacity(periods as usize);
        let mut held: Option<(u64, Motion)> = None;
        // Encoders are homed where the run begins.
        let home = train.measure();
        for index in 0..periods {
            let time = index as f64 * period;
            let set_point = match self.impedance {
                None => {
                    SetPoint::Position { now: motion.at(time), ahead: self.preview.map(|lead| motion.at(time + lead)) }
                }
                Some(gains) => {
                    let number = (time * gains.rate + 1e-9) as u64;
                    let about = match held {
                        Some((sent, about)) if sent == number => about,
                        _ => motion.at(time),
                    };
                    held = Some((number, about));
                    SetPoint::Impedance {
                        about: Motion { acceleration: 0.0, ..about },
                        torque: gains.inertia * about.acceleration,
                        stiffness: gains.stiffness,
                        damping: gains.damping,
                    }
                }
            };
            controller.witness(train.joint(), &train.torques());
            let command = controller.period(&train.measure().homed(&home), &set_point);
            if !command.is_finite() {
                return Err(BenchError::NotATorque(time));
            }
            train.advance(command)?;
            let joint = train.joint();
            samples.push(Sample::of(joint, motion.at(joint.time).position, half, command));
        }
        Ok(Run { samples, period })
    }
}
