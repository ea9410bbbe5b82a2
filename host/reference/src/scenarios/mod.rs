//! Named scenarios as data (joint, start, torques per tick) and the reference's trajectory through them.

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

/// Torques from a tick on, until the next segment begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSegment {
    /// First tick under these torques.
    pub from_tick: u64,
    /// Torque on the sun [N m].
    pub drive_torque: f64,
    /// Torque that brakes the link [N m].
    pub load_torque: f64,
}

/// Joint, start and torques of a scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Name in reports.
    pub name: String,
    /// Parameters of the joint.
    pub joint: JointParameters,
    /// State at tick 0.
    pub start: Start,
    /// Torques in order of ticks; zero before the first segment.
    pub torques: Vec<TorqueSegment>,
    /// Tick rate [Hz].
    pub tick_rate: u32,
    /// Length [ticks].
    pub ticks: u64,
    /// Ticks between two samples of `run`.
    pub sample_every: u64,
    /// `true` if single mesh deflections are comparable; `false` where a vanishing change of the start grows to a
    /// visible part of the motion (chaos, rattling planets).
    pub predictable: bool,
}

/// Trajectory of the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Samples, beginning with the start.
    pub samples: Vec<Observation>,
    /// Cost of the run.
    pub counters: Counters,
}

impl Scenario {
    /// Scenario without torques and of length zero, at 20,000 ticks per second, each tick sampled, marked as
    /// predictable.
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

    /// Returns drive and load torque during a tick [N m].
    pub fn torques_at(&self, tick: u64) -> (f64, f64) {
        let segment = self.torques.iter().rev().find(|segment| segment.from_tick <= tick);
        segment.map_or((0.0, 0.0), |segment| (segment.drive_torque, segment.load_torque))
    }

    /// Time at the start of a tick [s].
    pub fn time_of(&self, tick: u64) -> f64 {
        tick as f64 / f64::from(self.tick_rate)
    }

    /// Length of the scenario [s].
    pub fn duration(&self) -> f64 {
        self.time_of(self.ticks)
    }
}

impl Trajectory {
    /// Returns one signal over all samples.
    pub fn signal(&self, of: impl Fn(&Observation) -> f64) -> Vec<f64> {
        self.samples.iter().map(of).collect()
    }
}

/// Runs a scenario; samples at tick 0 and then every `sample_every` ticks.
pub fn run(scenario: &Scenario) -> Result<Trajectory, ReferenceError> {
    let every = scenario.sample_every.max(1);
    let times: Vec<f64> = (0..=scenario.ticks / every).map(|sample| scenario.time_of(sample * every)).collect();
    run_at(scenario, &times)
}

/// Runs a scenario; samples at the stated rising times [s], on the tick grid or off it.
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
