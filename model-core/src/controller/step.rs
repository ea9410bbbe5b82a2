//! Observer and compensation combined: once per control period samples and a set-point yield estimates and the
//! compensated torque. The width probe can replace the compensation.

use crate::compensation::CompensationTables;
use crate::compensation::{Command, Compensation, ControlOutput};
use crate::controller::ControllerDesign;
use crate::numbers::Real;
use crate::numbers::digest::chain;
use crate::observer::{Estimates, MAPPED, Memory, MemoryError, Observer, Samples};
use crate::observer::{ObserverTables, ProbeTable};
use crate::width_probe::{Probe, ProbeProgress};

/// Outputs of one control period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Answer<T: Real = f32> {
    /// Outputs of the observer.
    pub estimates: Estimates<T>,
    /// Outputs of the compensation.
    pub shaped: ControlOutput<T>,
    /// Progress of the width probe, in a period of the probe.
    pub probed: Option<ProbeProgress<T>>,
}

impl<T: Real> Answer<T> {
    /// Extends a digest by the main outputs: torque, gap, half-backlash, load, trust, and the probed half-backlash.
    pub fn digest(&self, running: u64) -> u64 {
        let Self { estimates, shaped, probed } = self;
        let running = match probed {
            Some(ProbeProgress::Done(width)) => chain(running, width.value.bits()),
            _ => running,
        };
        [shaped.torque, estimates.gap.value, estimates.half_backlash.value, estimates.load_torque.value, shaped.trust]
            .iter()
            .fold(running, |digest, value| chain(digest, value.bits()))
    }
}

/// Controller of one joint: observer with error maps, and compensation.
///
/// The controller holds a link at angle zero; after a second 3 N m pull at the link:
///
/// ```
/// use model_core::{Command, Controller, ControllerDesign, VirtualJointDesign};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let design = ControllerDesign::new(&q1, 10_000)?;
/// let plant = VirtualJointDesign::<3>::new(&q1, 10_000)?;
/// let (mut joint, mut controller) = (plant.joint(), Controller::new(&design));
/// let mut answer = controller.step(&joint.samples(), &Command::HOLD);
/// let mut held = 0.0;
/// for period in 1..30_000 {
///     joint.advance(answer.shaped.torque, if period < 10_000 { 0.0 } else { 3.0 });
///     answer = controller.step(&joint.samples(), &Command::HOLD);
///     held += if period < 20_000 { 0.0 } else { answer.shaped.torque / 10_000.0 };
/// }
/// // The estimated load torque is the pull, less friction. On average over a second the motor holds against the pull
/// // through the gear ratio of 6; before the width of the gap is known, the torque oscillates about that.
/// assert!((answer.estimates.load_torque.value - 3.0).abs() < 0.5, "{:?}", answer.estimates.load_torque);
/// assert!((6.0 * held - 3.0).abs() < 0.7, "{held}");
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Controller<'tables, T: Real = f32> {
    observer: Observer<'tables, T, MAPPED>,
    compensation: Compensation<'tables, T>,
    probe_table: Option<&'tables ProbeTable<T>>,
    probing: Option<Probing<'tables, T>>,
}

/// Width probe, and the periods until the observer has settled.
#[derive(Debug, Clone)]
struct Probing<'tables, T: Real> {
    probe: Probe<'tables, T>,
    wait: u32,
}

impl<'tables, T: Real> Controller<'tables, T> {
    /// Creates a controller in its initial state.
    pub fn new(design: &'tables ControllerDesign<T>) -> Self {
        Self::with_tables(&design.observer, &design.compensation).with_probe(design.probe.as_ref())
    }

    /// Creates a controller in its initial state from tables that stand apart, without a width probe.
    pub fn with_tables(observer: &'tables ObserverTables<T>, compensation: &'tables CompensationTables<T>) -> Self {
        Self {
            observer: Observer::new(observer),
            compensation: Compensation::new(compensation),
            probe_table: None,
            probing: None,
        }
    }

    /// Adds a width probe, if its table could be designed.
    pub fn with_probe(self, table: Option<&'tables ProbeTable<T>>) -> Self {
        Self { probe_table: table, ..self }
    }

    /// Returns to the initial state and discards all estimated parameters.
    pub fn reset(&mut self) {
        self.observer.reset();
        self.compensation.restart();
        self.probing = None;
    }

    /// Estimates of the last step.
    pub fn estimates(&self) -> &Estimates<T> {
        self.observer.estimates()
    }

    /// Estimated parameters of the observer.
    pub fn save(&self) -> Memory {
        self.observer.save()
    }

    /// Restores saved parameters. A refused memory changes nothing.
    pub fn load(&mut self, memory: &[u8]) -> Result<(), MemoryError> {
        self.observer.load(memory)
    }

    /// Runs one control period. Not inlined: beside a plant on the same processor the values would need stack at the
    /// same time.
    #[inline(never)]
    pub fn step(&mut self, samples: &Samples<T>, command: &Command<T>) -> Answer<T> {
        let estimates = *self.observer.step(samples);
        self.probing = None;
        let shaped = self.compensation.step(&estimates, command);
        Answer { estimates, shaped, probed: None }
    }

    /// Runs one control period of a width probe. The probe begins with the first of consecutive calls and keeps its
    /// result until [`step`](Self::step) is called. Without a probe table the torque is zero and `probed` is `None`.
    #[inline(never)]
    pub fn probe(&mut self, samples: &Samples<T>) -> Answer<T> {
        let estimates = *self.observer.step(samples);
        let still = Answer { estimates, ..Answer::default() };
        let Some(table) = self.probe_table else { return still };
        let Some(Probing { probe, wait }) = &mut self.probing else {
            self.compensation.restart();
            self.probing = Some(Probing { probe: Probe::new(table), wait: table.settle });
            return Answer { probed: Some(ProbeProgress::Running), ..still };
        };
        if *wait > 0 {
            *wait -= 1;
            return Answer { probed: Some(ProbeProgress::Running), ..still };
        }
        let (torque, progress) = probe.step(&estimates);
        Answer { shaped: ControlOutput { torque, ..ControlOutput::default() }, probed: Some(progress), ..still }
    }
}
