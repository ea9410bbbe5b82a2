//! Named scenarios as data: a joint, where it starts and what torques act tick by tick, and the reference's trajectory
//! through them.

pub mod case_r;
mod cases;
mod joints;
mod motions;
mod random_joints;

pub use cases::{CASE_A_OMEGA, CASE_Q_OMEGA, case, poincare_point, regime};
pub use joints::{PAPER_LENGTH, l1, paper_joint, paper_natural_frequency, q1, same, with_teeth};
pub use motions::motions;
use parameters::JointParameters;
pub use random_joints::random_joint;

use crate::integrator::Counters;
use crate::joint::{Observation, Reference, ReferenceError, RelativeState, Start};

/// Torques from one tick on, until the next segment begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSegment {
    /// First tick that the torques act in.
    pub from_tick: u64,
    /// On the sun [N m].
    pub drive_torque: f64,
    /// Braking the link [N m].
    pub load_torque: f64,
}

/// A joint and what happens to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// For reports.
    pub name: String,
    /// The joint.
    pub joint: JointParameters,
    /// Its state at tick 0.
    pub start: Start,
    /// Torques, in order of ticks; none act before the first.
    pub torques: Vec<TorqueSegment>,
    /// Ticks in one second [Hz].
    pub tick_rate: u32,
    /// Length.
    pub ticks: u64,
    /// Ticks between two samples of `run`.
    pub sample_every: u64,
    /// Whether single mesh deflections can be compared at all: false where a vanishing change of the start grows to a
    /// visible part of the motion (chaos, or rattling planets).
    pub predictable: bool,
}

/// What the reference did.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The first sample is the start.
    pub samples: Vec<Observation>,
    /// Cost of the run.
    pub counters: Counters,
}

impl Scenario {
    /// No torques and no length yet, at 20,000 ticks a second, each of them sampled; taken for predictable.
    pub fn new(name: impl Into<String>, joint: JointParameters, start: RelativeState) -> Self {
        Self {
            name: name.into(),
            joint,
            start: Start::Relative(start),
            torques: Vec::new(),
            tick_rate: 20_000,
            ticks: 0,
            sample_every: 1,
            predictable: true,
        }
    }

    /// Drive and load torque during a tick [N m].
    pub fn torques_at(&self, tick: u64) -> (f64, f64) {
        let segment = self.torques.iter().rev().find(|segment| segment.from_tick <= tick);
        segment.map_or((0.0, 0.0), |segment| (segment.drive_torque, segment.load_torque))
    }

    /// Time at the beginning of a tick [s].
    pub fn time_of(&self, tick: u64) -> f64 {
        tick as f64 / f64::from(self.tick_rate)
    }

    /// The scenario's length [s].
    pub fn duration(&self) -> f64 {
        self.time_of(self.ticks)
    }
}

impl Trajectory {
    /// One signal over all samples.
    pub fn signal(&self, of: impl Fn(&Observation) -> f64) -> Vec<f64> {
        self.samples.iter().map(of).collect()
    }
}

/// Follows a scenario, sampling at tick 0 and then every `sample_every` ticks.
pub fn run(scenario: &Scenario) -> Result<Trajectory, ReferenceError> {
    let every = scenario.sample_every.max(1);
    let times: Vec<f64> = (0..=scenario.ticks / every).map(|sample| scenario.time_of(sample * every)).collect();
    run_at(scenario, &times)
}

/// Follows a scenario, sampling at the stated times [s] in rising order, on the tick grid or not.
pub fn run_at(scenario: &Scenario, times: &[f64]) -> Result<Trajectory, ReferenceError> {
    let mut reference = Reference::start(&scenario.joint, &scenario.start)?;
    let mut samples = Vec::with_capacity(times.len());
    let mut changes = scenario.torques.iter().peekable();
    let (mut drive, mut load) = (0.0, 0.0);
    for &time in times {
        while let Some(change) = changes.next_if(|change| scenario.time_of(change.from_tick) <= time) {
            reference.advance(scenario.time_of(change.from_tick), drive, load)?;
            (drive, load) = (change.drive_torque, change.load_torque);
        }
        reference.advance(time, drive, load)?;
        samples.push(reference.observe());
    }
    Ok(Trajectory { samples, counters: reference.counters() })
}
