//! Watches the output encoder: when it is given up, why, and when it is taken back. What the observer does without it is
//! left to `motor_only`.

use super::counts::Advance;
use super::estimates::{Doubt, Source};
use super::motion::magnitude;
use crate::real::Real;
use crate::tables::observer::SupervisorTable;

/// Standing of the output encoder.
#[derive(Debug, Clone, Copy)]
pub(super) struct Supervisor<T: Real> {
    source: Source,
    silent_for: u32,
    unmoved_for: u32,
    outside_for: u32,
    inside_for: u32,
    /// The way at the last period, and whether it leapt to where it is [m].
    way: T,
    leapt: bool,
    /// The output has moved since the last look.
    moved: bool,
    /// Load torque of the last and of the last but one look, before a failing encoder could spoil it [N m].
    torques: [T; 2],
    looked: u32,
}

/// Where a way lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// Between the flanks, or as far beyond as forces wind up.
    Possible,
    /// Beyond that, by no more than teeth can have worn; whether the motor turns.
    Worn {
        /// The motor turns by more than the output could hide.
        turning: bool,
    },
    /// Where no teeth could let it be.
    Impossible,
}

/// Intervals between two looks at the load torque: longer than it takes to find a failure.
const LOOK: u32 = 16;

impl<T: Real> Supervisor<T> {
    pub fn new(has_output: bool) -> Self {
        Self {
            source: Source::MotorOnly(if has_output { Doubt::Silent } else { Doubt::Absent }),
            silent_for: 0,
            unmoved_for: 0,
            outside_for: 0,
            inside_for: 0,
            way: T::ZERO,
            leapt: false,
            moved: false,
            torques: [T::ZERO; 2],
            looked: 0,
        }
    }

    pub fn source(&self) -> Source {
        self.source
    }

    /// What the encoder gave in this period. True when it is there for the first time.
    pub fn hear(&mut self, advance: Option<Advance>) -> bool {
        match advance {
            None => {
                self.silent_for = self.silent_for.saturating_add(1);
                return false;
            }
            Some(Advance::By(0)) => self.unmoved_for = self.unmoved_for.saturating_add(1),
            Some(_) => {
                self.unmoved_for = 0;
                self.moved = true;
            }
        }
        self.silent_for = 0;
        let began = advance == Some(Advance::Began);
        if began {
            self.source = Source::Both;
        }
        began
    }

    /// Whether the way has been where it could not be for longer than impacts ring: teeth have worn, or the encoder fails.
    pub fn is_at_odds(&self, table: &SupervisorTable<T>) -> bool {
        self.outside_for >= table.failed_after
    }

    /// Whether the way is one that teeth allow; true when the encoder is given up now. Teeth that have worn let the way
    /// go on beyond where it could be, step by step; an encoder that slips leaps there.
    pub fn judge(&mut self, table: &SupervisorTable<T>, way: T, place: Place) -> bool {
        let by = way - core::mem::replace(&mut self.way, way);
        if self.source != Source::Both {
            return false;
        }
        let possible = place == Place::Possible;
        self.leapt = !possible && (self.leapt || magnitude(by) > table.margin);
        self.outside_for = if possible { 0 } else { self.outside_for.saturating_add(1) };
        let doubt = if self.silent_for > table.silent_after {
            Doubt::Silent
        } else if self.outside_for < table.failed_after {
            return false;
        } else if self.unmoved_for >= table.failed_after && place != (Place::Worn { turning: false }) {
            Doubt::Frozen
        } else if matches!(place, Place::Worn { .. }) && !self.leapt {
            return false;
        } else {
            Doubt::OutOfRange
        };
        self.source = Source::MotorOnly(doubt);
        self.outside_for = 0;
        self.inside_for = 0;
        true
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

    /// Once an interval, without it: whether the encoder says what the motor implies, `None` where that cannot be told.
    /// True when it is taken back now.
    pub fn reconsider(&mut self, table: &SupervisorTable<T>, agrees: Option<bool>) -> bool {
        let moved = self.moved && self.silent_for == 0;
        self.moved = false;
        match agrees {
            Some(true) if moved => self.inside_for += 1,
            Some(false) => self.inside_for = 0,
            _ => {}
        }
        let trusted = self.inside_for >= table.trusted_after && self.source != Source::MotorOnly(Doubt::Absent);
        if trusted {
            self.source = Source::Both;
        }
        trusted
    }
}
