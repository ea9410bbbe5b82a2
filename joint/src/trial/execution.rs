//! One run: a plant, a controller, faults between them, period by period, with what truly happened and what the observer
//! made of it. What it is worth is `figures`' business.

use std::fmt;
use std::time::Instant;

use host_tests::closed_loop::rivals::Knowledge;
use host_tests::closed_loop::{Run, Sample};
use host_tests::drive_train::DriveTrainParameters;
use model_core::digest;
use model_core::mesh::ContactState;
use model_core::realtime::observer::Source;

use super::case::{Case, Designed};
use super::controller::{ControllerName, Driver};
use super::file::TestFile;
use super::injection::Injection;
use super::plant::{Plant, PlantName, plant};
use super::port::{Answer, ControllerPort, HostPort, Translator};
use super::sender::Sender;
use crate::failure::{Failure, Outcome};
use crate::interruption;

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Ran {
    /// The truth, one sample for each control period.
    pub run: Run,
    /// What the observer made of it, in the same order; empty for controllers without one.
    pub sights: Vec<Sight>,
    /// Half of the true gap at every period [m]: teeth may wear.
    pub truths: Vec<Truth>,
    /// Digest over every bit of all of it.
    pub digest: u64,
}

/// What is true beside the sample.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Truth {
    /// Gap coordinate [m].
    pub gap: f64,
    /// Half-backlash now [m].
    pub half_backlash: f64,
    /// What brakes the link [N m].
    pub load_torque: f64,
    /// Motor angle [rad].
    pub motor: f64,
}

/// What the observer says in one period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sight {
    /// Gap coordinate [m].
    pub gap: f32,
    /// Its variance [m^2].
    pub gap_variance: f32,
    /// Whether it may be used.
    pub valid: bool,
    /// -1, 0, 1.
    pub side: i8,
    /// Between carrier and link [N m].
    pub mesh_torque: f32,
    /// What brakes the link [N m].
    pub load_torque: f32,
    /// [m].
    pub half_backlash: f32,
    /// [rad/(N m)].
    pub compliance: f32,
    /// [s].
    pub skew: f32,
    /// Both encoders are trusted.
    pub both: bool,
    /// Share of the compensation in the torque.
    pub trust: f32,
}

/// Why a run ended early.
#[derive(Debug)]
pub enum RunError {
    /// It cannot even begin.
    Refused(Failure),
    /// Plant or controller left what is finite: a fault of what is tested.
    Broke(String),
    /// The test's time on the clock was up.
    TimedOut,
    /// By the user.
    Interrupted,
}

impl fmt::Display for RunError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(failure) => formatter.write_str(failure.message()),
            Self::Broke(why) => formatter.write_str(why),
            Self::TimedOut => formatter.write_str("the test's time on the clock was up"),
            Self::Interrupted => formatter.write_str("stopped by the user"),
        }
    }
}

impl From<Failure> for RunError {
    fn from(failure: Failure) -> Self {
        Self::Refused(failure)
    }
}

/// Who shall control what.
#[derive(Debug, Clone, Copy)]
pub struct Order {
    /// Who.
    pub controller: ControllerName,
    /// What.
    pub plant: PlantName,
    /// On teeth without a gap and without faults: what an impedance's deviation is measured from.
    pub without_gap: bool,
}

/// Periods between looks at the clock.
const LOOK: u64 = 500;

/// Makes the port to observer and compensation of a run.
pub type MakePort<'p> = &'p dyn for<'d> Fn(&'d Designed) -> Outcome<Box<dyn ControllerPort + 'd>>;

/// Runs one controller in one case, all of it on the host.
pub fn execute(file: &TestFile, case: &Case, seed: u64, order: Order, deadline: Instant) -> Result<Ran, RunError> {
    execute_with(file, case, seed, order, deadline, &|designed| {
        Ok(Box::new(HostPort::new(&designed.observer, &designed.compensation)))
    })
}

/// Runs one controller in one case; observer and compensation are where their port leads.
pub fn execute_with(
    file: &TestFile,
    case: &Case,
    seed: u64,
    order: Order,
    deadline: Instant,
    port: MakePort<'_>,
) -> Result<Ran, RunError> {
    let joint = if order.without_gap { case.joint_without_gap() } else { case.truth.parameters.clone() };
    let mut plant = plant(order.plant, &joint, &case.train, case.disturbances.clone(), seed)?;
    let designed = if order.controller.is_ours() { Some(case.design(file)?) } else { None };
    let mut driver = driver(order.controller, case, designed.as_ref(), file.bandwidth, port)?;
    let faults = if order.without_gap { &[] } else { file.faults.as_slice() };
    let mut injection = Injection::new(faults, seed, case);
    let mut sender = Sender::new(file, case, order.controller, designed.as_ref());
    let period = 1.0 / case.train.control_rate;
    let periods = (file.duration * case.train.control_rate).round() as u64;
    let mut ran = Ran::begin(period, periods);
    for index in 0..periods {
        if index % LOOK == 0 {
            if Instant::now() > deadline {
                return Err(RunError::TimedOut);
            }
            if interruption::requested() {
                return Err(RunError::Interrupted);
            }
        }
        let time = index as f64 * period;
        let joint = plant.joint().clone();
        injection.wear(time, &joint, plant.inside().as_mut());
        let (number, set_point) = sender.at(time, index);
        let set_point = injection.receive(time, number, set_point);
        let seen = injection.sense(&plant.measure());
        let (command, answer) = driver.period(&seen, &set_point)?;
        if !command.is_finite() {
            return Err(RunError::Broke(format!("the controller's torque is not finite at t = {time:.4} s")));
        }
        plant
            .advance(injection.torque(time, command))
            .map_err(|error| RunError::Broke(format!("the plant at t = {time:.4} s: {error}")))?;
        ran.note(&plant, case, &injection, command, answer.as_ref());
        if ran.run.samples.last().is_some_and(|sample| !(sample.link + sample.mesh_force).is_finite()) {
            return Err(RunError::Broke(format!("the joint's motion is not finite at t = {time:.4} s")));
        }
    }
    Ok(ran)
}

fn driver<'d>(
    name: ControllerName,
    case: &Case,
    designed: Option<&'d Designed>,
    bandwidth: f64,
    port: MakePort<'_>,
) -> Outcome<Driver<'d>> {
    let knowledge: Knowledge = case.knowledge();
    Ok(match designed {
        Some(designed) => {
            let train: &DriveTrainParameters = &case.told_train;
            let bits = [train.motor_encoder.bits, train.output_encoder.bits];
            Driver::Ours(port(designed)?, Translator::new(designed.ticks, bits))
        }
        None => Driver::rival(name, knowledge, bandwidth),
    })
}

impl Ran {
    /// Nothing has happened yet.
    pub fn begin(period: f64, periods: u64) -> Self {
        Self {
            run: Run { samples: Vec::with_capacity(periods as usize), period },
            sights: Vec::new(),
            truths: Vec::with_capacity(periods as usize),
            digest: digest::START,
        }
    }

    fn note(&mut self, plant: &Plant, case: &Case, injection: &Injection, command: f64, answer: Option<&Answer>) {
        let joint = plant.joint();
        let torques = plant.torques();
        let half = injection.half_backlash_now();
        let sample = Sample {
            time: joint.time,
            wanted: case.motion.at(joint.time).position,
            link: joint.link_angle,
            link_speed: joint.link_speed,
            gap: if half > 0.0 { joint.gap / (2.0 * half) } else { joint.gap.signum() },
            mesh_force: joint.sun_force(),
            transmitted: joint.wind_up_torque,
            command,
        };
        let truth = Truth {
            gap: joint.gap,
            half_backlash: half,
            load_torque: torques.load_friction + torques.gravity + torques.disturbance,
            motor: joint.motor_angle,
        };
        self.add(sample, truth, answer);
    }

    /// Adds a period.
    pub fn add(&mut self, sample: Sample, truth: Truth, answer: Option<&Answer>) {
        for value in [sample.link, sample.mesh_force, sample.command, truth.gap, truth.motor] {
            self.digest = digest::chain(self.digest, value.to_bits());
        }
        if let Some(answer) = answer {
            let sight = Sight::of(answer);
            for value in [sight.gap, sight.half_backlash, sight.load_torque, sight.trust] {
                self.digest = digest::chain(self.digest, value.to_bits().into());
            }
            self.sights.push(sight);
        }
        self.run.samples.push(sample);
        self.truths.push(truth);
    }
}

impl Sight {
    fn of(answer: &Answer) -> Self {
        let Answer { estimates, shaped } = answer;
        Self {
            gap: estimates.gap.value,
            gap_variance: estimates.gap.variance,
            valid: estimates.gap.valid,
            side: match estimates.reported_contact {
                ContactState::DriveSide => 1,
                ContactState::Separated => 0,
                ContactState::BackSide => -1,
            },
            mesh_torque: estimates.mesh_torque.value,
            load_torque: estimates.load_torque.value,
            half_backlash: estimates.half_backlash.value,
            compliance: estimates.compliance.value,
            skew: estimates.skew.value,
            both: estimates.source == Source::Both,
            trust: shaped.trust,
        }
    }
}
