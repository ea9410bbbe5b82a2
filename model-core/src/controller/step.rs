//! Observer and compensation combined: once per control period samples and a set-point yield estimates and the
//! compensated torque. The width probe can replace the compensation.

use crate::compensation::CompensationTables;
use crate::compensation::{Command, Compensation, ControlOutput};
use crate::numbers::Real;
use crate::numbers::digest::chain;
use crate::observer::{Estimates, MAPPED, Memory, MemoryError, Observer, Probe, Progress, Samples};
use crate::observer::{ObserverTables, ProbeTable};

/// Outputs of one control period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Answer<T: Real> {
    /// Outputs of the observer.
    pub estimates: Estimates<T>,
    /// Outputs of the compensation.
    pub shaped: ControlOutput<T>,
    /// Progress of the width probe, in a period of the probe.
    pub probed: Option<Progress<T>>,
}

impl<T: Real> Answer<T> {
    /// Extends a digest by the main outputs: torque, gap, half-backlash, load, trust, and the probed half-backlash.
    pub fn digest(&self, running: u64) -> u64 {
        let Self { estimates, shaped, probed } = self;
        let running = match probed {
            Some(Progress::Done(width)) => chain(running, width.value.bits()),
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
/// use model_core::compensation::design::{compensation_settings, design_compensation};
/// use model_core::controller::{Controller, trajectory::Trajectory};
/// use model_core::gears::{Tables, design::design};
/// use model_core::observer::design::{design_observer, observer_settings};
/// use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
/// let around = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
/// let observer = design_observer(&q1.parameters, &observer_settings(&q1.surroundings))?;
/// let compensation = design_compensation(&q1.parameters, &compensation_settings(&q1.surroundings, 60.0))?;
/// let (mut joint, mut controller) = (VirtualJoint::new(&gears, &around), Controller::new(&observer, &compensation));
/// let mut answer = controller.step(&joint.samples(), &Trajectory::HOLD.at(0.0, around.turn));
/// let mut held = 0.0;
/// for period in 1..30_000 {
///     joint.advance(answer.shaped.torque, if period < 10_000 { 0.0 } else { 3.0 });
///     answer = controller.step(&joint.samples(), &Trajectory::HOLD.at(0.0, around.turn));
///     held += if period < 20_000 { 0.0 } else { answer.shaped.torque / 10_000.0 };
/// }
/// // The observer knows of the pull, up to what friction takes of it; the motor holds against it through a gear of 6, over a
/// // second on the mean: as long as nobody has shown it how wide the gap is, it goes to and fro beside that.
/// assert!((answer.estimates.load_torque.value - 3.0).abs() < 0.5, "{:?}", answer.estimates.load_torque);
/// assert!((6.0 * held - 3.0).abs() < 0.7, "{held}");
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Controller<'tables, T: Real> {
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
    pub fn new(observer: &'tables ObserverTables<T>, compensation: &'tables CompensationTables<T>) -> Self {
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
        self.observer.restart();
        self.compensation.restart();
        self.probing = None;
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
            return Answer { probed: Some(Progress::Running), ..still };
        };
        if *wait > 0 {
            *wait -= 1;
            return Answer { probed: Some(Progress::Running), ..still };
        }
        let (torque, progress) = probe.step(&estimates);
        Answer { shaped: ControlOutput { torque, ..ControlOutput::default() }, probed: Some(progress), ..still }
    }
}
