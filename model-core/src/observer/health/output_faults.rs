//! Faults of the output encoder (O23, O24), in the order of the checks. The first check that fails excludes the
//! encoder:
//!
//! | # | found by | condition | purpose | needed by |
//! |---|---|---|---|---|
//! | 1 | counts that jumped for good ([`Advance::Jumped`]) | readings farther apart than any motor turns | a lost reference, a wrong absolute word | `observer faults::output_fault_at_speed_is_excluded_in_1_ms` |
//! | 2 | [`Plausibility`]: counts that jump | a few readings that confirm the jump | a slipped coupling, an offset; acts before the deflection is corrupted | `observer faults::output_fault_at_speed_is_excluded_in_1_ms` |
//! | 3 | [`Plausibility`]: counts that stand still at once | fewer counts than any stop explains | a frozen encoder in motion, within a few periods | `observer faults::output_fault_at_speed_is_excluded_in_1_ms` |
//! | 4 | silence ([`OutputFault::Silent`]) | no fresh reading for 10 ms | a broken line | `observer faults::silent_output_is_reported_and_readmitted` |
//! | 5 | the motor outruns counts that stand still | more than gap and wind-up, for 4 ms | an encoder that froze in slow motion or at rest | `observer faults::motor_travel_reveals_frozen_output` |
//! | 6 | a deflection that no teeth allow | out of range for 4 ms, longer than impacts ring | all other faults: slow slip, missing counts | `observer faults::lost_counts_keep_half_backlash_positive` |
//! | 7 | teeth that seem to have grown, or shafts to have turned against each other ([`learnt::Outcome::EncoderFails`]) | a half-gap trusted on both flanks | missing counts that stay within the gap | `observer faults::narrowing_output_is_excluded` |
//!
//! [`learnt::Outcome::EncoderFails`]: crate::observer::learnt::Outcome::EncoderFails

use super::plausibility::{Plausibility, Surroundings, Verdict, counts};
use crate::numbers::Real;
use crate::observer::estimates::OutputFault;
use crate::observer::learnt::Learnt;
use crate::observer::learnt::fusion::Fused;
use crate::observer::sensors::Sensed;
use crate::observer::sensors::counts::Advance;
use crate::observer::tables::{ObserverTables, StopTable, SupervisorTable};

/// Longest interval between two readings over which the link's speed is kept [control periods].
const SPEED_KEPT: u32 = 6;

/// Fault checks of the output encoder.
#[derive(Debug, Clone, Copy)]
pub struct OutputFaultDetector<T: Real> {
    plausibility: Plausibility,
    silent_for: u16,
    unmoved_for: u16,
    outside_for: u16,
    /// Deflection of the teeth in the last period [m]. `jumped`: the deflection jumped to its present place, beyond its
    /// range or within the margin of its end.
    deflection: T,
    jumped: bool,
    /// Deflection less wind-up when the counts last changed [m].
    stood_at: T,
    /// True if the deflection was unknown in the last period.
    found: bool,
}

/// An obstacle stops a link; nothing throws a link.
impl<T: Real> Surroundings<T> for SupervisorTable<T> {
    fn stops(&self) -> &StopTable<T> {
        &self.output
    }

    fn brake(&self) -> T {
        self.output_brake
    }

    fn throw(&self, _: i32) -> i32 {
        0
    }

    fn carried(&self, _: i32) -> i32 {
        0
    }

    fn sure(&self, rate: i32) -> T {
        counts(rate)
    }
}

/// Result of screening a reading.
#[derive(Debug, Clone, Copy)]
pub enum Screened<T: Real> {
    /// First reading of the run; accepted.
    First,
    /// The reading is used.
    Used,
    /// The reading is missing or rejected.
    NotUsed,
    /// The reading excludes the encoder. The last motion of the link is given if known.
    GivenUp(OutputFault, Option<LastMotion<T>>),
}

/// Motion of the link when its readings broke off.
#[derive(Debug, Clone, Copy)]
pub struct LastMotion<T: Real> {
    /// Lead of the link over its last reading [counts].
    pub ahead: T,
    /// Speed [counts per period].
    pub speed: T,
}

/// Range of a deflection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Range {
    /// Between the flanks, or beyond a flank by at most the wind-up.
    Possible,
    /// Farther beyond a flank, by no more than wear.
    Worn,
    /// Beyond wear: no teeth allow the deflection.
    Impossible,
}

impl<T: Real> OutputFaultDetector<T> {
    pub fn new() -> Self {
        Self {
            plausibility: Plausibility::new(),
            silent_for: 0,
            unmoved_for: 0,
            outside_for: 0,
            deflection: T::ZERO,
            jumped: false,
            stood_at: T::ZERO,
            found: false,
        }
    }

    /// Starts the time out of range anew after an exclusion.
    pub fn begin(&mut self) {
        self.outside_for = 0;
    }

    /// Starts anew after an unknown deflection: counts that stood still did so at another deflection.
    pub fn find_deflection(&mut self) {
        self.outside_for = 0;
        self.found = true;
    }

    /// Returns true once the deflection has been out of range for 4 ms, longer than impacts ring.
    pub fn is_at_odds(&self, table: &SupervisorTable<T>) -> bool {
        self.outside_for >= table.failed_after
    }

    /// Speed of the link [parts of an output count per period].
    pub fn rate(&self) -> i32 {
        self.plausibility.rate()
    }

    /// Returns true if the last period had no reading.
    pub fn is_silent(&self) -> bool {
        self.silent_for > 0
    }

    /// Judges the reading of one period by the readings before.
    // Inlined: a call and its result cost more than the work of most periods.
    #[inline(always)]
    pub fn screen(&mut self, tables: &ObserverTables<T>, sensed: &Sensed<T>, both_encoders: bool) -> Screened<T> {
        let by = match sensed.output {
            None => {
                self.silent_for = self.silent_for.saturating_add(1);
                return Screened::NotUsed;
            }
            Some(Advance::By(by)) => by,
            Some(advance) => return self.screen_odd(advance, both_encoders),
        };
        self.silent_for = 0;
        self.unmoved_for = if by == 0 { self.unmoved_for.saturating_add(1) } else { 0 };
        let used = if both_encoders { Screened::Used } else { Screened::NotUsed };
        let clock = &tables.clock;
        let beyond = sensed.output_interval.wrapping_sub(clock.shortest);
        if beyond > clock.longer {
            self.plausibility.miss(by, beyond > clock.period.saturating_mul(SPEED_KEPT));
            return used;
        }
        match self.plausibility.take(&tables.supervisor, by) {
            Verdict::Plausible => used,
            Verdict::Suspect => Screened::NotUsed,
            Verdict::Implausible => self.implausible(both_encoders),
        }
    }

    /// Handles the first reading, and a reading far from the last one.
    #[cold]
    fn screen_odd(&mut self, advance: Advance, both_encoders: bool) -> Screened<T> {
        self.silent_for = 0;
        self.unmoved_for = 0;
        match advance {
            Advance::Began => Screened::First,
            Advance::Jumped(_) if both_encoders => {
                self.plausibility.lose();
                Screened::GivenUp(OutputFault::OutOfRange, None)
            }
            Advance::Jumped(_) | Advance::Implausible | Advance::By(_) => Screened::NotUsed,
        }
    }

    /// Excludes the encoder after readings that no link can follow.
    #[cold]
    fn implausible(&mut self, both_encoders: bool) -> Screened<T> {
        let last = self.plausibility.speed().map(|speed| LastMotion { ahead: self.plausibility.ahead(), speed });
        let frozen = last.is_some() && self.plausibility.stands_still();
        self.plausibility.lose();
        if both_encoders {
            Screened::GivenUp(if frozen { OutputFault::Frozen } else { OutputFault::OutOfRange }, last)
        } else {
            Screened::NotUsed
        }
    }

    /// Judges the deflection. Worn teeth extend its range step by step; a slipping encoder makes the deflection jump. A
    /// link that sticks beyond a half-gap estimated too small looks like a frozen encoder until the deflection exceeds
    /// possible wear. `unwound` is the deflection less wind-up [m].
    pub fn judge<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        fused: &Fused<T>,
        learnt: &Learnt<T, P>,
        unwound: T,
        both_encoders: bool,
    ) -> Option<OutputFault> {
        let table = &tables.supervisor;
        let deflection = fused.of_teeth();
        let [half_gap, _] = learnt.shape();
        if self.unmoved_for == 0 || core::mem::take(&mut self.found) {
            self.stood_at = unwound;
        }
        let by = deflection - core::mem::replace(&mut self.deflection, deflection);
        if !both_encoders {
            return None;
        }
        let went_on = (unwound - self.stood_at).abs();
        let range = if went_on > half_gap && outruns(tables, learnt, went_on, fused.force) {
            Range::Impossible
        } else if deflection.abs() < learnt.uncertainty.reach {
            Range::Possible
        } else {
            far_range(learnt, deflection, fused.force)
        };
        // A deflection that jumps to the end of its range may continue beyond it.
        let near = deflection.abs() + table.margin > learnt.uncertainty.reach;
        self.jumped = near && (self.jumped || by.abs() > table.margin);
        let beyond = if range == Range::Possible {
            self.outside_for = 0;
            None
        } else {
            self.beyond(table, range)
        };
        if self.silent_for > table.silent_after { Some(OutputFault::Silent) } else { beyond }
    }

    /// Counts one more period with the deflection out of range.
    #[cold]
    fn beyond(&mut self, table: &SupervisorTable<T>, range: Range) -> Option<OutputFault> {
        self.outside_for = self.outside_for.saturating_add(1);
        if self.outside_for < table.failed_after || range == Range::Worn && !self.jumped {
            None
        } else if self.unmoved_for >= table.failed_after {
            Some(OutputFault::Frozen)
        } else {
            Some(OutputFault::OutOfRange)
        }
    }
}

/// Returns true if one shaft has moved by more than gap and wind-up allow while the other's counts stood still (O24).
/// The test needs no knowledge of the flank.
#[cold]
pub fn outruns<T: Real, const P: usize>(
    tables: &ObserverTables<T>,
    learnt: &Learnt<T, P>,
    went_on: T,
    force: T,
) -> bool {
    let [half_gap, _] = learnt.shape();
    let [half_gap_variance, ..] = learnt.uncertainty.variances;
    let by_learnt = half_gap + T::THREE * half_gap_variance.square_root();
    let by_guess = learnt.uncertainty.guessed_half_gap;
    let widest = if by_guess > by_learnt { by_guess } else { by_learnt };
    went_on > T::TWO * widest + slack(tables, learnt, force)
}

/// Tolerance of a change of the deflection beside gap and wind-up [m].
pub fn slack<T: Real, const P: usize>(tables: &ObserverTables<T>, learnt: &Learnt<T, P>, force: T) -> T {
    let count = tables.counts.output.angle * tables.levers.output;
    count + T::TWO * (tables.supervisor.margin + learnt.uncertainty.softness * force.abs())
}

/// Returns true if a deflection of the teeth [m] lies between the flanks or beyond a flank by at most the wind-up of a
/// force [N].
pub fn is_possible<T: Real, const P: usize>(learnt: &Learnt<T, P>, deflection: T, force: T) -> bool {
    far_range(learnt, deflection, force) == Range::Possible
}

/// Returns true if a deflection of the teeth [m] lies in its range, or beyond it by no more than wear or wind-up.
pub fn is_near<T: Real, const P: usize>(learnt: &Learnt<T, P>, deflection: T) -> bool {
    far_range(learnt, deflection, T::ZERO) != Range::Impossible
}

/// Range of a deflection beyond the flanks.
#[cold]
fn far_range<T: Real, const P: usize>(learnt: &Learnt<T, P>, deflection: T, force: T) -> Range {
    let [half_gap, compliance] = learnt.shape();
    let (beyond, force) = if deflection > T::ZERO { (deflection, force) } else { (-deflection, -force) };
    let wind_up = if force > T::ZERO { compliance * force } else { T::ZERO };
    let beyond = beyond - wind_up - learnt.uncertainty.reach;
    if beyond < T::ZERO {
        Range::Possible
    } else if beyond < half_gap {
        Range::Worn
    } else {
        Range::Impossible
    }
}
