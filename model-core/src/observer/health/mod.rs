//! The health of both encoders: when each is given up, why, when it is taken back, and what is known of the link without its
//! own. Without the motor's nothing is.

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

/// Learning intervals between two looks at the load torque: what is used is 16 to 32 ms old, and most faults are found
/// sooner than that. An output encoder that freezes in slow motion takes 8 to 22 ms, so a look may be from after it
/// froze.
const LOOK: u16 = 16;

/// Which encoders are used, and what that is decided by.
#[derive(Debug, Clone, Copy)]
pub struct Health<T: Real> {
    source: Source,
    motor: MotorFaultDetector<T>,
    faults: OutputFaultDetector<T>,
    recovery: Recovery<T>,
    /// Whether the motor goes where the torque drives it.
    pub response: ResponseCheck<T>,
    /// What is known of the link without its encoder.
    pub motor_only: MotorOnly<T>,
    /// Load torque of the last and of the last but one look, before a failing encoder could spoil it [N m].
    load_torques: [T; 2],
    looked: u16,
}

/// What the deflection says of the encoders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judged {
    /// It is one that teeth allow.
    Sound,
    /// The output's is given up.
    OutputFails,
    /// The motor's is given up.
    MotorFails,
}

impl<T: Real> Health<T> {
    /// Until the output encoder gives its first reading there is the motor's only.
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

    /// Which encoders are used, as long as the motor's is.
    pub fn source(&self) -> Source {
        self.source
    }

    /// Why the motor encoder is not used.
    pub fn motor_fault(&self) -> Option<MotorFault> {
        self.motor.fault()
    }

    /// Counts by which the motor goes on in a period.
    pub fn motor_counts(&self) -> T {
        self.motor.counts()
    }

    /// Judges the motor's reading by itself. Where that gives the encoder up, nothing of it is used until
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
        // Where the torque was none that is known, it may have been any.
        let unsure = sensors.is_unsure();
        let drag = if unsure { tables.current.believed } else { tables.supervisor.motor_drag };
        let surroundings = MotorSurroundings { table: &tables.supervisor, drive: &filters.drive, drag, link_rate };
        self.motor.screen(tables, sensed, &surroundings)
    }

    /// Whether a motor encoder that was given up is used again, by what its readings have come to and a deflection of the teeth
    /// [m]: that of the place which agrees best with the output's.
    pub fn finds_motor<const P: usize>(
        &mut self,
        outlook: Outlook,
        learnt: &Learnt<T, P>,
        deflection: T,
    ) -> Option<Return> {
        // Without torque shafts are hardly wound up; what is a little beyond waits.
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

    /// Whether both encoders are used.
    pub fn both_encoders(&self) -> bool {
        matches!(self.source, Source::Both)
    }

    /// Whether the deflection has been beyond its range for 4 ms, longer than impacts ring: teeth have worn, or the
    /// encoder fails.
    pub fn is_at_odds(&self, tables: &ObserverTables<T>) -> bool {
        self.faults.is_at_odds(&tables.supervisor)
    }

    /// Judges the output's reading by itself. Where that gives the encoder up, the caller goes on without it.
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

    /// Judges both encoders by the deflection. Where that gives one up, the caller goes on without it. Who stands still while the
    /// other goes on is to blame.
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

    /// The motor's counts stand still while the link goes on.
    #[cold]
    fn blame_motor(&mut self) -> Judged {
        self.motor.give_up(MotorFault::Frozen);
        Judged::MotorFails
    }

    /// The output encoder is not used from now on.
    pub fn give_up(&mut self, fault: OutputFault) {
        self.source = Source::MotorOnly(fault);
        self.faults.begin();
        self.recovery.begin();
        self.motor_only = MotorOnly::default();
    }

    /// Load torque as it was before the last possible fault began [N m].
    pub fn load_torque_before(&self) -> T {
        let [_, before] = self.load_torques;
        before
    }

    /// Once a learning interval, with both encoders in use: remembers the load torque [N m].
    pub fn remember(&mut self, load_torque: T) {
        self.looked += 1;
        if self.looked >= LOOK {
            self.looked = 0;
            self.load_torques = [load_torque, self.load_torques[0]];
        }
    }

    /// Once a learning interval without the output encoder: says when and how it is taken back, and by how much it has slipped,
    /// as a deflection [m]: a place that no teeth allow is the encoder's, not the link's.
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
        // A link that turns with the motor between the flanks is seen as it was, whether or not teeth are felt.
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
