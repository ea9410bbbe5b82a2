//! Health of both encoders: fault declaration, readmission, and the link's position while its encoder is excluded.
//! Without the motor encoder no estimate is valid.

pub mod motor_faults;
pub mod motor_only;
mod output_faults;
mod plausibility;
mod recovery;
mod torque_response;

use motor_faults::{MotorFaultDetector, MotorScreened, MotorSurroundings, Outlook};
use motor_only::MotorOnly;
use output_faults::OutputFaultDetector;
use recovery::Recovery;
use torque_response::ResponseCheck;

use super::estimates::{MotorFault, OutputFault, Source};
use super::filters::Filters;
use super::learnt::fusion::{Fused, small};
use super::learnt::regressors::{self, Touch};
use super::learnt::{Learnt, Reading};
use super::sensors::{Sensed, Sensors};
use crate::numbers::Real;
use crate::observer::tables::ObserverTables;

pub use output_faults::{LastMotion, Screened};
pub use recovery::Return;

/// Learning intervals between two stored load torques: the restored torque is 16 to 32 ms old, and most faults are
/// declared sooner. A freeze in slow motion is declared after 8 to 22 ms, so that a torque may be stored after the
/// output encoder froze.
const LOOK: u16 = 16;

/// Encoders in use, and the state of the fault checks.
#[derive(Debug, Clone, Copy)]
pub struct Health<T: Real> {
    source: Source,
    motor: MotorFaultDetector<T>,
    faults: OutputFaultDetector<T>,
    recovery: Recovery<T>,
    /// Check of the sign of torque and motor encoder.
    pub response: ResponseCheck<T>,
    /// Estimate of the link's motion without its encoder.
    pub motor_only: MotorOnly<T>,
    /// Last and last but one stored load torque, from before a failing encoder could corrupt the estimate [N m].
    load_torques: [T; 2],
    looked: u16,
}

/// Verdict on the encoders by the deflection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judged {
    /// Teeth allow the deflection.
    Sound,
    /// The output encoder is excluded.
    OutputFails,
    /// The motor encoder is excluded.
    MotorFails,
}

impl<T: Real> Health<T> {
    /// Starts with the motor encoder alone, until the output encoder gives its first reading.
    #[inline(always)]
    pub fn new(has_output: bool) -> Self {
        Self {
            source: Source::MotorOnly(if has_output { OutputFault::Unheard } else { OutputFault::Absent }),
            motor: MotorFaultDetector::new(),
            faults: OutputFaultDetector::new(),
            recovery: Recovery::new(),
            response: ResponseCheck::new(),
            motor_only: MotorOnly::default(),
            load_torques: [T::ZERO; 2],
            looked: 0,
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
    pub fn motor_counts(&self) -> T {
        self.motor.counts()
    }

    /// Judges the motor's reading by itself. After an exclusion no reading is used until
    /// [`finds_motor`](Self::finds_motor).
    #[inline(always)]
    pub fn screen_motor(
        &mut self,
        tables: &ObserverTables<T>,
        sensed: &Sensed<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
    ) -> MotorScreened {
        let link_rate = self.both_encoders().then(|| self.faults.rate());
        // While the torque is unknown, the largest plausible torque may brake the motor.
        let unsure = sensors.is_unsure();
        let drag = if unsure { tables.current.believed } else { tables.supervisor.motor_drag };
        let surroundings = MotorSurroundings { table: &tables.supervisor, drive: &filters.drive, drag, link_rate };
        self.motor.screen(tables, sensed, &surroundings)
    }

    /// Decides on the readmission of the motor encoder from its outlook and a deflection of the teeth [m]. Of all
    /// possible motor positions the caller passes the deflection that agrees best with the output encoder.
    pub fn finds_motor<const P: usize>(
        &mut self,
        outlook: Outlook,
        learnt: &Learnt<T, P>,
        deflection: T,
    ) -> Option<Return> {
        // At rest without torque the shafts are hardly wound up, so that a deflection slightly out of range is accepted
        // only once the outlook has settled.
        let agrees = if outlook == Outlook::Settled {
            output_faults::is_near(learnt, deflection)
        } else {
            output_faults::is_possible(learnt, deflection, T::ZERO)
        };
        let back = if !self.both_encoders() || agrees {
            Return::AsLearnt
        } else if outlook == Outlook::Settled && self.motor.has_moved() {
            Return::Otherwise
        } else {
            return None;
        };
        self.motor.trust();
        self.faults.find_deflection();
        Some(back)
    }

    /// Returns true while both encoders are in use.
    pub fn both_encoders(&self) -> bool {
        matches!(self.source, Source::Both)
    }

    /// Returns true once the deflection has been out of range for 4 ms, longer than impacts ring: teeth are worn, or an
    /// encoder fails.
    pub fn is_at_odds(&self, tables: &ObserverTables<T>) -> bool {
        self.faults.is_at_odds(&tables.supervisor)
    }

    /// Judges the output's reading by itself. After an exclusion the caller continues without the output encoder.
    #[inline(always)]
    pub fn screen(&mut self, tables: &ObserverTables<T>, sensed: &Sensed<T>) -> Screened<T> {
        let screened = self.faults.screen(tables, sensed, self.both_encoders());
        match &screened {
            Screened::First => self.source = Source::Both,
            Screened::GivenUp(fault, _) => self.give_up(*fault),
            Screened::Used | Screened::NotUsed => {}
        }
        screened
    }

    /// Judges both encoders by the deflection. After an exclusion the caller continues without that encoder. The
    /// encoder whose counts stand still while the other's advance is excluded.
    pub fn judge<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        fused: &Fused<T>,
        learnt: &Learnt<T, P>,
    ) -> Judged {
        let both = self.both_encoders();
        let [_, compliance] = learnt.shape();
        let unwound = fused.of_teeth() - compliance * fused.force;
        let outrun = self.motor.is_outrun(tables, learnt, unwound, fused.force) && both;
        match self.faults.judge(tables, fused, learnt, unwound, both) {
            Some(OutputFault::OutOfRange) if self.motor.is_unmoved(&tables.supervisor) => self.blame_motor(),
            _ if outrun => self.blame_motor(),
            Some(fault) => {
                self.give_up(fault);
                Judged::OutputFails
            }
            None => Judged::Sound,
        }
    }

    /// Excludes the motor encoder: its counts stand still while the link moves.
    #[cold]
    fn blame_motor(&mut self) -> Judged {
        self.motor.give_up(MotorFault::Frozen);
        Judged::MotorFails
    }

    /// Excludes the output encoder.
    pub fn give_up(&mut self, fault: OutputFault) {
        self.source = Source::MotorOnly(fault);
        self.faults.begin();
        self.recovery.begin();
        self.motor_only = MotorOnly::default();
    }

    /// Stored load torque from before the last possible fault began [N m].
    pub fn load_torque_before(&self) -> T {
        let [_, before] = self.load_torques;
        before
    }

    /// Stores the load torque [N m]; called once per learning interval while both encoders are in use.
    pub fn remember(&mut self, load_torque: T) {
        self.looked += 1;
        if self.looked >= LOOK {
            self.looked = 0;
            self.load_torques = [load_torque, self.load_torques[0]];
        }
    }

    /// Decides on the readmission of the output encoder; called once per learning interval without it. Returns the kind
    /// of return and the encoder's slip as a deflection [m]: a deflection that no teeth allow is attributed to the
    /// encoder, not to the link.
    pub fn reconsider<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        learnt: &Learnt<T, P>,
        reading: &Reading<T>,
    ) -> Option<(Return, T)> {
        let phase = sensors.counts.motor.phase(&tables.counts.motor);
        let output = sensors.counts.output.phase(&tables.counts.output);
        let free = regressors::free(filters.load.speed, phase, Some(output));
        let measured =
            tables.counts.length * small(sensors.counts.difference) + tables.levers.sun * filters.drive.ahead;
        let room = tables.supervisor.margin + T::TWO * learnt.uncertainty.edge_deviation;
        let force = reading.force();
        let settled = reading.flank.map(|flank| {
            let touch = Touch { flank: Some(flank), force, mesh: reading.mesh };
            (flank, measured - learnt.learner.deflection(&touch.on(&free)))
        });
        // Between the flanks no contact is needed: the encoder agrees while the deflection lies within the gap.
        let deflection = measured - learnt.learner.deflection(&free) - learnt.transmission_error(&reading.mesh);
        let between = output_faults::is_possible(learnt, deflection, force);
        let silent = self.faults.is_silent();
        let back = self.recovery.step(&tables.supervisor, settled, room, between, (!silent).then_some(output))?;
        if self.source == Source::MotorOnly(OutputFault::Absent) {
            return None;
        }
        self.source = Source::Both;
        let slip = match settled {
            Some((_, beyond)) if back == Return::Otherwise && !output_faults::is_near(learnt, deflection) => beyond,
            _ => T::ZERO,
        };
        Some((back, slip))
    }
}
