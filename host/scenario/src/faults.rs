//! Faults applied on the host, between the f64 drive train and its controller: to counts, torques, set-points and teeth
//! while a run goes on. `active` is one fault with its state, `teeth` its effect on the teeth. A board applies faults
//! by its own code; the test `on_board::same_faults` holds both equal.

mod active;
mod teeth;

use std::collections::VecDeque;

use model_core::virtual_joint::fault::{FaultKind, Shaft};
use parameters::JointParameters;
use reference::closed_loop::SetPoint;
use reference::drive_train::{DriveTrainParameters, Measurement};
use reference::joint::Observation;

use active::Active;
use teeth::ToothState;

use super::file::{Fault, HostOnlyFault, fault_is_on};
use super::plant::Teeth;

/// One encoder reading and when it was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimedReading {
    /// Whole turns included.
    pub counts: i64,
    /// Control period.
    pub period: u64,
}

/// The sensor readings that reach a controller in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControllerInputs {
    /// Now.
    pub period: u64,
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
    /// What the encoders read at the start, where they are homed: what they say is counted from there.
    home: Option<[i64; 2]>,
    past: [VecDeque<TimedReading>; 2],
    /// Periods of the last readings that came.
    come: [Option<u64>; 2],
    last: Option<ControllerInputs>,
    set_points: VecDeque<(u64, SetPoint)>,
    given: Option<(u64, SetPoint)>,
    teeth: ToothState,
}

/// Readings and set-points kept for delayed delivery [periods]: delays are a second at most.
const MEMORY: usize = 100_000;

impl HostFaults {
    /// The faults of a run of a true joint with what truly surrounds it.
    pub fn new(faults: &[Fault], seed: u64, joint: &JointParameters, train: &DriveTrainParameters) -> Self {
        let around = &train.surroundings;
        let encoders = [&around.motor_encoder, &around.output_encoder];
        Self {
            faults: faults.iter().enumerate().map(|(index, fault)| Active::new(fault, index, seed)).collect(),
            period: 1.0 / f64::from(around.control_rate),
            counts_per_turn: encoders.map(|encoder| (1_u64 << encoder.bits) as f64),
            home: None,
            past: Default::default(),
            come: [None; 2],
            last: None,
            set_points: VecDeque::new(),
            given: None,
            teeth: ToothState::new(joint),
        }
    }

    /// Applies faults to a measurement on its way to the controller.
    pub fn sense(&mut self, measurement: &Measurement) -> ControllerInputs {
        let time = measurement.period as f64 * self.period;
        let shafts = [Shaft::Motor, Shaft::Link];
        let counts = [measurement.motor_counts, measurement.output_counts];
        let home = *self.home.get_or_insert(counts);
        let frame =
            |index: usize| Some(TimedReading { counts: counts[index] - home[index], period: measurement.period });
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
        let motor = frames[0].or(self.last.map(|last| last.motor)).unwrap_or(TimedReading { counts: 0, period: 0 });
        let seen = ControllerInputs { period: measurement.period, motor, output: frames[1] };
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

#[cfg(test)]
mod tests;
