//! Watches the output encoder: when it is given up, why, and when it is taken back. What the observer does without it is
//! left to `motor_only`.

use super::counts::Advance;
use super::estimates::{Doubt, Source};
use super::motion::magnitude;
use crate::numbers::Real;
use crate::observer::tables::SupervisorTable;

/// Standing of the output encoder.
#[derive(Debug, Clone, Copy)]
pub(super) struct Supervisor<T: Real> {
    source: Source,
    silent_for: u16,
    unmoved_for: u16,
    outside_for: u16,
    /// Intervals in motion in which it said what was learnt.
    inside_for: u16,
    /// Intervals in motion in which it said the same as before, and what: the way beyond what was learnt, on the back side
    /// and on the drive side [m].
    steady_for: u16,
    steady: [T; 2],
    /// The way at the last period, and whether it leapt to where it is [m].
    way: T,
    leapt: bool,
    /// The way less wind-up when its counts moved last [m].
    stood_at: T,
    /// Where the output was when it moved last [2^-32 turns].
    place: u32,
    /// Load torque of the last and of the last but one look, before a failing encoder could spoil it [N m].
    torques: [T; 2],
    looked: u16,
}

/// Where a way lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// Between the flanks, or as far beyond as forces wind up.
    Possible,
    /// Beyond that, by no more than teeth can have worn.
    Worn,
    /// Where no teeth could let it be.
    Impossible,
}

/// How the output encoder comes back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Return {
    /// It says what was learnt.
    AsLearnt,
    /// It turns with the motor, but something else was learnt.
    Otherwise,
}

/// An encoder that turns with the motor must do so this many times longer if it says anything else than what was learnt.
const OTHERWISE: u16 = 3;

/// Intervals between two looks at the load torque: longer than it takes to find a failure.
const LOOK: u16 = 16;

impl<T: Real> Supervisor<T> {
    pub fn new(has_output: bool) -> Self {
        Self {
            source: Source::MotorOnly(if has_output { Doubt::Silent } else { Doubt::Absent }),
            silent_for: 0,
            unmoved_for: 0,
            outside_for: 0,
            inside_for: 0,
            steady_for: 0,
            steady: [T::ZERO; 2],
            way: T::ZERO,
            leapt: false,
            stood_at: T::ZERO,
            place: 0,
            torques: [T::ZERO; 2],
            looked: 0,
        }
    }

    pub fn source(&self) -> Source {
        self.source
    }

    /// Whether both encoders are used.
    pub fn sees_both(&self) -> bool {
        matches!(self.source, Source::Both)
    }

    /// What the encoder gave in this period. True when it is there for the first time.
    pub fn hear(&mut self, advance: Option<Advance>) -> bool {
        match advance {
            None => {
                self.silent_for = self.silent_for.saturating_add(1);
                return false;
            }
            Some(Advance::By(0)) => self.unmoved_for = self.unmoved_for.saturating_add(1),
            Some(_) => self.unmoved_for = 0,
        }
        self.silent_for = 0;
        let began = advance == Some(Advance::Began);
        if began {
            self.source = Source::Both;
        }
        began
    }

    /// By how much the way less wind-up has gone on since the encoder's counts moved last.
    pub fn went_on(&mut self, way: T) -> T {
        if self.unmoved_for == 0 {
            self.stood_at = way;
        }
        way - self.stood_at
    }

    /// Whether the way has been where it could not be for longer than impacts ring: teeth have worn, or the encoder fails.
    pub fn is_at_odds(&self, table: &SupervisorTable<T>) -> bool {
        self.outside_for >= table.failed_after
    }

    /// Whether the way is one that teeth allow; true when the encoder is given up now. Teeth that have worn let the way
    /// go on beyond where it could be, step by step; an encoder that slips leaps there. A link that sticks beyond a width
    /// that is too small looks like a frozen encoder, until the way goes further than teeth can be worn.
    pub fn judge(&mut self, table: &SupervisorTable<T>, way: T, place: Place) -> bool {
        let by = way - core::mem::replace(&mut self.way, way);
        if !self.sees_both() {
            return false;
        }
        if place == Place::Possible {
            self.leapt = false;
            self.outside_for = 0;
        } else {
            self.leapt |= magnitude(by) > table.margin;
            self.outside_for = self.outside_for.saturating_add(1);
        }
        let doubt = if self.silent_for > table.silent_after {
            Doubt::Silent
        } else if self.outside_for < table.failed_after || place == Place::Worn && !self.leapt {
            return false;
        } else if self.unmoved_for >= table.failed_after {
            Doubt::Frozen
        } else {
            Doubt::OutOfRange
        };
        self.give_up(doubt);
        true
    }

    /// The encoder is not used from now on.
    pub fn give_up(&mut self, doubt: Doubt) {
        self.source = Source::MotorOnly(doubt);
        self.outside_for = 0;
        self.inside_for = 0;
        self.steady_for = 0;
        self.steady = [T::ZERO; 2];
    }

    /// Load torque as it was before the last possible failure began.
    pub fn torque_before(&self) -> T {
        let [_, before] = self.torques;
        before
    }

    /// Once an interval, with the output in use.
    pub fn remember(&mut self, torque: T) {
        self.looked += 1;
        if self.looked >= LOOK {
            self.looked = 0;
            self.torques = [torque, self.torques[0]];
        }
    }

    /// Once an interval without it: in settled contact the side of the teeth, by how much the way that it would give is
    /// beyond what was learnt there, and what may be between ways that agree; elsewhere whether that way is between the
    /// flanks. Besides, where the output is [2^-32 turns]. Says when it is taken back.
    pub fn reconsider(
        &mut self,
        table: &SupervisorTable<T>,
        settled: Option<(T, T, T)>,
        between: bool,
        place: u32,
    ) -> Option<Return> {
        let agrees = if let Some((side, beyond, room)) = settled {
            let [back, drive] = &mut self.steady;
            let steady = if side > T::ZERO { drive } else { back };
            if magnitude(beyond - *steady) > room {
                *steady = beyond;
                self.steady_for = 0;
            }
            magnitude(beyond) < room
        } else {
            between
        };
        if !agrees {
            self.inside_for = 0;
        }
        // An encoder that stands still and flickers does not turn.
        let went = place.wrapping_sub(self.place) as i32;
        if self.silent_for == 0 && went.unsigned_abs() >= table.moved {
            self.place = place;
            self.steady_for = self.steady_for.saturating_add(u16::from(settled.is_some()));
            self.inside_for = self.inside_for.saturating_add(u16::from(agrees));
        }
        let back = if self.inside_for >= table.trusted_after {
            Return::AsLearnt
        } else if self.steady_for >= table.trusted_after.saturating_mul(OTHERWISE) {
            Return::Otherwise
        } else {
            return None;
        };
        if self.source == Source::MotorOnly(Doubt::Absent) {
            return None;
        }
        self.source = Source::Both;
        Some(back)
    }
}
