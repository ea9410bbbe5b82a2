//! Where the gap is: from encoder counts and motor torque to gap coordinate, contact, torques and everything about the
//! joint that they depend on, once a control period. Making use of it is left to `compensation`.
//!
//! The structure, front to back:
//! 1. `counts` unwraps raw counts and forms motor less ratio times output in whole numbers: exact over any number of
//!    turns and over wrap-around.
//! 2. `drive_side`, a disturbance observer on the motor, gives the mesh force; `load_side`, the same on the link,
//!    position, speed and load torque. Both are linear flows from tables.
//! 3. `motion` tells crossing from rest without knowing the width; `bias` takes from open gaps what the motor's torque is
//!    wrong by; `contact` decides which flank touches.
//! 4. `learner` is one small recursive least squares, updated every few periods in settled contact, for half-backlash,
//!    offset, compliance, skew and the encoders' error maps. `anchor` tells flanks without a force that stands out, and
//!    `doubt` what no longer belongs to what was learnt.
//! 5. `supervisor` watches the output encoder and falls back to the motor alone.
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
mod interval;
mod knowledge;
mod learner;
mod load_side;
mod memory;
mod motion;
mod motor_only;
mod probe;
mod regressors;
mod samples;
mod saying;
mod supervisor;

pub use estimates::{Doubt, Estimate, Estimates, Notices, Shaft, Source};
pub use memory::{MEMORY_BYTES, Memory, MemoryError};
pub use probe::{Probe, Progress, Refusal};
pub use samples::{Reading, Samples};

use crate::mesh::ContactState;
use crate::real::Real;
use crate::realtime::phase::sine_cosine;
use crate::tables::observer::ObserverTables;
use anchor::Anchor;
use bias::Bias;
use block::Block;
use contact::{ByForce, ByPosition};
use counts::{Advance, Counts};
use doubt::Doubts;
use drive_side::DriveSide;
use interval::Interval;
use knowledge::Knowledge;
use learner::{Learner, Regressors};
use load_side::LoadSide;
use motion::{Motion, magnitude};
use motor_only::Blind;
use regressors::{COMPLIANCE, ERROR, HALF_GAP};
use supervisor::Supervisor;

/// Parameters learnt when the encoders count as free of harmonics: half-gap, offset, compliance, skew, and sine and cosine
/// of the gears' transmission error.
pub const PLAIN: usize = 6;

/// Parameters learnt with the error maps: the plain ones, then sine and cosine once and twice a turn of the motor, once
/// and twice a turn of the output.
pub const MAPPED: usize = PLAIN + 8;

/// Periods beyond which the age of a reading is not believed.
const OLDEST: u32 = 64;

/// The observer of one joint. `P` is [`PLAIN`] or [`MAPPED`].
#[derive(Debug, Clone)]
pub struct Observer<'tables, T: Real, const P: usize> {
    tables: &'tables ObserverTables<T>,
    counts: Counts,
    drive: DriveSide<T>,
    load: LoadSide<T>,
    bias: Bias<T>,
    by_force: ByForce,
    motion: Motion<T>,
    learner: Learner<T, P>,
    interval: Interval<T, P>,
    block: Block<T, P>,
    anchor: Anchor<T, P>,
    doubts: Doubts,
    knowledge: Knowledge<T>,
    supervisor: Supervisor<T>,
    blind: Blind<T>,
    time: Option<u32>,
    /// Torque that the meshes put on the load side, by the motor side alone [N m].
    from_meshes: T,
    estimates: Estimates<T>,
}

/// What one period comes to before anything is decided.
#[derive(Debug, Clone, Copy)]
struct Now<T: Real, const P: usize> {
    /// What the way depends on, teeth left out.
    free: Regressors<T, P>,
    /// Sine and cosine of the mesh phase.
    mesh: [T; 2],
    /// Transmission error [m].
    shift: T,
    /// Motor less ratio times link along the line of action, as measured [m].
    raw: T,
    /// The same with everything taken out that was learnt, wind-up left in [m].
    way: T,
    /// Rate of either [m/s].
    rate: T,
    /// Way that goes on while what is measured lags behind, where it is more than noise [m].
    soon: T,
    /// Force that the motor loses, friction and bias included [N].
    lost: T,
    /// Direction of the motor's dry friction.
    direction: T,
    /// Mesh force from the motor side [N].
    force: T,
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
            drive: DriveSide::default(),
            load: LoadSide::default(),
            bias: Bias::new(&tables.contact),
            by_force: ByForce::default(),
            motion: Motion::new(),
            knowledge: Knowledge::new(tables, &learner),
            learner,
            interval: Interval::new(),
            block: Block::new(),
            anchor: Anchor::new(),
            doubts: Doubts::default(),
            supervisor: Supervisor::new(tables.counts.has_output),
            blind: Blind::default(),
            time: None,
            from_meshes: T::ZERO,
            estimates: Estimates::default(),
        };
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
        self.drive = DriveSide::default();
        self.load = LoadSide::default();
        self.bias = Bias::new(&tables.contact);
        self.by_force = ByForce::default();
        self.motion = Motion::new();
        self.learner = Learner::new(&tables.learner);
        self.knowledge = Knowledge::new(tables, &self.learner);
        self.interval = Interval::new();
        self.block = Block::new();
        self.anchor = Anchor::new();
        self.doubts = Doubts::default();
        self.supervisor = Supervisor::new(tables.counts.has_output);
        self.blind = Blind::default();
        self.time = None;
        self.from_meshes = T::ZERO;
        self.estimates = Estimates::default();
        self.say_learnt();
    }

    /// Takes the samples of one control period and says what they mean.
    pub fn step(&mut self, samples: &Samples<T>) -> &Estimates<T> {
        self.follow(samples);
        let now = self.now();
        self.decide(&now);
        self.watch(&now);
        self.learn(&now);
        self.say(&now);
        &self.estimates
    }

    /// What the last step said.
    pub fn estimates(&self) -> &Estimates<T> {
        &self.estimates
    }

    /// Counts, motor side and load side go on by one period.
    fn follow(&mut self, samples: &Samples<T>) {
        let tables = self.tables;
        let known = samples.torque.is_finite();
        let command = if known { samples.torque } else { T::ZERO };
        let taken = self.counts.take(&tables.counts, samples.motor, samples.output);
        let [shortest, longest] = tables.period_ticks;
        let lasted = self.time.map(|before| samples.time.wrapping_sub(before));
        self.time = Some(samples.time);
        self.estimates.notices = Notices {
            torque_unknown: !known,
            out_of_time: lasted.is_some_and(|ticks| !(shortest..=longest).contains(&ticks)),
            motor_doubted: taken.motor == Advance::Doubted,
            motor_jumped: matches!(taken.motor, Advance::Jumped(_)),
        };
        // A reading older than a few periods says little of now; one from the future nothing.
        let age = |time: u32| {
            let ticks = samples.time.wrapping_sub(time);
            if ticks <= longest.saturating_mul(OLDEST) { T::from_i32(ticks as i32) * tables.tick } else { T::ZERO }
        };

        let motor_by = if let Advance::By(by) = taken.motor { by } else { 0 };
        self.drive.predict(&tables.drive, &tables.current, command, tables.counts.motor.angle * T::from_i32(motor_by));
        match taken.motor {
            Advance::By(_) => self.drive.correct(&tables.drive, age(samples.motor.time)),
            Advance::Began => self.drive.ahead = T::ZERO,
            Advance::Jumped(_) => {
                self.drive.ahead = T::ZERO;
                self.learner.reopen();
            }
            Advance::Doubted => {}
        }

        self.load.predict(&tables.load, self.from_meshes, tables.counts.output.angle * T::from_i32(taken.turned));
        if self.supervisor.hear(taken.output) {
            self.load.ahead = T::ZERO;
        }
        let both = self.supervisor.source() == Source::Both;
        if let (true, Some(reading), Some(Advance::By(_))) = (both, samples.output, taken.output) {
            let surprise = self.load.speed * age(reading.time) - self.load.ahead;
            self.load.correct(&tables.load.gain, surprise);
        }
    }

    /// Puts the two sides together.
    fn now(&self) -> Now<T, P> {
        let tables = self.tables;
        let levers = &tables.levers;
        let (output, difference) = self.counts.used();
        let motor_phase = self.counts.motor.phase(&tables.counts.motor);
        let both = self.supervisor.source() == Source::Both;
        let link_speed = if both { self.load.speed } else { T::ZERO };
        let free = regressors::free(link_speed, motor_phase, both.then(|| output.phase(&tables.counts.output)));
        let (sine, cosine) = sine_cosine(output.phase(&tables.counts.output).wrapping_mul(tables.counts.meshes));
        let shift = self.error(&[sine, cosine]);
        let raw =
            tables.counts.length * small(difference) + levers.sun * self.drive.ahead - levers.output * self.load.ahead;
        let lost = self.drive.taken * levers.per_sun;
        let direction = Bias::direction(&tables.contact, self.drive.speed);
        let net = lost - self.bias.at(direction);
        // Losses in proportion to the load are friction too: they take from what drives and add to what holds back.
        let gain = if net * direction > T::ZERO { tables.contact.efficiency } else { tables.contact.per_efficiency };
        let force = net + net * magnitude(direction) * (gain - T::ONE);
        let rate = levers.sun * self.drive.speed - levers.output * self.load.speed;
        let soon = if magnitude(rate) > tables.contact.rate_deviation { rate * tables.contact.lag } else { T::ZERO };
        Now {
            free,
            mesh: [sine, cosine],
            shift,
            raw,
            rate,
            soon,
            way: raw - self.learner.way(&free),
            lost,
            direction,
            force,
        }
    }

    /// Contact, and what the meshes pass on.
    fn decide(&mut self, now: &Now<T, P>) {
        let tables = self.tables;
        let known = &self.knowledge;
        self.estimates.contact = self.by_force.step(now.force, known.force_deviation);
        let mut force = now.force;
        self.estimates.reported_contact = if known.width_serves && self.supervisor.source() == Source::Both {
            let before = self.estimates.reported_contact;
            let (contact, both) =
                self.by_position(now.way, now.soon, now.shift).reported(before, force, known.both_deviation);
            force = both;
            contact
        } else if self.supervisor.source() == Source::Both {
            self.estimates.contact
        } else {
            self.contact_unseen(now)
        };
        let touching = self.estimates.reported_contact != ContactState::Separated;
        let torque = |force: T| if touching { force * tables.levers.output } else { T::ZERO };
        self.from_meshes = torque(now.force);
        self.estimates.mesh_torque.value = torque(force);
    }

    /// What a way says of the teeth.
    fn by_position(&self, way: T, soon: T, shift: T) -> ByPosition<T> {
        let [half_gap, compliance] = self.shape();
        let known = &self.knowledge;
        ByPosition { way, soon, shift, half_gap, blur: known.blur, compliance, weight: known.position_weight }
    }

    /// Half-gap [m] and compliance [m/N] as learnt so far.
    fn shape(&self) -> [T; 2] {
        [self.learner.value(HALF_GAP), self.learner.value(COMPLIANCE)]
    }

    /// Transmission error at a mesh phase [m].
    fn error(&self, mesh: &[T; 2]) -> T {
        mesh[0] * self.learner.value(ERROR) + mesh[1] * self.learner.value(ERROR + 1)
    }
}

/// A difference of counts, which teeth keep small, as a number: wide whole numbers take a chip without them long to turn.
fn small<T: Real>(difference: i64) -> T {
    T::from_i32(difference.clamp(i32::MIN.into(), i32::MAX.into()) as i32)
}
