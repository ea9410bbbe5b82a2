//! How a fault of the motor encoder is found, and when it is used again. In the order in which they are looked for:
//!
//! | # | found by | what it takes | why it is there | needed by |
//! |---|---|---|---|---|
//! | 1 | counts that jumped ([`Advance::Jumped`]) | four readings further apart than any motor turns | counts that are anything, a slipped coupling | `wild motor_encoder::counts_of_the_motor_that_are_anything_are_told_at_once_and_leave_nothing_behind` |
//! | 2 | [`Plausibility`]: counts that jump | a few readings further on than motor and link throw it | small jumps | `wild motor_encoder::counts_of_the_motor_that_jump_a_little_are_told_and_leave_nothing_behind` |
//! | 3 | [`Plausibility`]: counts that stand still at once | fewer counts than torque and teeth explain | a frozen encoder in motion, in a few periods | `wild motor_encoder::a_motor_encoder_that_freezes_at_speed_is_found_in_a_few_periods` |
//! | 4 | the output outruns counts that stand still under a torque | more than wind-up, while a free motor would have moved | a frozen encoder in slow motion | `wild motor_encoder::a_motor_encoder_that_freezes_in_slow_motion_is_found_before_the_link_has_crossed_the_gap` |
//! | 5 | the output outruns counts that stand still | more than gap and wind-up, while they have not moved for 1 ms | the same without a torque | `wild motor_encoder::a_motor_encoder_that_freezes_at_rest_is_found_by_how_far_the_link_goes` |
//!
//! From then on nothing of the motor's readings is used and nothing is valid. They are used again once they make sense for
//! 20 ms, move, and agree with the output's; for 100 ms where they stand still. Those that move and make sense but do not agree
//! belong to an encoder that has slipped: after 100 ms they are taken as they are, and the offset is learnt anew.

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

/// Counts by which a torque would have moved a free motor before one that stands still counts as held [-]: while one turns
/// round under a torque it is within a quarter of the way for as long. Chosen.
const HELD: i32 = 16;

/// Periods in which a torque acts before the speed that is judged by follows it.
const LAG: i32 = 6;

/// What watches the motor encoder.
#[derive(Debug, Clone, Copy)]
pub struct MotorFaultDetector<T: Real> {
    plausibility: Plausibility,
    /// Why it is not used.
    fault: Option<MotorFault>,
    /// Periods for which its counts have stood still.
    unmoved_for: u16,
    /// Counts in a period, and counts, by which torque alone would have moved a free motor since then.
    free_rate: T,
    free_way: T,
    /// The deflection less wind-up when they moved last [m], and the mesh force [N].
    stood_at: T,
    stood_under: T,
    /// Periods for which its readings have made sense since it was given up, and whether they have moved.
    sensible_for: u16,
    moved: bool,
}

/// What a reading of the motor came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotorScreened {
    /// It is used.
    Used,
    /// It is not, unless the next ones bear it out: the motor is taken to go on as it went.
    NotUsed,
    /// The encoder is given up from now on.
    GivenUp,
    /// It was given up before.
    Doubted(Outlook),
}

/// What readings of an encoder that was given up have come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outlook {
    /// They make no sense yet.
    Bad,
    /// They make sense: if they agree with the output's they are used.
    Fair,
    /// They have made sense for so long that they are used in any case: if they do not agree, the encoder has slipped.
    Settled,
}

/// What may change the motor's speed from one reading to the next.
pub struct MotorSurroundings<'now, T: Real> {
    pub table: &'now SupervisorTable<T>,
    pub drive: &'now DriveSide<T>,
    /// Torque that may brake the motor beside what it was told to give [N m].
    pub drag: T,
    /// Parts of an output count by which the link goes on in a period; `None` where that is not known.
    pub link_rate: Option<i32>,
}

impl<T: Real> Surroundings<T> for MotorSurroundings<'_, T> {
    fn stops(&self) -> &StopTable<T> {
        &self.table.motor
    }

    fn brake(&self) -> T {
        self.table.motor_brake * (self.drive.strongest() + self.drag)
    }

    /// Teeth throw it back as fast as it was, or to twice the link's speed; its torque moves it on while the speed that it is
    /// judged by follows.
    fn throw(&self, rate: i32) -> i32 {
        let Some(link) = self.link() else { return i32::MAX };
        let fastest = rate.saturating_abs().max(link.saturating_abs());
        fastest.saturating_mul(2).saturating_add(whole(T::from_i32(COUNT) * self.unfollowed()))
    }

    /// Teeth bring it no further from the link's speed than it was.
    fn carried(&self, rate: i32) -> i32 {
        let Some(link) = self.link() else { return 0 };
        link.saturating_abs().saturating_sub(rate.saturating_sub(link).saturating_abs()).max(0)
    }

    /// What is said lags behind by a few periods in which the torque brakes; of less than a count in a period by too many.
    fn sure(&self, rate: i32) -> T {
        let braked = counts::<T>(rate) - self.unfollowed();
        if rate >= COUNT && braked > T::ZERO { braked } else { T::ZERO }
    }
}

impl<T: Real> MotorSurroundings<'_, T> {
    /// Parts of a motor count by which a motor that turns with the link goes on in a period.
    fn link(&self) -> Option<i32> {
        self.link_rate.map(|rate| whole(T::from_i32(rate) * self.table.motor_counts))
    }

    /// Counts in a period by which its torques may have changed the speed that the one that is judged by does not show yet.
    fn unfollowed(&self) -> T {
        T::from_i32(2 * LAG) * self.brake()
    }
}

/// The next whole number towards zero, as far as it fits.
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

    /// Why the encoder is not used.
    pub fn fault(&self) -> Option<MotorFault> {
        self.fault
    }

    /// The encoder is not used from now on.
    pub fn give_up(&mut self, fault: MotorFault) -> MotorScreened {
        self.fault = Some(fault);
        self.plausibility.lose();
        self.sensible_for = 0;
        self.moved = fault == MotorFault::Jumped;
        MotorScreened::GivenUp
    }

    /// The encoder is used again.
    pub fn trust(&mut self) {
        *self = Self { plausibility: self.plausibility, ..Self::new() };
    }

    /// Counts by which the motor goes on in a period.
    pub fn counts(&self) -> T {
        self.plausibility.speed().unwrap_or(T::ZERO)
    }

    /// Whether the counts have stood still for longer than by chance.
    pub fn is_unmoved(&self, table: &SupervisorTable<T>) -> bool {
        self.unmoved_for >= table.motor_unmoved_after
    }

    /// Judges the reading of one period by those before.
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

    /// The counts stand still in one more period: so far would torque have moved the motor if nothing but friction held it.
    fn stand(&mut self, table: &SupervisorTable<T>, drive: &DriveSide<T>) {
        if self.unmoved_for == 0 {
            (self.free_rate, self.free_way) = (T::ZERO, T::ZERO);
        }
        self.unmoved_for = self.unmoved_for.saturating_add(1);
        let torque = drive.air_gap();
        let per_torque = T::TWO * table.motor_brake;
        let left = beyond(torque, table.motor_drag);
        if left == T::ZERO {
            // What friction has left over stops it, and does not turn it round.
            self.free_rate = beyond(self.free_rate, per_torque * (table.motor_drag - torque.abs()));
        } else {
            self.free_rate += per_torque * left;
        }
        self.free_way += self.free_rate;
    }

    /// The first reading, or one that is far from those before.
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

    /// A reading that is not a period after the one before, that is too old, or of an encoder that was given up.
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
            // Where readings were left out the motor may have gone any way.
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

    /// Readings that no motor could follow.
    #[cold]
    fn implausible(&mut self) -> MotorScreened {
        let frozen = self.plausibility.stands_still();
        self.give_up(if frozen { MotorFault::Frozen } else { MotorFault::Jumped })
    }

    /// Whether the link has gone on by more than gap and shafts let it while the motor's counts stood still: teeth take the
    /// motor with them. `unwound` is the deflection less wind-up [m], under a force [N].
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
        // A motor that moves by no torque is held by teeth: the link may go on by what they wind up, and, while nobody knows how
        // much that is, a little further.
        if self.unmoved_for > FEWEST && self.free_way.abs() > T::from_i32(HELD) {
            let wound_up = compliance * (force - self.stood_under).abs();
            let unknown = T::QUARTER * learnt.uncertainty.guessed_half_gap;
            return went_on > unknown + wound_up + slack(tables, learnt, force);
        }
        went_on > half_gap && self.is_unmoved(&tables.supervisor) && outruns(tables, learnt, went_on, force)
    }

    /// Whether readings that do not agree with the output's belong to an encoder that has slipped, rather than to one that
    /// still stands still.
    pub fn has_moved(&self) -> bool {
        self.moved
    }
}
