//! Health of both encoders: fault declaration, readmission, and the link's position while its encoder is excluded.
//! Without the motor encoder no estimate is valid.

pub mod link_without_encoder;
pub mod motor_faults;
mod output_faults;
mod plausibility;
mod recovery;
pub(super) mod thresholds;
mod torque_response;

use link_without_encoder::LinkWithoutEncoder;
use motor_faults::{MotorFaultDetector, MotorMotionLimits, MotorReadingStatus, RecoveryState};
use output_faults::OutputFaultDetector;
use recovery::{OutputEvidence, OutputRecovery};
use thresholds::OUTPUT_FAULT;
use torque_response::TorqueResponseCheck;

use super::filters::Filters;
use super::identification::mesh_measurement::MeshMeasurement;
use super::identification::regressors::{self, ContactSample};
use super::identification::{IntervalResult, ParameterEstimator};
use super::sensors::{SensorReadings, Sensors};
use crate::estimates::{MotorFault, OutputFault, Source};
use crate::numbers::Real;
use crate::numbers::integers::saturating_real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::ObserverTables;

pub use output_faults::{LastMotion, ReadingStatus};
pub use recovery::Readmission;

/// Encoders in use, and the state of the fault checks.
#[derive(Debug, Clone, Copy)]
pub struct Health<T: Real> {
    source: Source,
    motor: MotorFaultDetector<T>,
    output: OutputFaultDetector<T>,
    output_recovery: OutputRecovery<T>,
    /// Check of the sign of torque and motor encoder.
    pub response: TorqueResponseCheck<T>,
    /// Estimate of the link's motion without its encoder.
    pub unseen_link: LinkWithoutEncoder<T>,
    /// Last and last but one stored load torque, from before a failing encoder could corrupt the estimate [N m].
    load_torques: [T; 2],
    intervals_since_store: u16,
}
state_words! {
    struct Health<T> {
        source, motor, output, output_recovery, response, unseen_link, load_torques, intervals_since_store,
    }
}

/// Verdict on the encoders by the deflection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultDecision {
    /// Teeth allow the deflection.
    NoFault,
    /// The output encoder is excluded.
    ExcludeOutput,
    /// The motor encoder is excluded.
    ExcludeMotor,
}

impl<T: Real> Health<T> {
    /// Starts with the motor encoder alone, until the output encoder gives its first reading.
    #[inline(always)]
    pub fn new(has_output: bool) -> Self {
        Self {
            source: Source::MotorOnly(if has_output { OutputFault::Unheard } else { OutputFault::Absent }),
            motor: MotorFaultDetector::default(),
            output: OutputFaultDetector::default(),
            output_recovery: OutputRecovery::default(),
            response: TorqueResponseCheck::default(),
            unseen_link: LinkWithoutEncoder::default(),
            load_torques: [T::ZERO; 2],
            intervals_since_store: 0,
        }
    }

    /// Encoders in use while the motor encoder is in use.
    pub fn source(&self) -> Source {
        self.source
    }

    /// Reason for the exclusion of the motor encoder.
    pub fn motor_fault(&self) -> Option<MotorFault> {
        self.motor.fault()
    }

    /// Motor speed [counts per period].
    pub fn motor_speed_in_counts(&self) -> T {
        self.motor.speed_in_counts()
    }

    /// Judges the motor's reading by itself. After an exclusion no reading is used until
    /// [`try_readmit_motor`](Self::try_readmit_motor).
    #[inline(always)]
    pub fn check_motor_reading(
        &mut self,
        tables: &ObserverTables<T>,
        readings: &SensorReadings<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
    ) -> MotorReadingStatus {
        let link_rate = self.both_encoders().then(|| self.output.rate());
        // While the torque is unknown, the largest plausible torque may brake the motor.
        let uncertain = sensors.is_torque_uncertain();
        let unknown_torque = if uncertain { tables.current.believed } else { tables.supervisor.motor_drag };
        let limits = MotorMotionLimits { table: &tables.supervisor, drive: &filters.drive, unknown_torque, link_rate };
        self.motor.check_reading(tables, readings, &limits)
    }

    /// Decides on the readmission of the motor encoder from its outlook and a deflection of the teeth [m]. Of all
    /// possible motor positions the caller passes the deflection that agrees best with the output encoder.
    pub fn try_readmit_motor<const P: usize>(
        &mut self,
        state: RecoveryState,
        estimator: &ParameterEstimator<T, P>,
        deflection: T,
    ) -> Option<Readmission> {
        // At rest without torque the shafts are hardly wound up, so that a deflection slightly out of range is accepted
        // only once the outlook has settled.
        let agrees = if state == RecoveryState::LongPlausible {
            output_faults::is_within_wear(estimator, deflection)
        } else {
            output_faults::is_possible(estimator, deflection, T::ZERO)
        };
        let readmission = if !self.both_encoders() || agrees {
            Readmission::SameOffset
        } else if state == RecoveryState::LongPlausible && self.motor.has_moved() {
            Readmission::NewOffset
        } else {
            return None;
        };
        self.motor.readmit();
        self.output.resume_deflection();
        Some(readmission)
    }

    /// Returns true while both encoders are in use.
    pub fn both_encoders(&self) -> bool {
        matches!(self.source, Source::Both)
    }

    /// Returns true once the deflection has been out of range for 4 ms, longer than impacts ring: teeth are worn, or an
    /// encoder fails.
    pub fn is_deflection_out_of_range(&self, tables: &ObserverTables<T>) -> bool {
        self.output.is_deflection_out_of_range(&tables.supervisor)
    }

    /// Judges the output's reading by itself. After an exclusion the caller continues without the output encoder.
    #[inline(always)]
    pub fn check_output_reading(
        &mut self,
        tables: &ObserverTables<T>,
        readings: &SensorReadings<T>,
    ) -> ReadingStatus<T> {
        let status = self.output.check_reading(tables, readings, self.both_encoders());
        match &status {
            ReadingStatus::First => self.source = Source::Both,
            ReadingStatus::Excluded(fault, _) => self.exclude_output(*fault),
            ReadingStatus::Accepted | ReadingStatus::Rejected => {}
        }
        status
    }

    /// Judges both encoders by the deflection. After an exclusion the caller continues without that encoder. The
    /// encoder whose counts stand still while the other's advance is excluded.
    pub fn check_deflection<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        measurement: &MeshMeasurement<T>,
        estimator: &ParameterEstimator<T, P>,
    ) -> FaultDecision {
        let both = self.both_encoders();
        let [_, compliance] = estimator.half_gap_and_compliance();
        let unwound_deflection = measurement.tooth_deflection() - compliance * measurement.force;
        let is_outrun =
            self.motor.is_outrun_by_output(tables, estimator, unwound_deflection, measurement.force) && both;
        match self.output.check_deflection(tables, measurement, estimator, unwound_deflection, both) {
            Some(OutputFault::OutOfRange) if self.motor.is_at_standstill(&tables.supervisor) => self.exclude_motor(),
            _ if is_outrun => self.exclude_motor(),
            Some(fault) => {
                self.exclude_output(fault);
                FaultDecision::ExcludeOutput
            }
            None => FaultDecision::NoFault,
        }
    }

    /// Excludes the motor encoder: its counts stand still while the link moves.
    #[cold]
    fn exclude_motor(&mut self) -> FaultDecision {
        self.motor.exclude(MotorFault::Frozen);
        FaultDecision::ExcludeMotor
    }

    /// Excludes the output encoder.
    pub fn exclude_output(&mut self, fault: OutputFault) {
        self.source = Source::MotorOnly(fault);
        self.output.reset_timer();
        self.output_recovery.reset();
        self.unseen_link = LinkWithoutEncoder::default();
    }

    /// Stored load torque from before the last possible fault began [N m].
    pub fn load_torque_before_fault(&self) -> T {
        let [_, before] = self.load_torques;
        before
    }

    /// Stores the load torque [N m]; called once per learning interval while both encoders are in use.
    pub fn store_load_torque(&mut self, load_torque: T) {
        self.intervals_since_store += 1;
        if self.intervals_since_store >= OUTPUT_FAULT.load_torque_intervals {
            self.intervals_since_store = 0;
            self.load_torques = [load_torque, self.load_torques[0]];
        }
    }

    /// Decides on the readmission of the output encoder; called once per learning interval without it. Returns the kind
    /// of return and the encoder's slip as a deflection [m]: a deflection that no teeth allow is attributed to the
    /// encoder, not to the link.
    pub fn try_readmit_output<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        estimator: &ParameterEstimator<T, P>,
        interval: &IntervalResult<T>,
    ) -> Option<(Readmission, T)> {
        let motor_phase = sensors.counts.motor.phase(&tables.counts.motor);
        let output_phase = sensors.counts.output.phase(&tables.counts.output);
        let open_gap = regressors::open_gap(filters.load.speed, motor_phase, Some(output_phase));
        let raw_deflection = tables.counts.length * saturating_real(sensors.counts.difference)
            + tables.levers.sun * filters.drive.angle_residual;
        let tolerance = tables.supervisor.margin + T::TWO * estimator.uncertainty.edge_deviation;
        let force = interval.force();
        let settled = interval.flank.map(|flank| {
            let contact = ContactSample { flank: Some(flank), force, mesh: interval.mesh };
            (flank, raw_deflection - estimator.least_squares.deflection(&contact.add_to(&open_gap)))
        });
        // Between the flanks no contact is needed: the encoder agrees while the deflection lies within the gap.
        let deflection = raw_deflection
            - estimator.least_squares.deflection(&open_gap)
            - estimator.transmission_error(&interval.mesh);
        let lies_in_gap = output_faults::is_possible(estimator, deflection, force);
        let is_silent = self.output.is_silent();
        let position = (!is_silent).then_some(output_phase);
        let evidence = OutputEvidence { settled, tolerance, lies_in_gap, position };
        let readmission = self.output_recovery.step(&tables.supervisor, &evidence)?;
        if self.source == Source::MotorOnly(OutputFault::Absent) {
            return None;
        }
        self.source = Source::Both;
        let slip = match settled {
            Some((_, offset))
                if readmission == Readmission::NewOffset && !output_faults::is_within_wear(estimator, deflection) =>
            {
                offset
            }
            _ => T::ZERO,
        };
        Some((readmission, slip))
    }
}
