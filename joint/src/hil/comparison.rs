//! The run against the f64 reference: the same torques through an independent integration, as far as the motion can be
//! predicted at all. Both are computed beside the run; what the distances mean for the verdict is the checks' business.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use host_tests::reference::{Observation, Reference, ReferenceError};
use host_tests::tolerance::{self, Bound};
use link::messages::{Command, Sample};
use model_core::joint::JointParameters;
use model_core::mesh::ContactState;

use crate::failure::{Failure, Outcome};
use crate::record::{self, MotionSample};

/// The reference is followed for so long at most [s]: it takes about half as long to compute.
const LONGEST: f64 = 10.0;
/// A second reference gets torques that are wrong by this much, up and down in turn.
const DISTURBANCE: f64 = 1e-6;
/// Once that moves any compared quantity by more than this part of its standard deviation, the motion is chaotic: what
/// comes later says nothing about the step any more.
const PREDICTABLE: f64 = 1e-4;
/// Samples between two looks at whether it still can be predicted.
const BLOCK: usize = 100;

/// What is compared.
const QUANTITIES: [Quantity; 4] = [
    Quantity { name: "link angle", bound: &tolerance::HIL_LINK_ANGLE },
    Quantity { name: "twist of motor against link", bound: &tolerance::HIL_TWIST },
    Quantity { name: "gap", bound: &tolerance::HIL_GAP },
    Quantity { name: "mesh deflections", bound: &tolerance::HIL_DEFLECTIONS },
];

struct Quantity {
    name: &'static str,
    bound: &'static Bound,
}

/// References under way, on threads of their own.
pub struct UnderWay {
    joint: JointParameters,
    tick_rate: u32,
    ticks: Vec<u32>,
    stop: Arc<AtomicBool>,
    followed: JoinHandle<Result<Vec<Observation>, ReferenceError>>,
}

/// How far a run is from the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// For the report.
    pub reference: record::Reference,
    /// End of the part that was compared [s].
    pub until: f64,
    /// End of the run [s].
    pub of: f64,
    /// Every quantity's root mean square error over its standard deviation, with its bound.
    pub errors: Vec<QuantityError>,
}

/// One quantity's distance from the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuantityError {
    /// Which.
    pub name: &'static str,
    /// Root mean square of the error over the standard deviation of the reference.
    pub error: f64,
    /// The bound on it.
    pub bound: &'static Bound,
}

/// Starts two references on the torques of a run, one of them disturbed.
pub fn start(joint: &JointParameters, tick_rate: u32, decimation: u32, run: (&[Command], u32)) -> UnderWay {
    let (commands, ticks) = run;
    let last = ticks.min((LONGEST * f64::from(tick_rate)) as u32);
    let ticks: Vec<u32> = (1..=last / decimation).map(|sample| sample * decimation).collect();
    let stop = Arc::new(AtomicBool::new(false));
    let follower = |disturbance: f64| Follower::new(joint, tick_rate, commands, disturbance);
    let (exact, disturbed) = (follower(0.0), follower(DISTURBANCE));
    let followed = {
        let (ticks, stop) = (ticks.clone(), Arc::clone(&stop));
        thread::spawn(move || follow(exact?, disturbed?, &ticks, &stop))
    };
    UnderWay { joint: joint.clone(), tick_rate, ticks, stop, followed }
}

/// The reference at the ends of the given ticks, as far as the disturbed one stays with it.
fn follow(
    mut exact: Follower,
    mut disturbed: Follower,
    ticks: &[u32],
    stop: &AtomicBool,
) -> Result<Vec<Observation>, ReferenceError> {
    let mut observations = Vec::with_capacity(ticks.len());
    let mut rows: [Vec<Row>; 2] = Default::default();
    for block in ticks.chunks(BLOCK) {
        if stop.load(Ordering::Relaxed) {
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
        if let Some(departure) = departure(exact_rows, disturbed_rows, observations.len() - block.len()) {
            observations.truncate(departure);
            break;
        }
    }
    Ok(observations)
}

/// A reference that is given a run's torques.
struct Follower {
    reference: Reference,
    commands: VecDeque<Command>,
    torques: (f64, f64),
    tick_rate: f64,
    factor: f64,
    ratio: f64,
}

impl Follower {
    fn new(
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

impl UnderWay {
    /// Ends the references without their result.
    pub fn abandon(self) {
        self.stop.store(true, Ordering::Relaxed);
        // Nobody waits for a result that nobody wants: the threads end by themselves within a sample.
    }

    /// Waits for the references and compares the samples of the run with them.
    pub fn finish(self, samples: &[Sample], ratio: f64) -> Outcome<Comparison> {
        let exact = match self.followed.join() {
            Ok(Ok(observations)) => observations,
            Ok(Err(error)) => return Err(Failure::new(format!("the reference does not take this joint: {error}"))),
            Err(_) => return Err(Failure::new("the reference has failed")),
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
            let spread = spread(&exact_rows, place);
            let distances = || {
                board.iter().zip(&exact_rows).enumerate().filter_map(move |(index, (board, exact))| {
                    board.as_ref().map(|board| (index, board.distance(exact, place) / spread))
                })
            };
            let count = distances().count();
            let square: f64 = distances().map(|(_, distance)| distance * distance).sum();
            errors.push(QuantityError {
                name: quantity.name,
                error: (square / count as f64).sqrt(),
                bound: quantity.bound,
            });
            series.push(record::ErrorSeries {
                quantity: quantity.name.to_owned(),
                time_s: distances().map(|(index, _)| motion.time_s[index]).collect(),
                error_percent: distances().map(|(_, distance)| 100.0 * distance).collect(),
                bound_percent: 100.0 * quantity.bound.limit,
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

/// The first sample, from a place on, at which the disturbed reference has departed from the other.
fn departure(exact: &[Row], disturbed: &[Row], from: usize) -> Option<usize> {
    let spreads: Vec<f64> = (0..QUANTITIES.len()).map(|place| spread(exact, place)).collect();
    let departed = |(exact, disturbed): (&Row, &Row)| {
        spreads.iter().enumerate().any(|(place, spread)| disturbed.distance(exact, place).abs() > PREDICTABLE * spread)
    };
    let later = exact.iter().zip(disturbed).skip(from).position(departed);
    later.map(|place| from + place).or((disturbed.len() < exact.len()).then_some(disturbed.len()))
}

/// Compared quantities at one moment: as many values each as there are.
#[derive(Debug, Clone, PartialEq)]
struct Row([Vec<f64>; QUANTITIES.len()]);

impl Row {
    fn of_reference(observation: &Observation, ratio: f64) -> Self {
        let deflections = observation.deflections.iter().flatten().copied().collect();
        let twist = observation.motor_offset / ratio - observation.link_offset;
        Self([vec![observation.link_angle], vec![twist], vec![observation.gap], deflections])
    }

    fn of_board(sample: &Sample, ratio: f64) -> Self {
        let motion = MotionSample::from_board(sample, 1);
        let deflections = motion.deflections.iter().copied().map(f64::from).collect();
        let twist = motion.motor_offset / ratio - motion.link_offset;
        Self([vec![motion.carrier_angle + motion.link_offset], vec![twist], vec![motion.gap.into()], deflections])
    }

    /// Distance in one quantity: signed where it is one value, else the root mean square over its values.
    fn distance(&self, other: &Self, place: usize) -> f64 {
        match (self.0[place].as_slice(), other.0[place].as_slice()) {
            (&[one], &[other]) => one - other,
            (ones, others) => {
                let square: f64 = ones.iter().zip(others).map(|(one, other)| (one - other).powi(2)).sum();
                (square / ones.len() as f64).sqrt()
            }
        }
    }
}

/// Standard deviation of one quantity over time, as a root mean square over its values.
fn spread(rows: &[Row], place: usize) -> f64 {
    let values = rows.first().map_or(0, |row| row.0[place].len());
    let count = rows.len() as f64;
    let variance = |value: usize| {
        let mean = rows.iter().map(|row| row.0[place][value]).sum::<f64>() / count;
        rows.iter().map(|row| (row.0[place][value] - mean).powi(2)).sum::<f64>() / count
    };
    ((0..values).map(variance).sum::<f64>() / values as f64).sqrt()
}

/// The board's rows by place in the list of ticks; samples that were lost are missing.
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
        ContactState::DriveSide => record::Contact::DriveSide,
        ContactState::Separated => record::Contact::Separated,
        ContactState::BackSide => record::Contact::BackSide,
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
