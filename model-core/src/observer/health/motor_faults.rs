//! Faults of the motor encoder (O22), in the order of the checks, and its readmission:
//!
//! | # | found by | condition | purpose | needed by |
//! |---|---|---|---|---|
//! | 1 | counts that jumped ([`Advance::Jumped`]) | four readings farther apart than any motor turns | random counts, a slipped coupling | `wild motor_encoder::random_motor_counts_are_reported` |
//! | 2 | [`Plausibility`]: counts that jump | a few readings farther on than motor and link can throw the motor | small jumps | `wild motor_encoder::small_motor_jump_is_reported` |
//! | 3 | [`Plausibility`]: counts that stand still at once | fewer counts than torque and teeth explain | a frozen encoder in motion, within a few periods | `wild motor_encoder::motor_freeze_at_speed_is_detected` |
//! | 4 | the output outruns counts that stand still under a torque | more than wind-up, while a free motor would have moved | a frozen encoder in slow motion | `wild motor_encoder::slow_motor_freeze_is_detected_in_the_gap` |
//! | 5 | the output outruns counts that stand still | more than gap and wind-up, while the counts stand still for 1 ms | a frozen encoder in slow motion without torque | `wild motor_encoder::link_travel_reveals_frozen_motor` |
//!
//! After an exclusion no reading of the motor is used and no estimate is valid. The encoder is readmitted once its
//! readings have been plausible for 20 ms, move, and agree with the output encoder, or after 100 ms at rest. Readings
//! that move plausibly for 100 ms without agreement mean that the encoder has slipped: the encoder is readmitted and
//! the offset is estimated anew.

use super::output_faults::{outruns, slack};
use super::plausibility::{COUNT, FEWEST, Plausibility, Surroundings, Verdict, counts};
use crate::numbers::Real;
use crate::numbers::arithmetic::beyond;
use crate::observer::estimates::MotorFault;
use crate::observer::filters::drive_side::DriveSide;
use crate::observer::learnt::Learnt;
use crate::observer::sensors::Sensed;
use crate::observer::sensors::counts::Advance;
use crate::observer::sensors::latency::Freshness;
use crate::observer::tables::{ObserverTables, StopTable, SupervisorTable};

/// Counts by which the commanded torque would have moved a free motor before a stationary motor counts as blocked [-]:
/// four times the travel that a free motor loses while it reverses under a torque. Tuned on `hil/motor-faults.toml`.
const HELD: i32 = 16;

/// Periods until the estimated speed follows a torque.
const LAG: i32 = 6;

/// Fault checks of the motor encoder.
#[derive(Debug, Clone, Copy)]
pub struct MotorFaultDetector<T: Real> {
    plausibility: Plausibility,
    /// Reason for the exclusion.
    fault: Option<MotorFault>,
    /// Periods since the counts last changed.
    unmoved_for: u16,
    /// Speed [counts per period] and travel [counts] that the torque alone would have given a free motor since then.
    free_rate: T,
    free_way: T,
    /// Deflection less wind-up [m] and mesh force [N] when the counts last changed.
    stood_at: T,
    stood_under: T,
    /// Periods of plausible readings since the exclusion, and whether the counts have moved.
    sensible_for: u16,
    moved: bool,
}

/// Result of screening a motor reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotorScreened {
    /// The reading is used.
    Used,
    /// The reading is rejected unless the next readings confirm it; the motor is assumed to keep its speed.
    NotUsed,
    /// The reading excludes the encoder.
    GivenUp,
    /// The encoder was excluded before.
    Doubted(Outlook),
}

/// State of the readings of an excluded encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outlook {
    /// The readings are not plausible yet.
    Bad,
    /// The readings are plausible: the encoder is readmitted if it agrees with the output encoder.
    Fair,
    /// The readings have been plausible for so long that the encoder is readmitted in any case; without agreement it
    /// has slipped.
    Settled,
}

/// Influences that change the motor's speed between two readings.
pub struct MotorSurroundings<'now, T: Real> {
    pub table: &'now SupervisorTable<T>,
    pub drive: &'now DriveSide<T>,
    /// Largest unknown braking torque beside the commanded torque [N m].
    pub drag: T,
    /// Speed of the link [parts of an output count per period]; `None` if unknown.
    pub link_rate: Option<i32>,
}

impl<T: Real> Surroundings<T> for MotorSurroundings<'_, T> {
    fn stops(&self) -> &StopTable<T> {
        &self.table.motor
    }

    fn brake(&self) -> T {
        self.table.motor_brake * (self.drive.strongest() + self.drag)
    }

    /// Teeth throw the motor back at its own speed, or to twice the link's speed; the torque also changes the speed
    /// before the estimate follows.
    fn throw(&self, rate: i32) -> i32 {
        let Some(link) = self.link() else { return i32::MAX };
        let fastest = rate.saturating_abs().max(link.saturating_abs());
        fastest.saturating_mul(2).saturating_add(whole(T::from_i32(COUNT) * self.unfollowed()))
    }

    /// Teeth move the motor no farther from the link's speed than it was.
    fn carried(&self, rate: i32) -> i32 {
        let Some(link) = self.link() else { return 0 };
        link.saturating_abs().saturating_sub(rate.saturating_sub(link).saturating_abs()).max(0)
    }

    /// The estimated speed lags behind by a few periods of braking. Speeds below a count per period are not certain.
    fn sure(&self, rate: i32) -> T {
        let braked = counts::<T>(rate) - self.unfollowed();
        if rate >= COUNT && braked > T::ZERO { braked } else { T::ZERO }
    }
}

impl<T: Real> MotorSurroundings<'_, T> {
    /// Speed of a motor that turns with the link [parts of a motor count per period].
    fn link(&self) -> Option<i32> {
        self.link_rate.map(|rate| whole(T::from_i32(rate) * self.table.motor_counts))
    }

    /// Change of speed that the torques may have caused and the estimate does not show yet [counts per period].
    fn unfollowed(&self) -> T {
        T::from_i32(2 * LAG) * self.brake()
    }
}

/// Truncates towards zero and saturates.
fn whole<T: Real>(size: T) -> i32 {
    size.to_i64().clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

impl<T: Real> MotorFaultDetector<T> {
    pub fn new() -> Self {
        Self {
            plausibility: Plausibility::new(),
            fault: None,
            unmoved_for: 0,
            free_rate: T::ZERO,
            free_way: T::ZERO,
            stood_at: T::ZERO,
            stood_under: T::ZERO,
            sensible_for: 0,
            moved: false,
        }
    }

    /// Reason for the exclusion of the encoder.
    pub fn fault(&self) -> Option<MotorFault> {
        self.fault
    }

    /// Excludes the encoder.
    pub fn give_up(&mut self, fault: MotorFault) -> MotorScreened {
        self.fault = Some(fault);
        self.plausibility.lose();
        self.sensible_for = 0;
        self.moved = fault == MotorFault::Jumped;
        MotorScreened::GivenUp
    }

    /// Readmits the encoder.
    pub fn trust(&mut self) {
        *self = Self { plausibility: self.plausibility, ..Self::new() };
    }

    /// Speed of the motor, 0 if unknown [counts per period].
    pub fn counts(&self) -> T {
        self.plausibility.speed().unwrap_or(T::ZERO)
    }

    /// Returns true once the counts have stood still for longer than chance explains.
    pub fn is_unmoved(&self, table: &SupervisorTable<T>) -> bool {
        self.unmoved_for >= table.motor_unmoved_after
    }

    /// Judges the reading of one period by the readings before.
    #[inline(always)]
    pub fn screen(
        &mut self,
        tables: &ObserverTables<T>,
        sensed: &Sensed<T>,
        surroundings: &MotorSurroundings<'_, T>,
    ) -> MotorScreened {
        let clock = &tables.clock;
        let regular = sensed.motor_interval.wrapping_sub(clock.shortest) <= clock.longer;
        let used = self.fault.is_none() && sensed.freshness != Freshness::Unusable;
        let Advance::By(by) = sensed.motor else { return self.screen_odd(sensed) };
        if !(regular && used) {
            return self.screen_irregular(tables, sensed, surroundings, regular, by);
        }
        if by == 0 {
            self.stand(&tables.supervisor, surroundings.drive);
        } else {
            self.unmoved_for = 0;
        }
        match self.plausibility.take(surroundings, by) {
            Verdict::Plausible => MotorScreened::Used,
            Verdict::Suspect => MotorScreened::NotUsed,
            Verdict::Implausible => self.implausible(),
        }
    }

    /// Counts one more period at a standstill and integrates the travel that the torque would have given a motor held
    /// by friction alone.
    fn stand(&mut self, table: &SupervisorTable<T>, drive: &DriveSide<T>) {
        if self.unmoved_for == 0 {
            (self.free_rate, self.free_way) = (T::ZERO, T::ZERO);
        }
        self.unmoved_for = self.unmoved_for.saturating_add(1);
        let torque = drive.air_gap();
        let per_torque = T::TWO * table.motor_brake;
        let left = beyond(torque, table.motor_drag);
        if left == T::ZERO {
            // Friction in excess of the torque stops the motor without reversing it.
            self.free_rate = beyond(self.free_rate, per_torque * (table.motor_drag - torque.abs()));
        } else {
            self.free_rate += per_torque * left;
        }
        self.free_way += self.free_rate;
    }

    /// Handles the first reading, and a reading far from the last one.
    #[cold]
    fn screen_odd(&mut self, sensed: &Sensed<T>) -> MotorScreened {
        let jumped = matches!(sensed.motor, Advance::Jumped(_));
        self.sensible_for = 0;
        self.moved |= jumped;
        if jumped {
            self.plausibility.lose();
        }
        if self.fault.is_some() {
            MotorScreened::Doubted(Outlook::Bad)
        } else if sensed.freshness == Freshness::Unusable {
            self.give_up(MotorFault::Silent)
        } else if jumped {
            self.give_up(MotorFault::Jumped)
        } else if sensed.motor == Advance::Began {
            MotorScreened::Used
        } else {
            MotorScreened::NotUsed
        }
    }

    /// Handles a reading after an irregular interval, a reading that is too old, and a reading of an excluded encoder.
    #[cold]
    fn screen_irregular(
        &mut self,
        tables: &ObserverTables<T>,
        sensed: &Sensed<T>,
        surroundings: &MotorSurroundings<'_, T>,
        regular: bool,
        by: i32,
    ) -> MotorScreened {
        let mut sensible = sensed.freshness != Freshness::Unusable;
        if regular {
            let verdict = self.plausibility.take(surroundings, by);
            sensible &= verdict == Verdict::Plausible;
            if verdict == Verdict::Implausible {
                self.plausibility.lose();
            }
        } else if sensed.motor_interval > 0 {
            // The motor may have moved any way during missing readings.
            self.plausibility.lose();
        }
        if self.fault.is_none() {
            return if sensed.freshness == Freshness::Unusable {
                self.give_up(MotorFault::Silent)
            } else {
                MotorScreened::Used
            };
        }
        self.moved |= by != 0;
        self.sensible_for = if sensible { self.sensible_for.saturating_add(1) } else { 0 };
        let table = &tables.supervisor;
        MotorScreened::Doubted(if self.sensible_for >= table.motor_slipped_after {
            Outlook::Settled
        } else if self.sensible_for >= table.motor_trusted_after && self.moved {
            Outlook::Fair
        } else {
            Outlook::Bad
        })
    }

    /// Excludes the encoder after readings that no motor can follow.
    #[cold]
    fn implausible(&mut self) -> MotorScreened {
        let frozen = self.plausibility.stands_still();
        self.give_up(if frozen { MotorFault::Frozen } else { MotorFault::Jumped })
    }

    /// Returns true if the link has moved by more than gap and wind-up allow while the motor's counts stood still:
    /// teeth would have moved the motor. `unwound` is the deflection less wind-up [m], under a force [N].
    pub fn is_outrun<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        learnt: &Learnt<T, P>,
        unwound: T,
        force: T,
    ) -> bool {
        if self.unmoved_for == 0 {
            (self.stood_at, self.stood_under) = (unwound, force);
            return false;
        }
        let [half_gap, compliance] = learnt.shape();
        let went_on = (unwound - self.stood_at).abs();
        // A motor that no torque moves is held by teeth: the link can move by the wind-up of those teeth, and by a
        // little more while the half-gap is a guess.
        if self.unmoved_for > FEWEST && self.free_way.abs() > T::from_i32(HELD) {
            let wound_up = compliance * (force - self.stood_under).abs();
            let unknown = T::QUARTER * learnt.uncertainty.guessed_half_gap;
            return went_on > unknown + wound_up + slack(tables, learnt, force);
        }
        went_on > half_gap && self.is_unmoved(&tables.supervisor) && outruns(tables, learnt, went_on, force)
    }

    /// Returns true if the readings have moved. Without agreement a moving encoder has slipped; a stationary one may
    /// still be frozen.
    pub fn has_moved(&self) -> bool {
        self.moved
    }
}
