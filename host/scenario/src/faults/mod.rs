//! Faults applied on the host, between the f64 drive train and its controller: to counts, torques, set-points and teeth
//! while a run goes on. `active` is one fault with its state, `teeth` its effect on the teeth. A board applies faults
//! by its own code; the test `on_board::same_faults` holds both equal.

mod active;
mod teeth;

use std::collections::VecDeque;

use model_core::virtual_joint::fault::{EncoderShaft, FaultKind};
use parameters::JointParameters;
use reference::closed_loop::SetPoint;
use reference::drive_train::{DriveTrainParameters, Measurement};
use reference::joint::Observation;

use active::Active;
use teeth::ToothState;

use super::file::{Fault, HostOnlyFault, fault_is_on};
use super::plant::Teeth;
use super::random::RandomStream;

/// One encoder reading and when it was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimedReading {
    /// Whole turns included.
    pub counts: i64,
    /// Control period.
    pub period: u64,
    /// Delay of that period's start [thousandths of a period].
    pub lateness: u32,
}

/// The sensor readings that reach a controller in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControllerInputs {
    /// Now.
    pub period: u64,
    /// Delay of this period's start [thousandths of a period]: a clock of the controller sees it.
    pub lateness: u32,
    /// From the motor's encoder.
    pub motor: TimedReading,
    /// From the output encoder, if a frame came.
    pub output: Option<TimedReading>,
}

/// All faults of a run with their state.
#[derive(Debug, Clone)]
pub struct HostFaults {
    faults: Vec<Active>,
    period: f64,
    counts_per_turn: [f64; 2],
    /// Counts of the encoders where they are homed: what they say is counted from there.
    home: Option<[i64; 2]>,
    /// What homed encoders say at the start: where the link is then, and where a motor is that leads it by nothing.
    start: [i64; 2],
    past: [VecDeque<TimedReading>; 2],
    /// Periods of the last readings that came.
    come: [Option<u64>; 2],
    last: Option<ControllerInputs>,
    set_points: VecDeque<(u64, SetPoint)>,
    given: Option<(u64, SetPoint)>,
    teeth: ToothState,
}

/// Parts of a control period in which delays of its start are counted.
pub const LATENESS_PARTS: u32 = 1000;

/// Readings and set-points kept for delayed delivery [periods]: delays are a second at most.
const MEMORY: usize = 100_000;

impl HostFaults {
    /// The faults of a run of a true joint with what truly surrounds it.
    pub fn new(faults: &[Fault], seed: u64, joint: &JointParameters, train: &DriveTrainParameters) -> Self {
        let around = &train.surroundings;
        let encoders = [&around.motor_encoder, &around.output_encoder];
        let stated = faults.iter().enumerate().map(|(index, fault)| Active::new(fault, index, seed));
        Self {
            faults: stated.chain(missing_frames(encoders.map(|encoder| encoder.missing_share), seed)).collect(),
            period: 1.0 / f64::from(around.control_rate),
            counts_per_turn: encoders.map(|encoder| encoder.counts_per_turn as f64),
            home: None,
            start: [0; 2],
            past: Default::default(),
            come: [None; 2],
            last: None,
            set_points: VecDeque::new(),
            given: None,
            teeth: ToothState::new(joint),
        }
    }

    /// The same for a link that starts at an angle [rad] behind gears of a ratio.
    pub fn starting_at(self, link_angle: f64, ratio: f64) -> Self {
        let [motor, output] = self.counts_per_turn.map(|counts| link_angle / std::f64::consts::TAU * counts);
        Self { start: [ratio * motor, output].map(|counts| counts.round() as i64), ..self }
    }

    /// Applies faults to a measurement on its way to the controller.
    pub fn sense(&mut self, measurement: &Measurement) -> ControllerInputs {
        self.sense_late(measurement, 0.0)
    }

    /// Applies faults to a measurement of a control period that began so late [s].
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
            past.truncate(MEMORY);
            let shaft = shafts[index];
            let mut keep = 0;
            for fault in self.faults.iter_mut() {
                match fault.fault.kind {
                    FaultKind::Other(HostOnlyFault::LateReadings(of, delay)) if of == shaft => {
                        let late = (delay / self.period).round() as usize;
                        keep = keep.max(late);
                        // What has come before does not come again: while a delay begins, nothing comes.
                        let known = self.come[index];
                        if fault_is_on(&fault.fault, time) {
                            let arrived = past.iter().rev().nth(late).copied();
                            *frame = arrived.filter(|arrived| known.is_none_or(|known| arrived.period > known));
                        }
                    }
                    FaultKind::LostReadings(of, share)
                        if of == shaft && fault_is_on(&fault.fault, time) && fault.stream.uniform() < share =>
                    {
                        *frame = None;
                    }
                    _ => {}
                }
            }
            while past.len() > keep + 1 {
                past.pop_front();
            }
            self.come[index] = frame.map(|frame| frame.period).or(self.come[index]);
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

    /// The set-point that the controller acts on; `number` tells one frame from the next.
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
                    if fault_is_on(&fault.fault, time) {
                        arrived = self.set_points.iter().rev().nth(late).or(self.set_points.front()).copied();
                    }
                }
                FaultKind::Other(HostOnlyFault::LostSetPoints(share)) if fault_is_on(&fault.fault, time) => {
                    // A frame that is held for several periods is lost once.
                    let lost = match fault.dropped {
                        Some((last, lost)) if last == number => lost,
                        _ => fault.stream.uniform() < share,
                    };
                    fault.dropped = Some((number, lost));
                    arrived = arrived.filter(|_| !lost);
                }
                _ => {}
            }
        }
        while self.set_points.len() > keep {
            self.set_points.pop_front();
        }
        let is_new = |(number, _): &(u64, SetPoint)| self.given.is_none_or(|(known, _)| *number >= known);
        self.given = arrived.filter(is_new).or(self.given).or(Some((number, set_point)));
        self.given.map_or(set_point, |(_, set_point)| set_point)
    }

    /// What the motor makes of a torque that was asked of it [N m].
    pub fn torque(&self, time: f64, command: f64) -> f64 {
        let on = self.faults.iter().filter(|active| fault_is_on(&active.fault, time));
        on.fold(command, |torque, active| match active.fault.kind {
            FaultKind::TorqueBias(ratio, offset) => torque * (1.0 + ratio) + offset,
            FaultKind::Saturation(limit) => torque.clamp(-limit, limit),
            _ => torque,
        })
    }

    /// Half-backlash that the teeth have now [m].
    pub fn half_backlash_now(&self) -> f64 {
        self.teeth.now
    }

    /// Changes the teeth as faults begin, end, or meet.
    pub fn wear(&mut self, time: f64, joint: &Observation, inside: &mut dyn Teeth) {
        self.teeth.wear(&self.faults, time, joint, inside);
    }
}

/// Readings that an encoder leaves out by itself, as faults of the whole run with random numbers of their own.
fn missing_frames(shares: [f64; 2], seed: u64) -> impl Iterator<Item = Active> {
    let of = [(EncoderShaft::Motor, "missing frames motor"), (EncoderShaft::Link, "missing frames output")];
    of.into_iter().zip(shares).filter(|(_, share)| *share > 0.0).map(move |((shaft, stream), share)| {
        let kind = FaultKind::LostReadings(shaft, share);
        let fault = Fault { start: 0.0, end: f64::INFINITY, seed: (), kind };
        Active::with_stream(&fault, RandomStream::new(seed, stream))
    })
}

#[cfg(test)]
mod tests;
