//! Observer and compensation as one: samples and a set-point in, estimates and the shaped set-point out, once a control
//! period. Where the samples come from, and over which line, is left to whoever calls.

use super::compensation::{Command, Compensation, Shaped};
use super::observer::{Estimates, MAPPED, Memory, MemoryError, Observer, Samples};
use crate::digest::chain;
use crate::real::Real;
use crate::tables::compensation::CompensationTables;
use crate::tables::observer::ObserverTables;

/// What one control period came to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Answer<T: Real> {
    /// What the observer makes of the samples.
    pub estimates: Estimates<T>,
    /// What the compensation makes of estimates and set-point.
    pub shaped: Shaped<T>,
}

impl<T: Real> Answer<T> {
    /// Extends a digest by what says most about the rest: torque, gap, width, load, trust.
    pub fn digest(&self, running: u64) -> u64 {
        let Self { estimates, shaped } = self;
        [shaped.torque, estimates.gap.value, estimates.half_backlash.value, estimates.load_torque.value, shaped.trust]
            .iter()
            .fold(running, |digest, value| chain(digest, value.bits()))
    }
}

/// Observer, with error maps, and compensation of one joint.
#[derive(Debug, Clone)]
pub struct Controller<'tables, T: Real> {
    observer: Observer<'tables, T, MAPPED>,
    compensation: Compensation<'tables, T>,
    tables: &'tables CompensationTables<T>,
}

impl<'tables, T: Real> Controller<'tables, T> {
    /// Both as they are after a reset.
    pub fn new(observer: &'tables ObserverTables<T>, compensation: &'tables CompensationTables<T>) -> Self {
        Self { observer: Observer::new(observer), compensation: Compensation::new(compensation), tables: compensation }
    }

    /// Forgets everything but what was designed.
    pub fn reset(&mut self) {
        self.observer.restart();
        self.compensation = Compensation::new(self.tables);
    }

    /// What the observer has learnt so far.
    pub fn save(&self) -> Memory {
        self.observer.save()
    }

    /// Goes on from what was saved. Refused memories change nothing.
    pub fn load(&mut self, memory: &[u8]) -> Result<(), MemoryError> {
        self.observer.load(memory)
    }

    /// One control period. Not inlined: beside a plant that is stepped on the same chip its values would lie on the stack.
    #[inline(never)]
    pub fn step(&mut self, samples: &Samples<T>, command: &Command<T>) -> Answer<T> {
        let estimates = *self.observer.step(samples);
        let shaped = self.compensation.step(&estimates, command);
        Answer { estimates, shaped }
    }
}
