//! Where the gap is: from encoder counts and motor torque to gap coordinate, contact, torques and everything about the
//! joint that they depend on, once a control period. Making use of it is left to `compensation`.
//!
//! The structure, front to back:
//! 1. `counts` unwraps raw counts and forms motor less ratio times output in whole numbers: exact over any number of
//!    turns and over wrap-around. `places` knows what the encoders' and the gears' errors are there.
//! 2. `drive_side`, a disturbance observer on the motor, gives the mesh force; `load_side`, the same on the link,
//!    position, speed and load torque. Both are linear flows from tables.
//! 3. `motion` tells crossing from rest without knowing the width; `bias` takes from open gaps what the motor's torque is
//!    wrong by; `contact` decides which flank touches.
//! 4. `learner` is one small recursive least squares, updated every few periods in settled contact, for half-backlash,
//!    offset, compliance, skew and the encoders' error maps. `anchor` and `ride` tell flanks without a force that stands
//!    out, and `doubt` what no longer belongs to what was learnt. `parts` gives each period some of that work.
//! 5. `pace` and `supervisor` watch the output encoder and fall back to the motor alone.
//!
//! `docs/observer.md` derives all of it and says what it cannot know.

mod anchor;
mod bias;
mod block;
mod contact;
mod counts;
mod doubt;
mod drive_side;
mod estimates;
mod firm;
mod follow;
mod inertia;
mod interval;
mod knowledge;
mod late;
mod learner;
mod load_side;
mod memory;
mod motion;
mod motor_only;
mod pace;
mod parts;
mod places;
mod present;
mod probe;
mod regressors;
mod ride;
mod samples;
mod saying;
mod supervisor;

pub use estimates::{Doubt, Estimate, Estimates, Notices, Shaft, Source};
pub use memory::{MEMORY_BYTES, Memory, MemoryError, memory_numbers};
pub use probe::{Probe, Progress, Refusal};
pub use samples::{Reading, Samples};

use crate::real::Real;
use crate::tables::observer::ObserverTables;
use anchor::Anchor;
use bias::Bias;
use block::Block;
use contact::ByForce;
use counts::Counts;
use doubt::Doubts;
use drive_side::DriveSide;
use inertia::Inertia;
use interval::Interval;
use knowledge::Knowledge;
use late::{Heard, Lateness};
use learner::Learner;
use load_side::LoadSide;
use motion::Motion;
use motor_only::Blind;
use pace::Pace;
use places::Places;
use present::Now;
use regressors::{COMPLIANCE, HALF_GAP};
use supervisor::Supervisor;

/// Parameters learnt when the encoders count as free of harmonics: half-gap, offset, compliance, skew, and sine and cosine
/// of the gears' transmission error.
pub const PLAIN: usize = 6;

/// Parameters learnt with the error maps: the plain ones, then sine and cosine once and twice a turn of the motor, once
/// and twice a turn of the output.
pub const MAPPED: usize = PLAIN + 8;

/// The observer of one joint. `P` is [`PLAIN`] or [`MAPPED`].
#[derive(Debug, Clone)]
pub struct Observer<'tables, T: Real, const P: usize> {
    tables: &'tables ObserverTables<T>,
    counts: Counts,
    lateness: Lateness,
    drive: DriveSide<T>,
    load: LoadSide<T>,
    inertia: Inertia<T>,
    bias: Bias<T>,
    by_force: ByForce,
    motion: Motion<T>,
    learner: Learner<T, P>,
    places: Places<T, P>,
    interval: Interval<T>,
    block: Block<T, P>,
    anchor: Anchor<T, P>,
    doubts: Doubts,
    knowledge: Knowledge<T>,
    supervisor: Supervisor<T>,
    pace: Pace,
    blind: Blind<T>,
    /// When the last samples were taken, in ticks.
    time: u32,
    /// Teeth have settled since they came across the gap.
    settled: bool,
    /// Torque that the meshes put on the load side, by the motor side alone [N m].
    from_meshes: T,
    estimates: Estimates<T>,
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

    /// Takes the samples of one control period and says what they mean.
    pub fn step(&mut self, samples: &Samples<T>) -> &Estimates<T> {
        let heard = self.follow(samples);
        if heard == Heard::Not {
            self.hold();
            return &self.estimates;
        }
        let now = self.now();
        self.decide(&now);
        self.watch(&now);
        self.say(&now);
        if matches!(heard, Heard::Now | Heard::Missed) && !self.lateness.lasts() {
            self.learn(&now);
        } else {
            self.vouch_for_nothing();
            if self.lateness.lasts() {
                self.estimates.source = Source::Nothing;
            }
        }
        &self.estimates
    }

    /// What the last step said.
    pub fn estimates(&self) -> &Estimates<T> {
        &self.estimates
    }

    /// Half-gap [m] and compliance [m/N] as learnt so far.
    fn shape(&self) -> [T; 2] {
        [self.learner.value(HALF_GAP), self.learner.value(COMPLIANCE)]
    }
}
