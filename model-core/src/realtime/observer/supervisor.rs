//! Watches the output encoder: when it is given up, why, and when it is taken back. What the observer does without it is
//! left to the observer.

use super::counts::Advance;
use super::estimates::{Doubt, Source};
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
    moved: u32,
    /// Load torque of one and of two watches ago, before a failing encoder could spoil it [N m].
    torques: [T; 2],
    watch: u32,
}

impl<T: Real> Supervisor<T> {
    pub fn new(has_output: bool) -> Self {
        Self {
            source: if has_output { Source::MotorOnly(Doubt::Silent) } else { Source::MotorOnly(Doubt::Absent) },
            silent_for: 0,
            unmoved_for: 0,
            outside_for: 0,
            inside_for: 0,
            moved: 0,
            torques: [T::ZERO; 2],
            watch: 0,
        }
    }

    pub fn source(&self) -> Source {
        self.source
    }

    /// What the encoder gave in this period.
    pub fn hear(&mut self, table: &SupervisorTable<T>, advance: Option<Advance>) {
        let _ = table;
        match advance {
            None => self.silent_for = self.silent_for.saturating_add(1),
            Some(Advance::Began) => self.source = Source::Both,
            Some(_) => self.silent_for = 0,
        }
    }
}
