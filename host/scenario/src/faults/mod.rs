//! Faults on the host, applied between the f64 drive train and its controller to counts, torques, set-points and teeth
//! during a run. `active` is one fault with its state, `teeth` the effect on the teeth. A board has its own code for
//! faults; the test `on_board::same_faults` checks that both agree.

mod active;
mod teeth;

use std::collections::VecDeque;

use model_core::virtual_joint::fault::{EncoderShaft, FaultKind};
use parameters::JointParameters;
use reference::closed_loop::SetPoint;
use reference::drive_train::{DriveTrainParameters, Measurement};
use reference::joint::Observation;

use active::ActiveFault;
use teeth::ToothState;
pub use teeth::check_broken_tooth;

use super::file::{Fault, HostOnlyFault, fault_is_active};
use super::plant::Teeth;
use super::random::RandomStream;

/// An encoder reading and its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimedReading {
    /// Counts, whole turns included.
    pub counts: i64,
    /// Control period of the reading.
    pub period: u64,
    /// Delay of that period's start [thousandths of a period].
    pub lateness: u32,
}

/// Sensor readings that reach a controller in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControllerInputs {
    /// Current control period.
    pub period: u64,
    /// Delay of this period's start [thousandths of a period], visible to the controller's clock.
    pub lateness: u32,
    /// Reading of the motor encoder.
    pub motor: TimedReading,
    /// Reading of the output encoder, if a frame arrived.
    pub output: Option<TimedReading>,
}

/// All faults of a run with their state.
#[derive(Debug, Clone)]
pub struct HostFaults {
    faults: Vec<ActiveFault>,
    period: f64,
    counts_per_turn: [f64; 2],
    /// Counts of the homed encoders; readings are relative to them.
    home: Option<[i64; 2]>,
    /// Readings of the homed encoders at the start: link angle, and motor angle with its lead since the mounting.
    start: [i64; 2],
    past: [VecDeque<TimedReading>; 2],
    /// Periods of the last readings that arrived.
    last_delivered: [Option<u64>; 2],
    last: Option<ControllerInputs>,
    set_points: VecDeque<(u64, SetPoint)>,
    delivered_set_point: Option<(u64, SetPoint)>,
    teeth: ToothState,
}

/// Resolution of a period's delay [parts of a control period].
pub const LATENESS_PARTS: u32 = 1000;

/// Readings and set-points stored for delayed delivery [periods]; a delay is at most a second.
const MAX_DELAY_PERIODS: usize = 100_000;

impl HostFaults {
    /// Faults of a run with the true joint and its true surroundings.
    pub fn new(faults: &[Fault], seed: u64, joint: &JointParameters, train: &DriveTrainParameters) -> Self {
        let surroundings = &train.surroundings;
        let encoders = [&surroundings.motor_encoder, &surroundings.output_encoder];
        let stated = faults.iter().enumerate().map(|(index, fault)| ActiveFault::new(fault, index, seed));
        Self {
            faults: stated.chain(missing_frames(encoders.map(|encoder| encoder.missing_share), seed)).collect(),
            period: 1.0 / f64::from(surroundings.control_rate),
            counts_per_turn: encoders.map(|encoder| encoder.counts_per_turn as f64),
            home: None,
            start: [0; 2],
            past: Default::default(),
            last_delivered: [None; 2],
            last: None,
            set_points: VecDeque::new(),
            delivered_set_point: None,
            teeth: ToothState::new(joint),
        }
    }

    /// Sets the angles at the start, behind gears of the given ratio, and those at which the encoders were mounted.
    pub fn starting_at(self, start: &Observation, mounted: &Observation, ratio: f64) -> Self {
        let lead = |joint: &Observation| joint.motor_angle - ratio * joint.link_angle;
        let angles = [ratio * start.link_angle + (lead(start) - lead(mounted)), start.link_angle];
        let counts =
            |shaft: usize| (angles[shaft] / std::f64::consts::TAU * self.counts_per_turn[shaft]).round() as i64;
        Self { start: [0, 1].map(counts), ..self }
    }

    /// Adds a fault during a run; `seed` is that of its random numbers.
    pub fn inject(&mut self, fault: &Fault, seed: u64) {
        self.faults.push(ActiveFault::new(fault, self.faults.len(), seed));
    }

    /// Ends all faults at a time [s]. Readings that encoders drop by themselves go on; lost counts stay lost.
    pub fn end_all(&mut self, time: f64) {
        let stated = self.faults.iter_mut().filter(|active| !active.is_of_encoder);
        stated.for_each(|active| active.fault.end = active.fault.end.min(time));
    }

    /// Sets the half-backlash of the sound teeth [m].
    pub fn set_half_backlash(&mut self, half_backlash: f64) {
        self.teeth.set_half_backlash(half_backlash);
    }

    /// Applies faults to a measurement on its way to the controller.
    pub fn sense(&mut self, measurement: &Measurement) -> ControllerInputs {
        self.sense_late(measurement, 0.0)
    }

    /// Applies faults to a measurement of a control period that began late [s].
    pub fn sense_late(&mut self, measurement: &Measurement, lateness: f64) -> ControllerInputs {
        let lateness = (lateness / self.period * f64::from(LATENESS_PARTS)).round() as u32;
        let time = measurement.period as f64 * self.period;
        let shafts = [EncoderShaft::Motor, EncoderShaft::Link];
        let counts = [measurement.motor_counts, measurement.output_counts];
        let start = self.start;
        let home = *self.home.get_or_insert([counts[0] - start[0], counts[1] - start[1]]);
        let frame = |index: usize| {
            Some(TimedReading { counts: counts[index] - home[index], period: measurement.period, lateness })
        };
        let mut frames = [frame(0), frame(1)];
        for (index, frame) in frames.iter_mut().enumerate() {
            for fault in self.faults.iter_mut() {
                if let Some(frame) = frame {
                    frame.counts = fault.count(time, shafts[index], frame.counts, self.counts_per_turn[index]);
                }
            }
            let Some(fresh) = *frame else { continue };
            let past = &mut self.past[index];
            past.push_back(fresh);
            past.truncate(MAX_DELAY_PERIODS);
            let shaft = shafts[index];
            let mut keep = 0;
            for fault in self.faults.iter_mut() {
                match fault.fault.kind {
                    FaultKind::Other(HostOnlyFault::LateReadings(of, delay)) if of == shaft => {
                        let late = (delay / self.period).round() as usize;
                        keep = keep.max(late);
                        // A reading is not delivered twice: while a delay begins, no reading arrives.
                        let known = self.last_delivered[index];
                        if fault_is_active(&fault.fault, time) {
                            let arrived = past.iter().rev().nth(late).copied();
                            *frame = arrived.filter(|arrived| known.is_none_or(|known| arrived.period > known));
                        }
                    }
                    FaultKind::LostReadings(of, share)
                        if of == shaft && fault_is_active(&fault.fault, time) && fault.stream.uniform() < share =>
                    {
                        *frame = None;
                    }
                    _ => {}
                }
            }
            while past.len() > keep + 1 {
                past.pop_front();
            }
            self.last_delivered[index] = frame.map(|frame| frame.period).or(self.last_delivered[index]);
        }
        // A silent motor encoder leaves its last reading in place, with the time of that reading.
        let motor = frames[0].or(self.last.map(|last| last.motor)).unwrap_or(TimedReading {
            counts: 0,
            period: 0,
            lateness: 0,
        });
        let seen = ControllerInputs { period: measurement.period, lateness, motor, output: frames[1] };
        self.last = Some(seen);
        seen
    }

    /// Set-point that reaches the controller; `number` identifies the frame.
    pub fn receive(&mut self, time: f64, number: u64, set_point: SetPoint) -> SetPoint {
        if self.set_points.back().is_none_or(|(last, _)| *last != number) {
            self.set_points.push_back((number, set_point));
        }
        let mut arrived = Some((number, set_point));
        let mut keep = 1;
        for fault in self.faults.iter_mut() {
            match fault.fault.kind {
                FaultKind::Other(HostOnlyFault::LateSetPoints(delay)) => {
                    let late = (delay / self.period).round() as usize;
                    keep = keep.max(late + 1);
                    if fault_is_active(&fault.fault, time) {
                        arrived = self.set_points.iter().rev().nth(late).or(self.set_points.front()).copied();
                    }
                }
                FaultKind::Other(HostOnlyFault::LostSetPoints(share)) if fault_is_active(&fault.fault, time) => {
                    // A frame that is held for several periods is lost once.
                    let lost = match fault.last_set_point {
                        Some((last, lost)) if last == number => lost,
                        _ => fault.stream.uniform() < share,
                    };
                    fault.last_set_point = Some((number, lost));
                    arrived = arrived.filter(|_| !lost);
                }
                _ => {}
            }
        }
        while self.set_points.len() > keep {
            self.set_points.pop_front();
        }
        let is_new = |(number, _): &(u64, SetPoint)| self.delivered_set_point.is_none_or(|(known, _)| *number >= known);
        self.delivered_set_point = arrived.filter(is_new).or(self.delivered_set_point).or(Some((number, set_point)));
        self.delivered_set_point.map_or(set_point, |(_, set_point)| set_point)
    }

    /// Torque of the motor for a command [N m].
    pub fn torque(&self, time: f64, command: f64) -> f64 {
        let on = self.faults.iter().filter(|active| fault_is_active(&active.fault, time));
        on.fold(command, |torque, active| match active.fault.kind {
            FaultKind::TorqueBias(ratio, offset) => torque * (1.0 + ratio) + offset,
            FaultKind::Saturation(limit) => torque.clamp(-limit, limit),
            _ => torque,
        })
    }

    /// Current half-backlash of the teeth [m].
    pub fn current_half_backlash(&self) -> f64 {
        self.teeth.half_backlash_now
    }

    /// Changes the teeth as faults begin, end, or come into mesh.
    pub fn update_teeth(&mut self, time: f64, joint: &Observation, inside: &mut dyn Teeth) {
        self.teeth.update_teeth(&self.faults, time, joint, inside);
    }
}

/// Readings that an encoder drops by itself, as faults of the whole run with their own random numbers.
fn missing_frames(shares: [f64; 2], seed: u64) -> impl Iterator<Item = ActiveFault> {
    let of = [(EncoderShaft::Motor, "missing frames motor"), (EncoderShaft::Link, "missing frames output")];
    of.into_iter().zip(shares).filter(|(_, share)| *share > 0.0).map(move |((shaft, stream), share)| {
        let kind = FaultKind::LostReadings(shaft, share);
        let fault = Fault { start: 0.0, end: f64::INFINITY, seed: (), kind };
        let mut active = ActiveFault::with_stream(&fault, RandomStream::new(seed, stream));
        active.is_of_encoder = true;
        active
    })
}

#[cfg(test)]
mod tests;
