//! Comparison of a run with the f64 reference: the run's torques through an independent integration, while the motion
//! is predictable. The references are computed in parallel to the run.

mod follow;
mod row;

use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use follow::{DISTURBANCE, ReferenceReplay, follow};
use link::messages::{Command, Sample};
use parameters::{ContactState, JointParameters};
use reference::joint::{Observation, ReferenceError};
use row::{QUANTITIES, Row, standard_deviation};

use crate::record::{self, MotionSample};
use report::contacts::Contact;
use report::failure::{Failure, Outcome};

/// Longest comparison [s]: the reference takes longer than the run itself.
const COMPARISON_TIME_MAX: f64 = 3.0;
/// References in computation, on their own threads.
pub struct PendingReferences {
    joint: JointParameters,
    tick_rate: u32,
    ticks: Vec<u32>,
    stop: Arc<AtomicBool>,
    followed: JoinHandle<Result<Vec<Observation>, ReferenceError>>,
}

/// Distance of a run from the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Reference for the report.
    pub reference: record::Reference,
    /// End of the compared part [s].
    pub until: f64,
    /// End of the run [s].
    pub of: f64,
    /// Root mean square error of every quantity over its standard deviation, with its bound.
    pub errors: Vec<QuantityError>,
}

/// One quantity's distance from the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuantityError {
    /// Name of the quantity.
    pub name: &'static str,
    /// Root mean square of the error over the standard deviation of the reference.
    pub error: f64,
    /// Bound of the error.
    pub limit: f64,
}

/// Starts two reference simulations with the torques of a run. One of them is disturbed, so that the growth of a small
/// error is known.
pub fn start(joint: &JointParameters, tick_rate: u32, decimation: u32, run: (&[Command], u32)) -> PendingReferences {
    let (commands, ticks) = run;
    let last = ticks.min((COMPARISON_TIME_MAX * f64::from(tick_rate)) as u32);
    let ticks: Vec<u32> = (1..=last / decimation).map(|sample| sample * decimation).collect();
    let stop = Arc::new(AtomicBool::new(false));
    let follower = |disturbance: f64| ReferenceReplay::new(joint, tick_rate, commands, disturbance);
    let (exact, disturbed) = (follower(0.0), follower(DISTURBANCE));
    let followed = {
        let (ticks, stop) = (ticks.clone(), Arc::clone(&stop));
        thread::spawn(move || follow(exact?, disturbed?, &ticks, &stop))
    };
    PendingReferences { joint: joint.clone(), tick_rate, ticks, stop, followed }
}

impl PendingReferences {
    /// Ends the references without their result.
    pub fn abandon(self) {
        self.stop.store(true, Ordering::Relaxed);
        // The threads end by themselves within a sample, so they are not joined.
    }

    /// Waits for the references and compares the samples of the run with them.
    pub fn finish(self, samples: &[Sample], ratio: f64) -> Outcome<Comparison> {
        let exact = match self.followed.join() {
            Ok(Ok(observations)) => observations,
            Ok(Err(error)) => return Err(Failure::new(format!("the reference cannot model this joint: {error}"))),
            Err(_) => return Err(Failure::new("the reference panicked")),
        };
        let board = rows_of_board(samples, &self.ticks, ratio);
        let exact_rows: Vec<Row> = exact.iter().map(|observation| Row::of_reference(observation, ratio)).collect();
        let predictable = exact_rows.len();
        let mut motion = record::Samples::new(2 * self.joint.geometry.planets);
        for (&tick, observation) in self.ticks.iter().zip(&exact) {
            motion.push(&motion_sample(tick, observation), self.tick_rate, ratio);
        }
        let seconds = |count: usize| count.checked_sub(1).map_or(0.0, |last| motion.time_s[last]);
        let mut errors = Vec::new();
        let mut series = Vec::new();
        for (place, quantity) in QUANTITIES.iter().enumerate() {
            let deviation = standard_deviation(&exact_rows, place);
            let distances = || {
                board.iter().zip(&exact_rows).enumerate().filter_map(move |(index, (board, exact))| {
                    board.as_ref().map(|board| (index, board.distance(exact, place) / deviation))
                })
            };
            let count = distances().count();
            let square: f64 = distances().map(|(_, distance)| distance * distance).sum();
            errors.push(QuantityError {
                name: quantity.name,
                error: (square / count as f64).sqrt(),
                limit: quantity.limit,
            });
            series.push(record::ErrorSeries {
                quantity: quantity.name.to_owned(),
                time_s: distances().map(|(index, _)| motion.time_s[index]).collect(),
                error_percent: distances().map(|(_, distance)| 100.0 * distance).collect(),
                bound_percent: 100.0 * quantity.limit,
            });
        }
        let until = seconds(predictable);
        let of = samples.last().map_or(0.0, |last| f64::from(last.tick) / f64::from(self.tick_rate));
        let method =
            "equations of motion in absolute coordinates, f64, adaptive order 8, restarted at every contact event";
        let reference = record::Reference { method: method.to_owned(), samples: motion, errors: series };
        Ok(Comparison { reference, until, of, errors })
    }
}

/// Rows of the board at the given ticks; `None` for a lost sample.
fn rows_of_board(samples: &[Sample], ticks: &[u32], ratio: f64) -> Vec<Option<Row>> {
    let mut samples = samples.iter().peekable();
    let row = |&tick: &u32| {
        while samples.next_if(|sample| sample.tick < tick).is_some() {}
        samples.next_if(|sample| sample.tick == tick).map(|sample| Row::of_board(sample, ratio))
    };
    ticks.iter().map(row).collect()
}

fn motion_sample(tick: u32, observation: &Observation) -> MotionSample {
    let contact = |state: &ContactState| match state {
        ContactState::DriveSide => Contact::DriveSide,
        ContactState::Separated => Contact::Separated,
        ContactState::BackSide => Contact::BackSide,
    };
    MotionSample {
        tick,
        carrier_angle: observation.rigid_turns * TAU,
        motor_offset: observation.motor_offset,
        link_offset: observation.link_offset,
        carrier_speed: observation.rigid_speed as f32,
        gap: observation.gap as f32,
        wind_up: observation.wind_up as f32,
        deflections: observation.deflections.iter().flatten().map(|deflection| *deflection as f32).collect(),
        contacts: observation.contacts.iter().flatten().map(contact).collect(),
        state_digest: None,
        computation: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use board::device::board::Chip;
    use board::profile::TorqueProfile;
    use board::twin;
    use model_core::gears::Kinematics;

    const TICK_RATE: u32 = 20_000;
    const DECIMATION: u32 = 20;

    fn joint(preset: &str) -> JointParameters {
        joint_file::read(joint_file::preset(preset).expect("a preset")).expect("a good preset").parameters
    }

    /// Comparison of the twin's run, in place of a board's, through the beginning of a built-in profile, with samples
    /// changed by `spoil`.
    fn comparison(preset: &str, seconds: f64, spoil: impl Fn(&mut Sample)) -> Comparison {
        let joint = joint(preset);
        let profile = TorqueProfile::load("reversals", &joint, TICK_RATE, Some(seconds)).expect("built in");
        let pending = start(&joint, TICK_RATE, DECIMATION, (&profile.commands, profile.ticks));
        let ticks: Vec<u32> = (1..=profile.ticks / DECIMATION).map(|sample| sample * DECIMATION).collect();
        let mut samples =
            twin::replay(&joint, Chip::Stm32f405, TICK_RATE, &profile.commands, &ticks).expect("a good joint");
        samples.iter_mut().for_each(spoil);
        pending.finish(&samples, joint.geometry.ratio_by_radii()).expect("a joint for the reference")
    }

    fn failed(comparison: &Comparison) -> Vec<&'static str> {
        let over =
            comparison.errors.iter().filter(|quantity| quantity.error.is_nan() || quantity.error > quantity.limit);
        over.map(|quantity| quantity.name).collect()
    }

    /// The twin stays within every bound over the followed part.
    #[test]
    fn twin_is_within_every_bound() {
        let comparison = comparison("l1", 0.3, |_| {});
        assert_eq!(failed(&comparison), [""; 0]);
        assert_eq!((comparison.until, comparison.of), (0.3, 0.3));
    }

    /// An error of 2 % in one quantity exceeds the bound of that quantity alone.
    #[test]
    fn error_of_2_percent_fails_its_bound() {
        let gap = comparison("l1", 0.1, |sample| sample.gap *= 1.02);
        assert_eq!(failed(&gap), ["gap"]);
        let meshes = comparison("l1", 0.1, |sample| sample.deflections.iter_mut().for_each(|mesh| *mesh *= 1.02));
        assert_eq!(failed(&meshes), ["mesh deflections"]);
        let turned = comparison("l1", 0.1, |sample| sample.carrier_fraction = sample.carrier_fraction.wrapping_mul(2));
        assert_eq!(failed(&turned), ["link angle"]);
    }

    /// A chaotic motion is compared only while it is predictable.
    #[test]
    fn chaotic_motion_ends_comparison() {
        let comparison = comparison("paper", 0.5, |_| {});
        assert!(comparison.until < 0.05, "{}", comparison.until);
        assert!(comparison.reference.samples.len() < 100);
    }

    #[test]
    fn lost_sample_is_skipped() {
        let rows = rows_of_board(&[], &[20, 40], 6.0);
        assert_eq!(rows, [None, None]);
    }
}
