//! Observer: estimates gap coordinate, contact, torques and joint parameters from encoder counts and motor torque, once
//! per control period. [`crate::compensation`] uses the estimates.
//!
//! [`Observer::step`] steps five parts, each with its own state:
//!
//! | part | input | output |
//! |---|---|---|
//! | `sensors` | raw counts and times | counts, exact over turns and wrap-around (O1), ages, notices |
//! | `filters` | counts, commanded torque | torque taken from the motor (O2, O3); angle, speed, load torque of the link (O4) |
//! | `contact` | mesh force, deflection | flank in contact (O8, O10) |
//! | `learnt` | outputs of the rows above | parameters of joint, encoders and motor, with their variances (O6 to O20) |
//! | `health` | counts, deflection | encoders in use (O21 to O25); link state without output encoder (O26, O27) |
//!
//! [`Estimates`] are the published result. `docs/theory/observer.md` lists equations and limits.

mod contact;
#[cfg(feature = "design")]
pub mod design;
mod estimates;
mod filters;
mod health;
mod learnt;
mod memory;
mod outputs;
mod probe;
mod samples;
pub(crate) mod sensors;
pub mod tables;

use core::mem::MaybeUninit;

use contact::Contact;
use filters::Filters;
use health::motor_faults::{MotorScreened, Outlook};
use health::{Health, Judged, LastMotion, Return, Screened};
use learnt::fusion::Fused;
use learnt::{Learnt, Outcome};
use sensors::counts::Advance;
use sensors::latency::Freshness;
use sensors::{Sensed, Sensors};

use crate::gears::sign;
use crate::numbers::Real;

pub use estimates::{Estimate, Estimates, MotorFault, Notices, OutputFault, Shaft, Source, TorqueResponse};
pub use learnt::regressors::{MAPPED, PLAIN};
pub use memory::{MEMORY_BYTES, Memory, MemoryError, memory_numbers};
pub use probe::{Probe, Progress, Refusal};
pub use samples::{Reading, Samples};
pub use tables::{ObserverTables, ProbeTable};

/// Observer of one joint. `P` is [`PLAIN`] or [`MAPPED`].
///
/// The joint of this example has a narrower gap than its design states; a torque swings it to and fro twice a second:
///
/// ```
/// use model_core::gears::{Tables, design::design};
/// use model_core::observer::design::{design_observer, observer_settings};
/// use model_core::observer::{MAPPED, Observer, Source};
/// use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let mut told = q1.parameters.clone();
/// told.sun_planet.half_backlash.iter_mut().for_each(|half_backlash| *half_backlash = 60e-6);
/// let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
/// let around = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
/// let tables = design_observer(&told, &observer_settings(&q1.surroundings))?;
/// let mut joint = VirtualJoint::new(&gears, &around);
/// let mut observer = Observer::<f32, MAPPED>::new(&tables);
/// for period in 0..30_000 {
///     observer.step(&joint.samples());
///     joint.advance((12.6 * 1e-4 * period as f32).cos(), 0.0);
/// }
/// let said = observer.estimates();
/// assert_eq!(said.source, Source::Both);
/// assert!((said.half_backlash.value / 40e-6 - 1.0).abs() < 0.05, "it is 40 um: {:?}", said.half_backlash);
/// assert!(said.gap.valid && said.gap.variance.sqrt() < 10e-6);
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Observer<'tables, T: Real, const P: usize> {
    tables: &'tables ObserverTables<T>,
    sensors: Sensors,
    filters: Filters<T>,
    contact: Contact,
    learnt: Learnt<T, P>,
    health: Health<T>,
    estimates: Estimates<T>,
}

impl<'tables, T: Real, const P: usize> Observer<'tables, T, P> {
    /// Builds an observer with the designed parameters.
    pub fn new(tables: &'tables ObserverTables<T>) -> Self {
        let mut observer = Self::unbegun(tables);
        observer.begin();
        observer
    }

    /// Builds an observer in place, for stacks without room for a second one.
    pub fn new_in<'place>(
        place: &'place mut MaybeUninit<Self>,
        tables: &'tables ObserverTables<T>,
    ) -> &'place mut Self {
        let observer = Self::put(place, tables);
        observer.begin();
        observer
    }

    /// Not inlined, so that its stack is free again when the parts are initialised.
    #[inline(never)]
    fn put<'place>(place: &'place mut MaybeUninit<Self>, tables: &'tables ObserverTables<T>) -> &'place mut Self {
        place.write(Self::unbegun(tables))
    }

    /// Builds an observer whose parts are not initialised from the tables yet.
    #[inline(always)]
    fn unbegun(tables: &'tables ObserverTables<T>) -> Self {
        let has_output = tables.counts.has_output;
        Self {
            tables,
            sensors: Sensors::new(has_output),
            filters: Filters::default(),
            contact: Contact::default(),
            learnt: Learnt::unbegun(tables),
            health: Health::new(has_output),
            estimates: Estimates::default(),
        }
    }

    /// Resets the observer in place to the designed parameters.
    pub fn restart(&mut self) {
        self.clear();
        self.begin();
    }

    /// Not inlined, so that its stack is free again when the parts are initialised.
    #[inline(never)]
    fn clear(&mut self) {
        *self = Self::unbegun(self.tables);
    }

    /// Initialises the parts from the tables and publishes the initial parameters.
    fn begin(&mut self) {
        self.learnt.begin(self.tables);
        self.find_errors();
        self.say_learnt();
    }

    /// Estimates of the last step.
    pub fn estimates(&self) -> &Estimates<T> {
        &self.estimates
    }

    /// Processes the samples of one control period and returns the updated estimates.
    pub fn step(&mut self, samples: &Samples<T>) -> &Estimates<T> {
        let tables = self.tables;
        let sensed = self.sensors.step(tables, samples);
        self.estimates.notices = sensed.notices();
        self.check_response(&sensed);
        let motor = self.health.screen_motor(tables, &sensed, &self.sensors, &self.filters);
        self.filters.step(tables, &sensed, motor == MotorScreened::Used);
        let screened = self.health.screen(tables, &sensed);
        match screened {
            Screened::First => self.filters.load.ahead = T::ZERO,
            Screened::Used => self.filters.correct_load(tables, &sensed),
            Screened::NotUsed => {}
            Screened::GivenUp(_, last) => self.rely_on_motor(last),
        }
        let meshes = tables.counts.mesh_periods;
        let far = self.learnt.errors.go_on(sensed.motor_turned, sensed.output_turned, meshes);
        if far || matches!(screened, Screened::First) || !matches!(sensed.motor, Advance::By(_)) {
            self.find_errors();
        }
        match motor {
            MotorScreened::Used | MotorScreened::NotUsed => {}
            MotorScreened::GivenUp => return self.lose_motor(sensed.motor),
            MotorScreened::Doubted(outlook) => return self.look_for_motor(outlook),
        }

        let fused = self.fuse();
        self.tell_contact(&fused);
        match self.health.judge(tables, &fused, &self.learnt) {
            Judged::Sound => {}
            Judged::OutputFails => self.rely_on_motor(None),
            Judged::MotorFails => return self.lose_motor(sensed.motor),
        }
        if !self.health.both_encoders() {
            let correction = self.health.motor_only.step(tables, &fused, &self.learnt);
            self.filters.correct_unseen_load(&tables.load, correction, tables.levers.per_ratio);
        }
        self.say(&fused);
        let late_for_good = self.sensors.latency.is_late_for_good();
        let serves = matches!(sensed.freshness, Freshness::Fresh | Freshness::Lost) && !late_for_good;
        if serves && !self.sensors.is_unsure() {
            self.learn(&fused);
        } else {
            outputs::invalidate(&mut self.estimates);
            if late_for_good {
                self.estimates.source = Source::Nothing(MotorFault::Late);
            }
        }
        &self.estimates
    }

    /// Checks the signs of torque and motor encoder (O25).
    #[inline(always)]
    fn check_response(&mut self, sensed: &Sensed<T>) {
        let response = &mut self.health.response;
        if sensed.torque_known && !sensed.out_of_time && matches!(sensed.motor, Advance::By(_)) {
            response.step(&self.tables.response, sensed.command, sensed.motor_turned);
        } else {
            response.interrupt();
        }
        self.estimates.torque_response = response.response();
    }

    /// Serializes the estimated parameters.
    ///
    /// ```
    /// use model_core::observer::design::{design_observer, observer_settings};
    /// use model_core::observer::{MAPPED, MemoryError, Observer};
    ///
    /// let tables = |name| {
    ///     let joint = joint_file::read(joint_file::preset(name).unwrap()).unwrap();
    ///     design_observer::<f32>(&joint.parameters, &observer_settings(&joint.surroundings))
    /// };
    /// let (q1, s1) = (tables("q1")?, tables("s1")?);
    /// let mut memory = Observer::<f32, MAPPED>::new(&q1).save();
    /// assert_eq!(Observer::<f32, MAPPED>::new(&q1).load(&memory), Ok(()));
    /// assert_eq!(Observer::<f32, MAPPED>::new(&s1).load(&memory), Err(MemoryError::OtherJoint));
    /// memory[100] ^= 1;
    /// assert_eq!(Observer::<f32, MAPPED>::new(&q1).load(&memory), Err(MemoryError::Damaged));
    /// # Ok::<(), model_core::gears::design::DesignError>(())
    /// ```
    pub fn save(&self) -> Memory {
        memory::save(self.tables, self.sensors.counts.start, &self.learnt)
    }

    /// Restores saved parameters. A rejected memory changes nothing.
    pub fn load(&mut self, memory: &[u8]) -> Result<(), MemoryError> {
        let start = memory::load(memory, self.tables, &mut self.learnt)?;
        self.find_errors();
        if self.tables.counts.absolute {
            self.sensors.counts.refer_to(start, &self.tables.counts);
        } else {
            self.learnt.learner.forget_places();
        }
        Ok(())
    }

    /// Combines motor side and link side into deflection and force (O7, O9).
    #[inline]
    fn fuse(&self) -> Fused<T> {
        self.learnt.fuse(self.tables, &self.sensors, &self.filters, self.health.both_encoders())
    }

    /// Detects the contact (O8, O10) and sets the mesh torque.
    #[inline]
    fn tell_contact(&mut self, fused: &Fused<T>) {
        let tables = self.tables;
        let known = &self.learnt.uncertainty;
        let both = self.health.both_encoders();
        let deviations = [known.force_deviation, known.both_deviation];
        let by_force = self.contact.by_force.step(fused.force, known.force_deviation);
        let mut force = fused.force;
        if !both {
            let before = self.contact.reported;
            self.contact.reported = self.health.motor_only.contact(fused, &self.learnt, before);
        } else if known.half_gap_serves {
            let position = self.learnt.position(fused.of_teeth(), fused.travel);
            force = self.contact.step_by_position(&position, force, deviations, known.settled);
        } else {
            self.contact.reported = by_force;
        }
        // Before the half-gap is known, a light contact cannot be distinguished from an open gap: the motor side's
        // force is used.
        let unsure = both && !known.half_gap_serves;
        let open = self.contact.reported.is_none() && !unsure;
        let lever = if open { T::ZERO } else { tables.levers.output };
        self.filters.mesh_torque = self.learnt.inertia.pass(lever * fused.force);
        self.estimates.mesh_torque.value = lever * force;
    }

    /// Holds the estimates after the motor encoder was excluded in this period.
    #[cold]
    fn lose_motor(&mut self, last: Advance) -> &Estimates<T> {
        self.sensors.counts.doubt_motor(&self.tables.counts, last);
        self.learnt.interrupt();
        self.learnt.lose_encoder();
        self.say_nothing()
    }

    /// Readmits the motor encoder once its readings are plausible and agree with the output encoder.
    #[cold]
    fn look_for_motor(&mut self, outlook: Outlook) -> &Estimates<T> {
        let tables = self.tables;
        if outlook == Outlook::Bad {
            return self.say_nothing();
        }
        self.filters.drive.hold();
        self.sensors.counts.find_motor(&tables.counts);
        self.find_errors();
        let deflection = self.fuse().of_teeth();
        if let Some(back) = self.health.finds_motor(outlook, &self.learnt, deflection) {
            // The distance of a slip is unknown: assume teeth in the middle of the gap.
            let slipped = back == Return::Otherwise;
            let by = if slipped { deflection.over(tables.counts.length).to_i64() } else { 0 };
            self.sensors.counts.trust_motor(&tables.counts, by);
            self.find_errors();
            if slipped {
                self.learnt.doubt_motor(tables);
                self.say_learnt();
            }
            self.filters.find_motor(tables, self.health.motor_counts(), self.health.both_encoders());
            // The next period publishes the first estimates after readmission.
            return &self.estimates;
        }
        self.say_nothing()
    }

    /// Holds the estimates while the motor encoder is excluded; the mesh torque is set to zero.
    fn say_nothing(&mut self) -> &Estimates<T> {
        self.filters.drive.hold();
        self.filters.mesh_torque = T::ZERO;
        outputs::hold(&mut self.estimates, self.health.motor_fault().unwrap_or(MotorFault::Silent));
        &self.estimates
    }

    /// Continues without the output encoder, which was excluded in this period. The link keeps its last motion, if known.
    #[cold]
    fn rely_on_motor(&mut self, last: Option<LastMotion<T>>) {
        let tables = self.tables;
        self.learnt.lose_encoder();
        if self.learnt.return_to_trusted(tables) {
            self.find_errors();
            self.say_learnt();
        }
        let load = &mut self.filters.load;
        self.sensors.counts.imply();
        load.speed = self.filters.drive.speed * tables.levers.per_ratio;
        load.torque = self.health.load_torque_before();
        // The link is placed on the flank in contact, or in the middle of the gap; the next contact corrects the
        // position.
        let side: T = sign(self.contact.by_force.flank);
        let [half_gap, _] = self.learnt.shape();
        let implied = self.fuse();
        let load = &mut self.filters.load;
        load.ahead += (implied.of_teeth() - side * half_gap).over(tables.levers.output);
        if let Some(last) = last {
            let count = tables.counts.output.angle;
            load.ahead = count * last.ahead;
            load.speed = count * last.speed.over(tables.period);
            self.health.motor_only.keep_place();
        }
    }

    /// Adds a period to the learning interval and does due estimation work.
    fn learn(&mut self, fused: &Fused<T>) {
        let tables = self.tables;
        self.learnt.add(fused);
        if self.learnt.in_the_middle(&tables.learner) {
            // With few periods per interval, the remaining work of the last interval is due now.
            while self.learnt.has_work() {
                self.work();
            }
            let both = self.health.both_encoders();
            self.learnt.keep_errors(tables, &self.sensors, &self.filters, both);
        } else if self.learnt.has_work() {
            self.work();
        }
        if self.learnt.at_the_end(&tables.learner) {
            self.close_interval();
        }
    }

    /// Does one task of the parameter estimation.
    fn work(&mut self) {
        let both = self.health.both_encoders();
        let outcome = self.learnt.work(self.tables, &mut self.filters.load, both);
        self.heed(outcome);
    }

    /// Ends a learning interval.
    fn close_interval(&mut self) {
        let tables = self.tables;
        let both = self.health.both_encoders();
        let reading = self.learnt.read(tables, self.filters.drive.speed, both);
        if both {
            self.health.remember(self.filters.load.torque);
        } else if let Some(back) = self.health.reconsider(tables, &self.sensors, &self.filters, &self.learnt, &reading)
        {
            self.trust_output(back);
        }
        let outcome = self.learnt.close(tables, &reading, self.health.both_encoders());
        self.heed(outcome);
    }

    /// Readmits the output encoder; `slip` is its slip as a deflection [m].
    #[cold]
    fn trust_output(&mut self, (back, slip): (Return, T)) {
        let table = &self.tables.counts;
        self.sensors.counts.trust(table, slip.over(table.length).to_i64());
        self.filters.load.ahead = T::ZERO;
        self.find_errors();
        if back == Return::Otherwise {
            self.learnt.reopen(self.tables);
            self.say_learnt();
        }
    }

    /// Applies the outcome of the parameter estimation to health and outputs.
    fn heed(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Nothing => {}
            Outcome::Concluded => {
                self.say_learnt();
                if self.health.both_encoders() {
                    self.learn_cogging();
                }
            }
            Outcome::EncoderFails => {
                self.health.give_up(OutputFault::OutOfRange);
                self.rely_on_motor(None);
            }
        }
    }

    /// Updates the cogging estimate (O17) from the estimates of this period.
    fn learn_cogging(&mut self) {
        let said = &self.estimates;
        let seen = [said.motor.fraction, said.motor.speed, said.load_torque.value];
        self.estimates.cogging = self.learnt.learn_cogging(self.tables, seen);
    }

    /// Recomputes the position-dependent errors (maps and transmission error) from the shaft positions.
    fn find_errors(&mut self) {
        let both = self.health.both_encoders();
        self.learnt.find_errors(self.tables, &self.sensors, &self.filters, both);
    }

    /// Publishes the estimates of a period.
    #[inline]
    fn say(&mut self, fused: &Fused<T>) {
        let state = outputs::State {
            tables: self.tables,
            sensors: &self.sensors,
            filters: &self.filters,
            contact: &self.contact,
            learnt: &self.learnt,
            health: &self.health,
        };
        state.say(fused, &mut self.estimates);
    }

    /// Publishes the estimates that change once per learning interval.
    fn say_learnt(&mut self) {
        let both = self.health.both_encoders();
        outputs::say_learnt(self.tables, &self.learnt, both, &mut self.estimates);
    }
}
