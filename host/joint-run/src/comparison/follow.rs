//! Reference along a run, while the motion is predictable: a second reference runs with slightly disturbed torques, and
//! where the two diverge the motion is chaotic.

use model_core::gears::Kinematics;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use link::messages::Command;
use parameters::JointParameters;
use reference::joint::{Observation, Reference, ReferenceError};

use super::row::{QUANTITIES, Row, standard_deviation};
use report::interruption;

/// Relative error of the second reference's torques, with alternating sign.
pub const DISTURBANCE: f64 = 1e-6;
/// Divergence of a compared quantity, as a share of its standard deviation, from which the motion is chaotic: later
/// samples say nothing about the step.
const DIVERGENCE_MAX: f64 = 1e-4;
/// Samples between tests of the divergence.
const BLOCK_SAMPLES: usize = 100;

/// Observations of the reference at the ends of the given ticks, until the disturbed reference diverges.
pub fn follow(
    mut exact: ReferenceReplay,
    mut disturbed: ReferenceReplay,
    ticks: &[u32],
    stop: &AtomicBool,
) -> Result<Vec<Observation>, ReferenceError> {
    let mut observations = Vec::with_capacity(ticks.len());
    let mut rows: [Vec<Row>; 2] = Default::default();
    for block in ticks.chunks(BLOCK_SAMPLES) {
        if stop.load(Ordering::Relaxed) || interruption::requested() {
            break;
        }
        let [here, there] = thread::scope(|scope| {
            let there = scope.spawn(|| disturbed.block(block));
            [exact.block(block), there.join().unwrap_or(Ok(Vec::new()))]
        });
        let (here, there) = (here?, there?);
        let [exact_rows, disturbed_rows] = &mut rows;
        exact_rows.extend(here.iter().map(|observation| Row::of_reference(observation, exact.ratio)));
        disturbed_rows.extend(there.iter().map(|observation| Row::of_reference(observation, exact.ratio)));
        observations.extend(here);
        if let Some(divergence) = divergence(exact_rows, disturbed_rows, observations.len() - block.len()) {
            observations.truncate(divergence);
            break;
        }
    }
    Ok(observations)
}

/// Reference driven by a run's torques.
pub struct ReferenceReplay {
    reference: Reference,
    commands: VecDeque<Command>,
    torques: (f64, f64),
    tick_rate: f64,
    factor: f64,
    ratio: f64,
}

impl ReferenceReplay {
    /// Reference at rest before the first torque; all torques are wrong by `disturbance`, with alternating sign.
    pub fn new(
        joint: &JointParameters,
        tick_rate: u32,
        commands: &[Command],
        disturbance: f64,
    ) -> Result<Self, ReferenceError> {
        Ok(Self {
            reference: Reference::new(joint)?,
            commands: commands.iter().copied().collect(),
            torques: (0.0, 0.0),
            tick_rate: tick_rate.into(),
            factor: 1.0 + disturbance,
            ratio: joint.geometry.ratio_by_radii(),
        })
    }

    fn block(&mut self, ticks: &[u32]) -> Result<Vec<Observation>, ReferenceError> {
        ticks.iter().map(|&tick| self.observe_at(tick)).collect()
    }

    fn observe_at(&mut self, tick: u32) -> Result<Observation, ReferenceError> {
        while let Some(command) = self.commands.pop_front_if(|command| command.tick < tick) {
            self.advance(command.tick)?;
            self.torques = (command.drive_torque.into(), command.load_torque.into());
        }
        self.advance(tick)?;
        self.factor = 2.0 - self.factor;
        Ok(self.reference.observe())
    }

    fn advance(&mut self, tick: u32) -> Result<(), ReferenceError> {
        let (drive, load) = self.torques;
        self.reference.advance(f64::from(tick) / self.tick_rate, self.factor * drive, self.factor * load)
    }
}

/// First sample from `from` on at which the disturbed reference has diverged.
fn divergence(exact: &[Row], disturbed: &[Row], from: usize) -> Option<usize> {
    let spreads: Vec<f64> = (0..QUANTITIES.len()).map(|place| standard_deviation(exact, place)).collect();
    let departed = |(exact, disturbed): (&Row, &Row)| {
        spreads
            .iter()
            .enumerate()
            .any(|(place, spread)| disturbed.distance(exact, place).abs() > DIVERGENCE_MAX * spread)
    };
    let later = exact.iter().zip(disturbed).skip(from).position(departed);
    later.map(|place| from + place).or((disturbed.len() < exact.len()).then_some(disturbed.len()))
}
