//! How a fault of the output encoder is found. In the order in which they are looked for; the first that is found gives the
//! encoder up:
//!
//! | # | found by | what it takes | why it is there | needed by |
//! |---|---|---|---|---|
//! | 1 | counts that jumped for good ([`Advance::Jumped`]) | readings further apart than any motor turns | a lost reference, a wrong absolute word | `observer faults::an_encoder_that_freezes_or_jumps_at_speed_is_given_up_within_a_millisecond` |
//! | 2 | [`Plausibility`]: counts that jump | a few readings that say the same | a slipped coupling, an offset; before the deflection is spoilt | `observer faults::an_encoder_that_freezes_or_jumps_at_speed_is_given_up_within_a_millisecond` |
//! | 3 | [`Plausibility`]: counts that stand still at once | fewer counts than any stop explains | a frozen encoder in motion, in a few periods | `observer faults::an_encoder_that_freezes_or_jumps_at_speed_is_given_up_within_a_millisecond` |
//! | 4 | silence ([`OutputFault::Silent`]) | no fresh reading for 10 ms | a broken line | `observer faults::a_silent_output_encoder_is_said_and_waited_for` |
//! | 5 | the motor outruns counts that stand still | more than gap and wind-up, for 4 ms | a frozen encoder that was slow, or at rest, when it froze | `observer faults::an_encoder_that_freezes_before_the_gap_is_known_is_found_by_how_far_the_motor_goes` |
//! | 6 | a deflection that no teeth allow | outside for 4 ms, longer than impacts ring | everything else: slow slip, missing counts | `observer faults::an_output_encoder_that_loses_counts_never_makes_a_width_less_than_none` |
//! | 7 | teeth that seem to have grown, or shafts to have turned against each other ([`learnt::Outcome::EncoderFails`]) | a half-gap trusted on both flanks | missing counts that stay within the gap | `observer faults::an_output_encoder_that_makes_the_gap_narrower_is_given_up_for_teeth_do_not_grow` |
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

/// Control periods between two readings over which a link is taken to keep its speed.
const SPEED_KEPT: u32 = 6;

/// What watches the output encoder while it is used.
#[derive(Debug, Clone, Copy)]
pub struct OutputFaultDetector<T: Real> {
    plausibility: Plausibility,
    silent_for: u16,
    unmoved_for: u16,
    outside_for: u16,
    /// The deflection of the teeth at the last period [m], and whether it jumped to where it is, close to the end of its range or
    /// beyond.
    deflection: T,
    jumped: bool,
    /// The deflection less wind-up when the counts moved last [m].
    stood_at: T,
    /// The deflection was not known in the last period.
    found: bool,
}

/// Nothing throws a link: what it runs into stops it.
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

/// What a reading came to.
#[derive(Debug, Clone, Copy)]
pub enum Screened<T: Real> {
    /// It is the first ever.
    First,
    /// It is used.
    Used,
    /// There is none, or it is not used.
    NotUsed,
    /// It gives the encoder up; where the link was going before, if that is known.
    GivenUp(OutputFault, Option<LastMotion<T>>),
}

/// Where the link was going when its readings broke off.
#[derive(Debug, Clone, Copy)]
pub struct LastMotion<T: Real> {
    /// Counts by which it is ahead of them.
    pub ahead: T,
    /// Counts in a period.
    pub speed: T,
}

/// Where a deflection lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Range {
    /// Between the flanks, or as far beyond as forces wind up.
    Possible,
    /// Beyond that, by no more than teeth can have worn.
    Worn,
    /// Where no teeth could let it be.
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

    /// The encoder was given up now.
    pub fn begin(&mut self) {
        self.outside_for = 0;
    }

    /// Nothing was known of the deflection until now: what stood still did so somewhere else.
    pub fn find_deflection(&mut self) {
        self.outside_for = 0;
        self.found = true;
    }

    /// Whether the deflection has been beyond its range for 4 ms, longer than impacts ring.
    pub fn is_at_odds(&self, table: &SupervisorTable<T>) -> bool {
        self.outside_for >= table.failed_after
    }

    /// Parts of an output count by which the link goes on in a period.
    pub fn rate(&self) -> i32 {
        self.plausibility.rate()
    }

    /// Whether there was no reading in the last period.
    pub fn is_silent(&self) -> bool {
        self.silent_for > 0
    }

    /// Judges the reading of one period by those before.
    // A call and what it hands back cost more than what it does in most periods.
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

    /// The first reading, or one that is far from those before.
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

    /// Readings that no link could follow.
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

    /// Whether the deflection is one that teeth allow. Teeth that have worn let it go on beyond where it could be, step by
    /// step; an encoder that slips jumps there. A link that sticks beyond a half-gap that is too small looks like a frozen
    /// encoder, until the deflection goes further than teeth can be worn. `unwound` is the deflection less wind-up [m].
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
        // What jumps to just within its range may go on beyond it.
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

    /// One more period in which the deflection is beyond its range.
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

/// Whether one shaft has gone on by more than gap and shafts let it while the other's counts stood still: one that sticks does
/// not let it, wherever the teeth are, which may not be known yet.
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

/// By what a deflection may differ from itself beside gap and wind-up [m].
pub fn slack<T: Real, const P: usize>(tables: &ObserverTables<T>, learnt: &Learnt<T, P>, force: T) -> T {
    let count = tables.counts.output.angle * tables.levers.output;
    count + T::TWO * (tables.supervisor.margin + learnt.uncertainty.softness * force.abs())
}

/// Whether a deflection of the teeth [m] is between the flanks, or as far beyond as a force [N] winds up.
pub fn is_possible<T: Real, const P: usize>(learnt: &Learnt<T, P>, deflection: T, force: T) -> bool {
    far_range(learnt, deflection, force) == Range::Possible
}

/// Whether a deflection of the teeth [m] is one that they allow, or nearly: what wears or winds up may be beyond.
pub fn is_near<T: Real, const P: usize>(learnt: &Learnt<T, P>, deflection: T) -> bool {
    far_range(learnt, deflection, T::ZERO) != Range::Impossible
}

/// What a deflection beyond the flanks is.
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
