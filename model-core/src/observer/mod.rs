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
//! | `estimator` | outputs of the rows above | parameters of joint, encoders and motor, with their variances (O6 to O20) |
//! | `health` | counts, deflection | encoders in use (O21 to O25); link state without output encoder (O26, O27) |
//!
//! [`Estimates`] are the published result. `docs/theory/observer.md` lists equations and limits.

mod contact;
#[cfg(feature = "design")]
pub mod design;
mod filters;
mod health;
mod identification;
mod memory;
mod outputs;
mod samples;
pub(crate) mod sensors;
pub mod tables;
#[cfg(test)]
mod test_tables;
mod thresholds;

use core::mem::MaybeUninit;

use contact::Contact;
use filters::Filters;
use health::motor_faults::{MotorReadingStatus, RecoveryState};
use health::{FaultDecision, Health, LastMotion, ReadingStatus, Readmission};
use identification::mesh_measurement::MeshMeasurement;
use identification::{Outcome, ParameterEstimator};
use sensors::counts::CountChange;
use sensors::latency::SampleAge;
use sensors::{SensorReadings, Sensors};

use crate::gears::sign;
use crate::numbers::Real;
use crate::numbers::state_words::{Layout, Reader, StateWords, Writer};

pub use crate::estimates::{Estimate, Estimates, MotorFault, Notices, OutputFault, Shaft, Source, TorqueResponse};
pub use identification::regressors::{MAPPED, PLAIN};
pub use memory::{MEMORY_BYTES, Memory, MemoryError, memory_numbers};
pub use samples::{Reading, Samples};
pub use tables::{ObserverTables, ProbeTable};

/// Description of every threshold of the observer.
#[cfg(feature = "sensitivity")]
pub(crate) fn thresholds() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [
        thresholds::list(),
        sensors::thresholds::list(),
        filters::thresholds::list(),
        contact::thresholds::list(),
        identification::thresholds::list(),
        health::thresholds::list(),
        design::thresholds::list(),
    ]
    .concat()
}

/// Observer of one joint. `P` is [`PLAIN`] or [`MAPPED`].
///
/// The joint of this example has a narrower gap than its design states; a torque swings it to and fro twice a second:
///
/// ```
/// use model_core::observer::{MAPPED, Observer, Source};
/// use model_core::{ControllerDesign, VirtualJointDesign};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let mut nominal = q1.clone();
/// nominal.parameters.sun_planet.half_backlash.iter_mut().for_each(|half_backlash| *half_backlash = 60e-6);
/// let tables = ControllerDesign::new(&nominal, 10_000)?.observer;
/// let plant = VirtualJointDesign::<3>::new(&q1, 10_000)?;
/// let (mut joint, mut observer) = (plant.joint(), Observer::<f32, MAPPED>::new(&tables));
/// for period in 0..30_000 {
///     observer.step(&joint.samples());
///     joint.advance((12.6 * 1e-4 * period as f32).cos(), 0.0);
/// }
/// let estimates = observer.estimates();
/// assert_eq!(estimates.source, Source::Both);
/// assert!((estimates.half_backlash.value / 40e-6 - 1.0).abs() < 0.05, "true: 40 um, {:?}", estimates.half_backlash);
/// assert!(estimates.gap.valid && estimates.gap.variance.sqrt() < 10e-6);
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Observer<'tables, T: Real, const P: usize> {
    tables: &'tables ObserverTables<T>,
    sensors: Sensors,
    filters: Filters<T>,
    contact: Contact,
    estimator: ParameterEstimator<T, P>,
    health: Health<T>,
    estimates: Estimates<T>,
}

impl<'tables, T: Real, const P: usize> Observer<'tables, T, P> {
    /// Builds an observer with the designed parameters.
    pub fn new(tables: &'tables ObserverTables<T>) -> Self {
        let mut observer = Self::uninitialized(tables);
        observer.initialize();
        observer
    }

    /// Builds an observer in place, for stacks without room for a second one.
    pub fn new_in<'place>(
        place: &'place mut MaybeUninit<Self>,
        tables: &'tables ObserverTables<T>,
    ) -> &'place mut Self {
        let observer = Self::write_uninitialized(place, tables);
        observer.initialize();
        observer
    }

    /// Not inlined, so that its stack is free again when the parts are initialised.
    #[inline(never)]
    fn write_uninitialized<'place>(
        place: &'place mut MaybeUninit<Self>,
        tables: &'tables ObserverTables<T>,
    ) -> &'place mut Self {
        place.write(Self::uninitialized(tables))
    }

    /// Builds an observer whose parts are not initialised from the tables yet.
    #[inline(always)]
    fn uninitialized(tables: &'tables ObserverTables<T>) -> Self {
        let has_output = tables.counts.has_output;
        Self {
            tables,
            sensors: Sensors::new(has_output),
            filters: Filters::default(),
            contact: Contact::default(),
            estimator: ParameterEstimator::uninitialized(tables),
            health: Health::new(has_output),
            estimates: Estimates::default(),
        }
    }

    /// Resets the observer in place to the designed parameters.
    pub fn reset(&mut self) {
        self.write_reset();
        self.initialize();
    }

    /// Not inlined, so that its stack is free again when the parts are initialised.
    #[inline(never)]
    fn write_reset(&mut self) {
        *self = Self::uninitialized(self.tables);
    }

    /// Initialises the parts from the tables and publishes the initial parameters.
    fn initialize(&mut self) {
        self.estimator.initialize(self.tables);
        self.update_position_errors();
        self.publish_parameters();
    }

    /// Estimates of the last step.
    pub fn estimates(&self) -> &Estimates<T> {
        &self.estimates
    }

    /// Processes the samples of one control period and returns the updated estimates.
    pub fn step(&mut self, samples: &Samples<T>) -> &Estimates<T> {
        let tables = self.tables;
        let readings = self.sensors.step(tables, samples);
        self.estimates.notices = readings.notices();
        self.check_torque_response(&readings);
        let motor = self.health.check_motor_reading(tables, &readings, &self.sensors, &self.filters);
        self.filters.step(tables, &readings, motor == MotorReadingStatus::Accepted);
        let output_status = self.health.check_output_reading(tables, &readings);
        match output_status {
            ReadingStatus::First => self.filters.load.angle_residual = T::ZERO,
            ReadingStatus::Accepted => self.filters.correct_load(tables, &readings),
            ReadingStatus::Rejected => {}
            ReadingStatus::Excluded(_, last) => self.continue_without_output(last),
        }
        let meshes = tables.counts.mesh_periods;
        let is_far = self.estimator.errors.advance(readings.motor_travel, readings.output_travel, meshes);
        if is_far || matches!(output_status, ReadingStatus::First) || !matches!(readings.motor, CountChange::By(_)) {
            self.update_position_errors();
        }
        match motor {
            MotorReadingStatus::Accepted | MotorReadingStatus::Rejected => {}
            MotorReadingStatus::Excluded => return self.exclude_motor(readings.motor),
            MotorReadingStatus::Recovering(recovery) => return self.try_readmit_motor(recovery),
        }

        let measurement = self.measure_mesh();
        self.detect_contact(&measurement);
        match self.health.check_deflection(tables, &measurement, &self.estimator) {
            FaultDecision::NoFault => {}
            FaultDecision::ExcludeOutput => self.continue_without_output(None),
            FaultDecision::ExcludeMotor => return self.exclude_motor(readings.motor),
        }
        if !self.health.both_encoders() {
            let correction = self.health.unseen_link.step(tables, &measurement, &self.estimator);
            self.filters.correct_unseen_load(&tables.load, correction, tables.levers.per_ratio);
        }
        self.publish(&measurement);
        let persistently_late = self.sensors.latency.is_persistently_late();
        let is_usable =
            matches!(readings.motor_sample_age, SampleAge::Fresh | SampleAge::Repeated) && !persistently_late;
        if is_usable && !self.sensors.is_torque_uncertain() {
            self.update_estimator(&measurement);
        } else {
            outputs::invalidate(&mut self.estimates);
            if persistently_late {
                self.estimates.source = Source::Nothing(MotorFault::Late);
            }
        }
        &self.estimates
    }

    /// Checks the signs of torque and motor encoder (O25).
    #[inline(always)]
    fn check_torque_response(&mut self, readings: &SensorReadings<T>) {
        let response = &mut self.health.response;
        if readings.torque_known && !readings.out_of_time && matches!(readings.motor, CountChange::By(_)) {
            response.step(&self.tables.response, readings.command, readings.motor_travel);
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
        memory::save(self.tables, self.sensors.counts.start, &self.estimator)
    }

    /// Restores saved parameters. A rejected memory changes nothing.
    pub fn load(&mut self, memory: &[u8]) -> Result<(), MemoryError> {
        let start = memory::load(memory, self.tables, &mut self.estimator)?;
        self.update_position_errors();
        if self.tables.counts.absolute {
            self.sensors.counts.set_reference(start, &self.tables.counts);
        } else {
            self.estimator.least_squares.reset_position_variances();
        }
        Ok(())
    }

    /// Layout of the state as words; the tables are no part of it.
    pub const STATE_LAYOUT: Layout = Layout::EMPTY
        .with("sensors", Sensors::LAYOUT)
        .with("filters", Filters::<T>::LAYOUT)
        .with("contact", Contact::LAYOUT)
        .with("estimator", ParameterEstimator::<T, P>::LAYOUT)
        .with("health", Health::<T>::LAYOUT)
        .with("estimates", Estimates::<T>::LAYOUT);

    /// Writes the state as `STATE_LAYOUT.words` words. An observer of the same tables that reads them continues with equal
    /// bits.
    ///
    /// ```
    /// use model_core::numbers::state_words::{Reader, Writer};
    /// use model_core::observer::{MAPPED, Observer};
    /// use model_core::{ControllerDesign, VirtualJointDesign};
    ///
    /// type Mapped<'tables> = Observer<'tables, f32, MAPPED>;
    /// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
    /// let tables = ControllerDesign::new(&q1, 10_000)?.observer;
    /// let plant = VirtualJointDesign::<3>::new(&q1, 10_000)?;
    /// let (mut joint, mut observer) = (plant.joint(), Mapped::new(&tables));
    /// for _ in 0..500 {
    ///     observer.step(&joint.samples());
    ///     joint.advance(0.5, 0.0);
    /// }
    /// let (mut words, mut other) = ([0; Mapped::STATE_LAYOUT.words], Mapped::new(&tables));
    /// observer.write_state(&mut Writer::new(&mut words));
    /// other.read_state(&mut Reader::new(&words));
    /// assert_eq!(other.step(&joint.samples()), observer.step(&joint.samples()));
    /// # Ok::<(), model_core::gears::design::DesignError>(())
    /// ```
    pub fn write_state(&self, to: &mut Writer) {
        let Self { tables: _, sensors, filters, contact, estimator, health, estimates } = self;
        sensors.write(to);
        filters.write(to);
        contact.write(to);
        estimator.write(to);
        health.write(to);
        estimates.write(to);
    }

    /// Replaces the state by one that was written by an observer of the same tables.
    pub fn read_state(&mut self, from: &mut Reader) {
        let Self { tables: _, sensors, filters, contact, estimator, health, estimates } = self;
        sensors.read_in_place(from);
        filters.read_in_place(from);
        contact.read_in_place(from);
        estimator.read_in_place(from);
        health.read_in_place(from);
        estimates.read_in_place(from);
    }

    /// Combines motor side and link side into deflection and force (O7, O9).
    #[inline]
    fn measure_mesh(&self) -> MeshMeasurement<T> {
        self.estimator.measure_mesh(self.tables, &self.sensors, &self.filters, self.health.both_encoders())
    }

    /// Detects the contact (O8, O10) and sets the mesh torque.
    #[inline]
    fn detect_contact(&mut self, measurement: &MeshMeasurement<T>) {
        let tables = self.tables;
        let uncertainty = &self.estimator.uncertainty;
        let both_encoders = self.health.both_encoders();
        let deviations = [uncertainty.force_deviation, uncertainty.combined_deviation];
        let by_force = self.contact.by_force.step(measurement.force, uncertainty.force_deviation);
        let mut force = measurement.force;
        if !both_encoders {
            let before = self.contact.reported;
            self.contact.reported = self.health.unseen_link.contact(measurement, &self.estimator, before);
        } else if uncertainty.half_gap_is_usable {
            let gap_position = self.estimator.gap_position(measurement.tooth_deflection(), measurement.travel);
            force = self.contact.step_by_position(&gap_position, force, deviations, uncertainty.settled);
        } else {
            self.contact.reported = by_force;
        }
        // Before the half-gap is known, a light contact cannot be distinguished from an open gap: the motor side's
        // force is used.
        let is_undecided = both_encoders && !uncertainty.half_gap_is_usable;
        let is_open = self.contact.reported.is_none() && !is_undecided;
        let lever = if is_open { T::ZERO } else { tables.levers.output };
        self.filters.mesh_torque = self.estimator.inertia.mesh_torque_for_load(lever * measurement.force);
        self.estimates.mesh_torque.value = lever * force;
    }

    /// Holds the estimates after the motor encoder was excluded in this period.
    #[cold]
    fn exclude_motor(&mut self, last: CountChange) -> &Estimates<T> {
        self.sensors.counts.suspend_motor(&self.tables.counts, last);
        self.estimator.discard_interval();
        self.estimator.begin_probation();
        self.hold_outputs()
    }

    /// Readmits the motor encoder once its readings are plausible and agree with the output encoder.
    #[cold]
    fn try_readmit_motor(&mut self, recovery: RecoveryState) -> &Estimates<T> {
        let tables = self.tables;
        if recovery == RecoveryState::NotPlausible {
            return self.hold_outputs();
        }
        self.filters.drive.stop();
        self.sensors.counts.resolve_motor_position(&tables.counts);
        self.update_position_errors();
        let deflection = self.measure_mesh().tooth_deflection();
        if let Some(readmission) = self.health.try_readmit_motor(recovery, &self.estimator, deflection) {
            // The distance of a slip is unknown: assume teeth in the middle of the gap.
            let has_slipped = readmission == Readmission::NewOffset;
            let slip = if has_slipped { (deflection / tables.counts.length).to_i64() } else { 0 };
            self.sensors.counts.readmit_motor(&tables.counts, slip);
            self.update_position_errors();
            if has_slipped {
                self.estimator.reset_motor_offset(tables);
                self.publish_parameters();
            }
            self.filters.restart_motor_side(tables, self.health.motor_speed_in_counts(), self.health.both_encoders());
            // The next period publishes the first estimates after readmission.
            return &self.estimates;
        }
        self.hold_outputs()
    }

    /// Holds the estimates while the motor encoder is excluded; the mesh torque is set to zero.
    fn hold_outputs(&mut self) -> &Estimates<T> {
        self.filters.drive.stop();
        self.filters.mesh_torque = T::ZERO;
        outputs::hold(&mut self.estimates, self.health.motor_fault().unwrap_or(MotorFault::Silent));
        &self.estimates
    }

    /// Continues without the output encoder, which was excluded in this period. The link keeps its last motion, if
    /// known.
    #[cold]
    fn continue_without_output(&mut self, last: Option<LastMotion<T>>) {
        let tables = self.tables;
        self.estimator.begin_probation();
        if self.estimator.restore_trusted(tables) {
            self.update_position_errors();
            self.publish_parameters();
        }
        let load = &mut self.filters.load;
        self.sensors.counts.imply_output();
        load.speed = self.filters.drive.speed * tables.levers.per_ratio;
        load.torque = self.health.load_torque_before_fault();
        // The link is placed on the flank in contact, or in the middle of the gap; the next contact corrects the
        // position.
        let side: T = sign(self.contact.by_force.flank);
        let [half_gap, _] = self.estimator.half_gap_and_compliance();
        let implied = self.measure_mesh();
        let load = &mut self.filters.load;
        load.angle_residual += (implied.tooth_deflection() - side * half_gap) / tables.levers.output;
        if let Some(last) = last {
            let count = tables.counts.output.angle;
            load.angle_residual = count * last.lead;
            load.speed = count * (last.speed / tables.period);
            self.health.unseen_link.keep_position();
        }
    }

    /// Adds a period to the learning interval and does due estimation work.
    fn update_estimator(&mut self, measurement: &MeshMeasurement<T>) {
        let tables = self.tables;
        self.estimator.add_period(measurement);
        if self.estimator.is_mid_interval(&tables.learner) {
            // With few periods per interval, the remaining work of the last interval is due now.
            while self.estimator.has_task() {
                self.run_task();
            }
            let both_encoders = self.health.both_encoders();
            self.estimator.store_position_errors(tables, &self.sensors, &self.filters, both_encoders);
        } else if self.estimator.has_task() {
            self.run_task();
        }
        if self.estimator.is_interval_over(&tables.learner) {
            self.finish_interval();
        }
    }

    /// Does one task of the parameter estimation.
    fn run_task(&mut self) {
        let both_encoders = self.health.both_encoders();
        let outcome = self.estimator.run_task(self.tables, &mut self.filters.load, both_encoders);
        self.apply_outcome(outcome);
    }

    /// Ends a learning interval.
    fn finish_interval(&mut self) {
        let tables = self.tables;
        let both_encoders = self.health.both_encoders();
        let interval = self.estimator.evaluate_interval(tables, self.filters.drive.speed, both_encoders);
        if both_encoders {
            self.health.store_load_torque(self.filters.load.torque);
        } else if let Some(readmission) =
            self.health.try_readmit_output(tables, &self.sensors, &self.filters, &self.estimator, &interval)
        {
            self.readmit_output(readmission);
        }
        let outcome = self.estimator.finish_interval(tables, &interval, self.health.both_encoders());
        self.apply_outcome(outcome);
    }

    /// Readmits the output encoder; `slip` is its slip as a deflection [m].
    #[cold]
    fn readmit_output(&mut self, (readmission, slip): (Readmission, T)) {
        let table = &self.tables.counts;
        self.sensors.counts.readmit_output(table, (slip / table.length).to_i64());
        self.filters.load.angle_residual = T::ZERO;
        self.update_position_errors();
        if readmission == Readmission::NewOffset {
            self.estimator.reset_variances(self.tables);
            self.publish_parameters();
        }
    }

    /// Applies the outcome of the parameter estimation to health and outputs.
    fn apply_outcome(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Nothing => {}
            Outcome::LimitsUpdated => {
                self.publish_parameters();
                if self.health.both_encoders() {
                    self.update_cogging();
                }
            }
            Outcome::OutputEncoderFault => {
                self.health.exclude_output(OutputFault::OutOfRange);
                self.continue_without_output(None);
            }
        }
    }

    /// Updates the cogging estimate (O17) from the estimates of this period.
    fn update_cogging(&mut self) {
        let Estimates { motor, load_torque, .. } = &self.estimates;
        let motion = [motor.fraction, motor.speed, load_torque.value];
        self.estimates.cogging = self.estimator.update_cogging(self.tables, motion);
    }

    /// Recomputes the position-dependent errors (maps and transmission error) from the shaft positions.
    fn update_position_errors(&mut self) {
        let both_encoders = self.health.both_encoders();
        self.estimator.update_position_errors(self.tables, &self.sensors, &self.filters, both_encoders);
    }

    /// Publishes the estimates of a period.
    #[inline]
    fn publish(&mut self, measurement: &MeshMeasurement<T>) {
        let state = outputs::ObserverParts {
            tables: self.tables,
            sensors: &self.sensors,
            filters: &self.filters,
            contact: &self.contact,
            estimator: &self.estimator,
            health: &self.health,
        };
        state.publish(measurement, &mut self.estimates);
    }

    /// Publishes the estimates that change once per learning interval.
    fn publish_parameters(&mut self) {
        let both_encoders = self.health.both_encoders();
        outputs::publish_parameters(self.tables, &self.estimator, both_encoders, &mut self.estimates);
    }
}
