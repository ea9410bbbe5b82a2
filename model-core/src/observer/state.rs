//! The observer's whole state, as it is designed and after a restart. What a control period does with it is left to
//! `step` and the files that it names.

use super::anchor::Anchor;
use super::bias::Bias;
use super::block::Block;
use super::contact::ByForce;
use super::counts::Counts;
use super::drive_side::DriveSide;
use super::estimates::Estimates;
use super::inertia::Inertia;
use super::interval::Interval;
use super::knowledge::Knowledge;
use super::late::Lateness;
use super::learner::Learner;
use super::load_side::LoadSide;
use super::motion::Motion;
use super::pace::Pace;
use super::places::Places;
use super::regressors::{COMPLIANCE, HALF_GAP};
use super::supervisor::Supervisor;
use crate::numbers::Real;
use crate::observer::tables::ObserverTables;
use parameters::ContactState;

/// The observer of one joint. `P` is [`PLAIN`](super::PLAIN) or [`MAPPED`](super::MAPPED).
#[derive(Debug, Clone)]
pub struct Observer<'tables, T: Real, const P: usize> {
    pub(super) tables: &'tables ObserverTables<T>,
    pub(super) counts: Counts,
    pub(super) lateness: Lateness,
    pub(super) drive: DriveSide<T>,
    pub(super) load: LoadSide<T>,
    pub(super) inertia: Inertia<T>,
    pub(super) bias: Bias<T>,
    pub(super) by_force: ByForce,
    pub(super) motion: Motion<T>,
    pub(super) learner: Learner<T, P>,
    pub(super) places: Places<T, P>,
    pub(super) interval: Interval<T>,
    pub(super) block: Block<T, P>,
    pub(super) anchor: Anchor<T, P>,
    pub(super) doubts: Doubts,
    pub(super) knowledge: Knowledge<T>,
    pub(super) supervisor: Supervisor<T>,
    pub(super) pace: Pace,
    pub(super) blind: Blind<T>,
    /// When the last samples were taken, in ticks.
    pub(super) time: u32,
    /// Teeth have settled since they came across the gap.
    pub(super) settled: bool,
    /// Torque that the meshes put on the load side, by the motor side alone [N m].
    pub(super) from_meshes: T,
    pub(super) estimates: Estimates<T>,
}

/// What is known of the load without seeing it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Blind<T: Real> {
    /// Periods since contact was last felt for sure, as far as they count.
    pub open_for: u16,
    /// Contact has been felt since the output encoder was given up.
    pub anchored: bool,
    /// Contact that is felt for sure now.
    pub felt: ContactState,
    /// Mesh force, smoothed [N].
    pub force: T,
    /// Speed at which the teeth landed last, dying away as bounces do [m/s].
    pub bounce: T,
}

/// What speaks against what was learnt.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Doubts {
    /// Intervals in a row with force between the flanks.
    pub contradicted: u8,
    /// Ways in a row that did not belong to the model.
    pub surprises: u8,
    /// Ways without surprise on the back side and on the drive side since the width was doubted.
    pub trusted: [u8; 2],
    /// How often it was.
    pub doubted: u8,
}

impl<'tables, T: Real, const P: usize> Observer<'tables, T, P> {
    /// An observer that has seen nothing yet and knows what was designed.
    pub fn new(tables: &'tables ObserverTables<T>) -> Self {
        let learner = Learner::new(&tables.learner);
        let mut counts = Counts::default();
        if !tables.counts.has_output {
            counts.imply();
        }
        let mut observer = Self {
            tables,
            counts,
            lateness: Lateness::default(),
            drive: DriveSide::default(),
            load: LoadSide::default(),
            inertia: Inertia::new(&tables.inertia),
            bias: Bias::new(&tables.contact),
            by_force: ByForce::default(),
            motion: Motion::new(),
            knowledge: Knowledge::new(tables, &learner),
            learner,
            places: Places::new(),
            interval: Interval::new(),
            block: Block::new(),
            anchor: Anchor::new(),
            doubts: Doubts::default(),
            supervisor: Supervisor::new(tables.counts.has_output),
            pace: Pace::new(),
            blind: Blind::default(),
            time: 0,
            settled: false,
            from_meshes: T::ZERO,
            estimates: Estimates::default(),
        };
        observer.find_places();
        observer.say_learnt();
        observer
    }

    /// Back to what was designed, part by part: a whole new observer would need as much stack again.
    pub fn restart(&mut self) {
        let tables = self.tables;
        self.counts = Counts::default();
        if !tables.counts.has_output {
            self.counts.imply();
        }
        self.lateness = Lateness::default();
        self.drive = DriveSide::default();
        self.load = LoadSide::default();
        self.inertia = Inertia::new(&tables.inertia);
        self.bias = Bias::new(&tables.contact);
        self.by_force = ByForce::default();
        self.motion = Motion::new();
        self.learner = Learner::new(&tables.learner);
        self.knowledge = Knowledge::new(tables, &self.learner);
        self.places = Places::new();
        self.interval = Interval::new();
        self.block = Block::new();
        self.anchor = Anchor::new();
        self.doubts = Doubts::default();
        self.supervisor = Supervisor::new(tables.counts.has_output);
        self.pace = Pace::new();
        self.blind = Blind::default();
        self.time = 0;
        self.settled = false;
        self.from_meshes = T::ZERO;
        self.estimates = Estimates::default();
        self.find_places();
        self.say_learnt();
    }

    /// What the last step said.
    pub fn estimates(&self) -> &Estimates<T> {
        &self.estimates
    }

    /// Half-gap [m] and compliance [m/N] as learnt so far.
    pub(super) fn shape(&self) -> [T; 2] {
        [self.learner.value(HALF_GAP), self.learner.value(COMPLIANCE)]
    }
}
