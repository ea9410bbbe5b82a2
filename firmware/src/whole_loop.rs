//! Role `loop`: joint, motor, observer and compensation on one chip in real time; a trajectory in, samples of the
//! motion out. Observer and compensation run behind a port, as with any motor controller.

use heapless::Vec;
use link::messages::{FromBoard, Role, Schedule, ToBoard};
use link::virtual_joint::{KNOTS_PER_SCHEDULE, Knot, LOOP_SAMPLES_PER_BATCH, LoopBatch, LoopSample};
use model_core::controller::Answer;
use model_core::controller::trajectory::Trajectory;
use model_core::gears::Tables;
use model_core::numbers::digest;
use model_core::observer::{Memory, MemoryError};
use model_core::virtual_joint::fault::{Fault, FixedPoint};
use model_core::virtual_joint::fault_injector::FaultInjector;
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};

use crate::batcher::Batcher;
use crate::learnt::RunMemory;
use crate::port::ControllerPort;
use crate::protocol::{Protocol, Timed, WireForm};
use crate::work::Work;

/// Longest segment [periods]: three knots of the host. A segment without a following knot is held at this time.
const LONGEST_SEGMENT: u16 = 150;

/// Messages of the role.
pub struct LoopProtocol;

impl Protocol for LoopProtocol {
    const ROLE: Role = Role::Loop;
    type Command = Knot;
    type Timetable = Schedule<Knot, KNOTS_PER_SCHEDULE>;
    type Sample = LoopSample;
    type Batch = Batcher<LoopForm, LOOP_SAMPLES_PER_BATCH>;
    type Learnt = Memory;

    fn timetable(message: ToBoard) -> Option<Self::Timetable> {
        if let ToBoard::Trajectory(schedule) = message { Some(schedule) } else { None }
    }
}

impl Timed for Knot {
    fn tick(&self) -> u32 {
        self.tick
    }

    fn is_sound(&self) -> bool {
        self.is_finite()
    }
}

/// Wire form of the loop's samples, equal to the form in the tick.
pub struct LoopForm;

impl WireForm<LOOP_SAMPLES_PER_BATCH> for LoopForm {
    type Raw = LoopSample;
    type Wire = LoopSample;

    fn wire(raw: &LoopSample) -> LoopSample {
        *raw
    }

    fn message(sequence: u16, samples: Vec<LoopSample, LOOP_SAMPLES_PER_BATCH>) -> FromBoard {
        FromBoard::Loop(LoopBatch { sequence, samples })
    }
}

/// State of the role `loop`.
pub struct WholeLoop<'t, P, const N: usize> {
    tables: &'t Tables<f32, N>,
    surroundings: &'t SurroundingsTable<f32>,
    joint: VirtualJoint<'t, f32, N>,
    /// Injected faults of the signals between joint and port.
    faults: FaultInjector<f32>,
    port: P,
    /// The memory at hand.
    run_memory: RunMemory,
    trajectory: Trajectory<f32>,
    load_torque: f32,
    /// Periods since the segment began.
    elapsed: u16,
    answer: Answer<f32>,
    digest: u64,
}

impl<'t, P: ControllerPort, const N: usize> WholeLoop<'t, P, N> {
    /// State at rest.
    pub fn new(tables: &'t Tables<f32, N>, surroundings: &'t SurroundingsTable<f32>, port: P) -> Self {
        Self {
            tables,
            surroundings,
            joint: VirtualJoint::new(tables, surroundings),
            faults: FaultInjector::default(),
            port,
            run_memory: RunMemory::default(),
            trajectory: Trajectory::HOLD,
            load_torque: 0.0,
            elapsed: 0,
            answer: Answer::default(),
            digest: digest::START,
        }
    }
}

impl<P: ControllerPort, const N: usize> Work for WholeLoop<'_, P, N> {
    type Protocol = LoopProtocol;
    const FREE_RUNNING: bool = true;

    fn is_sound(&self) -> bool {
        self.tables.digest_is_good()
    }

    fn reset(&mut self, from_memory: bool) {
        self.joint.reset();
        self.faults = FaultInjector::default();
        self.port.reset();
        if from_memory {
            self.run_memory.load_into(&mut self.port);
        }
        self.trajectory = Trajectory::HOLD;
        self.load_torque = 0.0;
        self.elapsed = 0;
        self.answer = Answer::default();
        self.digest = digest::START;
    }

    fn take(&mut self, knot: Knot) {
        self.trajectory = knot.trajectory.into();
        self.load_torque = knot.load_torque;
        self.elapsed = 0;
    }

    fn add_fault(&mut self, fault: Fault<FixedPoint<f32>>) -> bool {
        self.faults.add(fault)
    }

    fn learn(&mut self) -> bool {
        self.run_memory.learn_from(&self.port)
    }

    fn learnt(&self) -> Option<&Memory> {
        self.run_memory.get()
    }

    fn remember(&mut self, memory: &Memory) -> Result<(), MemoryError> {
        self.run_memory.take(memory, &mut self.port)
    }

    fn remember_learnt(&mut self, learnt: &Memory) -> Result<(), MemoryError> {
        self.remember(learnt)
    }

    fn forget(&mut self) {
        self.run_memory.forget();
    }

    fn step(&mut self) {
        let table = self.surroundings;
        let command = self.trajectory.at(table.period * f32::from(self.elapsed), table.turn);
        // A polynomial is valid in its own segment only; without a following knot it is held at the end of the segment.
        self.elapsed = self.elapsed.saturating_add(1).min(LONGEST_SEGMENT);
        let samples = self.faults.apply_to_samples(self.joint.samples(), table);
        let torque = match self.port.exchange(&samples, &command) {
            Ok(answer) => {
                self.answer = answer;
                answer.shaped.torque
            }
            Err(_) => 0.0,
        };
        self.joint.advance(self.faults.apply_to_torque(torque), self.load_torque);
        self.digest = digest::chain(self.answer.digest(self.digest), self.joint.model().state_digest());
    }

    fn is_finite(&self) -> bool {
        self.joint.model().is_finite()
    }

    fn sample(&self, steps: u32, computation: u16) -> LoopSample {
        let outputs = self.joint.outputs();
        let estimates = &self.answer.estimates;
        LoopSample {
            tick: steps,
            digest: self.digest,
            carrier: (outputs.carrier_turns, outputs.carrier_fraction),
            link_offset: outputs.link_offset,
            gaps: (outputs.gap, estimates.gap.value),
            gap_valid: estimates.gap.valid,
            half_backlash: estimates.half_backlash.value,
            torque: self.answer.shaped.torque,
            loads: (self.joint.acting().load, estimates.load_torque.value),
            trust: self.answer.shaped.trust,
            computation,
        }
    }
}
